//! Text as files hold it: lines with numbers, words across lines, cells of a line, and how they are
//! shown in messages.

use std::io::{BufRead, Read};

use anyhow::{Context, bail, ensure};

use crate::formats::gzip::Unpacking;
use crate::room::numbered;

/// Longest line of a text file. A longer one is some other kind of file, and would fill the memory.
pub const LONGEST_LINE: usize = 1 << 20;

/// Bytes of a file, from the first on, and the file's name for messages.
pub struct Source<'a> {
    pub input: &'a mut dyn BufRead,
    pub name: &'a str,
    pub(crate) unpacking: &'a Unpacking,
}

impl Source<'_> {
    /// Fills `bytes`. False where the file ends before.
    pub fn fill(&mut self, bytes: &mut [u8]) -> anyhow::Result<bool> {
        match self.input.read_exact(bytes) {
            Ok(()) => Ok(true),
            Err(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => Ok(false),
            Err(error) => Err(error).with_context(|| format!("cannot read {}", self.name)),
        }
    }

    /// Passes over `count` bytes. False where the file ends before.
    pub fn skip(&mut self, count: u64) -> anyhow::Result<bool> {
        let skipped = std::io::copy(&mut Read::take(&mut self.input, count), &mut std::io::sink());
        Ok(skipped.with_context(|| format!("cannot read {}", self.name))? == count)
    }
}

/// The lines of a text, numbered from 1, without their ends. One buffer serves them all.
pub struct Lines<'a> {
    pub source: Source<'a>,
    line: Vec<u8>,
    number: u64,
    /// Where the next word is looked for.
    at: usize,
    /// Where the last word began.
    word: usize,
    /// The line ends in a line feed.
    ended: bool,
}

impl<'a> Lines<'a> {
    pub fn new(source: Source<'a>) -> Lines<'a> {
        Lines { source, line: Vec::new(), number: 0, at: 0, word: 0, ended: false }
    }

    /// Goes to the next line; false at the end.
    pub fn advance(&mut self) -> anyhow::Result<bool> {
        self.line.clear();
        (self.at, self.word) = (0, 0);
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
            bail!(
                "{}: a line ends in a carriage return alone, as old Macintosh files have it; write \
                 line feeds: tr '\\r' '\\n'",
                self.place()
            );
        }
        if self.line.len() > LONGEST_LINE {
            bail!(
                "{}: the line is longer than {LONGEST_LINE} bytes; this is not a particle file",
                self.place()
            );
        }
        Ok(more)
    }

