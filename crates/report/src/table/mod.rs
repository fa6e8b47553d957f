//! A table as a value, which knows nothing of the language that it will be written in: Markdown,
//! HTML, CSV, or plain text for a terminal.

mod csv;
mod html;
mod markdown;
mod plain;

pub use csv::csv;

use contactbench_record::stats::interval::Interval;
use contactbench_terms::number::{number, percent, with_interval};

/// Columns, and rows with a cell per column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Stands above it; may be empty.
    pub title: String,
    pub columns: Vec<Column>,
    /// From top to bottom; each has as many cells as there are columns.
    pub rows: Vec<Vec<Cell>>,
}

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
    Left,
    Right,
}

/// One value of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    pub value: Value,
    /// Printed bold, where there is such a thing.
    pub strong: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Nothing was measured: a dash; an empty field of a CSV file.
    Absent,
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

/// A table that is being made column by column: each head comes with the function that makes the
/// cells below it, so that the two cannot get out of step.
pub struct Rows<R> {
    rows: Vec<R>,
    table: Table,
}

impl<R: Copy> Rows<R> {
    pub fn column<C: Into<Cell>>(mut self, column: Column, cell: impl Fn(R) -> C) -> Rows<R> {
        self.table.columns.push(column);
        for (&row, cells) in self.rows.iter().zip(&mut self.table.rows) {
            cells.push(cell(row).into());
        }
        self
    }

    /// Adds a column of words.
    pub fn left<C: Into<Cell>>(self, name: impl Into<String>, cell: impl Fn(R) -> C) -> Rows<R> {
        self.column(Column::left(name), cell)
    }

    /// Adds a column of numbers without a unit.
    pub fn right<C: Into<Cell>>(self, name: impl Into<String>, cell: impl Fn(R) -> C) -> Rows<R> {
        self.column(Column::right(name, ""), cell)
    }

    /// Adds a column of numbers with their unit.
    pub fn unit<C: Into<Cell>>(
        self,
        name: impl Into<String>,
        unit: &'static str,
        cell: impl Fn(R) -> C,
    ) -> Rows<R> {
        self.column(Column::right(name, unit), cell)
    }

    /// Adds a column of ratios, three columns in a CSV file.
    pub fn ratio<C: Into<Cell>>(self, name: &str, cell: impl Fn(R) -> C) -> Rows<R> {
        self.column(Column::ratio(name), cell)
    }

    /// Adds these columns on this condition.
    pub fn when(self, wanted: bool, columns: impl FnOnce(Rows<R>) -> Rows<R>) -> Rows<R> {
        if wanted { columns(self) } else { self }
    }

    /// Adds a column for each of these.
    pub fn each<T>(
        self,
        all: impl IntoIterator<Item = T>,
        column: impl Fn(Rows<R>, T) -> Rows<R>,
    ) -> Rows<R> {
        all.into_iter().fold(self, column)
    }
}

impl<R> From<Rows<R>> for Table {
    fn from(rows: Rows<R>) -> Table {
        rows.table
    }
}

impl Table {
    /// Begins a table with a row for each of these.
    pub fn of<R>(title: impl Into<String>, rows: impl IntoIterator<Item = R>) -> Rows<R> {
        let rows: Vec<R> = rows.into_iter().collect();
        let cells = rows.iter().map(|_| Vec::new());
        let table = Table::new(title, Vec::new()).with(cells);
        Rows { rows, table }
    }

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
    pub fn count(value: u64) -> Cell {
        Value::Count(value).into()
    }

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

    pub fn absent() -> Cell {
        Value::Absent.into()
    }

    pub fn lines(lines: Vec<String>) -> Cell {
        Value::Lines(lines).into()
    }

    /// The same, of a wrong answer.
    pub fn wrong(self) -> Cell {
        Cell { value: Value::Wrong(Box::new(self.value)), strong: self.strong }
    }

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

impl From<u64> for Cell {
    fn from(value: u64) -> Cell {
        Cell::count(value)
    }
}

impl From<f64> for Cell {
    fn from(value: f64) -> Cell {
        Cell::number(value)
    }
}

impl From<Interval> for Cell {
    fn from(value: Interval) -> Cell {
        Cell::ratio(&value)
    }
}

/// The value if there is one.
impl<T: Into<Cell>> From<Option<T>> for Cell {
    fn from(value: Option<T>) -> Cell {
        value.map_or_else(Cell::absent, T::into)
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
