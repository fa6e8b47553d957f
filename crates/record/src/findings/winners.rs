//! The fastest detector of each scene, its lead, and whether it is decided. Reports, pages and
//! tables all print this result.
//!
//! In each scene, every detector takes part once, in its plainest setting: the fewest threads, and
//! exact arithmetic if available. Otherwise a detector with two threads could be followed by itself
//! with one thread, and rounded arithmetic could win with a wrong answer. Other settings have
//! tables of their own.
//!
//! If a detector has several forms (`streamed-nbs` and `streamed-nbs:level=avx2`), the default one
//! takes part unless another form is decidedly faster.
//!
//! The result is decided if every other detector is slower by [`Noise::slower`]. Comparing only
//! with the runner-up is not enough, because a noisy third may be as fast. Ratios within blocks
//! give the order; medians over all blocks are used only without common blocks.

use std::cmp::{Ordering, max_by_key};
use std::collections::{BTreeMap, BTreeSet};

use crate::cells::series::Line;
use crate::cells::{Cell, series};
use crate::findings::claim::every::{Scene, every};
use crate::findings::trust::noise::Noise;
use crate::record::row::Outcome;
use crate::stats::interval::Interval;
use contactbench_terms::arithmetic::Arithmetic;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Winners {
    pub scenes: usize,
    pub contests: Vec<Contest>,
    /// Whether the machine was disturbed; then nothing is decided.
    pub disturbed: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Contest {
    pub title: String,
    pub shown: bool,
    pub first: RankedSubject,
    pub others: Vec<RankedSubject>,
    pub without: Vec<(String, Outcome)>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct RankedSubject {
    pub line: Line,
    pub name: String,
    /// Median time in nanoseconds per particle.
    pub per_particle: f64,
    /// Median time in nanoseconds per contact; `None` without contacts.
    pub per_pair: Option<f64>,
    /// Time over the time of the fastest; `None` for the fastest, and without a common block.
    pub ratio: Option<Interval>,
    pub cold: Option<Interval>,
    /// Whether this subject is slower than the fastest by more than the noise.
    pub slower: bool,
}

pub fn winners(cells: &[&Cell]) -> Winners {
    let noise = Noise::new(cells);
    let scenes = every(cells);
    let taking_part: Vec<&Cell> =
        scenes.iter().flat_map(|scene| plainest(&able(&scene.cells), &noise)).collect();
    let label = series::labels(&taking_part);
    let contests = scenes.iter().filter_map(|scene| contest(scene, &noise, label));
    Winners { scenes: scenes.len(), contests: contests.collect(), disturbed: false }
}

fn able<'a>(cells: &[&'a Cell]) -> Vec<&'a Cell> {
    let mut able = cells.to_vec();
    // A tracker that misses contacts does not count as fast.
    able.retain(|it| !it.role.is_control() && it.time().is_some() && !it.misses_by_rule());
    able
}

pub fn time(cell: &Cell) -> f64 {
    cell.time().map_or(f64::INFINITY, |time| time.median)
}

fn plainest<'a>(cells: &[&'a Cell], noise: &Noise) -> Vec<&'a Cell> {
    let setting = |cell: &Cell| (cell.id.threads(), cell.id.arithmetic != Arithmetic::Exact.name());
    let mut forms: BTreeMap<&str, Vec<&Cell>> = BTreeMap::new();
    for &cell in cells {
        let known = forms.entry(&cell.id.detector).or_default();
        match known.first().map(|first| setting(cell).cmp(&setting(first))) {
            Some(Ordering::Greater) => {}
            Some(Ordering::Less) => *known = vec![cell],
            Some(Ordering::Equal) | None => known.push(cell),
        }
    }
    by_ratio(forms.into_values().filter_map(|forms| representative(forms, noise)).collect())
}

/// Chooses the form that represents a detector: the default one, unless another is decidedly
/// faster; without a default form (as for trackers), the fastest.
fn representative<'a>(forms: Vec<&'a Cell>, noise: &Noise) -> Option<&'a Cell> {
    let default = forms.iter().copied().find(|cell| cell.id.detector_params.is_empty());
    let ahead =
        |cell: &&Cell| default.is_none_or(|it| noise.slower(it.ratio(cell).as_ref(), cell.id.n));
    let ahead: Vec<&Cell> = forms.into_iter().filter(ahead).collect();
    by_ratio(ahead).first().copied().or(default)
}

