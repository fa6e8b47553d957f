//! A report as values (headings, paragraphs, lists, tables, figures), to be written as Markdown,
//! HTML or plain text.

mod html;
mod markdown;
mod plain;

use std::path::PathBuf;

pub use html::html;
pub use markdown::{escaped, markdown};
pub use plain::{indented, plain};

use crate::table::Table;

#[derive(Clone, Debug, PartialEq)]
pub enum Block {
    Heading(u8, Text),
    Paragraph(Text),
    Warning(Text),
    List(Vec<Text>),
    Code(String),
    Table(Table),
    Figure { title: String, path: PathBuf },
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Text(Vec<(Style, String)>);

#[derive(Clone, Copy, Debug, PartialEq)]
enum Style {
    Plain,
    Strong,
    Emphasis,
    Code,
}

impl Text {
    pub fn plain(self, text: impl Into<String>) -> Text {
        self.and(Style::Plain, text)
    }

    pub fn strong(self, text: impl Into<String>) -> Text {
        self.and(Style::Strong, text)
    }

    pub fn emphasis(self, text: impl Into<String>) -> Text {
        self.and(Style::Emphasis, text)
    }

    pub fn code(self, text: impl Into<String>) -> Text {
        self.and(Style::Code, text)
    }

    /// Reads a text whose pieces in backticks are code, and those in asterisks emphasis.
    pub fn marked(text: &str) -> Text {
        let mut out = Text::default();
        for (k, outside) in text.split('`').enumerate() {
            for (j, piece) in outside.split('*').enumerate() {
                let style = match (k % 2, j % 2) {
                    (1, _) => Style::Code,
                    (_, 1) => Style::Emphasis,
                    _ => Style::Plain,
                };
                out = out.and(style, piece);
            }
        }
        out
    }

    fn and(mut self, style: Style, text: impl Into<String>) -> Text {
        self.0.push((style, text.into()));
        self
    }

    /// Returns the text, with `around` on both sides of each style except the plain one.
    fn written(&self, around: [[&str; 2]; 3], escape: impl Fn(Style, &str) -> String) -> String {
        let span = |(style, text): &(Style, String)| {
            let [open, close] = match style {
                Style::Plain => [""; 2],
                Style::Strong => around[0],
                Style::Emphasis => around[1],
                Style::Code => around[2],
            };
            format!("{open}{}{close}", escape(*style, text))
        };
        self.0.iter().map(span).collect()
    }
}

impl<T: Into<String>> From<T> for Text {
    fn from(text: T) -> Text {
        Text::default().plain(text)
    }
}

impl Block {
    pub fn heading(level: u8, text: impl Into<Text>) -> Block {
        Block::Heading(level, text.into())
    }

    pub fn table(table: impl Into<Table>) -> Block {
        Block::Table(table.into())
    }

    pub fn paragraph(text: impl Into<Text>) -> Block {
        Block::Paragraph(text.into())
    }
}

#[cfg(test)]
mod tests;
