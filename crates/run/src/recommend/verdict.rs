//! Chooses the recommended detector: the fastest, or one with less memory that is undecided against
//! it and has a similar median.

use crate::recommend::subject::{Race, RacedSubject, fastest};
use contactbench_record::findings::trust::noise::Noise;
use contactbench_record::stats::interval::{Interval, interval, ratio};

/// Largest median of a detector chosen for its memory, as a multiple of the shortest. On a noisy
/// machine, much slower detectors may be undecided, too.
const LEANER: f64 = 1.2;

pub struct Verdict {
    pub choice: usize,
    pub next: Option<(usize, Interval)>,
    /// Other detectors that are undecided against the fastest.
    pub tied: Vec<usize>,
    pub is_fastest: bool,
    /// Factor by which times of equal code differ; `None` without a twin.
    pub floor: Option<f64>,
}

impl Verdict {
    /// Chooses a detector; returns `None` if none has a time.
    pub fn new(race: &Race) -> Option<Verdict> {
        let subjects = &race.subjects;
        let best = fastest(subjects)?;
        let against = |k: usize, base: usize| ratio(&subjects[k].times, &subjects[base].times);
        let others: Vec<usize> =
            (0..subjects.len()).filter(|&k| k != best && subjects[k].is_timed()).collect();
        let noise = Noise::of_twin(race.twin);
        let sure = |ratio: Interval| ratio.median > 1.0 && noise.decides(&ratio, 0);
        let slower = |k: &usize| against(*k, best).is_some_and(sure);
        let (behind, mut near): (Vec<usize>, Vec<usize>) = others.into_iter().partition(slower);
        near.push(best);
        let beside = |k: usize| k == best || against(k, best).is_some_and(|r| r.median <= LEANER);
        let choice = near
            .iter()
            .copied()
            .filter(|&k| beside(k))
            .min_by_key(|&k| (subjects[k].row.peak_bytes.unwrap_or(u64::MAX), k != best))?;
        let next = behind
            .into_iter()
            .filter_map(|k| Some((k, against(k, choice)?)))
            .filter(|(_, ratio)| sure(*ratio));
        let next = next.min_by(|a, b| a.1.median.total_cmp(&b.1.median));
        near.retain(|&k| k != choice);
        let floor = race.twin.map(|_| noise.floor);
        Some(Verdict { choice, next, tied: near, is_fastest: choice == best, floor })
    }
}

pub fn per_particle(subject: &RacedSubject, n: usize) -> Option<Interval> {
    let times: Vec<f64> =
        subject.times.values().map(|&time| time as f64 / n.max(1) as f64).collect();
    interval(&times)
}

pub fn bytes_per_particle(subject: &RacedSubject, n: usize) -> Option<f64> {
    subject.row.peak_bytes.map(|bytes| bytes as f64 / n.max(1) as f64)
}
