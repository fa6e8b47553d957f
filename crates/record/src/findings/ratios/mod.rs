//! The time of every subject over that of one detector: paired within blocks, per scene and N.

use std::collections::BTreeMap;

use crate::cells::series::{Group, Line, preference};
use crate::cells::{Cell, series};
use crate::findings::claim::every;
use crate::findings::trust::noise::Noise;
use crate::record::role::Role;
use crate::record::row::{Outcome, Pass};
use crate::stats::interval::Interval;
use contactbench_terms::arithmetic::Arithmetic;

#[derive(Clone, Debug, PartialEq)]
pub struct Ratios {
    pub reference: String,
    pub scenes: Vec<SceneRatios>,
    pub libraries: Vec<Library>,
    pub missing: Vec<Missing>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Library {
    pub title: String,
    pub n: u64,
    pub scenes: usize,
    pub name: String,
    pub ratio: Interval,
    /// Ratio of first detections, where a library that allocates in each call loses less.
    pub cold: Option<Interval>,
    /// Libraries that may be as fast as the reference; empty if it is decided which is faster.
    pub open: Vec<String>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct SceneRatios {
    pub experiment: String,
    pub title: String,
    pub sizes: Vec<u64>,
    pub lines: Vec<LineRatios>,
}

/// The entries of a subject, one for each N.
#[derive(Clone, Debug, PartialEq)]
pub struct LineRatios {
    pub line: Line,
    pub name: String,
    pub entries: Vec<Option<Entry>>,
}

impl SceneRatios {
    /// Lines are sorted by the ratio at their largest N; lines without entries are left out.
    fn new(group: &Group<'_>, label: impl Fn(&Line) -> String, reference: &str) -> SceneRatios {
        let sizes = Vec::from_iter(group.sizes());
        let line = |line: &Line| LineRatios {
            line: line.clone(),
            name: label(line),
            entries: sizes.iter().map(|&n| entry(group, line, n, reference)).collect(),
        };
        let mut lines: Vec<LineRatios> = group.lines.keys().map(line).collect();
        lines.retain(|line| line.entries.iter().any(Option::is_some));
        let last = |line: &LineRatios| {
            let ratios = line.entries.iter().rev().map(|entry| entry.as_ref()?.right_ratio());
            let last = ratios.enumerate().find_map(|(k, ratio)| Some((k, ratio?)));
            last.unwrap_or((usize::MAX, f64::INFINITY))
        };
        lines.sort_by(|a, b| {
            let (a, b) = (last(a), last(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        let any = group.lines.values().flat_map(BTreeMap::values).flatten().next();
        let experiment = any.map_or(String::new(), |cell| cell.id.experiment.clone());
        SceneRatios { experiment, title: group.title.clone(), sizes, lines }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    pub outcome: Outcome,
    pub reason: String,
    pub control: bool,
    /// Median time per detection, in nanoseconds; `None` without a correct answer.
    pub time_ns: Option<f64>,
    /// Time over the time of the base, whatever the outcome; `None` unless the base is correct.
    pub ratio: Option<Interval>,
    pub base: Option<String>,
    /// Whether this entry is the base of its own ratio.
    pub is_base: bool,
}

impl Entry {
    pub fn right_ratio(&self) -> Option<f64> {
        self.ratio.filter(|_| self.outcome.is_good()).map(|ratio| ratio.median)
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Missing {
    pub name: String,
    pub outcome: Outcome,
    pub cells: usize,
    /// The first reason; other reasons differ from it only in numbers.
    pub reason: String,
}

impl Ratios {
    /// Compares all subjects with the reference; `None` if it has no time. The reference has its
    /// fewest threads, and preferably the arithmetic of the other subject, otherwise exact
    /// arithmetic.
    pub fn new(cells: &[&Cell], reference: &str) -> Option<Ratios> {
        let label = series::labels(cells);
        let noise = Noise::new(cells);
        let groups = series::groups(cells);
        let libraries = groups.iter().flat_map(|group| {
            let found = |n| library(group, n, reference, &noise, label);
            group.sizes().into_iter().filter_map(found).collect::<Vec<_>>()
        });
        let libraries = libraries.collect();
        let found = Ratios {
            reference: reference.to_string(),
            scenes: groups.iter().map(|it| SceneRatios::new(it, label, reference)).collect(),
            libraries,
            missing: missing(cells),
        };
        let lines = found.scenes.iter().flat_map(|scene| &scene.lines);
        let mut entries = lines.flat_map(|line| line.entries.iter().flatten());
        entries.any(|entry| entry.is_base && entry.time_ns.is_some()).then_some(found)
    }
}

fn library(
    group: &Group<'_>,
    n: u64,
    reference: &str,
    noise: &Noise,
    label: impl Fn(&Line) -> String,
) -> Option<Library> {
    // The runners contactbench and contactbench-half are our own list in Python.
    let libraries = group.ranked(n, |line| {
        matches!(line.role, Role::Peer | Role::Runner) && !line.detector.starts_with("contactbench")
    });
    let own = group.ranked(n, |line| {
        line.detector == reference && line.arithmetic.parse().is_ok_and(Arithmetic::is_exact)
    });
    let (own, _) = *own.first()?;
    let ratio = |line: &Line| series::ratio(group.at(line, n)?, group.at(own, n)?);
    let (first, _) = *libraries.first()?;
    let to_first = ratio(first)?;
    let cold = Cell::first_times;
    let cold = series::ratio_of(group.at(first, n)?, cold, group.at(own, n)?, cold);
    let behind = to_first.median < 1.0 && noise.decides(&to_first, n);
    let open = libraries.iter().filter(|it| !noise.slower(ratio(it.0).as_ref(), n));
    let open = open.filter(|_| !behind).map(|it| label(it.0)).collect();
    let (title, name, scenes) = (group.title.clone(), label(first), every::count(group.cells(n)));
    Some(Library { title, n, scenes, name, ratio: to_first, cold, open })
}

impl Library {
    pub fn decided(&self) -> bool {
        self.open.is_empty()
    }
}

/// The line of the reference that `line` is compared with: preferably the same arithmetic, then the
/// fewest threads.
fn base<'a>(group: &'a Group<'_>, line: &Line, reference: &str) -> Option<&'a Line> {
    let known = group.lines.keys().filter(|known| known.detector == reference);
    known.min_by_key(|it| (preference(&it.arithmetic, &line.arithmetic), it.threads))
}

fn entry(group: &Group<'_>, line: &Line, n: u64, reference: &str) -> Option<Entry> {
    let cells = group.at(line, n)?;
    let (outcome, reason) = series::outcome(cells);
    let base = base(group, line, reference);
    let right = base.and_then(|base| group.at(base, n)).filter(|base| series::time(base).is_some());
    Some(Entry {
        outcome,
        reason: reason.to_string(),
        control: line.role.is_control(),
        time_ns: series::time(cells),
        ratio: right.and_then(|base| series::ratio(cells, base)),
        base: base.map(|base| base.arithmetic.clone()),
        is_base: base == Some(line),
    })
}

/// Counts bad outcomes per subject and reason. Reasons that differ only in numbers count as one.
fn missing(cells: &[&Cell]) -> Vec<Missing> {
    let kind = |reason: &str| {
        let mut kind: Vec<char> =
            reason.chars().map(|c| if c.is_ascii_digit() { '0' } else { c }).collect();
        kind.dedup_by(|a, b| *a == '0' && *b == '0');
        kind
    };
    let label = series::labels(cells);
    let mut found: BTreeMap<_, Missing> = BTreeMap::new();
    for cell in cells {
        let (outcome, reason) = cell.outcome(&[Pass::Time]);
        if !outcome.is_good() {
            let name = label(&Line::new(cell));
            let first = Missing { name: name.clone(), outcome, cells: 0, reason: reason.into() };
            found.entry((name, outcome.name(), kind(reason))).or_insert(first).cells += 1;
        }
    }
    found.into_values().collect()
}

#[cfg(test)]
mod tests;
