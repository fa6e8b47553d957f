//! The fastest detector of each scene, by how much, and whether that is decided. There is one
//! answer, and the report, the page, the terminal and the tables for papers all print it.
//!
//! Every scene has a contest. In it each detector takes part once, in its plainest setting: with
//! its fewest threads, and in exact arithmetic if it can. So detectors are compared and not
//! settings: were each setting a contestant, a detector with two threads would have itself with one
//! thread as its runner-up, whose distance says nothing of other detectors, and one that was also
//! run in a rounded arithmetic would win by being wrong. Settings have tables of their own: all
//! contenders of a scene, threads, arithmetics.
//!
//! It is decided if every other detector is slower by [`Noise::slower`]. Comparing only with the
//! runner-up is not enough: a noisy third may be as fast. Ratios within blocks give the order, and
//! medians over all blocks only where they have no block in common.

use std::collections::{BTreeMap, BTreeSet};

use crate::cells::series::Line;
use crate::cells::{Cell, series};
use crate::findings::every::{Scene, every};
use crate::findings::noise::Noise;
use crate::record::row::Outcome;
use crate::stats::interval::{Interval, median};
use contactbench_terms::arithmetic::Arithmetic;

/// The contests of an experiment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Winners {
    /// All scenes, also those in which no detector has a time.
    pub scenes: usize,
    /// The scenes in which some detector has a time.
    pub contests: Vec<Contest>,
}

/// The detectors of one scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Contest {
    /// `packed, 3D, N = 1000`.
    pub title: String,
    /// Is it among the scenes that an answer shows?
    pub shown: bool,
    /// The fastest, with ratio 1.
    pub first: Contender,
    /// The others, the next first.
    pub others: Vec<Contender>,
    /// Detectors that take no part, and why: wrong, refused, too slow.
    pub without: Vec<(String, Outcome)>,
}

/// A detector in its plainest setting.
#[derive(Clone, Debug, PartialEq)]
pub struct Contender {
    /// Detector, arithmetic and threads.
    pub line: Line,
    /// The same as it is called among the others.
    pub name: String,
    /// Nanoseconds per particle.
    pub per_particle: f64,
    /// Its time over that of the fastest; none of the fastest, and without a common block.
    pub ratio: Option<Interval>,
    /// Is it slower than the fastest by more than the noise?
    pub slower: bool,
}

/// How often each is the fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Tally {
    /// All scenes.
    pub scenes: usize,
    /// Scenes in which no detector is faster than all others, or only one was timed.
    pub undecided: usize,
    /// Scenes in which no detector has a time.
    pub untimed: usize,
    /// Most wins first.
    pub wins: Vec<Wins>,
    /// The only one that was timed, if there was one only.
    pub alone: Option<Alone>,
}

/// The only detector with a time.
#[derive(Clone, Debug, PartialEq)]
pub struct Alone {
    /// Its name.
    pub name: String,
    /// The other detectors, and the outcome of each.
    pub others: BTreeMap<String, Outcome>,
}

/// The scenes in which a detector is decidedly the fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Wins {
    /// The detector.
    pub detector: String,
    /// The time of the next over its own, by scene.
    pub margins: Vec<f64>,
}

/// The contests of all scenes.
pub fn winners(cells: &[&Cell]) -> Winners {
    let noise = Noise::new(cells);
    let scenes = every(cells);
    let taking_part: Vec<&Cell> =
        scenes.iter().flat_map(|scene| plainest(&able(&scene.cells), detector)).collect();
    let name = |cell: &Cell| series::label(&Line::new(cell), &taking_part);
    let contests = scenes.iter().filter_map(|scene| contest(scene, &noise, detector, name));
    Winners { scenes: scenes.len(), contests: contests.collect() }
}

/// The winner among the cells of one scene, N and seed, if it is decided.
pub fn winner<'a>(cells: &[&'a Cell], noise: &Noise) -> Option<&'a Cell> {
    let order = plainest(&able(cells), detector);
    let (&first, others) = order.split_first()?;
    let slower = |cell: &&Cell| noise.slower(cell.ratio(first).as_ref(), first.id.n);
    (!others.is_empty() && others.iter().all(slower)).then_some(first)
}