/// Sorts by the ratio to the fastest, which is first. The fastest is the one that no other beats
/// within blocks; if ratios form a cycle, it is the one that others beat least.
pub fn by_ratio(mut cells: Vec<&Cell>) -> Vec<&Cell> {
    cells.sort_by(|a, b| time(a).total_cmp(&time(b)));
    let ratio = |cell: &Cell, to: &Cell| cell.ratio(to).map(|ratio| ratio.median);
    let beaten = |cell: &Cell| {
        let by = |other: &&Cell| ratio(other, cell).unwrap_or_else(|| time(other) / time(cell));
        cells.iter().map(by).fold(1.0, f64::min)
    };
    let scores: Vec<f64> = cells.iter().map(|cell| beaten(cell)).collect();
    let best = scores.iter().copied().fold(0.0, f64::max);
    let Some(first) = scores.iter().position(|&score| score == best) else { return cells };
    let first = cells[first];
    let place = |cell: &Cell| match cell.id == first.id {
        true => 0.0,
        false => ratio(cell, first).unwrap_or(f64::INFINITY),
    };
    cells.sort_by(|a, b| place(a).total_cmp(&place(b)));
    cells
}

/// The contest of one scene; `None` if no cell has a time.
fn contest(scene: &Scene<'_>, noise: &Noise, label: impl Fn(&Line) -> String) -> Option<Contest> {
    let order = plainest(&able(&scene.cells), noise);
    let (first, others) = order.split_first()?;
    let taking_part: BTreeSet<&str> = order.iter().map(|cell| &*cell.id.detector).collect();
    let mut without: BTreeMap<String, Outcome> = BTreeMap::new();
    for cell in scene.cells.iter().filter(|cell| !cell.role.is_control()) {
        let (name, outcome) = (&cell.id.detector, cell.overall().0);
        if !taking_part.contains(&**name) {
            // The worst outcome counts.
            let known = without.entry(name.clone()).or_insert(outcome);
            *known = max_by_key(*known, outcome, |it| (*it == Outcome::Wrong, *it));
        }
    }
    let subject = |cell: &Cell| {
        let line = Line::new(cell);
        let name = label(&line);
        let other = cell.id != first.id;
        let [ratio, cold] =
            [cell.ratio(first), cell.cold_ratio(first)].map(|it| it.filter(|_| other));
        let slower = noise.slower(ratio.as_ref(), scene.n);
        let per_particle = time(cell) / scene.n.max(1) as f64;
        let per_pair = cell.per_pair(time(cell));
        RankedSubject { line, name, per_particle, per_pair, ratio, cold, slower }
    };
    let others = others.iter().map(|cell| subject(cell)).collect();
    let (title, shown) = (scene.title.clone(), scene.shown);
    let without = without.into_iter().collect();
    Some(Contest { title, shown, first: subject(first), others, without })
}

impl Contest {
    pub fn decided(&self) -> bool {
        !self.others.is_empty() && self.others.iter().all(|other| other.slower)
    }
}

impl Winners {
    /// Withdraws all decisions, because the machine was disturbed.
    pub fn withdraw(&mut self) {
        self.disturbed = true;
        let others = self.contests.iter_mut().flat_map(|contest| &mut contest.others);
        others.for_each(|other| other.slower = false);
    }

    pub fn undecided(&self) -> usize {
        self.contests.iter().filter(|contest| !contest.decided()).count()
    }

