//! The numeric columns of a row: name, unit, pass, and value.
//!
//! Expressions, filters, `summary.csv`, merging and comparing use this list. Most columns are
//! declared in [`crate::record::row`]; docs/RECORD.md describes each.

use std::borrow::Cow;
use std::sync::LazyLock;

use crate::record::outcome::Pass;
use crate::record::row::{Course, Row};
use contactbench_terms::errors::{Causes, Errors};
use contactbench_terms::moved::Moved;
use contactbench_terms::op::Op;

pub struct Column {
    pub name: Cow<'static, str>,
    /// The pass that measures the column; `None` if every pass records it.
    pub pass: Option<Pass>,
    /// Unit of the column; empty for a ratio or a count.
    pub unit: &'static str,
    read: Read,
}

type Read = Box<dyn Fn(&Row) -> Option<f64> + Send + Sync>;

pub static COLUMNS: LazyLock<Vec<Column>> = LazyLock::new(columns);

pub const TIME: &str = "time_ns";
pub const FIRST: &str = "first_ns";
pub const BUILDING: &str = "building_ns";
pub const MEDIAN_STEP: &str = "median_step_ns";
pub const WORST_STEP: &str = "worst_step_ns";

type Whose = fn(&Causes) -> &Errors;
type Which = fn(&Errors) -> f64;

/// For each cause of error: prefix of its columns, and its errors.
const CAUSES: [(&str, Whose); 3] = [
    ("representation_", |causes| &causes.representation),
    ("predicate_", |causes| &causes.predicate),
    ("search_", |causes| &causes.search),
];

const ERRORS: [(&str, &str, Which); 7] = [
    ("missed", "pairs", |errors| errors.missed as f64),
    ("spurious", "pairs", |errors| errors.spurious as f64),
    ("duplicate", "pairs", |errors| errors.duplicate as f64),
    ("self_pairs", "pairs", |errors| errors.self_pairs as f64),
    ("deepest_miss", "mean radii", |errors| errors.deepest_miss),
    ("widest_false", "mean radii", |errors| errors.widest_false),
    ("wrong", "pairs", |errors| errors.wrong() as f64),
];

type Named<T> = (&'static str, &'static str, fn(&T) -> Option<f64>);

const MOVED: [Named<Moved>; 5] = [
    ("mean_way", "diameters", |it| Some(it.mean_way())),
    ("longest_way", "diameters", |it| Some(it.displacements.longest)),
    ("born", "pairs", |it| Some(it.born as f64)),
    ("ended", "pairs", |it| Some(it.ended as f64)),
    ("at_rest", "", |it| Some(it.share_at_rest())),
];

fn columns() -> Vec<Column> {
    let of_row = |pass: Option<Pass>| {
        let own = Row::COLUMNS.iter().filter(move |(_, by, ..)| *by == pass);
        own.map(|&(name, pass, unit, read)| Column::new(name, pass, unit, read))
    };
    let mut columns: Vec<Column> = of_row(Some(Pass::Time)).chain(of_row(None)).collect();
    columns.extend(Op::ALL.iter().map(|op| {
        // An operation that the row lacks counts as 0.
        Column::new(op.name(), Some(Pass::Count), "", |row| {
            let counted = row.outcome.is_good() && !row.counts.is_empty();
            counted.then(|| row.counts.get(op.name()).copied().unwrap_or(0) as f64)
        })
    }));
    columns.extend(of_row(Some(Pass::Memory)));
    let number = |name, unit, read: fn(&Row) -> Option<f64>| Column::new(name, None, unit, read);
    columns.push(number("true_contacts", "pairs", |row| Some(row.true_contacts())));
    columns.extend(ERRORS.map(|(name, unit, read)| {
        Column::new(name, None, unit, move |row| row.errors.as_ref().map(read))
    }));
    for (prefix, whose) in CAUSES {
        columns.extend(ERRORS.map(|(name, unit, read)| {
            let read = move |row: &Row| Some(read(whose(row.causes.as_ref()?)));
            Column::new(format!("{prefix}{name}"), None, unit, read)
        }));
    }
    columns.extend([
        number("packing_fraction", "", |row| Some(row.stats.packing_fraction)),
        number("coordination", "", |row| Some(row.stats.coordination)),
        number("radius_ratio", "", |row| row.stats.radius_ratio),
    ]);
    columns.extend(Course::COLUMNS.iter().map(|&(name, pass, unit, read)| {
        Column::new(name, pass, unit, move |row| read(row.course.as_ref()?))
    }));
    columns.extend(MOVED.map(|(name, unit, read)| {
        Column::new(name, None, unit, move |row| read(row.moved.as_ref()?))
    }));
    columns
}

