//! The numbers of a row: their names, units, the passes that measure them, and how they are read.
//!
//! Expressions, filters, `summary.csv`, merging and comparing know a number by this list alone;
//! docs/RECORD.md describes each.

use std::borrow::Cow;
use std::sync::LazyLock;

use crate::record::outcome::Pass;
use crate::record::row::{Course, Row};
use contactbench_terms::errors::{Causes, Errors};
use contactbench_terms::moved::Moved;
use contactbench_terms::op::Op;

/// A number that rows have.
pub struct Column {
    /// What expressions call it.
    pub name: Cow<'static, str>,
    /// The pass that measures it; none where every pass knows it.
    pub pass: Option<Pass>,
    /// Its unit; empty for a ratio or a plain count.
    pub unit: &'static str,
    read: Box<Read>,
}

type Read = dyn Fn(&Row) -> Option<f64> + Send + Sync;
/// The errors of one cause.
type Whose = fn(&Causes) -> &Errors;
/// One of the numbers of errors.
type Which = fn(&Errors) -> f64;

/// All columns, in the order of `summary.csv`.
pub static COLUMNS: LazyLock<Vec<Column>> = LazyLock::new(columns);

/// The time of a detection.
pub const TIME: &str = "time_ns";
/// The time of the first detection of a process.
pub const FIRST: &str = "first_ns";
/// Of a scene in motion: of the time, what building lists took.
pub const BUILDING: &str = "building_ns";
/// The time of the frame in the middle of all.
pub const MEDIAN_STEP: &str = "median_step_ns";
/// The time of the slowest frame.
pub const WORST_STEP: &str = "worst_step_ns";

/// The causes of error: the prefix of their columns, and the prefix that these had before.
const CAUSES: [(&str, &str, Whose); 3] = [
    ("representation_", "input_", |causes| &causes.representation),
    ("predicate_", "arithmetic_", |causes| &causes.predicate),
    ("search_", "algorithm_", |causes| &causes.search),
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

fn columns() -> Vec<Column> {
    use Pass::{Memory, Time};
    let number = |name: &'static str, pass, unit, read: fn(&Row) -> Option<f64>| Column {
        name: name.into(),
        pass,
        unit,
        read: Box::new(read),
    };
    let whole = |value: Option<u64>| value.map(|value| value as f64);
    let whole = move |name, pass, unit, read: fn(&Row) -> Option<u64>| Column {
        read: Box::new(move |row| whole(read(row))),
        ..number(name, pass, unit, |_| None)
    };
    let mut columns = vec![
        whole(TIME, Some(Time), "ns", |row| row.time_ns),
        whole(FIRST, Some(Time), "ns", |row| row.first_ns),
        whole(BUILDING, Some(Time), "ns", |row| row.building_ns),
        whole(MEDIAN_STEP, Some(Time), "ns", |row| row.median_step_ns),
        whole(WORST_STEP, Some(Time), "ns", |row| row.worst_step_ns),
        whole("pulse_ns", Some(Time), "ns", |row| row.pulse_ns),
        whole("contacts", None, "pairs", |row| row.contacts),
    ];
    columns.extend(Op::ALL.iter().map(|op| Column {
        name: op.name().into(),
        pass: Some(Pass::Count),
        unit: "",
        // An operation that a version does not know yet has happened no time.
        read: Box::new(|row| {
            let counted = row.outcome.is_good() && !row.counts.is_empty();
            counted.then(|| row.counts.get(op.name()).copied().unwrap_or(0) as f64)
        }),
    }));
    columns.extend([
        whole("peak_bytes", Some(Memory), "bytes", |row| row.peak_bytes),
        whole("live_bytes", Some(Memory), "bytes", |row| row.live_bytes),
        whole("allocations", Some(Memory), "", |row| row.allocations),
        whole("warm_allocations", Some(Memory), "", |row| row.warm_allocations),
        whole("formula_bytes", Some(Memory), "bytes", |row| row.formula_bytes),
        number("true_contacts", None, "pairs", |row| Some(row.true_contacts())),
    ]);
    let error = |prefix: &str, (name, unit, read): (&str, _, Which), whose: Option<Whose>| Column {
        name: format!("{prefix}{name}").into(),
        pass: None,
        unit,
        read: match whose {
            None => Box::new(move |row| Some(read(row.errors.as_ref()?))),
            Some(cause) => Box::new(move |row| Some(read(cause(row.causes.as_ref()?)))),
        },
    };
    columns.extend(ERRORS.map(|kind| error("", kind, None)));
    for (prefix, _, cause) in CAUSES {
        columns.extend(ERRORS.map(|kind| error(prefix, kind, Some(cause))));
    }
    columns.extend([
        number("packing_fraction", None, "", |row| Some(row.stats.packing_fraction)),
        number("coordination", None, "", |row| Some(row.stats.coordination)),
        number("radius_ratio", None, "", |row| row.stats.radius_ratio),
    ]);
    let course = |name, unit, read: fn(&Course) -> f64| Column {
        read: Box::new(move |row: &Row| row.course.as_ref().map(read)),
        ..number(name, None, unit, |_| None)
    };
    columns.extend([
        course("builds", "frames", |it| it.builds as f64),
        course("dangerous", "frames", |it| it.dangerous as f64),
        course("dangerous_rightly", "frames", |it| it.dangerous_rightly as f64),
        course("missing_builds", "frames", |it| it.missing_builds as f64),
        course("listed", "pairs", |it| it.listed as f64),
        course("wrong_frames", "frames", |it| it.wrong_frames as f64),
        course("worst_missed", "pairs", |it| it.worst_missed as f64),
        course("never", "pairs", |it| it.never as f64),
        course("latest", "frames", |it| it.latest as f64),
        course("deepest_late", "mean radii", |it| it.deepest_late),
        number("first_wrong", None, "frame", |row| Some(row.course?.first_wrong? as f64)),
    ]);
    let moved = |name, unit, read: fn(&Moved) -> f64| Column {
        read: Box::new(move |row: &Row| row.moved.as_ref().map(read)),
        ..number(name, None, unit, |_| None)
    };
    columns.extend([
        moved("mean_way", "diameters", Moved::mean_way),
        moved("longest_way", "diameters", |it| it.way.longest),
        moved("born", "pairs", |it| it.born as f64),
        moved("ended", "pairs", |it| it.ended as f64),
        moved("at_rest", "", Moved::share_at_rest),
        number("tunnelled", None, "pairs", |row| {
            let moved = row.moved.as_ref()?;
            moved.uncounted.is_none().then_some(moved.tunnelled as f64)
        }),
    ]);
    columns
}

