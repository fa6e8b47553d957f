//! Output for people on standard error and standard output, cleaned of control sequences
//! ([`text`]), and wrapped at words on a terminal.

use std::io::{Result, Write};
use std::path::Path;

use anyhow::Context;

use contactbench_terms::number::wrap;
use contactbench_terms::text;

/// Returns the columns of the terminal; `usize::MAX` if the output is not a terminal.
pub fn width() -> usize {
    columns(std::io::stdout())
}

#[cfg(unix)]
fn columns(terminal: impl std::os::fd::AsFd) -> usize {
    match rustix::termios::tcgetwinsize(terminal) {
        Ok(size) if size.ws_col > 0 => size.ws_col.into(),
        _ => usize::MAX,
    }
}

#[cfg(not(unix))]
fn columns<T>(_: T) -> usize {
    usize::MAX
}

/// Prints a line on standard error; ignores errors.
pub fn say(line: &str) {
    let width = columns(std::io::stderr());
    let mut out = std::io::stderr().lock();
    let _ = writeln!(out, "{}", wrapped(&text::line(&text::shortened(line)), width));
}

/// Prints a command on standard error as one line, which can be copied; ignores errors.
pub fn command(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{}", text::line(line));
}

/// Formats its arguments, and prints them as a line on standard error.
macro_rules! say {
    ($($words:tt)*) => { $crate::cli::shared::terminal::say(&format!($($words)*)) };
}

/// Returns standard output for text that people read: a terminal wraps it.
pub fn out() -> Words<std::io::StdoutLock<'static>> {
    Words { out: std::io::stdout().lock(), width: width() }
}

pub fn json(value: &serde_json::Value) -> Result<()> {
    writeln!(std::io::stdout(), "{value:#}")
}

pub struct Words<W> {
    out: W,
    width: usize,
}

impl<W: Write> Write for Words<W> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        self.write_all(bytes).map(|()| bytes.len())
    }

    fn write_all(&mut self, bytes: &[u8]) -> Result<()> {
        let text = String::from_utf8_lossy(bytes);
        let clean = text::lines(&text);
        self.out.write_all(wrapped(&clean, self.width).as_bytes())
    }

    fn write_fmt(&mut self, words: std::fmt::Arguments<'_>) -> Result<()> {
        self.write_all(std::fmt::format(words).as_bytes())
    }

    fn flush(&mut self) -> Result<()> {
        self.out.flush()
    }
}

/// Breaks lines longer than `width` at words, and indents the rest like the first word.
fn wrapped(text: &str, width: usize) -> std::borrow::Cow<'_, str> {
    let fits = |line: &str| line.len() <= width || line.chars().count() <= width;
    if text.split('\n').all(fits) {
        return text.into();
    }
    let mut lines = Vec::new();
    for line in text.split('\n') {
        let rest = line.trim_start();
        if fits(line) || rest.is_empty() {
            lines.push(line.to_string());
            continue;
        }
        let indent = line[..line.len() - rest.len()].chars().count().min(width / 2);
        let broken = wrap(rest, width - indent);
        lines.extend(broken.iter().map(|line| format!("{:indent$}{line}", "")));
    }
    lines.join("\n").into()
}

/// Writes a whole file; an error suggests the option that names another place.
pub fn save(path: &Path, bytes: &[u8], option: &str) -> anyhow::Result<()> {
    let place = path.display();
    let cannot = || format!("cannot write {place}; choose another place with {option}");
    contactbench_io::write::whole(path, |out| out.write_all(bytes)).with_context(cannot)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_cleaned_and_wrapped() {
        let mut words = Words { out: Vec::new(), width: 12 };
        writeln!(words, "  one two three\nshort\x1b\n::error::x").unwrap();
        words.write_all(b"a b").unwrap();
        let said = String::from_utf8(words.out).unwrap();
        assert_eq!(said, "  one two\n  three\nshort\u{fffd}\n: :error::x\na b");
    }
}
