//! Tables as values, to be written as Markdown, HTML, CSV, or plain text for a terminal.

mod csv;
mod html;
mod markdown;
mod plain;

pub use csv::csv;

use contactbench_record::stats::interval::Interval;
use contactbench_terms::number::{number, percent, with_interval};

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    pub title: String,
    columns: Vec<Column>,
    pub rows: Vec<Vec<Cell>>,
}

#[derive(Clone, Debug, PartialEq)]
struct Column {
    name: String,
    unit: &'static str,
    right: bool,
    /// True if a CSV file has three columns for it: `name`, `name_low`, `name_high`.
    interval: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// A value that was not measured: shown as a dash, empty in a CSV file.
    Absent,
    Text(String),
    Count(u64),
    /// A number, shown with four significant digits, and with all digits in a CSV file.
    Number(f64),
    Share(f64),
    Ratio(Interval),
    /// Value of a wrong answer: shown in brackets, and empty in a CSV file.
    Wrong(Box<Cell>),
    /// Several texts, shown one below the other where the format can.
    Lines(Vec<String>),
    Strong(Box<Cell>),
    /// A text and its address; only HTML has the address.
    Link(String, String),
}

/// A table that is made column by column: each head comes with the function that fills its cells.
pub struct Rows<R> {
    rows: Vec<R>,
    table: Table,
}

impl<R: Copy> Rows<R> {
    fn column<C: Into<Cell>>(mut self, column: Column, cell: impl Fn(R) -> C) -> Rows<R> {
        self.table.columns.push(column);
        for (&row, cells) in self.rows.iter().zip(&mut self.table.rows) {
            cells.push(cell(row).into());
        }
        self
    }

    pub fn left<C: Into<Cell>>(self, name: impl Into<String>, cell: impl Fn(R) -> C) -> Rows<R> {
        let name = name.into();
        self.column(Column { name, unit: "", right: false, interval: false }, cell)
    }

    pub fn right<C: Into<Cell>>(self, name: impl Into<String>, cell: impl Fn(R) -> C) -> Rows<R> {
        self.unit(name, "", cell)
    }

    pub fn unit<C: Into<Cell>>(
        self,
        name: impl Into<String>,
        unit: &'static str,
        cell: impl Fn(R) -> C,
    ) -> Rows<R> {
        self.column(Column { name: name.into(), unit, right: true, interval: false }, cell)
    }

    pub fn ratio<C: Into<Cell>>(self, name: &str, cell: impl Fn(R) -> C) -> Rows<R> {
        self.column(Column { name: name.into(), unit: "", right: true, interval: true }, cell)
    }

    pub fn when(self, wanted: bool, columns: impl FnOnce(Rows<R>) -> Rows<R>) -> Rows<R> {
        if wanted { columns(self) } else { self }
    }

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
    pub fn of<R>(title: impl Into<String>, rows: impl IntoIterator<Item = R>) -> Rows<R> {
        let rows: Vec<R> = rows.into_iter().collect();
        let cells = vec![Vec::new(); rows.len()];
        Rows { rows, table: Table { title: title.into(), columns: Vec::new(), rows: cells } }
    }
}

impl Column {
    fn head(&self) -> String {
        match self.unit {
            "" => self.name.clone(),
            unit => format!("{} ({unit})", self.name),
        }
    }
}

impl Cell {
    pub fn wrong(self) -> Cell {
        Cell::Wrong(Box::new(self))
    }

    pub fn strong(self) -> Cell {
        Cell::Strong(Box::new(self))
    }

    /// Returns the text, in bold if the cell is strong and not empty.
    fn shown(&self, text: String, bold: [&str; 2]) -> String {
        let [open, close] = if text.is_empty() { [""; 2] } else { bold };
        if matches!(self, Cell::Strong(_)) { format!("{open}{text}{close}") } else { text }
    }

    fn lines(&self) -> Vec<String> {
        match self {
            Cell::Lines(lines) => lines.clone(),
            cell => vec![cell.to_string()],
        }
    }
}

impl std::fmt::Display for Cell {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Cell::Absent => f.write_str("–"),
            Cell::Text(text) | Cell::Link(text, _) => f.write_str(text),
            Cell::Count(count) => write!(f, "{count}"),
            Cell::Number(value) => f.write_str(&number(*value)),
            Cell::Share(share) => f.write_str(&percent(*share)),
            Cell::Ratio(ratio) => f.write_str(&with_interval(ratio)),
            Cell::Wrong(cell) => write!(f, "wrong ({cell})"),
            Cell::Lines(lines) => f.write_str(&lines.join("; ")),
            Cell::Strong(cell) => cell.fmt(f),
        }
    }
}

macro_rules! cells {
    ($($value:ty => $cell:expr;)*) => { $(
        impl From<$value> for Cell {
            fn from(value: $value) -> Cell {
                $cell(value)
            }
        }
    )* };
}

cells! {
    &str => |text: &str| Cell::Text(text.into());
    String => Cell::Text;
    Vec<String> => Cell::Lines;
    u32 => |count: u32| Cell::Count(count.into());
    u64 => Cell::Count;
    usize => |count: usize| Cell::Count(count as u64);
    f64 => Cell::Number;
    Interval => Cell::Ratio;
}

impl<T: Into<Cell>> From<Option<T>> for Cell {
    fn from(value: Option<T>) -> Cell {
        value.map_or(Cell::Absent, T::into)
    }
}

#[cfg(test)]
mod tests;
