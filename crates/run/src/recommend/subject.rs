//! Subjects of a race: their times so far, and the rules by which slow subjects drop out.

use contactbench_detectors::table::Entry;
use contactbench_record::record::row::Row;
use contactbench_record::stats::interval::{Blocks, Interval, median, ratio};

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
    pub(super) racing: bool,
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
            racing: true,
            start,
        }
    }

    pub(super) fn twin(&self) -> RacedSubject {
        let start = self.start.clone();
        RacedSubject { is_twin: true, ..RacedSubject::new(self.entry, self.threads, start) }
    }

    pub(super) fn fail(&mut self, Failure { outcome, reason }: Failure) {
        (self.row.outcome, self.row.reason, self.racing) = (outcome, reason, false);
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
}

pub fn fastest(subjects: &[RacedSubject]) -> Option<usize> {
    let timed = subjects.iter().enumerate().filter(|(_, subject)| subject.is_timed());
    timed.min_by(|a, b| a.1.typical().total_cmp(&b.1.typical())).map(|(k, _)| k)
}

pub(super) struct Rule {
    pub limit: f64,
    /// Returns the time of the first subject as a multiple of that of the second, the fastest.
    over: fn(&RacedSubject, &RacedSubject) -> Option<f64>,
    /// Text for the reason, which states where the subject was slower; its few times are dropped.
    /// If `None`, the times are kept.
    place: Option<&'static str>,
}

/// Compares the probes. The limit is larger than what a single disturbed sample can cause.
pub(super) const HOPELESS: Rule = Rule {
    limit: 12.0,
    over: |one, best| Some(one.probe_ns? as f64 / best.probe_ns?.max(1) as f64),
    place: Some("a first probe"),
};
/// Compares the times in each block so far, and takes the smallest ratio.
pub(super) const FAR: Rule = Rule {
    limit: 3.0,
    over: |one, best| {
        let over =
            |(block, own): (_, &u64)| Some(*own as f64 / (*best.times.get(block)?).max(1) as f64);
        one.times.iter().filter_map(over).reduce(f64::min)
    },
    place: Some("each of the first blocks"),
};
/// Drops a subject if the whole interval of its ratio to the fastest exceeds the limit.
pub(super) const BEHIND: Rule =
    Rule { limit: 1.5, over: |one, best| Some(ratio(&one.times, &best.times)?.low), place: None };

impl Rule {
    pub fn apply(&self, subjects: &mut [RacedSubject]) {
        let mut racing: Vec<usize> =
            (0..subjects.len()).filter(|&k| subjects[k].racing && !subjects[k].is_twin).collect();
        racing.sort_by(|&a, &b| subjects[a].typical().total_cmp(&subjects[b].typical()));
        let Some((best, others)) = racing.split_first() else { return };
        for &k in others.iter().skip(1) {
            let Some(times) = (self.over)(&subjects[k], &subjects[*best]) else { continue };
            if times <= self.limit {
                continue;
            }
            let out = &mut subjects[k];
            out.racing = false;
            if let Some(place) = self.place {
                out.row.reason =
                    format!("about {times:.0} times as slow as the fastest in {place}");
                out.times.clear();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contactbench_detectors::table::TABLE;

    #[test]
    fn one_look_that_was_disturbed_ends_nobody_and_two_remain() {
        let start = Start::of(&[], std::time::Duration::ZERO, 0);
        let subject = |(k, (probe, blocks)): (usize, &(u64, &[u64]))| RacedSubject {
            probe_ns: Some(*probe),
            times: (1u32..).zip(*blocks).map(|(block, &time)| (block.into(), time)).collect(),
            ..RacedSubject::new(&TABLE[k], 1, start.clone())
        };
        let race = |times: &[(u64, &[u64])]| -> Vec<RacedSubject> {
            times.iter().enumerate().map(subject).collect()
        };
        let racing = |all: &[RacedSubject]| all.iter().map(|one| one.racing).collect::<Vec<_>>();
        let mut all = race(&[(10, &[8, 8]), (50, &[11, 40]), (11, &[40, 32]), (121, &[])]);
        HOPELESS.apply(&mut all);
        assert_eq!(racing(&all), [true, true, true, false]);
        assert_eq!(all[3].row.reason, "about 12 times as slow as the fastest in a first probe");
        FAR.apply(&mut all);
        assert_eq!(racing(&all), [true, true, false, false]);
        assert!(all[2].row.reason.starts_with("about 4 times "));
        assert!(all[2].times.is_empty());
        assert!(all[1].row.reason.is_empty() && all[1].times.len() == 2);
        let mut slow = race(&[(10, &[10, 10]), (900, &[900, 900]), (990, &[990, 990])]);
        HOPELESS.apply(&mut slow);
        FAR.apply(&mut slow);
        assert_eq!(racing(&slow), [true, true, false]);
    }
}
