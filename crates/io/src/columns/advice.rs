//! Advice on columns without names: which may be coordinates and sizes, by the numbers in the first
//! rows.

use std::collections::BTreeSet;
use std::fmt;

use crate::raw::lines::{Separator, number, shown};

/// An error of a file that does not say what its columns are.
#[derive(Debug)]
pub struct Unclear(pub String);

impl fmt::Display for Unclear {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Unclear {}

/// Returns the error that the meaning of columns is unclear; the advice is added later.
macro_rules! unclear {
    ($($words:tt)*) => {
        anyhow::Error::new($crate::columns::advice::Unclear(format!($($words)*)))
    };
}
pub(crate) use unclear;

const MOST_ROWS: usize = 200;
/// Fewer rows do not show what a column holds.
const FEWEST_ROWS: usize = 3;
/// Extents of coordinates along the axes differ by at most this factor.
const SIMILAR: f64 = 50.0;

struct Column {
    /// The cell of the first row.
    first: String,
    values: Vec<f64>,
    kind: Kind,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Text,
    Constant,
    /// Whole numbers, each higher than the one before.
    Numbers,
    /// Few different whole numbers.
    Kinds,
    Real,
}

impl Column {
    fn new(cells: &[&[u8]]) -> Column {
        let first = shown(cells[0]);
        let values: Vec<f64> =
            cells.iter().filter_map(|cell| number(cell)).filter(|x| x.is_finite()).collect();
        let whole = values.iter().all(|x| x.fract() == 0.0);
        let distinct: BTreeSet<u64> = values.iter().map(|x| x.to_bits()).collect();
        let kind = match distinct.len() {
            _ if values.len() < cells.len() => Kind::Text,
            1 => Kind::Constant,
            _ if whole && values.is_sorted_by(|a, b| a < b) => Kind::Numbers,
            count if whole && 3 * count <= values.len().max(9) => Kind::Kinds,
            _ => Kind::Real,
        };
        Column { first, values, kind }
    }

    fn extent(&self) -> f64 {
        let [low, high] = self
            .values
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], &x| [a.min(x), b.max(x)]);
        high - low
    }

    fn words(&self) -> Option<&'static str> {
        match self.kind {
            Kind::Text => Some("text"),
            Kind::Constant => Some("one value"),
            Kind::Numbers => Some("numbers in order"),
            Kind::Kinds => Some("few whole numbers"),
            Kind::Real => None,
        }
    }
}

/// Returns the options that may read the rows in the first bytes of a file, and what its columns
/// hold.
pub fn of(head: &[u8], has_radius: bool) -> String {
    let columns = columns(head);
    let mut found = ways(&columns, 3, 0, has_radius);
    if found.is_empty() {
        // All particles may have one x, y or z; or they are discs.
        found = ways(&columns, 3, 1, has_radius);
        found.extend(ways(&columns, 2, 0, has_radius));
    }
    found.truncate(3);
    let give = if found.is_empty() { "--columns x=I,y=J,z=K".into() } else { found.join(", or ") };
    let others: Vec<String> = (1..)
        .zip(&columns)
        .filter_map(|(k, column)| column.words().map(|words| format!("column {k} has {words}")))
        .collect();
    let others = if others.is_empty() { String::new() } else { format!("; {}", others.join(", ")) };
    format!("give {give}{others}")
}

/// Returns ways to take `dim` adjacent columns as coordinates, the likeliest first; `constant` of
/// them have one value.
fn ways(columns: &[Column], dim: usize, constant: usize, has_radius: bool) -> Vec<String> {
    let mut places: Vec<(f64, usize)> = Vec::new();
    for (k, axes) in columns.windows(dim).enumerate() {
        let count = |kind: Kind| axes.iter().filter(|it| it.kind == kind).count();
        let extents = axes.iter().map(Column::extent).filter(|extent| *extent > 0.0);
        let [least, most] = [f64::min, f64::max].map(|f| extents.clone().reduce(f).unwrap_or(1.0));
        let fits = [count(Kind::Real), count(Kind::Constant)] == [dim - constant, constant];
        if fits && most / least <= SIMILAR {
            places.push((most / least, k));
        }
    }
    places.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut ways = Vec::new();
    for &(_, k) in places.iter().take(2) {
        let axes: Vec<String> = ["x", "y", "z"][..dim]
            .iter()
            .zip(k + 1..)
            .map(|(axis, at)| format!("{axis}={at}"))
            .collect();
        let axes = format!("--columns {}", axes.join(","));
        let taken = &columns[k..k + dim];
        let first: Vec<&str> = taken.iter().map(|it| &*it.first).collect();
        let first = first.join(" ");
        let most = taken.iter().map(Column::extent).fold(0.0, f64::max);
        let is_size = |at: &usize| {
            let column = &columns[*at];
            let sized = column.values.iter().all(|x| *x > 0.0 && *x <= most);
            matches!(column.kind, Kind::Real | Kind::Constant) && sized
        };
        // A size stands behind the coordinates, or in front.
        let size = (k + dim..columns.len()).find(is_size).or((0..k).rev().find(is_size));
        if let (Some(size), false) = (size, has_radius) {
            let (value, at) = (&columns[size].first, size + 1);
            ways.push(format!("{axes},r={at} or d={at} (first row: {first}, size {value})"));
        }
        let radius = if has_radius { "" } else { " --radius R" };
        ways.push(format!("{axes}{radius} (first row: {first})"));
    }
    ways
}

/// Returns the columns of the rows that have as many cells as most other lines.
fn columns(head: &[u8]) -> Vec<Column> {
    // The last line may be cut off.
    let end = head.iter().rposition(|&b| b == b'\n').unwrap_or(head.len());
    let lines = head[..end].split(|&b| b == b'\n').map(<[u8]>::trim_ascii);
    // In LAMMPS data, other numbers stand above the atoms.
    let atoms = lines.clone().position(|line| line.starts_with(b"Atoms"));
    let lines = lines.skip(atoms.unwrap_or_default());
    let rows: Vec<Vec<&[u8]>> = lines
        .map(|line| Separator::guess(line).cells(line).collect::<Vec<_>>())
        .filter(|cells| cells.iter().filter(|cell| number(cell).is_some()).count() > 1)
        .collect();
    let count = |cells: usize| rows.iter().filter(|row| row.len() == cells).count();
    let Some(usual) = rows.iter().map(Vec::len).max_by_key(|&cells| (count(cells), cells)) else {
        return Vec::new();
    };
    if count(usual) < FEWEST_ROWS {
        return Vec::new();
    }
    let rows: Vec<&Vec<&[u8]>> =
        rows.iter().filter(|row| row.len() == usual).take(MOST_ROWS).collect();
    (0..usual).map(|k| Column::new(&rows.iter().map(|row| row[k]).collect::<Vec<_>>())).collect()
}
