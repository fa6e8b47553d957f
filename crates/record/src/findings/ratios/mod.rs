//! Times as multiples of a reference detector's, paired by block, per scene and n; and whether the
//! reference is near the fastest.

use std::collections::BTreeMap;

use crate::cells::series::{BySize, Group, Line};
use crate::cells::{Cell, series};
use crate::findings::every;
use crate::findings::noise::Noise;
use crate::record::role::Role;
use crate::record::row::{Outcome, Pass};
use crate::stats::interval::Interval;
use contactbench_terms::arithmetic::Arithmetic;

/// A detector is near the fastest if it takes at most this multiple of its time.
pub const NEAR: f64 = 1.2;

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
    /// Number of scenes with this n: one per seed.
    pub scenes: usize,
    pub name: String,
    pub ratio: Interval,
    /// The ratio for first detections, where a library that allocates in each call loses less.
    pub cold: Option<Interval>,
    /// Libraries that may be as fast as the reference; empty if it is decided which is faster.
    pub open: Vec<String>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct SceneRatios {
    pub experiment: String,
    pub fastest: Vec<Fastest>,
    pub entries: BySize<Entry>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Fastest {
    pub n: u64,
    pub scenes: usize,
    pub name: String,
    /// Median time per detection, in nanoseconds.
    pub time_ns: f64,
    pub near: Near,
    pub open: Vec<String>,
}

/// Whether the reference is near the fastest. The ratio is its time over that of the fastest, or
/// over the runner-up's if its own median is the shortest. The answer holds against all others,
/// because a noisy one may be faster than its median. [`Noise::tells`] decides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Near {
    /// The reference is the fastest; decidedly, if there are others.
    Fastest,
    Within(Interval),
    Beyond(Interval),
    Undecided(Option<Interval>),
    /// The reference has no time: its outcome, or `None` if it was not measured.
    Absent(Option<Outcome>),
}

impl Near {
    fn of_ratio(ratio: Option<Interval>, noise: &Noise, n: u64) -> Near {
        match ratio {
            Some(ratio) if !noise.tells(&ratio, NEAR, n) => Near::Undecided(Some(ratio)),
            Some(ratio) if ratio.median < NEAR => Near::Within(ratio),
            Some(ratio) => Near::Beyond(ratio),
            None => Near::Undecided(None),
        }
    }

    pub fn ratio(&self) -> Option<Interval> {
        match self {
            Near::Within(ratio) | Near::Beyond(ratio) => Some(*ratio),
            Near::Undecided(ratio) => *ratio,
            Near::Fastest | Near::Absent(_) => None,
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    pub outcome: Outcome,
    pub reason: String,
    pub control: bool,
    /// Median time per detection, in nanoseconds; `None` without a correct answer.
    pub time_ns: Option<f64>,
    /// Time over that of the base, whatever the outcome; `None` unless the base is correct.
    pub ratio: Option<Interval>,
    pub base: Option<String>,
    /// Whether it is the base of its own ratio.
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
    /// The first reason; the others differ only in numbers.
    pub reason: String,
}

impl Ratios {
    /// Compares all subjects with the reference; `None` if that has no time. The reference has its
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
        let scene = |group: Group<'_>| {
            let fastest = group.sizes().into_iter().filter_map(|n| {
                let (first, time_ns) = group.fastest(n)?;
                let (near, open) = distance(&group, first, n, reference, &noise);
                let open = open.into_iter().map(label).collect();
                // The fastest is decided within blocks, although medians over all blocks may
                // differ.
                let own = timed(&group, first, n, reference).filter(|_| near == Near::Fastest);
                let own_ns = own.and_then(|own| series::time(group.at(own, n)?));
                let (name, time_ns) = (label(own.unwrap_or(first)), own_ns.unwrap_or(time_ns));
                let scenes = every::count(group.cells(n));
                Some(Fastest { n, scenes, name, time_ns, near, open })
            });
            let any = group.lines.values().flat_map(BTreeMap::values).flatten().next();
            SceneRatios {
                experiment: any.map_or(String::new(), |cell| cell.id.experiment.clone()),
                fastest: fastest.collect(),
                entries: group.by_size(
                    label,
                    |line, n| entry(&group, line, n, reference),
                    Entry::right_ratio,
                ),
            }
        };
        let found = Ratios {
            reference: reference.to_string(),
            scenes: groups.into_iter().map(scene).collect(),
            libraries,
            missing: missing(cells),
        };
        let timed = found.fastest().any(|(_, found)| !matches!(found.near, Near::Absent(_)));
        timed.then_some(found)
    }

