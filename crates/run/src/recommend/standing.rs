//! Who takes part in a race, and where each stands.

use std::collections::BTreeMap;

use crate::run::client::{Failure, Start};
use contactbench_core::detect::table::Entry;
use contactbench_core::oracle::Errors;
use contactbench_record::record::row::Outcome;
use contactbench_record::stats::interval::{Blocks, Interval, median, ratio};

/// Who takes so many times the time of the fastest in a probe is out: far more than one look may be
/// disturbed.
pub const HOPELESS: f64 = 12.0;
/// Who takes so many times the time of the fastest in each of the first blocks is out.
pub const FAR: f64 = 3.0;
/// Who is so many times slower after some blocks, with the whole interval, is out.
pub const BEHIND: f64 = 1.5;

/// A detector.
#[derive(Clone, Copy, Debug)]
pub struct Contender {
    /// Its name in the table.
    pub name: &'static str,
    /// Of this crate: a wrong answer is a defect.
    pub is_ours: bool,
    /// Threads given to it.
    pub threads: usize,
}

impl Contender {
    /// A detector of the table, with these threads if it can use several.
    pub fn of(entry: &'static Entry, threads: usize) -> Contender {
        let threads = if entry.threads { threads } else { 1 };
        Contender { name: entry.name, is_ours: entry.is_ours(), threads }
    }
}

/// Where a contender stands in the race.
pub struct Standing {
    /// Who.
    pub who: Contender,
    /// `ok`, or `lossy` with textbook filters: it has finished, or was only slow. All else: why
    /// not.
    pub outcome: Outcome,
    /// Why it is out; empty for those that were measured to the end.
    pub reason: String,
    /// Nanoseconds of the probe.
    pub probe_ns: Option<u64>,
    /// How many times slower than the fastest it was when it was left behind early.
    pub behind: Option<f64>,
    /// Nanoseconds by block.
    pub times: Blocks,
    /// Most bytes held at one time, without scene and pairs.
    pub peak_bytes: Option<u64>,
    /// Bytes by its formula.
    pub formula_bytes: Option<u64>,
    /// Against exact decisions on the scene as given.
    pub errors: Option<Errors>,
    /// Is it in the race?
    pub(super) racing: bool,
    /// How its processes are started.
    pub(super) start: Start,
}

impl Standing {
    /// At the beginning.
    pub(super) fn new(who: Contender, start: Start) -> Standing {
        Standing {
            who,
            outcome: Outcome::Ok,
            reason: String::new(),
            probe_ns: None,
            behind: None,
            times: Blocks::new(),
            peak_bytes: None,
            formula_bytes: None,
            errors: None,
            racing: true,
            start,
        }
    }

    /// It is out of the race.
    pub(super) fn fail(&mut self, failure: Failure) {
        self.outcome = failure.outcome;
        self.reason = failure.reason;
        self.racing = false;
        self.times = BTreeMap::new();
    }

    /// The median of the times, or the probe; in nanoseconds.
    pub(super) fn typical(&self) -> f64 {
        let times: Vec<f64> = self.times.values().map(|&time| time as f64).collect();
        median(&times).or(self.probe_ns.map(|probe| probe as f64)).unwrap_or(f64::INFINITY)
    }
}

/// The outcome of the race.
pub struct Race {
    /// All who were asked.
    pub standings: Vec<Standing>,
    /// True pairs in the arithmetic.
    pub contacts: u64,
    /// Blocks run.
    pub blocks: u32,
    /// The time of one of them over its own, measured again in every block: what equal code differs
    /// by. None with less than two blocks.
    pub twin: Option<Interval>,
}

/// The one with the smallest median.
pub fn fastest(standings: &[Standing]) -> Option<usize> {
    let timed = standings
        .iter()
        .enumerate()
        .filter(|(_, standing)| standing.outcome.is_good() && !standing.times.is_empty());
    timed.min_by(|a, b| a.1.typical().total_cmp(&b.1.typical())).map(|(k, _)| k)
}

/// Ends those who are hopelessly behind the fastest in the probe.
pub(super) fn drop_hopeless(standings: &mut [Standing]) {
    let over = |standing: &Standing, best: &Standing| {
        Some(standing.probe_ns? as f64 / best.probe_ns?.max(1) as f64)
    };
    leave(standings, HOPELESS, "a first probe", over);
}

