//! Cells in the order of tables: a group per scene without its N, a line per contender, a column per N.

use std::collections::{BTreeMap, BTreeSet};

use super::interval::{Blocks, Interval, median, typical_ratio};
use super::summary::{Table, is_control, title};
use super::value::{Cell, Key};
use super::{place, text};
use crate::detect::table::{self, Role};
use crate::harness::record::{Outcome, Pass};

/// Who is compared: the same in all scenes.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Line {
    /// The detector.
    pub detector: String,
    /// How it decides.
    pub arithmetic: String,
    /// Its threads.
    pub threads: u32,
}

/// The cells of a contender at one N: one per seed, in the order of seeds.
pub type Seeds<'a> = Vec<&'a Cell>;

/// A scene at all its N.
pub struct Group<'a> {
    /// `packed, 3D, morton`.
    pub title: String,
    /// Its cells, by contender and N.
    pub lines: BTreeMap<Line, BTreeMap<u64, Seeds<'a>>>,
}

/// Makes the groups, in the order of keys. The control that reports nothing is left out.
pub fn groups<'a>(cells: &[&'a Cell]) -> Vec<Group<'a>> {
    let swept = place::swept(cells);
    let mut groups: BTreeMap<Key, Group<'a>> = BTreeMap::new();
    for &cell in cells.iter().filter(|cell| !is_nothing(&cell.key.detector)) {
        let key = cell.key.clone().without("n").without("seed").without("arithmetic").without("threads").without("detector");
        let name = title(&key, &swept).replacen(", N = 0", "", 1);
        let group = groups.entry(key).or_insert_with(|| Group { title: name, lines: BTreeMap::new() });
        group.lines.entry(Line::of(&cell.key)).or_default().entry(cell.key.n).or_default().push(cell);
    }
    groups.into_values().collect()
}

/// The control that reports nothing.
pub fn is_nothing(name: &str) -> bool {
    table::find(name).is_some_and(|entry| entry.role == Role::Nothing)
}

/// The label of a line: its arithmetic where there are several, its threads where they are not one.
pub fn label(line: &Line, cells: &[&Cell]) -> String {
    let arithmetics: BTreeSet<&str> = cells.iter().map(|cell| cell.key.arithmetic.as_str()).collect();
    let mut label = line.detector.clone();
    if arithmetics.len() > 1 {
        label += &format!(" ({})", line.arithmetic);
    }
    if line.threads > 1 {
        label += &format!(" ({} threads)", line.threads);
    }
    label
}

impl Line {
    /// Of a cell.
    pub fn of(key: &Key) -> Line {
        Line { detector: key.detector.clone(), arithmetic: key.arithmetic.clone(), threads: key.threads }
    }
}

impl<'a> Group<'a> {
    /// All N, in order.
    pub fn sizes(&self) -> BTreeSet<u64> {
        self.lines.values().flat_map(|cells| cells.keys().copied()).collect()
    }

