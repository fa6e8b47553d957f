//! Who is the fastest, where, by how much, and whether that is decided. There is one answer, and
//! the report, the page, the terminal and the tables for papers all print it.
//!
//! A scene speaks at its largest N. There each detector takes part once, in its plainest setting:
//! with its fewest threads, and in exact arithmetic if it can. So detectors are compared and not
//! settings: were each setting a contestant, a detector with two threads would have itself with one
//! thread as its runner-up, whose distance says nothing of other detectors, and one that was also
//! run in a rounded arithmetic would win by being wrong. Settings have tables of their own: all
//! contenders of a scene, threads, arithmetics.
//!
//! It is decided if everybody else is slower by [`Noise::slower`]. To look at the next alone would
//! not do: medians give the order, ratios within blocks decide, and a noisy third may be as fast.

use std::collections::{BTreeMap, BTreeSet};

use crate::cells::label::title;
use crate::cells::series::Line;
use crate::cells::{Cell, CellId, label, series};
use crate::contact::Arithmetic;
use crate::findings::noise::Noise;
use crate::stats::interval::{Interval, median};

/// A scene at its largest N.
#[derive(Clone, Debug, PartialEq)]
pub struct Contest {
    /// `packed, 3D, N = 1000`.
    pub title: String,
    /// The fastest, with ratio 1.
    pub first: Contender,
    /// The others, the next first.
    pub others: Vec<Contender>,
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
    /// Scenes in which nobody is faster than all others, or nobody else was timed.
    pub undecided: usize,
    /// Most wins first.
    pub wins: Vec<Wins>,
    /// The only one that was timed, if there was one only.
    pub alone: Option<String>,
}

/// The scenes in which a detector is decidedly the fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Wins {
    /// The detector.
    pub detector: String,
    /// The time of the next over its own, by scene.
    pub margins: Vec<f64>,
}

/// The contests of all scenes in which someone was timed.
pub fn contests(cells: &[&Cell]) -> Vec<Contest> {
    let able: Vec<&Cell> = cells.iter().filter(|cell| is_able(cell)).copied().collect();
    let noise = Noise::new(cells);
    let scenes = largest(&able);
    let taking_part: Vec<&Cell> =
        scenes.iter().flat_map(|scene| plainest(&scene.cells, detector)).collect();
    let name = |cell: &Cell| series::label(&Line::new(cell), &taking_part);
    scenes.iter().filter_map(|scene| contest(scene, &noise, detector, name)).collect()
}

/// The winner among the cells of one scene, N and seed, if it is decided.
pub fn winner<'a>(cells: &[&'a Cell], noise: &Noise) -> Option<&'a Cell> {
    let able: Vec<&Cell> = cells.iter().filter(|cell| is_able(cell)).copied().collect();
    let order = plainest(&able, detector);
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

/// A scene at its largest N, and among several with that N at the last parameters and the first
/// seed.
pub struct Scene<'a> {
    /// Its name.
    pub title: String,
    /// Its particles.
    pub n: u64,
    /// All cells there.
    pub cells: Vec<&'a Cell>,
}

/// The scenes of these cells.
pub fn largest<'a>(cells: &[&'a Cell]) -> Vec<Scene<'a>> {
    let mut families: BTreeMap<_, Vec<&Cell>> = BTreeMap::new();
    for &cell in cells {
        families.entry(label::family(&cell.id)).or_default().push(cell);
    }
    let place =
        |key: &CellId| (key.n, key.params.clone(), key.order.clone(), std::cmp::Reverse(key.seed));
    let scene = |cells: &Vec<&'a Cell>| {
        let last = cells.iter().map(|cell| place(&cell.id)).max()?;
        let there: Vec<&Cell> =
            cells.iter().copied().filter(|cell| place(&cell.id) == last).collect();
        let key = &there.first()?.id;
        Some(Scene { title: title(key, &label::swept(cells)), n: key.n, cells: there })
    };
    families.values().filter_map(scene).collect()
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
    let mut order: Vec<&Cell> = best.into_values().collect();
    order.sort_by(|a, b| time(a).total_cmp(&time(b)));
    order
}

/// The contest of one scene, of one N and seed; none if nobody was timed. `who` says whose setting
/// a cell is, and `name` what it is called.
pub fn contest(
    scene: &Scene<'_>,
    noise: &Noise,
    who: impl Fn(&Cell) -> String,
    name: impl Fn(&Cell) -> String,
) -> Option<Contest> {
    let able: Vec<&Cell> = scene.cells.iter().filter(|cell| is_able(cell)).copied().collect();
    let order = plainest(&able, who);
    let (first, others) = order.split_first()?;
    let contender = |cell: &Cell, ratio: Option<Interval>| {
        let (line, name) = (Line::new(cell), name(cell));
        let slower = noise.slower(ratio.as_ref(), scene.n);
        Contender { line, name, per_particle: time(cell) / scene.n.max(1) as f64, ratio, slower }
    };
    let others = others.iter().map(|cell| contender(cell, cell.ratio(first))).collect();
    Some(Contest { title: scene.title.clone(), first: contender(first, None), others })
}

impl Contest {
    /// Is the fastest faster than all others by more than the noise?
    pub fn decided(&self) -> bool {
        !self.others.is_empty() && self.others.iter().all(|other| other.slower)
    }
}

impl Tally {
    /// Of these contests.
    pub fn new(contests: &[Contest]) -> Tally {
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
        let names: BTreeSet<&str> =
            contests.iter().map(|contest| contest.first.line.detector.as_str()).collect();
        let alone = contests.iter().all(|contest| contest.others.is_empty()) && names.len() == 1;
        Tally {
            scenes: contests.len(),
            undecided: contests.iter().filter(|contest| !contest.decided()).count(),
            wins,
            alone: names.first().filter(|_| alone).map(|name| name.to_string()),
        }
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
        let found = contests(&all);
        let words: Vec<_> = found
            .iter()
            .map(|it| (it.title.as_str(), it.first.name.as_str(), it.others.len(), it.decided()))
            .collect();
        assert_eq!(
            words,
            [
                ("alone, 3D, N = 1000", "<b> (exact)", 0, false),
                ("loose, 2D, N = 1000", "nbs (exact)", 1, false),
                ("packed, 2D, N = 1000", "nbs (exact)", 2, true)
            ]
        );
        let next = &found[2].others[0];
        assert_eq!(next.name, "sorting (exact)");
        assert!((next.ratio.unwrap().median - 2.5).abs() < 1e-9 && next.per_particle == 2.5);
        let tally = Tally::new(&found);
        assert_eq!((tally.scenes, tally.undecided, tally.alone), (3, 2, None));
        let [wins] = &*tally.wins else { panic!("{:?}", tally.wins) };
        assert_eq!((&*wins.detector, wins.margins.len()), ("nbs", 1));
        let packed: Vec<&Cell> = largest(&all)[2].cells.clone();
        let noise = |floor| Noise { floor, ..Noise::default() };
        let wins = |floor| winner(&packed, &noise(floor)).map(|cell| cell.id.detector.as_str());
        assert_eq!((wins(1.1), wins(2.6)), (Some("nbs"), None));
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
            let found = contests(&cells.iter().collect::<Vec<_>>());
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
        let [contest] = &*contests(&all) else { panic!() };
        let slower: Vec<_> = contest.others.iter().map(|it| (&*it.name, it.slower)).collect();
        assert_eq!(slower, [("sorting", true), ("sweep", false)]);
        assert!(!contest.decided() && winner(&all, &Noise::new(&all)).is_none());
        assert_eq!(Tally::new(&contests(&all)).undecided, 1);
    }
}