    pub fn fastest(&self) -> impl Iterator<Item = (&SceneRatios, &Fastest)> {
        self.scenes.iter().flat_map(|scene| scene.fastest.iter().map(move |found| (scene, found)))
    }

    /// The scene and n at which the reference is farthest behind the fastest, with the ratio;
    /// `None` if its median is always shorter.
    pub fn worst(&self) -> Option<(&SceneRatios, u64, Interval)> {
        let ratios =
            self.fastest().filter_map(|(scene, found)| Some((scene, found.n, found.near.ratio()?)));
        let behind = ratios.filter(|(_, _, ratio)| ratio.median > 1.0);
        behind.max_by(|a, b| a.2.median.total_cmp(&b.2.median))
    }
}

fn library(
    group: &Group<'_>,
    n: u64,
    reference: &str,
    noise: &Noise,
    label: impl Fn(&Line) -> String,
) -> Option<Library> {
    let libraries = group.ranked(n, |line| matches!(line.role, Role::Peer | Role::Runner));
    let (own, _) = group.fastest_of(n, |line| {
        line.detector == reference && line.arithmetic == Arithmetic::Exact.name()
    })?;
    let ratio = |line: &Line| series::ratio(group.at(line, n)?, group.at(own, n)?);
    let (first, _) = *libraries.first()?;
    let to_first = ratio(first)?;
    let cold = series::cold_ratio(group.at(first, n)?, group.at(own, n)?);
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
    known.min_by_key(|known| {
        (
            known.arithmetic != line.arithmetic,
            known.arithmetic != Arithmetic::Exact.name(),
            known.threads,
        )
    })
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

/// The line of the reference that has a time: the fewest threads, then preferably the arithmetic of
/// `first`.
fn timed<'a>(group: &'a Group<'_>, first: &Line, n: u64, reference: &str) -> Option<&'a Line> {
    let has_time =
        |line: &&Line| group.at(line, n).is_some_and(|cells| series::time(cells).is_some());
    let known = group.lines.keys().filter(|line| line.detector == reference);
    known.filter(has_time).min_by_key(|line| (line.threads, line.arithmetic != first.arithmetic))
}

/// The distance of the reference from the fastest, and the subjects for which it is undecided.
fn distance<'a>(
    group: &'a Group<'_>,
    first: &Line,
    n: u64,
    reference: &str,
    noise: &Noise,
) -> (Near, Vec<&'a Line>) {
    let measured = |line: &&Line| line.detector == reference && group.lines[*line].contains_key(&n);
    let line = timed(group, first, n, reference);
    let Some(line) = line else {
        let ended = group.lines.keys().find(measured).and_then(|line| group.at(line, n));
        return (Near::Absent(ended.map(|cells| series::outcome(cells).0)), Vec::new());
    };
    let others = group.ranked(n, |other| other.detector != reference);
    let ratio = |a: &Line, b: &Line| series::ratio(group.at(a, n)?, group.at(b, n)?);
    if others.iter().all(|(other, _)| noise.slower(ratio(other, line).as_ref(), n)) {
        return (Near::Fastest, Vec::new());
    }
    let stand = |other: &Line| Near::of_ratio(ratio(line, other), noise, n);
    let to_first = others.first().map_or(Near::Fastest, |(other, _)| stand(other));
    if matches!(to_first, Near::Beyond(_)) {
        return (to_first, Vec::new());
    }
    let open = others.into_iter().map(|(other, _)| other);
    let open: Vec<&Line> = open.filter(|it| !matches!(stand(it), Near::Within(_))).collect();
    if open.is_empty() { (to_first, open) } else { (Near::Undecided(to_first.ratio()), open) }
}

/// Counts bad outcomes per subject and reason; reasons that differ only in numbers are one.
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