    /// The cells of a line at one N.
    pub fn at(&self, line: &Line, n: u64) -> Option<&Seeds<'a>> {
        self.lines.get(line)?.get(&n)
    }

    /// The fastest of those that are right, are no controls, and have one thread.
    pub fn fastest(&self, n: u64) -> Option<(&Line, f64)> {
        let able = self.lines.iter().filter(|(line, _)| line.threads == 1 && !is_control(&line.detector));
        let timed = able.filter_map(|(line, cells)| Some((line, time(cells.get(&n)?)?)));
        timed.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// A table of this group: a row per line, in the order of the last value that it has; a column per N. `cell` gives the text and the
    /// value to sort by.
    pub fn table(
        &self,
        first: &[Vec<String>],
        label: impl Fn(&Line) -> String,
        cell: impl Fn(&Line, u64) -> Option<(String, Option<f64>)>,
    ) -> Option<Table> {
        let sizes = self.sizes();
        let mut rows: Vec<(Vec<Option<f64>>, Vec<String>)> = Vec::new();
        for line in self.lines.keys() {
            let entries: Vec<_> = sizes.iter().map(|&n| cell(line, n)).collect();
            if entries.iter().any(Option::is_some) {
                let order = entries.iter().rev().map(|entry| entry.as_ref().and_then(|entry| entry.1)).collect();
                let texts = entries.into_iter().map(|entry| entry.map_or("–".into(), |entry| entry.0));
                rows.push((order, std::iter::once(label(line)).chain(texts).collect()));
            }
        }
        let last = |values: &[Option<f64>]| values.iter().position(Option::is_some).map(|k| (k, values[k].unwrap_or(f64::INFINITY)));
        rows.sort_by(|a, b| match (last(&a.0), last(&b.0)) {
            (Some(a), Some(b)) => a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)),
            (a, b) => b.is_some().cmp(&a.is_some()),
        });
        let heads: Vec<String> = std::iter::once("detector".into()).chain(sizes.iter().map(|n| format!(">N = {n}"))).collect();
        let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
        let body: Vec<Vec<String>> = first.iter().cloned().chain(rows.iter().map(|row| row.1.clone())).collect();
        (!rows.is_empty()).then(|| Table { title: self.title.clone(), markdown: text::markdown_table(&heads, &body) })
    }
}

/// The median over seeds of the median times; none if any of them did not end well.
pub fn time(cells: &Seeds<'_>) -> Option<f64> {
    let times: Option<Vec<f64>> = cells.iter().map(|cell| Some(cell.time()?.median)).collect();
    median(&times?)
}

/// How the cells of a line ended, as far as times go: the worst of the seeds, with its reason.
pub fn outcome<'a>(cells: &Seeds<'a>) -> (Outcome, &'a str) {
    let found = cells.iter().map(|cell| cell.outcome(&[Pass::Time]));
    found.max_by_key(|(outcome, _)| (!outcome.is_good(), *outcome)).unwrap_or((Outcome::Ok, ""))
}

/// The ratio of two lines' times, each cell against that of the same seed, in each block the median over the seeds.
pub fn ratio(a: &Seeds<'_>, b: &Seeds<'_>) -> Option<Interval> {
    ratio_of(a, |cell| &cell.times, b, |cell| &cell.times)
}

/// The same of other numbers per block.
pub fn ratio_of<'a>(a: &Seeds<'a>, of_a: fn(&Cell) -> &Blocks, b: &Seeds<'a>, of_b: fn(&Cell) -> &Blocks) -> Option<Interval> {
    let other = |cell: &Cell| b.iter().find(|other| other.key.seed == cell.key.seed);
    let couples: Vec<(&Blocks, &Blocks)> = a.iter().filter_map(|cell| Some((of_a(cell), of_b(other(cell)?)))).collect();
    typical_ratio(&couples)
}

/// What did not end well in these cells and why: one line per kind of reason, numbers aside.
pub fn missing(cells: &[&Cell]) -> Vec<String> {
    let kind = |text: &str| text.chars().map(|c| if c.is_ascii_digit() { '0' } else { c }).collect::<String>();
    let mut found: BTreeMap<(String, &str, String), (usize, &str)> = BTreeMap::new();
    for cell in cells {
        let (outcome, reason) = cell.outcome(&[Pass::Time]);
        if !outcome.is_good() {
            let mut kind = kind(reason);
            while kind.contains("00") {
                kind = kind.replace("00", "0");
            }
            let label = label(&Line::of(&cell.key), cells);
            found.entry((label, outcome.name(), kind)).or_insert((0, reason)).0 += 1;
        }
    }
    let line = |((label, outcome, _), (count, reason)): (&(String, &str, String), &(usize, &str))| {
        format!("{label}: {outcome} in {}: {reason}", text::plural(*count, "cell"))
    };
    found.iter().map(line).collect()
}