/// Ends those who are far behind the fastest in every block so far. So few of their times say
/// nothing more.
pub(super) fn drop_far(standings: &mut [Standing]) {
    leave(standings, FAR, "each of the first blocks", |standing, best| {
        let over =
            |(block, own): (_, &u64)| Some(*own as f64 / (*best.times.get(block)?).max(1) as f64);
        standing.times.iter().filter_map(over).reduce(f64::min)
    });
}

/// As [`drop_over`], and says why.
fn leave(
    standings: &mut [Standing],
    limit: f64,
    place: &str,
    over: impl Fn(&Standing, &Standing) -> Option<f64>,
) {
    for (k, times) in drop_over(standings, limit, over) {
        let standing = &mut standings[k];
        standing.behind = Some(times);
        standing.reason = format!("some {times:.0} times slower than the fastest in {place}");
        standing.times.clear();
    }
}

/// Ends those who are behind the fastest in the blocks; what was measured of them is kept.
pub(super) fn drop_behind(standings: &mut [Standing]) {
    drop_over(standings, BEHIND, |standing, best| Some(ratio(&standing.times, &best.times)?.low));
}

/// Ends those who take over `limit` times as long as the fastest, and returns who and how many
/// times; but two stay, so that there is a margin to be told.
fn drop_over(
    standings: &mut [Standing],
    limit: f64,
    over: impl Fn(&Standing, &Standing) -> Option<f64>,
) -> Vec<(usize, f64)> {
    let mut racing: Vec<usize> = (0..standings.len()).filter(|&k| standings[k].racing).collect();
    racing.sort_by(|&a, &b| standings[a].typical().total_cmp(&standings[b].typical()));
    let Some(&best) = racing.first() else { return Vec::new() };
    let behind = racing
        .into_iter()
        .skip(2)
        .filter_map(|k| Some((k, over(&standings[k], &standings[best])?)));
    let out: Vec<(usize, f64)> = behind.filter(|(_, times)| *times > limit).collect();
    out.iter().for_each(|&(k, _)| standings[k].racing = false);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn race(times: &[(u64, &[u64])]) -> Vec<Standing> {
        let standing = |(k, (probe, blocks)): (usize, &(u64, &[u64]))| {
            let who = Contender { name: ["a", "b", "c", "d"][k], is_ours: true, threads: 1 };
            let start = Start {
                command: Vec::new(),
                install: String::new(),
                time_limit: std::time::Duration::ZERO,
                memory_limit: 0,
                processor: None,
            };
            let mut standing = Standing::new(who, start);
            standing.probe_ns = Some(*probe);
            let blocks = (1u32..).zip(*blocks);
            standing.times = blocks.map(|(block, &time)| (block.into(), time)).collect();
            standing
        };
        times.iter().enumerate().map(standing).collect()
    }

    fn racing(standings: &[Standing]) -> Vec<bool> {
        standings.iter().map(|standing| standing.racing).collect()
    }

    #[test]
    fn one_look_that_was_disturbed_ends_nobody() {
        let mut standings = race(&[(10, &[8, 8]), (50, &[11, 40]), (11, &[40, 32]), (121, &[])]);
        drop_hopeless(&mut standings);
        assert_eq!(racing(&standings), [true, true, true, false]);
        assert_eq!(standings[3].reason, "some 12 times slower than the fastest in a first probe");
        drop_far(&mut standings);
        assert_eq!(racing(&standings), [true, true, false, false]);
        assert_eq!((standings[2].behind, standings[2].times.len()), (Some(4.0), 0));
        assert!(standings[2].reason.starts_with("some 4 times slower than the fastest in each of"));
        assert!(standings[1].reason.is_empty() && standings[1].times.len() == 2);
    }

    #[test]
    fn two_remain_however_slow() {
        let mut standings = race(&[(10, &[10, 10]), (900, &[900, 900]), (990, &[990, 990])]);
        drop_hopeless(&mut standings);
        drop_far(&mut standings);
        assert_eq!(racing(&standings), [true, true, false]);
    }
}
