//! Everybody's time as a multiple of one detector's: paired within blocks, per scene and N, and
//! whether that detector is near the best.

use std::collections::BTreeMap;

use crate::cells::series::{BySize, Group, Line};
use crate::cells::{Cell, series};
use crate::contact::Arithmetic;
use crate::record::row::{Outcome, Pass};
use crate::stats::interval::Interval;

/// A detector that takes at most so many times the time of the fastest is near it.
pub const NEAR: f64 = 1.2;

/// The comparison of all contenders with one detector.
#[derive(Clone, Debug, PartialEq)]
pub struct Ratios {
    /// The detector that the others are compared with.
    pub reference: String,
    /// One per scene, in the order of cells.
    pub scenes: Vec<SceneRatios>,
    /// Who has no right answer, and why.
    pub missing: Vec<Missing>,
}

/// A scene at all its N.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneRatios {
    /// The experiment's name.
    pub experiment: String,
    /// How the reference stands to the fastest, by N; without those N at which nobody has a time.
    pub fastest: Vec<Fastest>,
    /// Every contender's time and ratio, by N.
    pub entries: BySize<Entry>,
}

/// The fastest of those with a right answer and one thread, controls aside, at one N.
#[derive(Clone, Debug, PartialEq)]
pub struct Fastest {
    /// Particles.
    pub n: u64,
    /// Its name.
    pub name: String,
    /// Its median time per detection, in nanoseconds.
    pub time_ns: f64,
    /// How the reference stands to it.
    pub near: Near,
}

/// Is the reference near the fastest? Ratios are its time over that of the fastest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Near {
    /// It is the fastest.
    Fastest,
    /// The whole interval is at most [`NEAR`].
    Within(Interval),
    /// The whole interval is above [`NEAR`].
    Beyond(Interval),
    /// The interval holds [`NEAR`], is of one block only, or there is none.
    Undecided(Option<Interval>),
    /// It has no time: how it ended, or none if it was not measured.
    Absent(Option<Outcome>),
}

impl Near {
    fn of_ratio(ratio: Option<Interval>) -> Near {
        match ratio {
            Some(ratio) if ratio.count > 1 && ratio.high <= NEAR => Near::Within(ratio),
            Some(ratio) if ratio.count > 1 && ratio.low > NEAR => Near::Beyond(ratio),
            ratio => Near::Undecided(ratio),
        }
    }

    /// The time of the reference over that of the fastest.
    pub fn ratio(&self) -> Option<Interval> {
        match self {
            Near::Within(ratio) | Near::Beyond(ratio) => Some(*ratio),
            Near::Undecided(ratio) => *ratio,
            Near::Fastest | Near::Absent(_) => None,
        }
    }
}

/// A contender at one N.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// How it ended, as far as times go: the worst of its seeds.
    pub outcome: Outcome,
    /// Why; empty if it ended well.
    pub reason: String,
    /// Is it a control, which is no contender?
    pub control: bool,
    /// Its median time per detection, in nanoseconds; none without a right answer.
    pub time_ns: Option<f64>,
    /// Its time over that of its base, whatever its outcome; none unless the base is right.
    pub ratio: Option<Interval>,
    /// The arithmetic of the reference that it is compared with.
    pub base: Option<String>,
    /// Is it the base of its own ratio?
    pub is_base: bool,
}

impl Entry {
    /// The ratio, where the answer is right.
    pub fn right_ratio(&self) -> Option<f64> {
        self.ratio.filter(|_| self.outcome.is_good()).map(|ratio| ratio.median)
    }
}

/// Cells that did not end well, of one contender and for one kind of reason.
#[derive(Clone, Debug, PartialEq)]
pub struct Missing {
    /// The contender.
    pub name: String,
    /// How they ended.
    pub outcome: Outcome,
    /// How many cells.
    pub cells: usize,
    /// The first reason; the others differ from it in numbers.
    pub reason: String,
}