impl Column {
    fn new(
        name: impl Into<Cow<'static, str>>,
        pass: Option<Pass>,
        unit: &'static str,
        read: impl Fn(&Row) -> Option<f64> + Send + Sync + 'static,
    ) -> Column {
        Column { name: name.into(), pass, unit, read: Box::new(read) }
    }

    pub fn find(name: &str) -> Option<&'static Column> {
        COLUMNS.iter().find(|column| column.name == name)
    }

    pub fn read(&self, row: &Row) -> Option<f64> {
        (self.read)(row)
    }

    pub fn repeats(&self) -> bool {
        self.pass != Some(Pass::Time)
    }

    /// Whether the column counts errors of one cause.
    pub fn is_of_cause(&self) -> bool {
        CAUSES.iter().any(|(prefix, ..)| self.name.starts_with(prefix))
    }

    pub fn is_whole(&self) -> bool {
        // Columns that every pass records are ratios if they have one of these units.
        self.pass.is_some() || !matches!(self.unit, "" | "mean radii" | "diameters")
    }

    pub fn measured_by(pass: Pass) -> impl Iterator<Item = &'static Column> {
        COLUMNS.iter().filter(move |column| column.pass == Some(pass))
    }
}

pub fn errors() -> impl Iterator<Item = &'static Column> {
    COLUMNS.iter().filter(|column| {
        let kind = CAUSES.iter().find_map(|(prefix, ..)| column.name.strip_prefix(prefix));
        ERRORS.iter().any(|(name, ..)| kind.unwrap_or(&column.name) == *name)
    })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn names_are_told_apart() {
        let names: BTreeSet<&str> = COLUMNS.iter().map(|column| &*column.name).collect();
        assert_eq!((names.len(), errors().count()), (COLUMNS.len(), 28));
        assert!(Column::find("storage_missed").is_none() && Column::find("wron").is_none());
        let is_whole = |name: &&str| Column::find(name).unwrap().is_whole();
        let whole =
            ["time_ns", "contact_test", "peak_bytes", "allocations", "first_wrong", "wrong"];
        assert!(whole.iter().all(is_whole));
        let others = ["coordination", "deepest_late", "search_widest_false", "mean_way", "at_rest"];
        assert!(!others.iter().any(is_whole));
    }

    /// docs/RECORD.md lists exactly these columns, with unit and pass.
    #[test]
    fn the_page_lists_every_column() {
        let page = include_str!("../../../../docs/RECORD.md");
        let section = page.split_once("\n## Columns\n").unwrap().1;
        let section = section.split("\n## ").next().unwrap();
        let mut listed = BTreeSet::new();
        for line in section.lines().filter(|line| line.starts_with("| `")) {
            let cells: Vec<&str> = line.split('|').map(str::trim).collect();
            for name in cells[1].split(", ") {
                listed.insert((name.trim_matches('`').to_string(), cells[2], cells[3]));
            }
        }
        let columns = COLUMNS.iter().map(|column| {
            (column.name.to_string(), column.pass.map_or("", Pass::name), column.unit)
        });
        assert_eq!(listed, columns.collect());
    }
}
