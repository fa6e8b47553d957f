//! The comment line of extended XYZ: pairs `key=value`, as the specification allows and ASE reads
//! them.
//!
//! * Blanks and tabs may surround `=`; a key may be quoted; a bare word is not a pair.
//! * A value is a bare word, a text in double or single quotes, `{...}`, or an array `[a, b]` or
//!   `[[a, b], [c, d]]`. A backslash escapes the next character. Commas and blanks separate
//!   numbers.
//! * Keys are compared without case.
//!
//! Specification: <https://github.com/libAtoms/extxyz>.

use anyhow::{bail, ensure};

use crate::raw::lines::short;

/// Keys that change which contacts are found.
const DECIDE: [&str; 3] = ["lattice", "pbc", "properties"];

#[derive(Debug)]
pub(super) struct Pair {
    key: String,
    /// Byte position of the key in the line, counted from 1.
    pub column: usize,
    /// The value without its quotes; arrays as written.
    pub text: String,
    pub cells: Vec<String>,
}

/// All pairs of the line; empty if it is a plain comment.
#[derive(Debug, Default)]
pub(super) struct Comment(Vec<Pair>);

impl Comment {
    /// Parses the line. A line that does not consist of pairs is a plain comment, unless it
    /// contains a key of [`DECIDE`].
    pub fn read(line: &str) -> anyhow::Result<Comment> {
        let has_key = || DECIDE.iter().any(|key| stands(line, key) > 0);
        match pairs(line) {
            Ok(pairs) => {
                for key in DECIDE {
                    let read = pairs.iter().filter(|it| it.key.eq_ignore_ascii_case(key)).count();
                    ensure!(
                        stands(line, key) <= read.min(1),
                        "'{key}' stands twice, or within the value of another key; write it once"
                    );
                }
                Ok(Comment(pairs))
            }
            Err((at, why)) if has_key() => bail!("column {}: {why}", at + 1),
            Err(_) => Ok(Comment::default()),
        }
    }

    pub fn get(&self, key: &str) -> Option<&Pair> {
        self.0.iter().find(|pair| pair.key.eq_ignore_ascii_case(key))
    }
}

/// Counts how often a key stands before a sign `=`. The end of a longer key does not count.
fn stands(line: &str, key: &str) -> usize {
    let line = line.to_ascii_lowercase();
    let parts: Vec<&str> = line.split('=').collect();
    let names = parts.split_last().map_or(&[][..], |(_, names)| names);
    let is_key = |c: char| c.is_ascii_alphanumeric() || "_-".contains(c);
    let ends = |part: &&&str| {
        let before = part.trim_end().strip_suffix(key);
        before.is_some_and(|before| !before.ends_with(is_key))
    };
    names.iter().filter(ends).count()
}

/// Byte position of a syntax error, counted from 0, and its description.
type Fault = (usize, &'static str);

fn pairs(line: &str) -> Result<Vec<Pair>, Fault> {
    let mut scan = Scan { line, at: 0 };
    let mut pairs = Vec::new();
    loop {
        scan.blanks();
        let start = scan.at;
        let Some(first) = scan.peek() else { return Ok(pairs) };
        let key = match first {
            '"' | '\'' => scan.quoted(first)?,
            '=' => return Err((start, "no key stands before '='")),
            _ => scan.bare(|c| c == '=' || c.is_whitespace()),
        };
        let after = scan.at;
        scan.blanks();
        if scan.peek() != Some('=') {
            scan.at = after;
            continue;
        }
        scan.at += 1;
        scan.blanks();
        let (text, cells) = scan.value()?;
        pairs.push(Pair { key, column: start + 1, text, cells });
    }
}

struct Scan<'a> {
    line: &'a str,
    at: usize,
}

impl Scan<'_> {
    fn peek(&self) -> Option<char> {
        self.line[self.at..].chars().next()
    }

    fn next(&mut self) -> Option<char> {
        let next = self.peek();
        self.at += next.map_or(0, char::len_utf8);
        next
    }

    fn blanks(&mut self) {
        while self.peek().is_some_and(char::is_whitespace) {
            self.next();
        }
    }

    fn bare(&mut self, ends: impl Fn(char) -> bool) -> String {
        let mut text = String::new();
        while let Some(c) = self.peek().filter(|&c| !ends(c)) {
            self.next();
            text.extend(if c == '\\' { self.next() } else { Some(c) });
        }
        text
    }

    fn quoted(&mut self, end: char) -> Result<String, Fault> {
        let start = self.at;
        let mut text = String::new();
        self.next();
        while let Some(c) = self.next() {
            match c {
                '\\' => text.extend(self.next().map(|c| if c == 'n' { '\n' } else { c })),
                _ if c == end => return Ok(text),
                _ => text.push(c),
            }
        }
        Err((start, "the quote or brace that begins here has no end"))
    }

    fn value(&mut self) -> Result<(String, Vec<String>), Fault> {
        let start = self.at;
        let text = match self.peek() {
            None | Some('=') => return Err((start, "no value stands behind '='")),
            Some('[') => self.array()?,
            Some('{') => self.quoted('}')?,
            Some(quote @ ('"' | '\'')) => self.quoted(quote)?,
            Some(_) => self.bare(char::is_whitespace),
        };
        let ends = |c: char| c.is_whitespace() || ",[]\"'".contains(c);
        let cells = text.split(ends).filter(|cell| !cell.is_empty()).map(String::from).collect();
        Ok((text, cells))
    }

    fn array(&mut self) -> Result<String, Fault> {
        let (start, mut open) = (self.at, 0);
        while let Some(c) = self.next() {
            open += i32::from(c == '[') - i32::from(c == ']');
            if open == 0 {
                return Ok(self.line[start..self.at].into());
            }
        }
        Err((start, "the bracket that begins here has no end"))
    }
}

impl Pair {
    /// Parses truth values: three, such as `T T F`, `[true, true, false]` or `1,1,0`; two in 2D; or
    /// one for all.
    pub fn flags(&self, dim: usize) -> anyhow::Result<[bool; 3]> {
        let flag = |cell: &String| match cell.to_ascii_lowercase().as_str() {
            "t" | "true" | "1" => Some(true),
            "f" | "false" | "0" => Some(false),
            _ => None,
        };
        let flags: Option<Vec<bool>> = self.cells.iter().map(flag).collect();
        match flags.as_deref() {
            Some(&[x, y, z]) => Ok([x, y, z]),
            Some(&[x, y]) if dim == 2 => Ok([x, y, false]),
            Some(&[all]) => Ok([all; 3]),
            _ => self.wrong(
                "T or F for each vector, as in pbc=\"T T F\"; fix the line, or give --periodic or \
                 --open",
            ),
        }
    }

    /// Parses finite numbers; their count must be one of `counts`.
    pub fn numbers(&self, counts: &[usize], what: &str) -> anyhow::Result<Vec<f64>> {
        let number = |cell: &String| crate::raw::lines::number(cell.as_bytes());
        let numbers: Option<Vec<f64>> = self.cells.iter().map(number).collect();
        let fits = |numbers: &Vec<f64>| {
            counts.contains(&numbers.len()) && numbers.iter().all(|x| x.is_finite())
        };
        match numbers.filter(fits) {
            Some(numbers) => Ok(numbers),
            None => self.wrong(&format!("{what}; fix the line, or give --open")),
        }
    }

    fn wrong<T>(&self, what: &str) -> anyhow::Result<T> {
        let quote = if self.text.starts_with('[') { "" } else { "\"" };
        let Pair { key, column, text, .. } = self;
        bail!("column {column}: {}={quote}{}{quote} must be {what}", short(key), short(text))
    }
}
