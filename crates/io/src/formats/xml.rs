//! A reader for the XML of VTK files: tags with attributes, from front to back in bounded memory.
//! The caller reads what stands between tags, because it may be gigabytes of numbers or raw bytes
//! that no XML library accepts.

use std::io::Read;

use anyhow::{Context, bail, ensure};

use crate::raw::lines::{Source, short, shown};

const LONGEST_TAG: usize = 1 << 16;

#[derive(Debug)]
pub(crate) struct Tag {
    pub name: String,
    pub closing: bool,
    pub empty: bool,
    attributes: Vec<(String, String)>,
}

impl Tag {
    pub fn get(&self, key: &str) -> Option<&str> {
        self.attributes.iter().find(|(name, _)| name == key).map(|(_, value)| value.as_str())
    }
}

pub(crate) struct Xml<'a> {
    pub source: Source<'a>,
    pub line: u64,
}

impl Xml<'_> {
    pub fn place(&self) -> String {
        format!("{}:{}", self.source.name, self.line)
    }

    /// Returns the next byte without consuming it, or `None` at the end.
    pub fn peek(&mut self) -> anyhow::Result<Option<u8>> {
        let Source { input, name, .. } = &mut self.source;
        let next = input.fill_buf().with_context(|| format!("cannot read {name}"))?;
        Ok(next.first().copied())
    }

    pub fn take(&mut self) -> anyhow::Result<Option<u8>> {
        let byte = self.peek()?;
        if let Some(byte) = byte {
            self.source.input.consume(1);
            self.line += u64::from(byte == b'\n');
        }
        Ok(byte)
    }

    /// Returns the next tag; skips comments, declarations and text before it.
    pub fn tag(&mut self) -> anyhow::Result<Option<Tag>> {
        loop {
            loop {
                match self.take()? {
                    None => return Ok(None),
                    Some(b'<') => break,
                    Some(_) => {}
                }
            }
            let place = self.place();
            let (mut text, mut quote) = (Vec::new(), None);
            loop {
                let Some(byte) = self.take()? else {
                    bail!("{place}: a tag is cut off; write the file again")
                };
                match quote {
                    None if byte == b'>'
                        && (!text.starts_with(b"!--")
                            || text.len() >= 5 && text.ends_with(b"--")) =>
                    {
                        break;
                    }
                    None if matches!(byte, b'"' | b'\'') && !text.starts_with(b"!--") => {
                        quote = Some(byte)
                    }
                    Some(open) if byte == open => quote = None,
                    _ => {}
                }
                text.push(byte);
                ensure!(
                    text.len() <= LONGEST_TAG,
                    "{place}: a tag is longer than {LONGEST_TAG} bytes; this is not a VTK file"
                );
            }
            if !text.starts_with(b"!") && !text.starts_with(b"?") {
                return parse(&String::from_utf8_lossy(&text)).with_context(|| place).map(Some);
            }
        }
    }

    /// Returns the next word of text, or `None` at the next tag.
    pub fn word<'b>(&mut self, word: &'b mut Vec<u8>) -> anyhow::Result<Option<&'b [u8]>> {
        word.clear();
        while let Some(byte) = self.peek()? {
            let ends = byte.is_ascii_whitespace();
            if byte == b'<' || ends && !word.is_empty() {
                break;
            }
            if !ends {
                word.push(byte);
                ensure!(word.len() < 1000, "{}: '{}' is not a number", self.place(), shown(word));
            }
            self.take()?;
        }
        Ok((!word.is_empty()).then_some(&word[..]))
    }
}

fn parse(text: &str) -> anyhow::Result<Tag> {
    let closing = text.starts_with('/');
    let text = text.trim_start_matches('/');
    let empty = text.ends_with('/');
    let mut rest = text.trim_end_matches('/').trim();
    let end = rest.find(char::is_whitespace).unwrap_or(rest.len());
    let mut tag = Tag { name: rest[..end].to_string(), closing, empty, attributes: Vec::new() };
    rest = rest[end..].trim_start();
    while !rest.is_empty() {
        let bad = || format!("'{}' is not of the form key=\"value\"", short(rest));
        let (key, after) = rest.split_once('=').with_context(bad)?;
        let after = after.trim_start();
        let quote = after.chars().next().filter(|c| matches!(c, '"' | '\'')).with_context(bad)?;
        let (value, after) = after[1..].split_once(quote).with_context(bad)?;
        tag.attributes.push((key.trim().to_string(), value.to_string()));
        rest = after.trim_start();
    }
    Ok(tag)
}

/// Decodes base64 text up to the next tag. After padding another group may follow. Letters are read
/// only when needed.
pub(crate) struct Base64<'a, 'b> {
    xml: &'a mut Xml<'b>,
    letters: u64,
    ready: Vec<u8>,
    at: usize,
}

impl<'a, 'b> Base64<'a, 'b> {
    pub fn new(xml: &'a mut Xml<'b>) -> Base64<'a, 'b> {
        Base64 { xml, letters: 0, ready: Vec::new(), at: 0 }
    }

    pub fn letters(&self) -> u64 {
        self.letters
    }

    fn group(&mut self) -> anyhow::Result<bool> {
        let (mut bits, mut count, mut padding) = (0, 0, 0);
        while count < 4 {
            let value = match self.xml.peek()? {
                None | Some(b'<') => return Ok(false),
                Some(byte) if byte.is_ascii_whitespace() => None,
                Some(byte @ b'A'..=b'Z') => Some(byte - b'A'),
                Some(byte @ b'a'..=b'z') => Some(byte - b'a' + 26),
                Some(byte @ b'0'..=b'9') => Some(byte - b'0' + 52),
                Some(b'+') => Some(62),
                Some(b'/') => Some(63),
                Some(b'=') => {
                    padding += 1;
                    Some(0)
                }
                Some(_) => bail!("{}: a letter that is not of base64", self.xml.place()),
            };
            self.xml.take()?;
            self.letters += 1;
            if let Some(value) = value {
                bits = bits << 6 | u32::from(value);
                count += 1;
            }
        }
        let [_, bytes @ ..] = bits.to_be_bytes();
        self.ready.extend_from_slice(&bytes[..3usize.saturating_sub(padding)]);
        Ok(true)
    }
}

impl Read for Base64<'_, '_> {
    fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        if self.at == self.ready.len() {
            self.ready.clear();
            self.at = 0;
            let wanted = bytes.len().min(1 << 12);
            while self.ready.len() < wanted
                && self.group().map_err(|error| std::io::Error::other(format!("{error:#}")))?
            {
            }
        }
        let count = bytes.len().min(self.ready.len() - self.at);
        bytes[..count].copy_from_slice(&self.ready[self.at..self.at + count]);
        self.at += count;
        Ok(count)
    }
}