impl Ratios {
    /// Compares; none if the reference has no time anywhere. It is taken with its fewest threads,
    /// in the arithmetic of the one that it is compared with, or else in exact arithmetic.
    pub fn new(cells: &[&Cell], reference: &str) -> Option<Ratios> {
        let label = |line: &Line| series::label(line, cells);
        let scene = |group: Group<'_>| {
            let fastest = group.sizes().into_iter().filter_map(|n| {
                let (first, time_ns) = group.fastest(n)?;
                let near = distance(&group, first, n, reference);
                Some(Fastest { n, name: label(first), time_ns, near })
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
            scenes: series::groups(cells).into_iter().map(scene).collect(),
            missing: missing(cells),
        };
        let timed = found.fastest().any(|(_, found)| !matches!(found.near, Near::Absent(_)));
        timed.then_some(found)
    }

    /// All scenes at all N at which somebody has a time.
    pub fn fastest(&self) -> impl Iterator<Item = (&SceneRatios, &Fastest)> {
        self.scenes.iter().flat_map(|scene| scene.fastest.iter().map(move |found| (scene, found)))
    }

    /// Where the reference is farthest behind the fastest, and by how much.
    pub fn worst(&self) -> Option<(&SceneRatios, u64, Interval)> {
        let ratios =
            self.fastest().filter_map(|(scene, found)| Some((scene, found.n, found.near.ratio()?)));
        ratios.max_by(|a, b| a.2.median.total_cmp(&b.2.median))
    }
}

/// The line that `line` is compared with in its group: as few threads as there are, and the same
/// arithmetic if there is one.
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

/// How far the reference is from the fastest.
fn distance(group: &Group<'_>, first: &Line, n: u64, reference: &str) -> Near {
    let measured = |line: &&Line| line.detector == reference && group.lines[*line].contains_key(&n);
    let timed = |line: &&Line| group.at(line, n).is_some_and(|cells| series::time(cells).is_some());
    let line = group
        .lines
        .keys()
        .filter(measured)
        .filter(timed)
        .min_by_key(|line| (line.threads, line.arithmetic != first.arithmetic));
    match line {
        None => {
            let ended = group.lines.keys().find(measured).and_then(|line| group.at(line, n));
            Near::Absent(ended.map(|cells| series::outcome(cells).0))
        }
        Some(line) if line == first => Near::Fastest,
        Some(line) => {
            let both = group.at(line, n).zip(group.at(first, n));
            Near::of_ratio(both.and_then(|(line, first)| series::ratio(line, first)))
        }
    }
}

/// What did not end well in these cells and why: one per contender and kind of reason, numbers
/// aside.
fn missing(cells: &[&Cell]) -> Vec<Missing> {
    let kind = |reason: &str| {
        let mut kind: Vec<char> =
            reason.chars().map(|c| if c.is_ascii_digit() { '0' } else { c }).collect();
        kind.dedup_by(|a, b| *a == '0' && *b == '0');
        kind
    };
    let mut found: BTreeMap<_, Missing> = BTreeMap::new();
    for cell in cells {
        let (outcome, reason) = cell.outcome(&[Pass::Time]);
        if !outcome.is_good() {
            let name = series::label(&Line::new(cell), cells);
            let first = Missing { name: name.clone(), outcome, cells: 0, reason: reason.into() };
            found.entry((name, outcome.name(), kind(reason))).or_insert(first).cells += 1;
        }
    }
    found.into_values().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells;
    use crate::cells::testing::Lab;

    fn ratios(lab: &Lab, reference: &str) -> Option<Ratios> {
        let cells = cells::cells(&lab.rows());
        Ratios::new(&cells.iter().collect::<Vec<_>>(), reference)
    }

    fn near(ratio: Option<Interval>, expected: f64) -> bool {
        ratio.is_some_and(|ratio| {
            [ratio.low, ratio.median, ratio.high].iter().all(|v| (v - expected).abs() < 1e-9)
        })
    }

    #[test]
    fn ratios_are_paired_sorted_and_without_wrong_winners() {
        let mut lab = Lab::new("e", "packed");
        for (n, screening, sorting) in [(100, 125, 300), (1000, 110, 250)] {
            lab.n(n).arithmetic("exact");
            lab.detector("nbs").time(&[100 * n; 15]).detector("nbs-twin").time(&[101 * n; 15]);
            lab.detector("screening").time(&[screening * n; 15]);
            lab.detector("sorting").time(&[sorting * n; 15]);
            lab.detector("nothing").time(&[1; 15]).edit(|row| row.outcome = Outcome::Control);
            // The fastest of all, but wrong; and a peer that is not there, in an arithmetic of its
            // own.
            lab.detector("direct").time(&[50 * n; 15]).edit(|row| row.outcome = Outcome::Wrong);
            let why = format!("get it, {n}");
            lab.arithmetic("f64").detector("peer").fail(Pass::Time, Outcome::Unavailable, &why);
            lab.detector("other").time(&[80 * n; 15]);
        }
        let found = ratios(&lab, "nbs").unwrap();
        let [scene] = &*found.scenes else { panic!("{found:?}") };
        assert_eq!(scene.entries.sizes, [100, 1000]);
        let names: Vec<&str> = scene.entries.lines.iter().map(|line| &*line.name).collect();
        assert_eq!(
            names[..5],
            [
                "other (f64)",
                "nbs (exact)",
                "nbs-twin (exact)",
                "screening (exact)",
                "sorting (exact)"
            ]
        );
        assert_eq!(names.len(), 7, "nothing is no contender");
        let entry = |name: &str, k: usize| {
            let line = scene.entries.lines.iter().find(|line| line.name == name).unwrap();
            line.values[k].clone().unwrap()
        };
        assert!(near(entry("other (f64)", 1).ratio, 0.8));
        assert!(near(entry("screening (exact)", 0).ratio, 1.25));
        assert!(near(entry("screening (exact)", 1).ratio, 1.1));
        let nbs = entry("nbs (exact)", 0);
        assert_eq!((nbs.time_ns, nbs.is_base, nbs.control), (Some(1e4), true, false));
        assert!(entry("nbs-twin (exact)", 0).control);
        let wrong = entry("direct (exact)", 0);
        assert_eq!((wrong.outcome, wrong.time_ns), (Outcome::Wrong, None));
        assert!(near(wrong.ratio, 0.5) && wrong.right_ratio().is_none());
        let peer = entry("peer (f64)", 1);
        assert_eq!(
            (peer.outcome, peer.ratio, peer.base.as_deref()),
            (Outcome::Unavailable, None, Some("exact"))
        );
        let Missing { name, outcome, cells, reason } = &found.missing[1];
        assert_eq!((&**name, *outcome, *cells), ("peer (f64)", Outcome::Unavailable, 2));
        assert_eq!(reason, "get it, 100");
        let last = &scene.fastest[1];
        assert_eq!((last.n, &*last.name, last.time_ns), (1000, "other (f64)", 8e4));
        assert!(matches!(last.near, Near::Beyond(_)) && near(last.near.ratio(), 1.25));
    }

    #[test]
    fn near_is_decided_by_the_interval() {
        let mut lab = Lab::new("e", "packed");
        for (n, other) in [(10, 100), (20, 90), (30, 50), (40, 84)] {
            lab.n(n).detector("nbs").time(&[100; 15]);
            lab.detector("screening").time(&[other; 15]);
        }
        // Half the blocks here, half there: the median is beyond, or within, and proves nothing.
        for (n, odd, even) in [(50, 95, 60), (55, 60, 95)] {
            let spread: Vec<u64> = (0..15).map(|k| if k % 2 == 0 { even } else { odd }).collect();
            lab.n(n).detector("nbs").time(&[100; 15]).detector("screening").time(&spread);
        }
        lab.n(60).detector("nbs").fail(Pass::Time, Outcome::Timeout, "30 s");
        lab.detector("screening").time(&[5; 15]);
        lab.n(5).detector("nbs").time(&[100; 15]).detector("screening").time(&[101; 15]);
        lab.n(4).detector("screening").time(&[101; 15]);
        let found = ratios(&lab, "nbs").unwrap();
        let words: Vec<&str> = found
            .fastest()
            .map(|(_, fastest)| match fastest.near {
                Near::Fastest => "fastest",
                Near::Within(ratio) if ratio.high <= NEAR => "within",
                Near::Beyond(ratio) if ratio.low > NEAR => "beyond",
                Near::Undecided(Some(ratio)) if ratio.low <= NEAR && ratio.high > NEAR => "open",
                Near::Absent(Some(Outcome::Timeout)) => "timeout",
                Near::Absent(None) => "not measured",
                other => panic!("{other:?}"),
            })
            .collect();
        // Equal times at N = 10: the first in order is the fastest.
        let rest = ["fastest", "within", "beyond", "within", "open", "open", "timeout"];
        assert_eq!(words, [&["not measured", "fastest"], &rest[..]].concat());
        let (_, n, worst) = found.worst().unwrap();
        assert!(n == 30 && near(Some(worst), 2.0), "{worst:?}");
        assert!(ratios(&lab, "sorting").is_none());
        let one = Interval { median: 1.0, low: 1.0, high: 1.0, coverage: 0.0, count: 1 };
        assert_eq!(Near::of_ratio(Some(one)), Near::Undecided(Some(one)), "one block is no proof");
    }

    #[test]
    fn seeds_are_compared_with_their_own_and_threads_with_one() {
        let mut lab = Lab::new("e", "packed");
        for (seed, scale) in [(1, 1), (2, 10), (3, 100)] {
            lab.seed(seed).threads(1).detector("nbs").time(&[100 * scale; 15]);
            lab.detector("direct").time(&[200 * scale; 15]);
            lab.threads(2).detector("nbs").time(&[60 * scale; 15]);
        }
        let found = ratios(&lab, "nbs").unwrap();
        let entries = &found.scenes[0].entries.lines;
        let names: Vec<&str> = entries.iter().map(|line| &*line.name).collect();
        assert_eq!(names, ["nbs (2 threads)", "nbs", "direct"]);
        for (line, ratio) in entries.iter().zip([0.6, 1.0, 2.0]) {
            let entry = line.values[0].as_ref().unwrap();
            assert!(near(entry.ratio, ratio) && entry.is_base == (line.name == "nbs"), "{entry:?}");
        }
        assert_eq!(entries[1].values[0].as_ref().unwrap().time_ns, Some(1000.0));
    }
}