    /// Goes to the next line that is not blank; false at the end.
    pub fn advance_over_blanks(&mut self) -> anyhow::Result<bool> {
        while self.advance()? {
            if !self.line().is_empty() {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Goes to row `k` of `n`. If the file ends before, `of` names the rows and the remedy in the
    /// error.
    pub fn row(&mut self, k: u64, n: u64, of: &str) -> anyhow::Result<()> {
        ensure!(self.advance()?, "{} ends after {k} of the {n} {of}", self.source.name);
        Ok(())
    }

    /// The line, without blanks around it.
    pub fn line(&self) -> &[u8] {
        self.line.trim_ascii()
    }

    /// The line as text, for headers and messages; what is no UTF-8 becomes U+FFFD.
    pub fn text(&self) -> String {
        String::from_utf8_lossy(self.line()).into_owned()
    }

    pub fn at(&self) -> u64 {
        self.number
    }

    /// The number of the line, and whether it ends in a line feed.
    pub fn end(&self) -> (u64, bool) {
        (self.number, self.ended)
    }

    /// Whether the last line that was there ends in a line feed.
    pub fn ended(&self) -> bool {
        self.ended
    }

    /// `file:line`.
    pub fn place(&self) -> String {
        format!("{}:{}", self.source.name, self.number)
    }

    /// `file:line:column` of the last word; the column counts bytes from 1.
    pub fn place_of_word(&self) -> String {
        format!("{}:{}:{}", self.source.name, self.number, self.word + 1)
    }

    /// The next word, on this line or a later one; none at the end. Words are separated by blanks.
    pub fn word(&mut self) -> anyhow::Result<Option<&[u8]>> {
        loop {
            let rest = self.line.get(self.at..).unwrap_or_default();
            if let Some(start) = rest.iter().position(|b| !b.is_ascii_whitespace()) {
                let length = rest[start..]
                    .iter()
                    .position(u8::is_ascii_whitespace)
                    .unwrap_or(rest.len() - start);
                self.word = self.at + start;
                self.at = self.word + length;
                return Ok(Some(&self.line[self.word..self.at]));
            }
            if !self.advance()? {
                return Ok(None);
            }
        }
    }

    /// The rest of the line holds no words.
    pub fn end_line(&mut self) {
        self.at = self.line.len();
    }

    /// What is left of the line behind the last word.
    pub fn rest(&self) -> &[u8] {
        self.line.get(self.at..).unwrap_or_default().trim_ascii()
    }

    pub fn number(&mut self, what: &str) -> anyhow::Result<f64> {
        let value = match self.word()? {
            Some(word) => number(word).ok_or_else(|| shown(word)),
            None => bail!(
                "{} ends before all numbers of {what} that it announces; write it again",
                self.source.name
            ),
        };
        value.map_err(|word| {
            anyhow::anyhow!(
                "{}: {what}: '{word}' is not a number; mend the file",
                self.place_of_word()
            )
        })
    }

    /// A number of particles, as a header announces it.
    pub fn count(&self, text: &[u8], what: &str) -> anyhow::Result<u64> {
        let Some(n) = std::str::from_utf8(text).ok().and_then(|text| text.parse::<u64>().ok())
        else {
            bail!("{}: '{}' is not {what}", self.place(), shown(text));
        };
        numbered(n, "particles", &self.place())?;
        Ok(n)
    }
}

/// A number, correctly rounded; none where it is not one. Infinities and NaN are numbers. The
/// exponent may follow a D, as Fortran writes it.
pub fn number(cell: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(cell).ok()?;
    let fortran = || {
        let (mantissa, exponent) = text.split_once(['d', 'D'])?;
        // At least one digit on both sides: else words such as "d1" would be numbers.
        exponent.parse::<i32>().ok()?;
        format!("{mantissa}e{exponent}").parse().ok()
    };
    text.parse().ok().or_else(fortran)
}

/// A whole number, which some programs write as `12.0` or `1.2000e+01`.
///
/// None also for `1e+06` and `1.23457e+06`: `%g` keeps six digits, so what was written there may
/// have been another number. With an exponent, every digit before the point has to stand there.
pub fn whole(cell: &[u8]) -> Option<i64> {
    let text = std::str::from_utf8(cell).ok()?;
    if let Ok(whole) = text.parse() {
        return Some(whole);
    }
    let (mantissa, exponent) = text.split_once(['e', 'E', 'd', 'D']).unwrap_or((text, "0"));
    let places = mantissa.split_once('.').map_or(0, |(_, places)| places.len());
    let complete = exponent.parse::<i64>().is_ok_and(|exponent| exponent <= places as i64);
    number(cell).filter(|x| complete && x.fract() == 0.0 && x.abs() < 9e15).map(|x| x as i64)
}

/// A time step; none where it is no whole number.
pub(crate) fn step_of(cell: &[u8]) -> Option<i64> {
    std::str::from_utf8(cell).ok()?.parse().ok()
}

/// Returns whether a word is in a list whose words are separated by blanks.
pub(crate) fn among(list: &str, word: &str) -> bool {
    list.split(' ').any(|it| it == word)
}

pub fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

pub fn texts(line: &[u8]) -> Vec<String> {
    words(line).map(|word| String::from_utf8_lossy(word).into_owned()).collect()
}

/// What stands between the cells of a line.
#[derive(Clone, Copy, Default, PartialEq)]
pub(crate) enum Separator {
    One(u8),
    #[default]
    Blanks,
}

impl Separator {
    /// Guesses the separator of a line, quoted text aside: semicolon, else comma, else tab, else
    /// blanks.
    pub fn guess(line: &[u8]) -> Separator {
        let bare: Vec<u8> = line.split(|&b| b == b'"').step_by(2).flatten().copied().collect();
        [b';', b',', b'\t']
            .into_iter()
            .find(|c| bare.contains(c))
            .map_or(Separator::Blanks, Separator::One)
    }

    /// The line without one separator at its end.
    pub fn shorn(self, line: &[u8]) -> &[u8] {
        match (self, line) {
            (Separator::One(c), [shorn @ .., last]) if *last == c => shorn.trim_ascii_end(),
            _ => line,
        }
    }

    /// The cells of a line, without the blanks and quotes around them.
    pub fn cells(self, line: &[u8]) -> Cells<'_> {
        Cells { rest: Some(line), separator: self }
    }

    pub fn name(self) -> String {
        match self {
            Separator::One(b'\t') => "tabs".into(),
            Separator::One(c) => format!("'{}'", char::from(c)),
            Separator::Blanks => "blanks".into(),
        }
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
        // What stands in quotes separates nothing.
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

/// Where the quotes end with which a line begins; none if it begins without, or they do not end.
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

/// True if a line of a table begins as comments do.
pub(crate) fn is_comment(line: &[u8]) -> bool {
    matches!(line, [b'#' | b'%' | b'!', ..] | [b'/', b'/', ..])
}

/// A line without the comment that # or % begins behind a blank or a separator.
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

fn unquoted(cell: &[u8]) -> &[u8] {
    if let [b'"', inner @ .., b'"'] = cell { inner.trim_ascii() } else { cell }
}

/// The beginning of a text, for messages: nothing of it reaches the terminal but letters, figures
/// and signs.
pub fn short(text: &str) -> String {
    let shown: String =
        text.chars()
            .take(40)
            .map(|c| {
                if c.is_alphanumeric() || c.is_ascii_graphic() || c == ' ' { c } else { '\u{fffd}' }
            })
            .collect();
    if text.chars().nth(40).is_some() { shown + "…" } else { shown }
}

/// The first names of a list, for messages.
pub fn listed<S: AsRef<str>>(names: &[S]) -> String {
    let shown: Vec<String> = names.iter().take(8).map(|name| short(name.as_ref())).collect();
    shown.join(" ") + if names.len() > 8 { " …" } else { "" }
}

pub fn shown(bytes: &[u8]) -> String {
    short(&String::from_utf8_lossy(&bytes[..bytes.len().min(200)]))
}
