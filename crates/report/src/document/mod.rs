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
    /// Running text.
    Paragraph(Text),
    /// Something that the reader must not miss.
    Warning(Text),
    /// Items with bullets.
    List(Vec<Text>),
    /// Text as it is, a command, say.
    Code(String),
    /// A table with its title.
    Table(Table),
    /// A figure.
    Figure {
        /// What it shows.
        title: String,
        /// Its file, in the folder `figures`.
        path: PathBuf,
    },
}

/// Words of a paragraph.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Text(pub Vec<Span>);

/// Words of one kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Span {
    /// As they are.
    Plain(String),
    /// Bold.
    Strong(String),
    /// Slanted.
    Emphasis(String),
    /// Of a program.
    Code(String),
}

impl Text {
    /// Without words.
    pub fn new() -> Text {
        Text::default()
    }

    /// These words after it.
    pub fn plain(self, text: impl Into<String>) -> Text {
        self.and(Span::Plain(text.into()))
    }

    /// These words after it, bold.
    pub fn strong(self, text: impl Into<String>) -> Text {
        self.and(Span::Strong(text.into()))
    }

    /// These words after it, slanted.
    pub fn emphasis(self, text: impl Into<String>) -> Text {
        self.and(Span::Emphasis(text.into()))
    }

    /// These words of a program after it.
    pub fn code(self, text: impl Into<String>) -> Text {
        self.and(Span::Code(text.into()))
    }

    fn and(mut self, span: Span) -> Text {
        self.0.push(span);
        self
    }

    /// Has it no words?
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl From<&str> for Text {
    fn from(text: &str) -> Text {
        Text::new().plain(text)
    }
}

impl From<String> for Text {
    fn from(text: String) -> Text {
        Text::new().plain(text)
    }
}

impl Block {
    /// A heading.
    pub fn heading(level: u8, text: impl Into<Text>) -> Block {
        Block::Heading(level, text.into())
    }

    /// A table.
    pub fn table(table: impl Into<Table>) -> Block {
        Block::Table(table.into())
    }

    /// A paragraph.
    pub fn paragraph(text: impl Into<Text>) -> Block {
        Block::Paragraph(text.into())
    }
}

#[cfg(test)]
mod tests;