/// Whose settings a cell is one of, where detectors are compared.
fn detector(cell: &Cell) -> String {
    cell.id.detector.clone()
}

fn is_able(cell: &Cell) -> bool {
    // A list that misses contacts is not the fastest way to find them.
    !cell.role.is_control() && cell.time().is_some() && !cell.misses_by_rule()
}

fn able<'a>(cells: &[&'a Cell]) -> Vec<&'a Cell> {
    cells.iter().filter(|cell| is_able(cell)).copied().collect()
}

/// Median nanoseconds.
pub fn time(cell: &Cell) -> f64 {
    cell.time().map_or(f64::INFINITY, |time| time.median)
}

/// Each contender in its plainest setting, the fastest first; `who` says whose setting a cell is.
fn plainest<'a>(cells: &[&'a Cell], who: impl Fn(&Cell) -> String) -> Vec<&'a Cell> {
    let setting = |cell: &Cell| (cell.id.threads(), cell.id.arithmetic != Arithmetic::Exact.name());
    let mut best: BTreeMap<String, &Cell> = BTreeMap::new();
    for &cell in cells {
        let known = best.entry(who(cell)).or_insert(cell);
        if setting(cell).cmp(&setting(known)).then(time(cell).total_cmp(&time(known))).is_lt() {
            *known = cell;
        }
    }
    by_ratio(best.into_values().collect())
}

/// The fastest first, the others by their ratio to it. The fastest is the one that no other is
/// faster than within blocks; where ratios go round in a circle, any of that circle.
pub fn by_ratio(mut cells: Vec<&Cell>) -> Vec<&Cell> {
    cells.sort_by(|a, b| time(a).total_cmp(&time(b)));
    let median = |cell: &Cell, to: &Cell| cell.ratio(to).map(|ratio| ratio.median);
    let Some(mut first) = cells.first().copied() else { return cells };
    for _ in 0..cells.len() {
        let ratios = cells.iter().filter_map(|cell| Some((*cell, median(cell, first)?)));
        match ratios.min_by(|a, b| a.1.total_cmp(&b.1)) {
            Some((cell, ratio)) if ratio < 1.0 => first = cell,
            _ => break,
        }
    }
    let place = |cell: &Cell| match cell.id == first.id {
        true => 0.0,
        false => median(cell, first).unwrap_or(f64::INFINITY),
    };
    cells.sort_by(|a, b| place(a).total_cmp(&place(b)));
    cells
}

/// The contest of one scene, of one N and seed; none if nobody was timed. `who` says whose setting
/// a cell is, and `name` what it is called.
pub fn contest(
    scene: &Scene<'_>,
    noise: &Noise,
    who: impl Fn(&Cell) -> String,
    name: impl Fn(&Cell) -> String,
) -> Option<Contest> {
    let order = plainest(&able(&scene.cells), &who);
    let (first, others) = order.split_first()?;
    let taking_part: BTreeSet<String> = order.iter().map(|cell| who(cell)).collect();
    let mut without: BTreeMap<String, Outcome> = BTreeMap::new();
    for cell in scene.cells.iter().filter(|cell| !cell.role.is_control()) {
        let (name, outcome) = (who(cell), cell.overall().0);
        if !taking_part.contains(&name) {
            let known = without.entry(name).or_insert(outcome);
            *known = worse(*known, outcome);
        }
    }
    let contender = |cell: &Cell, ratio: Option<Interval>| {
        let (line, name) = (Line::new(cell), name(cell));
        let slower = noise.slower(ratio.as_ref(), scene.n);
        Contender { line, name, per_particle: time(cell) / scene.n.max(1) as f64, ratio, slower }
    };
    let others = others.iter().map(|cell| contender(cell, cell.ratio(first))).collect();
    let (title, shown) = (scene.title.clone(), scene.shown);
    let without = without.into_iter().collect();
    Some(Contest { title, shown, first: contender(first, None), others, without })
}

