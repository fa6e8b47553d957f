//! Lines, words, cells and numbers of text files, and how messages quote them.

use std::io::{BufRead, Read};

use anyhow::{Context, bail, ensure};

use crate::raw::gzip::Unpacking;
use crate::raw::room::numbered;

/// Maximum length of a line in bytes. A longer line means that the file is not text.
pub const LONGEST_LINE: usize = 1 << 20;

pub struct Source<'a> {
    pub input: &'a mut dyn BufRead,
    pub name: &'a str,
    pub(crate) unpacking: &'a Unpacking,
}

impl Source<'_> {
    /// Fills `bytes`; returns false if the file is too short.
    pub fn fill(&mut self, bytes: &mut [u8]) -> anyhow::Result<bool> {
        match self.input.read_exact(bytes) {
            Ok(()) => Ok(true),
            Err(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => Ok(false),
            Err(error) => Err(error).with_context(|| format!("cannot read {}", self.name)),
        }
    }

    /// Skips `count` bytes; returns false if the file is too short.
    pub fn skip(&mut self, count: u64) -> anyhow::Result<bool> {
        let skipped = std::io::copy(&mut Read::take(&mut self.input, count), &mut std::io::sink());
        Ok(skipped.with_context(|| format!("cannot read {}", self.name))? == count)
    }
}

/// The lines of a text, numbered from 1, without line ends. All share one buffer.
pub struct Lines<'a> {
    pub source: Source<'a>,
    line: Vec<u8>,
    number: u64,
    ended: bool,
}

/// The place of the line, for messages.
impl std::fmt::Display for Lines<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}:{}", self.source.name, self.number)
    }
}

impl<'a> Lines<'a> {
    pub fn new(source: Source<'a>) -> Lines<'a> {
        Lines { source, line: Vec::new(), number: 0, ended: false }
    }

    pub fn advance(&mut self) -> anyhow::Result<bool> {
        self.line.clear();
        self.number += 1;
        let read = Read::take(&mut self.source.input, LONGEST_LINE as u64 + 1)
            .read_until(b'\n', &mut self.line);
        read.with_context(|| format!("cannot read {}", self.place()))?;
        let more = !self.line.is_empty();
        if more {
            self.ended = self.line.ends_with(b"\n");
        }
        if self.number == 1 && self.line.starts_with(b"\xef\xbb\xbf") {
            self.line.drain(..3);
        }
        while let Some(b'\n' | b'\r') = self.line.last() {
            self.line.pop();
        }
        if self.line.contains(&b'\r') {
            bail!("{self}: a line ends in a carriage return; write line feeds: tr '\\r' '\\n'");
        }
        if self.line.len() > LONGEST_LINE {
            bail!("{self}: the line is longer than {LONGEST_LINE} bytes; this is no text");
        }
        Ok(more)
    }

    /// Reads the next line that is not blank; returns false at the end.
    pub fn advance_over_blanks(&mut self) -> anyhow::Result<bool> {
        while self.advance()? {
            if !self.line().is_empty() {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Reads row `k` of `n`. If the file has fewer, the error uses `of`, which names the rows and
    /// the remedy.
    pub fn row(&mut self, k: u64, n: u64, of: &str) -> anyhow::Result<()> {
        ensure!(self.advance()?, "{} ends after {k} of the {n} {of}", self.source.name);
        Ok(())
    }

    pub fn line(&self) -> &[u8] {
        self.line.trim_ascii()
    }

    /// Returns the line as text; a line that is not UTF-8 is read as Latin-1.
    pub fn text(&self) -> String {
        decoded(self.line())
    }

    /// Whether the line ends with a line feed.
    pub fn ended(&self) -> bool {
        self.ended
    }

    pub fn place(&self) -> String {
        self.to_string()
    }

    pub fn count(&self, text: &[u8], what: &str) -> anyhow::Result<u64> {
        let Some(n) = std::str::from_utf8(text).ok().and_then(|text| text.parse::<u64>().ok())
        else {
            bail!("{self}: '{}' is not {what}", shown(text));
        };
        numbered(n, "particles").with_context(|| self.place())?;
        Ok(n)
    }
}

/// Parses a number with correct rounding, including infinities and NaN. The exponent may follow a
/// D, as in Fortran.
pub fn number(cell: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(cell).ok()?;
    let other = || {
        // Fortran writes 1.0D+00, Mathematica 1.0*^0.
        let (mantissa, exponent) = text.split_once("*^").or(text.split_once(['d', 'D']))?;
        exponent.parse::<i32>().ok()?;
        format!("{mantissa}e{exponent}").parse().ok()
    };
    text.parse().ok().or_else(other)
}

/// Parses a whole number, also if written as `12.0` or `1.2000e+01`.
///
/// Returns `None` for `1e+06` and `1.23457e+06`, because `%g` keeps six digits and may have rounded
/// another number. If there is an exponent, all digits of the number must be written.
pub fn whole(cell: &[u8]) -> Option<i64> {
    let text = std::str::from_utf8(cell).ok()?;
    if let Ok(whole) = text.parse() {
        return Some(whole);
    }
    let (mantissa, exponent) = text.split_once(['e', 'E', 'd', 'D']).unwrap_or((text, "0"));
    let places = mantissa.split_once('.').map_or(0, |(_, places)| places.len());
    let complete = exponent.parse::<i64>().is_ok_and(|exponent| exponent <= places as i64);
    number(cell).filter(|_| complete).and_then(exact)
}

/// Returns a number of a binary file as a whole number; `None` if it is not whole or not exact.
pub fn exact(value: f64) -> Option<i64> {
    (value.fract() == 0.0 && value.abs() < 9e15).then_some(value as i64)
}

pub(crate) fn step_of(cell: &[u8]) -> Option<i64> {
    std::str::from_utf8(cell).ok()?.parse().ok()
}

pub(crate) fn among(list: &str, word: &str) -> bool {
    list.split(' ').any(|it| it == word)
}

pub fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

pub fn texts(line: &[u8]) -> Vec<String> {
    words(line).map(decoded).collect()
}

#[derive(Clone, Copy, Default, PartialEq)]
pub(crate) enum Separator {
    One(u8),
    #[default]
    Blanks,
}

impl Separator {
    /// Guesses the separator of a line, ignoring quoted text: semicolon, else comma, else tab, else
    /// blanks.
    pub fn guess(line: &[u8]) -> Separator {
        let bare: Vec<u8> = line.split(|&b| b == b'"').step_by(2).flatten().copied().collect();
        [b';', b',', b'\t']
            .into_iter()
            .find(|c| bare.contains(c))
            .map_or(Separator::Blanks, Separator::One)
    }

    pub fn cells(self, line: &[u8]) -> Cells<'_> {
        Cells { rest: Some(line), separator: self }
    }
}

#[derive(Clone)]
pub struct Cells<'a> {
    rest: Option<&'a [u8]>,
    separator: Separator,
}

impl<'a> Iterator for Cells<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let mut rest = self.rest?;
        if self.separator == Separator::Blanks {
            rest = rest.trim_ascii_start();
            if rest.is_empty() {
                self.rest = None;
                return None;
            }
        }
        let from = quoted(rest).unwrap_or(0);
        let mut bytes = rest[from..].iter();
        let end = match self.separator {
            Separator::One(c) => bytes.position(|&b| b == c),
            Separator::Blanks => bytes.position(u8::is_ascii_whitespace),
        };
        let end = end.map(|end| from + end);
        self.rest = end.map(|end| &rest[end + 1..]);
        Some(unquoted(rest[..end.unwrap_or(rest.len())].trim_ascii()))
    }
}

