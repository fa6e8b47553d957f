//! Cells arranged for tables: a group per scene, with a line per subject and a column per N.

use std::collections::{BTreeMap, BTreeSet};

use crate::cells::label::title;
use crate::cells::{Cell, label};
use crate::record::id::Projection;
use crate::record::role::Role;
use crate::record::row::{Outcome, Pass};
use crate::stats::interval::{Blocks, Interval, median, typical_ratio};
use contactbench_terms::arithmetic::Arithmetic;

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Line {
    pub detector: String,
    pub arithmetic: String,
    pub threads: u32,
    pub role: Role,
}

/// The cells of a subject at one N, one per seed, in the order of seeds.
pub type Seeds<'a> = Vec<&'a Cell>;

pub struct Group<'a> {
    /// Title of the scene, such as `packed, 3D, morton`.
    pub title: String,
    pub lines: BTreeMap<Line, BTreeMap<u64, Seeds<'a>>>,
}

pub fn groups<'a>(cells: &[&'a Cell]) -> Vec<Group<'a>> {
    let swept = label::swept(cells);
    let mut groups: BTreeMap<Projection, Group<'a>> = BTreeMap::new();
    for &cell in cells.iter().filter(|cell| cell.role != Role::Nothing) {
        let key = cell.id.scene_id().without(&["n", "seed"]);
        let name = title(&key, &swept);
        let group =
            groups.entry(key).or_insert_with(|| Group { title: name, lines: BTreeMap::new() });
        group.lines.entry(Line::new(cell)).or_default().entry(cell.id.n).or_default().push(cell);
    }
    groups.into_values().collect()
}

/// Returns the label of a line: the arithmetic is included if there are several, and the threads if
/// not 1.
pub fn labels(cells: &[&Cell]) -> impl Fn(&Line) -> String + Copy {
    let several = cells.iter().any(|cell| cell.id.arithmetic != cells[0].id.arithmetic);
    move |line| {
        let mut label = line.detector.clone();
        if several {
            label += &format!(" ({})", line.arithmetic);
        }
        if line.threads > 1 {
            label += &format!(" ({} threads)", line.threads);
        }
        label
    }
}

/// Sorts the arithmetics with which another is compared: preferably the same, otherwise exact.
pub fn preference(arithmetic: &str, to: &str) -> [bool; 2] {
    [arithmetic != to, arithmetic != Arithmetic::Exact.name()]
}

impl Line {
    pub fn new(cell: &Cell) -> Line {
        Line {
            detector: cell.id.subject(),
            arithmetic: cell.id.arithmetic.clone(),
            threads: cell.id.threads(),
            role: cell.role.clone(),
        }
    }
}

impl<'a> Group<'a> {
    pub fn sizes(&self) -> BTreeSet<u64> {
        self.lines.values().flat_map(|cells| cells.keys().copied()).collect()
    }

    pub fn cells(&self, n: u64) -> impl Iterator<Item = &'a Cell> {
        self.lines.values().filter_map(move |sizes| sizes.get(&n)).flatten().copied()
    }

    pub fn at(&self, line: &Line, n: u64) -> Option<&Seeds<'a>> {
        self.lines.get(line)?.get(&n)
    }

    /// The correct subjects with one thread that are not controls, the fastest first.
    pub fn ranked(&self, n: u64, wanted: impl Fn(&Line) -> bool) -> Vec<(&Line, f64)> {
        let able = self
            .lines
            .iter()
            .filter(|(line, _)| line.threads == 1 && !line.role.is_control() && wanted(line));
        let timed = able.filter_map(|(line, cells)| Some((line, time(cells.get(&n)?)?)));
        let mut timed: Vec<(&Line, f64)> = timed.collect();
        timed.sort_by(|a, b| a.1.total_cmp(&b.1));
        timed
    }
}

/// The median over seeds of the median times; `None` unless all cells ended well.
pub fn time(cells: &Seeds<'_>) -> Option<f64> {
    let times: Option<Vec<f64>> = cells.iter().map(|cell| Some(cell.time()?.median)).collect();
    median(&times?)
}

pub fn outcome<'a>(cells: &Seeds<'a>) -> (Outcome, &'a str) {
    let found = cells.iter().map(|cell| cell.outcome(&[Pass::Time]));
    found.max_by_key(|(outcome, _)| (!outcome.is_good(), *outcome)).unwrap_or((Outcome::Ok, ""))
}

/// The ratio of two subjects' times, with its interval over the ratios of all seeds and blocks.
pub fn ratio(a: &Seeds<'_>, b: &Seeds<'_>) -> Option<Interval> {
    ratio_of(a, |cell| &cell.times, b, |cell| &cell.times)
}

pub fn ratio_of<'a>(
    a: &Seeds<'a>,
    of_a: fn(&Cell) -> &Blocks,
    b: &Seeds<'a>,
    of_b: fn(&Cell) -> &Blocks,
) -> Option<Interval> {
    let other = |cell: &Cell| b.iter().find(|other| other.id.seed == cell.id.seed);
    let pairs: Vec<(&Blocks, &Blocks)> =
        a.iter().filter_map(|cell| Some((of_a(cell), of_b(other(cell)?)))).collect();
    typical_ratio(&pairs)
}
