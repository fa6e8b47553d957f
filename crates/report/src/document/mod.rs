//! A report before it is written: headings, paragraphs, lists, tables and figures as values, which
//! become Markdown, HTML or plain text.

mod html;
mod markdown;
mod plain;

use std::path::PathBuf;

pub use html::{html, words as inline_html};
pub use markdown::{escaped, markdown};
pub use plain::{indented, plain};

use crate::table::Table;

/// A piece of a report.
#[derive(Clone, Debug, PartialEq)]
pub enum Block {
    /// A heading, 1 to 6.
    Heading(u8, Text),
    Paragraph(Text),
    /// Something that the reader must not miss.
    Warning(Text),
    List(Vec<Text>),
    /// Text as it is, a command, say.
    Code(String),
    Table(Table),
    /// Title of a figure, and its file in the folder `figures`.
    Figure {
        title: String,
        path: PathBuf,
    },
}

/// Words of a paragraph, each with its style.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Text(Vec<(Style, String)>);

#[derive(Clone, Copy, Debug, PartialEq)]
enum Style {
    Plain,
    Strong,
    Emphasis,
    /// Words of a program.
    Code,
}

impl Text {
    pub fn new() -> Text {
        Text::default()
    }

    /// These words after it.
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

    fn and(mut self, style: Style, text: impl Into<String>) -> Text {
        self.0.push((style, text.into()));
        self
    }

    /// Writes the words in a language: `around` is put around each style except the plain one, and
    /// `escape` escapes words.
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
        Text::new().plain(text)
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
