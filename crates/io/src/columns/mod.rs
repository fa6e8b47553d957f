//! The columns of a file or the arrays of an archive: their names and meaning.

pub mod advice;
pub mod chosen;
pub mod shapes;
pub mod units;
pub mod without;

use anyhow::{bail, ensure};

use crate::raw::lines::short;
use crate::types::RadiusSource;
use chosen::Chosen;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// Axis 0, 1 or 2 for x, y or z.
    Axis(usize),
    Radius,
    Diameter,
    Id,
    /// All coordinates, as rows of an array.
    Points,
    Other,
}

impl Column {
    pub fn named(name: &str) -> Column {
        match units::split(name).0.to_ascii_lowercase().as_str() {
            "x" => Column::Axis(0),
            "y" => Column::Axis(1),
            "z" => Column::Axis(2),
            "r" | "radius" | "radii" => Column::Radius,
            "d" | "diameter" | "diameters" => Column::Diameter,
            "id" => Column::Id,
            _ => Column::Other,
        }
    }

    pub fn words(self) -> &'static str {
        match self {
            Column::Axis(axis) => ["x", "y", "z"].get(axis).copied().unwrap_or("a coordinate"),
            Column::Radius => "the radius",
            Column::Diameter => "the diameter",
            Column::Id => "the id",
            Column::Points => "the points",
            Column::Other => "something else",
        }
    }

    pub fn is_size(self) -> bool {
        matches!(self, Column::Radius | Column::Diameter)
    }

    /// Returns the coordinate or radius for a value in this column.
    pub fn value(self, value: f64) -> Result<f64, &'static str> {
        match value {
            _ if !value.is_finite() => Err("is not a finite number"),
            _ if self.is_size() && value < 0.0 => Err("is negative"),
            _ if self == Column::Diameter => Ok(0.5 * value),
            _ => Ok(value),
        }
    }
}

#[derive(Clone, Debug, Default)]
pub struct Columns {
    pub meaning: Vec<Column>,
    pub names: Vec<String>,
    /// Whether lines may have more columns than the named ones.
    pub or_more: bool,
    /// Whether unused columns at the end of a line may be missing.
    pub or_fewer: bool,
}

impl Columns {
    pub fn named(names: impl IntoIterator<Item = impl Into<String>>) -> Columns {
        let names: Vec<String> = names.into_iter().map(Into::into).collect();
        let mut meaning: Vec<Column> = names.iter().map(|name| Column::named(name)).collect();
        // ParaView names coordinates Points:0, Points:1, Points:2.
        let of_points = |name: &String| match &*name.to_ascii_lowercase().replace('_', ":") {
            "points:0" => Column::Axis(0),
            "points:1" => Column::Axis(1),
            "points:2" => Column::Axis(2),
            _ => Column::Other,
        };
        let suffixed = |name: &String| {
            let plain = units::suffixed(name).map(|(name, _)| Column::named(name));
            plain.filter(|column| *column != Column::Id).unwrap_or(Column::Other)
        };
        let is_axis = |meaning: &Column| matches!(meaning, Column::Axis(_));
        for other in [&of_points as &dyn Fn(&String) -> Column, &suffixed] {
            if !meaning.iter().any(is_axis) {
                for (meaning, name) in meaning.iter_mut().zip(&names) {
                    *meaning =
                        Some(other(name)).filter(|it| *it != Column::Other).unwrap_or(*meaning);
                }
            }
        }
        Columns { meaning, names, ..Columns::default() }
    }

    /// Names the columns in a text by blanks.
    pub fn of(names: &str) -> Columns {
        Columns::named(names.split(' '))
    }

    /// Columns that have only numbers.
    pub fn numbered(count: usize) -> Columns {
        Columns::named((1..=count).map(|k| format!("column {k}")))
    }

    pub fn has(&self, column: Column) -> bool {
        self.meaning.contains(&column)
    }

    pub fn has_places(&self) -> bool {
        (0..2).all(|axis| self.has(Column::Axis(axis)))
    }

    fn all(&self) -> impl Iterator<Item = (Column, &String)> {
        self.meaning.iter().copied().zip(&self.names)
    }

    pub fn chosen(self, place: &str, chosen: Option<Chosen>) -> anyhow::Result<Columns> {
        match chosen {
            Some(chosen) => chosen.apply(self, place),
            None => Ok(self),
        }
    }

    /// Refuses columns that mean the same, missing coordinates, and lengths in several units.
    pub fn check(&self, place: &str) -> anyhow::Result<()> {
        let used = |column: Column| !matches!(column, Column::Other | Column::Id);
        let same = |a: Column, b: Column| a == b || a.is_size() && b.is_size();
        for (k, (column, name)) in self.all().enumerate().filter(|(_, it)| used(it.0)) {
            if let Some((_, other)) = self.all().skip(k + 1).find(|(it, _)| same(*it, column)) {
                let what = if column.is_size() { "the size" } else { column.words() };
                let [a, b] = [name, other].map(|name| short(name));
                bail!("{place}: '{a}' and '{b}' both mean {what}; choose one with --columns");
            }
        }
        for (axis, name) in ["x", "y"].into_iter().enumerate() {
            let names: Vec<String> = self.names.iter().map(|name| short(name)).take(8).collect();
            ensure!(
                self.has(Column::Axis(axis)),
                "{place}: there is no column '{name}' among '{}'; give --columns x=NAME,y=NAME",
                names.join("', '")
            );
        }
        let mut lengths =
            self.all().filter(|(column, name)| used(*column) && units::unit_of(name).is_some());
        let Some((_, first)) = lengths.next() else { return Ok(()) };
        let other = lengths.find(|(_, name)| units::unit_of(name) != units::unit_of(first));
        let other = other.map(|(_, name)| short(name)).unwrap_or_default();
        let same = other.is_empty();
        ensure!(same, "{place}: '{}' and '{other}' are in different units", short(first));
        Ok(())
    }

    pub fn radius(&self) -> RadiusSource {
        let named = |column| self.all().find(|(it, _)| *it == column).map(|(_, name)| name.clone());
        match (named(Column::Radius), named(Column::Diameter)) {
            (Some(name), _) => RadiusSource::Column(name),
            (_, Some(name)) => RadiusSource::Halved(name),
            _ => RadiusSource::Missing,
        }
    }
}