/// The outcome that matters more of two: a wrong answer before all others.
fn worse(a: Outcome, b: Outcome) -> Outcome {
    std::cmp::max_by_key(a, b, |outcome| (*outcome == Outcome::Wrong, *outcome))
}

impl Contest {
    /// Is the fastest faster than all others by more than the noise?
    pub fn decided(&self) -> bool {
        !self.others.is_empty() && self.others.iter().all(|other| other.slower)
    }
}

impl Tally {
    /// Counts the scenes.
    pub fn new(winners: &Winners) -> Tally {
        let contests = &winners.contests;
        let mut wins: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        for contest in contests.iter().filter(|contest| contest.decided()) {
            let next = contest.others.first().and_then(|next| next.ratio);
            wins.entry(&contest.first.line.detector)
                .or_default()
                .extend(next.map(|ratio| ratio.median));
        }
        let wins =
            wins.into_iter().map(|(detector, margins)| Wins { detector: detector.into(), margins });
        let mut wins: Vec<Wins> = wins.collect();
        wins.sort_by_key(|wins| std::cmp::Reverse(wins.margins.len()));
        Tally {
            scenes: winners.scenes,
            undecided: contests.iter().filter(|contest| !contest.decided()).count(),
            untimed: winners.scenes - contests.len(),
            wins,
            alone: Alone::new(contests),
        }
    }
}

impl Alone {
    fn new(contests: &[Contest]) -> Option<Alone> {
        let names: BTreeSet<&str> =
            contests.iter().map(|contest| contest.first.line.detector.as_str()).collect();
        let name = names.first().filter(|_| names.len() == 1)?.to_string();
        let mut others: BTreeMap<String, Outcome> = BTreeMap::new();
        for (name, outcome) in contests.iter().flat_map(|contest| contest.without.iter().cloned()) {
            let known = others.entry(name).or_insert(outcome);
            *known = worse(*known, outcome);
        }
        contests.iter().all(|contest| contest.others.is_empty()).then_some(Alone { name, others })
    }
}