/// Returns the end of the quoted text at the start of a line; `None` without quotes, or if they
/// stay open.
fn quoted(line: &[u8]) -> Option<usize> {
    if line.iter().find(|byte| !byte.is_ascii_whitespace()).is_none_or(|byte| *byte != b'"') {
        return None;
    }
    let mut at = line.iter().position(|&byte| byte == b'"')? + 1;
    loop {
        at += line[at..].iter().position(|&byte| byte == b'"')? + 1;
        match line.get(at) {
            Some(b'"') => at += 1,
            _ => return Some(at),
        }
    }
}

pub(crate) fn is_comment(line: &[u8]) -> bool {
    matches!(line, [b'#' | b'%' | b'!', ..] | [b'/', b'/', ..])
}

/// Removes a comment that starts with # or % after a blank or a separator.
pub(crate) fn uncommented(line: &[u8]) -> &[u8] {
    if !line.contains(&b'#') && !line.contains(&b'%') {
        return line;
    }
    let mut is_quoted = false;
    for (k, byte) in line.iter().enumerate() {
        is_quoted ^= *byte == b'"';
        let is_behind = || matches!(line[k - 1], b' ' | b'\t' | b',' | b';');
        if matches!(byte, b'#' | b'%') && !is_quoted && k > 0 && is_behind() {
            return line[..k].trim_ascii_end();
        }
    }
    line
}

/// Returns a line of names without its comment. The sign in a name such as `Spot #` has a separator
/// behind it, unlike that of a comment.
pub(crate) fn header_of(text: &[u8]) -> &[u8] {
    let line = uncommented(text);
    let few = words(line).count() < 2 || Separator::guess(line) != Separator::Blanks;
    match Separator::guess(text) {
        Separator::One(c) if few && text[line.len()..].trim_ascii_start().get(1) == Some(&c) => {
            text
        }
        _ => line,
    }
}

fn unquoted(cell: &[u8]) -> &[u8] {
    if let [b'"', inner @ .., b'"'] = cell { inner.trim_ascii() } else { cell }
}

/// Characters that word processors write for a minus.
pub(crate) const MINUS: [char; 2] = ['\u{2212}', '\u{2013}'];

/// Shortens a text for messages, and replaces characters that could control a terminal.
pub fn short(text: &str) -> String {
    let shown: String = text
        .chars()
        .take(40)
        .map(|c| {
            let is_plain = c.is_alphanumeric() || c.is_ascii_graphic() || c == ' ';
            if is_plain || MINUS.contains(&c) { c } else { '\u{fffd}' }
        })
        .collect();
    if text.chars().nth(40).is_some() { shown + "…" } else { shown }
}

pub fn listed<S: AsRef<str>>(names: &[S]) -> String {
    let shown: Vec<String> = names.iter().take(8).map(|name| short(name.as_ref())).collect();
    shown.join(" ") + if names.len() > 8 { " …" } else { "" }
}

pub fn shown(bytes: &[u8]) -> String {
    short(&String::from_utf8_lossy(&bytes[..bytes.len().min(200)]))
}

/// Decodes UTF-8, or Latin-1 if it is not UTF-8: Excel may write `r [µm]` in Latin-1.
pub fn decoded(bytes: &[u8]) -> String {
    let latin = || bytes.iter().map(|&byte| char::from(byte)).collect();
    std::str::from_utf8(bytes).map_or_else(|_| latin(), String::from)
}
