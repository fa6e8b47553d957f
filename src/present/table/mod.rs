//! A table as a value, which knows nothing of the language that it will be written in: Markdown,
//! HTML, CSV, or plain text for a terminal.

mod csv;
mod html;
mod markdown;
mod plain;

pub use csv::csv;

use crate::number::{number, percent, with_interval};
use crate::stats::interval::Interval;

/// Columns, and rows with a cell per column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Stands above it; may be empty.
    pub title: String,
    /// From left to right.
    pub columns: Vec<Column>,
    /// From top to bottom; each has as many cells as there are columns.
    pub rows: Vec<Vec<Cell>>,
}

/// What a column holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its head; in a CSV file its name.
    pub name: String,
    /// The unit of its numbers, shown in brackets; not in a CSV file.
    pub unit: &'static str,
    /// Words to the left, numbers to the right.
    pub align: Align,
    /// In a CSV file it is three columns: `name`, `name_low`, `name_high`.
    pub interval: bool,
}

/// The side on which cells of a column line up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    /// Words.
    Left,
    /// Numbers.
    Right,
}

/// One value of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// What it holds.
    pub value: Value,
    /// Printed bold, where there is such a thing.
    pub strong: bool,
}

/// What a cell holds.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Nothing was measured: a dash; an empty field of a CSV file.
    Absent,
    /// Words.
    Text(String),
    /// A whole number, always in full.
    Count(u64),
    /// A number; four significant digits, all of them in a CSV file.
    Number(f64),
    /// A fraction, shown as a percentage.
    Share(f64),
    /// A ratio with its interval.
    Ratio(Interval),
    /// What a wrong answer would have given; compared with nothing, and no value of a CSV file.
    Wrong(Box<Value>),
    /// Several texts, one below the other where that is possible.
    Lines(Vec<String>),
}

impl Table {
    /// A table without rows.
    pub fn new(title: impl Into<String>, columns: Vec<Column>) -> Table {
        Table { title: title.into(), columns, rows: Vec::new() }
    }

    /// The same with these rows.
    pub fn with(mut self, rows: impl IntoIterator<Item = Vec<Cell>>) -> Table {
        self.rows.extend(rows);
        self
    }
}

impl Column {
    /// A column of words.
    pub fn left(name: impl Into<String>) -> Column {
        Column { name: name.into(), unit: "", align: Align::Left, interval: false }
    }

    /// A column of numbers; their unit may be empty.
    pub fn right(name: impl Into<String>, unit: &'static str) -> Column {
        Column { name: name.into(), unit, align: Align::Right, interval: false }
    }

    /// A column of ratios with their intervals.
    pub fn ratio(name: impl Into<String>) -> Column {
        Column { interval: true, ..Column::right(name, "") }
    }

    /// `time / N (ns)`.
    fn head(&self) -> String {
        match (self.name.as_str(), self.unit) {
            (name, "") => name.into(),
            (name, unit) => format!("{name} ({unit})"),
        }
    }
}

impl Cell {
    /// A whole number.
    pub fn count(value: u64) -> Cell {
        Value::Count(value).into()
    }

    /// A number.
    pub fn number(value: f64) -> Cell {
        Value::Number(value).into()
    }

    /// A fraction, shown as a percentage.
    pub fn share(value: f64) -> Cell {
        Value::Share(value).into()
    }

    /// A ratio with its interval.
    pub fn ratio(value: &Interval) -> Cell {
        Value::Ratio(*value).into()
    }

    /// Nothing.
    pub fn absent() -> Cell {
        Value::Absent.into()
    }

    /// Several texts.
    pub fn lines(lines: Vec<String>) -> Cell {
        Value::Lines(lines).into()
    }

    /// The same, of a wrong answer.
    pub fn wrong(self) -> Cell {
        Cell { value: Value::Wrong(Box::new(self.value)), strong: self.strong }
    }

    /// The same in bold.
    pub fn strong(self) -> Cell {
        Cell { strong: true, ..self }
    }
}

impl From<Value> for Cell {
    fn from(value: Value) -> Cell {
        Cell { value, strong: false }
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Cell {
        Value::Text(text.into()).into()
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Cell {
        Value::Text(text).into()
    }
}

/// The number if there is one.
impl From<Option<f64>> for Cell {
    fn from(value: Option<f64>) -> Cell {
        value.map_or_else(Cell::absent, Cell::number)
    }
}

/// The ratio if there is one.
impl From<Option<Interval>> for Cell {
    fn from(value: Option<Interval>) -> Cell {
        value.as_ref().map_or_else(Cell::absent, Cell::ratio)
    }
}

impl Value {
    /// The texts that all languages show; more than one only for [`Value::Lines`].
    fn lines(&self) -> Vec<String> {
        match self {
            Value::Lines(lines) => lines.clone(),
            value => vec![value.to_string()],
        }
    }
}

/// In one line, as every language shows it.
impl std::fmt::Display for Value {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let text = match self {
            Value::Absent => "–".into(),
            Value::Text(text) => text.clone(),
            Value::Count(count) => count.to_string(),
            Value::Number(value) => number(*value),
            Value::Share(share) => percent(*share),
            Value::Ratio(ratio) => with_interval(ratio),
            Value::Wrong(value) => format!("wrong ({value})"),
            Value::Lines(lines) => lines.join("; "),
        };
        f.write_str(&text)
    }
}

#[cfg(test)]
mod tests;