impl Wins {
    /// Median, least and largest margin.
    pub fn margin(&self) -> Option<(f64, f64, f64)> {
        let (least, most) = self
            .margins
            .iter()
            .fold((f64::INFINITY, 0_f64), |(low, high), &ratio| (low.min(ratio), high.max(ratio)));
        Some((median(&self.margins)?, least, most))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells;
    use crate::cells::testing::Lab;

    /// Packed: nbs is 2.5 times as fast as sorting, and neither two threads nor rounded arithmetic
    /// wins. Loose: within the noise. Alone: nobody else.
    fn lab() -> Lab {
        let mut lab = Lab::new("e", "packed");
        for (n, sorting) in [(100, 50), (1000, 2500)] {
            lab.n(n).threads(1).detector("nbs").time(&[1000; 15]);
            lab.detector("sorting").time(&[sorting; 15]);
            lab.threads(2).detector("nbs").time(&[600; 15]);
            lab.threads(1).arithmetic("f64").time(&[700; 15]);
            lab.detector("library").time(&[4000; 15]).arithmetic("exact");
        }
        lab.scene("loose", 2).detector("nbs").time(&[100; 15]).detector("sorting").time(&[101; 15]);
        lab.detector("nbs-twin").time(&[95; 15]);
        lab.scene("alone", 3).detector("<b>").time(&[5; 15]);
        lab
    }

    #[test]
    fn detectors_are_compared_in_their_plainest_setting_and_noise_decides_nothing() {
        let cells = cells::cells(&lab().rows());
        let all: Vec<&Cell> = cells.iter().collect();
        let winners = winners(&all);
        let found = &winners.contests;
        let words: Vec<_> = found
            .iter()
            .map(|it| (it.title.as_str(), it.first.name.as_str(), it.others.len(), it.decided()))
            .collect();
        assert_eq!(
            words,
            [
                ("alone, 3D, N = 1000", "<b> (exact)", 0, false),
                ("loose, 2D, N = 1000", "nbs (exact)", 1, false),
                ("packed, 2D, N = 100", "sorting (exact)", 2, true),
                ("packed, 2D, N = 1000", "nbs (exact)", 2, true)
            ]
        );
        let next = &found[3].others[0];
        assert_eq!(next.name, "sorting (exact)");
        assert!((next.ratio.unwrap().median - 2.5).abs() < 1e-9 && next.per_particle == 2.5);
        let tally = Tally::new(&winners);
        assert_eq!((tally.scenes, tally.undecided, tally.alone), (4, 2, None));
        let wins: Vec<_> =
            tally.wins.iter().map(|wins| (&*wins.detector, wins.margins.len())).collect();
        assert_eq!(wins, [("nbs", 1), ("sorting", 1)]);
        let packed: Vec<&Cell> = every(&all)[3].cells.clone();
        let noise = |floor| Noise { floor, ..Noise::default() };
        let winner_at =
            |floor| winner(&packed, &noise(floor)).map(|cell| cell.id.detector.as_str());
        assert_eq!((winner_at(1.1), winner_at(2.6)), (Some("nbs"), None));
    }

    #[test]
    fn the_order_is_that_of_ratios_within_blocks() {
        // The median of sweep is the larger one; in most blocks it is the faster one.
        let mut lab = Lab::new("e", "packed");
        lab.detector("nbs").time(&[100, 100, 100, 400, 400]);
        lab.detector("sweep").time(&[110, 110, 26, 104, 104]).detector("direct").time(&[150; 5]);
        let cells = cells::cells(&lab.rows());
        let found = winners(&cells.iter().collect::<Vec<_>>());
        let contest = &found.contests[0];
        assert_eq!(contest.first.name, "sweep");
        assert!(contest.others.iter().all(|other| other.ratio.unwrap().median > 1.0));
    }

    #[test]
    fn wrong_detectors_are_named_beside_the_only_right_one() {
        let mut lab = Lab::new("e", "packed");
        lab.detector("nbs").time(&[100; 15]).detector("mine").time(&[50; 15]);
        lab.edit(|row| row.outcome = Outcome::Wrong);
        let cells = cells::cells(&lab.rows());
        let tally = Tally::new(&winners(&cells.iter().collect::<Vec<_>>()));
        let alone = tally.alone.unwrap();
        let others = BTreeMap::from([("mine".to_string(), Outcome::Wrong)]);
        assert_eq!((&*alone.name, alone.others), ("nbs", others));
    }

    #[test]
    fn few_blocks_and_intervals_that_hold_1_decide_nothing() {
        for (times, decided) in [
            (&[300_u64; 5][..], true),
            (&[300; 4], false),
            (&[90, 300, 300, 300, 300, 300, 300, 300, 300], true),
            (&[90, 90, 300, 300, 300, 300, 300, 300, 300], false),
        ] {
            let mut lab = Lab::new("e", "packed");
            lab.detector("nbs").time(&vec![100; times.len()]).detector("sorting").time(times);
            let cells = cells::cells(&lab.rows());
            let found = winners(&cells.iter().collect::<Vec<_>>()).contests;
            assert_eq!(found[0].decided(), decided, "{times:?}");
        }
    }

    #[test]
    fn a_noisy_third_leaves_the_fastest_open() {
        let mut lab = Lab::new("e", "packed");
        lab.detector("nbs").time(&[100; 15]).detector("sorting").time(&[120; 15]);
        // Half the blocks below the fastest, half far above: its median is the largest.
        let noisy: Vec<u64> = (0..15).map(|k| if k % 2 == 0 { 300 } else { 90 }).collect();
        lab.detector("sweep").time(&noisy);
        let cells = cells::cells(&lab.rows());
        let all: Vec<&Cell> = cells.iter().collect();
        let found = winners(&all);
        let [contest] = &*found.contests else { panic!() };
        let slower: Vec<_> = contest.others.iter().map(|it| (&*it.name, it.slower)).collect();
        assert_eq!(slower, [("sorting", true), ("sweep", false)]);
        assert!(!contest.decided() && winner(&all, &Noise::new(&all)).is_none());
        assert_eq!(Tally::new(&found).undecided, 1);
    }
}
