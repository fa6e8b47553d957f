//! Subjects of a race: their times so far, and the rule by which slow subjects drop out.

use contactbench_detectors::table::Entry;
use contactbench_record::record::row::Row;
use contactbench_record::stats::interval::{Blocks, Interval, median};

use crate::run::runner::client::{Failure, Start};

#[derive(Clone)]
pub struct RacedSubject {
    pub entry: &'static Entry,
    pub threads: usize,
    pub is_twin: bool,
    /// The outcome, `ok` or `lossy` if the subject finished or was only slow; the reason why it
    /// dropped out, empty if it was measured to the end; errors; and memory.
    pub row: Row,
    pub probe_ns: Option<u64>,
    pub times: Blocks,
    pub(super) active: bool,
    pub(super) start: Start,
}

impl RacedSubject {
    pub(super) fn new(entry: &'static Entry, threads: usize, start: Start) -> RacedSubject {
        RacedSubject {
            entry,
            threads,
            is_twin: false,
            row: Row::default(),
            probe_ns: None,
            times: Blocks::new(),
            active: true,
            start,
        }
    }

    pub(super) fn twin(&self) -> RacedSubject {
        let start = self.start.clone();
        RacedSubject { is_twin: true, ..RacedSubject::new(self.entry, self.threads, start) }
    }

    pub(super) fn fail(&mut self, Failure { outcome, reason }: Failure) {
        (self.row.outcome, self.row.reason, self.active) = (outcome, reason, false);
        self.times.clear();
    }

    pub fn is_timed(&self) -> bool {
        self.row.outcome.is_good() && !self.times.is_empty()
    }

    /// Returns the median of the times in nanoseconds or, without times, the time of the probe.
    fn typical(&self) -> f64 {
        let times: Vec<f64> = self.times.values().map(|&time| time as f64).collect();
        median(&times).or(self.probe_ns.map(|probe| probe as f64)).unwrap_or(f64::INFINITY)
    }
}

pub struct Race {
    pub subjects: Vec<RacedSubject>,
    pub contacts: u64,
    pub blocks: u32,
    /// Ratio of the twin's time to its original's, which shows the noise of equal code. `None` with
    /// fewer than two blocks.
    pub twin: Option<Interval>,
    /// Share of a core that other processes and the host took, if it may have changed the times.
    pub disturbed: Option<f64>,
}

pub fn fastest(subjects: &[RacedSubject]) -> Option<usize> {
    let timed = subjects.iter().enumerate().filter(|(_, subject)| subject.is_timed());
    timed.min_by(|a, b| a.1.typical().total_cmp(&b.1.typical())).map(|(k, _)| k)
}

/// Ratio above which one look, which may be disturbed, shows that a subject is slow.
pub(super) const HOPELESS: f64 = 12.0;
/// Ratio above which several looks show this, if all of them exceed it.
const FAR: f64 = 3.0;

/// Drops subjects that are much slower than the fastest in the probe and in each block so far. Two
/// subjects always remain, so that their ratio is measured.
pub(super) fn drop_slow(subjects: &mut [RacedSubject]) {
    let mut active: Vec<usize> =
        (0..subjects.len()).filter(|&k| subjects[k].active && !subjects[k].is_twin).collect();
    active.sort_by(|&a, &b| subjects[a].typical().total_cmp(&subjects[b].typical()));
    let Some((&best, others)) = active.split_first() else { return };
    for &k in others.iter().skip(1) {
        let (one, best) = (&subjects[k], &subjects[best]);
        let blocks = one.times.iter().filter_map(|(k, &own)| Some((own, *best.times.get(k)?)));
        let looks = one.probe_ns.zip(best.probe_ns).into_iter().chain(blocks);
        let looks: Vec<f64> = looks.map(|(own, best)| own as f64 / best.max(1) as f64).collect();
        let limit = if looks.len() > 1 { FAR } else { HOPELESS };
        let least = looks.into_iter().reduce(f64::min);
        let Some(least) = least.filter(|&least| least > limit) else { continue };
        let out = &mut subjects[k];
        out.active = false;
        out.row.reason = format!("about {least:.0} times as slow as the fastest");
        out.times.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contactbench_detectors::table::TABLE;

    #[test]
    fn one_disturbed_look_drops_no_subject_and_two_remain() {
        let start = Start::of(&[], std::time::Duration::ZERO, 0);
        let subject = |(k, (probe, blocks)): (usize, &(u64, &[u64]))| RacedSubject {
            probe_ns: Some(*probe),
            times: (1u32..).zip(*blocks).map(|(block, &time)| (block.into(), time)).collect(),
            ..RacedSubject::new(&TABLE[k], 1, start.clone())
        };
        let dropped = |times: &[(u64, &[u64])]| -> Vec<RacedSubject> {
            let mut all = times.iter().enumerate().map(subject).collect::<Vec<_>>();
            drop_slow(&mut all);
            all
        };
        let active = |all: &[RacedSubject]| all.iter().map(|one| one.active).collect::<Vec<_>>();
        let all = dropped(&[(10, &[]), (50, &[]), (11, &[]), (121, &[])]);
        assert_eq!(active(&all), [true, true, true, false]);
        assert_eq!(all[3].row.reason, "about 12 times as slow as the fastest");
        let all = dropped(&[(10, &[8, 8]), (50, &[11, 40]), (50, &[40, 32]), (11, &[90, 90])]);
        assert_eq!(active(&all), [true, true, false, true]);
        assert!(all[2].row.reason.starts_with("about 4 times ") && all[2].times.is_empty());
        let slow = dropped(&[(10, &[10, 10]), (900, &[900, 900]), (990, &[990, 990])]);
        assert_eq!(active(&slow), [true, true, false]);
    }
}