impl Column {
    /// The column that expressions call by this name. Those of older experiments are understood:
    /// `input_missed` is `representation_missed`.
    pub fn find(name: &str) -> Option<&'static Column> {
        let renamed = CAUSES
            .iter()
            .find_map(|(prefix, old, _)| Some(format!("{prefix}{}", name.strip_prefix(old)?)));
        let name = renamed.as_deref().unwrap_or(name);
        COLUMNS.iter().find(|column| column.name == name)
    }

    /// The number in a row, if it is there.
    pub fn read(&self, row: &Row) -> Option<f64> {
        (self.read)(row)
    }

    /// Is it the same whenever the same program measures the same cell?
    pub fn repeats(&self) -> bool {
        self.pass != Some(Pass::Time)
    }

    /// Is it a whole number in every row?
    pub fn is_whole(&self) -> bool {
        // Of what every pass knows, what has no unit is a ratio.
        self.pass.is_some() || !matches!(self.unit, "" | "mean radii" | "diameters")
    }

    /// The columns that this pass measures.
    pub fn measured_by(pass: Pass) -> impl Iterator<Item = &'static Column> {
        COLUMNS.iter().filter(move |column| column.pass == Some(pass))
    }
}

/// The columns of errors, of all causes together and of each.
pub fn errors() -> impl Iterator<Item = &'static Column> {
    let kind = |name: &'static str| {
        CAUSES.iter().find_map(|(prefix, ..)| name.strip_prefix(prefix)).unwrap_or(name)
    };
    let error = move |column: &&'static Column| {
        let kind = kind(&column.name);
        ERRORS.iter().any(|(name, ..)| kind == *name)
    };
    COLUMNS.iter().filter(error)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    const PAGE: &str = include_str!("../../../../docs/RECORD.md");

    #[test]
    fn names_are_told_apart_and_old_ones_are_understood() {
        let names: BTreeSet<&str> = COLUMNS.iter().map(|column| &*column.name).collect();
        assert_eq!(names.len(), COLUMNS.len());
        assert_eq!(errors().count(), 28);
        for column in COLUMNS.iter() {
            assert_eq!(Column::find(&column.name).unwrap().name, column.name);
        }
        for (old, new) in [
            ("input_missed", "representation_missed"),
            ("arithmetic_wrong", "predicate_wrong"),
            ("algorithm_deepest_miss", "search_deepest_miss"),
        ] {
            assert_eq!(Column::find(old).unwrap().name, new);
        }
        assert!(Column::find("storage_missed").is_none() && Column::find("wron").is_none());
    }

    #[test]
    fn whole_numbers_are_told_from_others() {
        let is_whole = |name: &&str| Column::find(name).unwrap().is_whole();
        let whole =
            ["time_ns", "contact_test", "peak_bytes", "allocations", "first_wrong", "wrong"];
        assert!(whole.iter().all(is_whole));
        let others = ["coordination", "deepest_late", "search_widest_false", "mean_way", "at_rest"];
        assert!(!others.iter().any(is_whole));
    }

    /// docs/RECORD.md lists every column with its unit and its pass, and no other.
    #[test]
    fn the_page_lists_every_column() {
        let section = PAGE.split_once("\n## Columns\n").unwrap().1;
        let section = section.split("\n## ").next().unwrap();
        let mut listed = BTreeSet::new();
        for line in section.lines().filter(|line| line.starts_with("| `")) {
            let cells: Vec<&str> = line.split('|').map(str::trim).collect();
            for name in cells[1].split(", ") {
                listed.insert((name.trim_matches('`').to_string(), cells[2], cells[3]));
            }
        }
        let columns: BTreeSet<(String, &str, &str)> = COLUMNS
            .iter()
            .map(|column| {
                (column.name.to_string(), column.pass.map_or("", Pass::name), column.unit)
            })
            .collect();
        assert_eq!(listed, columns);
    }
}