    /// Returns the detectors that win a scene, those with the most wins first, with the time of the
    /// runner-up over their own for each scene.
    pub fn wins(&self) -> Vec<(&str, Vec<f64>)> {
        let mut wins: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        for contest in self.contests.iter().filter(|contest| contest.decided()) {
            let next = contest.others.first().and_then(|next| next.ratio);
            let margins = wins.entry(&contest.first.line.detector).or_default();
            margins.extend(next.map(|ratio| ratio.median));
        }
        let mut wins = Vec::from_iter(wins);
        wins.sort_by_key(|(_, margins)| std::cmp::Reverse(margins.len()));
        wins
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells::testing::Lab;

    fn found(lab: &Lab) -> Winners {
        lab.find(winners)
    }

    /// In `packed`, nbs is 2.5 times as fast as sorting; neither two threads nor rounded arithmetic
    /// wins. In `loose`, the difference is within the noise. In `alone`, there is only one
    /// detector.
    #[test]
    fn detectors_are_compared_in_their_plainest_setting_and_noise_decides_nothing() {
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
        let winners = found(&lab);
        let contests = winners.contests.iter();
        let words: Vec<_> = contests
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
        let next = &winners.contests[3].others[0];
        assert_eq!(next.name, "sorting (exact)");
        assert!((next.ratio.unwrap().median - 2.5).abs() < 1e-9);
        assert_eq!((next.per_particle, next.per_pair), (2.5, Some(1.0)));
        assert_eq!((winners.scenes, winners.undecided()), (4, 2));
        let wins = winners.wins().into_iter().map(|(name, margins)| (name, margins.len()));
        assert_eq!(wins.collect::<Vec<_>>(), [("nbs", 1), ("sorting", 1)]);
    }

    /// sorting beats nbs by 1.05, nbs beats sweep by 1.5, and sweep beats sorting by 1.5.
    #[test]
    fn in_a_cycle_the_fastest_is_the_one_that_others_beat_least() {
        let mut lab = Lab::new("e", "packed");
        for (name, times) in
            [("sorting", [100, 200, 300]), ("nbs", [200, 210, 100]), ("sweep", [300, 100, 200])]
        {
            lab.detector(name).time(&times.repeat(3));
        }
        let contest = found(&lab).contests.remove(0);
        assert_eq!((&*contest.first.name, contest.decided()), ("nbs", false));
        assert_eq!(contest.others[0].name, "sorting");
    }

    /// Each case has times by detector, the first detector in the order, and for each other
    /// detector whether it is decidedly slower.
    #[test]
    fn ratios_within_blocks_give_the_order_and_decide() {
        let noisy: Vec<u64> = (0..15).map(|k| if k % 2 == 0 { 300 } else { 90 }).collect();
        let slow = [300; 15];
        type Case<'a> = (&'a [(&'a str, &'a [u64])], &'a str, &'a [(&'a str, bool)]);
        let cases: [Case; 7] = [
            // Undecided: too few blocks, or an interval that contains 1.
            (&[("nbs", &[100; 4]), ("sorting", &[300; 4])], "nbs", &[("sorting", false)]),
            (
                &[("nbs", &[100; 9]), ("sorting", &[90, 90, 300, 300, 300, 300, 300, 300, 300])],
                "nbs",
                &[("sorting", false)],
            ),
            // sweep has the longer median but is faster in most blocks.
            (
                &[("nbs", &[100, 100, 100, 400, 400]), ("sweep", &[110, 110, 26, 104, 104])],
                "sweep",
                &[("nbs", false)],
            ),
            // A noisy third detector leaves the fastest undecided.
            (
                &[("nbs", &[100; 15]), ("sorting", &[120; 15]), ("sweep", &noisy)],
                "nbs",
                &[("sorting", true), ("sweep", false)],
            ),
            // The default form takes part although another has a shorter median.
            (
                &[
                    ("nbs", &[100, 100, 100, 103, 103, 103, 103]),
                    ("nbs:form=b", &[101, 101, 101, 102, 102, 102, 102]),
                    ("sorting", &slow[..7]),
                ],
                "nbs",
                &[("sorting", true)],
            ),
            // Another form takes part if it is decidedly faster.
            (
                &[("nbs", &[100; 15]), ("nbs:form=b", &[50; 15]), ("sorting", &slow)],
                "nbs:form=b",
                &[("sorting", true)],
            ),
            // Without a default form, the fastest takes part.
            (
                &[("nbs:a=1", &[100; 15]), ("nbs:a=2", &[90; 15]), ("sorting", &slow)],
                "nbs:a=2",
                &[("sorting", true)],
            ),
        ];
        for (times, first, others) in cases {
            let mut lab = Lab::new("e", "packed");
            for (detector, times) in times {
                lab.detector(detector).time(times);
            }
            let found = found(&lab);
            let [contest] = &*found.contests else { panic!("{found:?}") };
            let slower: Vec<_> = contest.others.iter().map(|it| (&*it.name, it.slower)).collect();
            assert_eq!((&*contest.first.name, &*slower), (first, others), "{times:?}");
            let decided = others.iter().all(|(_, slower)| *slower);
            assert_eq!((contest.decided(), found.undecided() == 0), (decided, decided));
        }
    }

    #[test]
    fn first_detections_are_compared_with_each_other() {
        let mut lab = Lab::new("e", "packed");
        for (detector, times) in [("nbs", [100, 200]), ("library", [700, 800])] {
            for block in 0..6 {
                lab.detector(detector).time(&[times[0]]);
                lab.edit(|row| (row.block, row.first_ns) = (block, Some(times[1])));
            }
        }
        let next = found(&lab).contests[0].others[0].clone();
        let medians = [next.ratio, next.cold].map(|ratio| ratio.unwrap().median.round());
        assert_eq!(medians, [7.0, 4.0]);
    }

    #[test]
    fn wrong_detectors_do_not_take_part() {
        let mut lab = Lab::new("e", "packed");
        lab.detector("nbs").time(&[100; 15]).detector("mine").time(&[50; 15]);
        lab.edit(|row| row.outcome = Outcome::Wrong);
        let contest = found(&lab).contests.remove(0);
        assert_eq!((&*contest.first.name, contest.others.len()), ("nbs", 0));
        assert_eq!(contest.without, [("mine".to_string(), Outcome::Wrong)]);
    }
}
