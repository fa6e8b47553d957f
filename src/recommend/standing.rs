//! Who takes part in a race, and where each stands.

use std::collections::BTreeMap;

use crate::detect::table::Entry;
use crate::moving::Builds;
use crate::oracle::Errors;
use crate::record::row::Outcome;
use crate::run::client::{Failure, Start};
use crate::stats::interval::{Blocks, Interval, median, ratio};

/// Who takes so many times the time of the fastest in a probe is out.
pub const FAR: f64 = 3.0;
/// Who is so many times slower after some blocks, with the whole interval, is out.
pub const BEHIND: f64 = 1.5;

/// A detector, or a tracker.
#[derive(Clone, Debug)]
pub struct Contender {
    /// Its text on the command line.
    pub name: String,
    /// Of this crate: a wrong answer is a defect.
    pub is_ours: bool,
    /// Threads given to it.
    pub threads: usize,
    /// It is measured to the end however slow it is: others are compared with it.
    pub stays: bool,
}

impl Contender {
    /// A detector of the table, with these threads if it can use several.
    pub fn of(entry: &Entry, threads: usize) -> Contender {
        let threads = if entry.threads { threads } else { 1 };
        Contender { name: entry.name.into(), is_ours: entry.is_ours(), threads, stays: false }
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
    /// Nanoseconds by block; of several frames those of one, in the mean.
    pub times: Blocks,
    /// Most bytes held at one time, without scene and pairs.
    pub peak_bytes: Option<u64>,
    /// Bytes by its formula.
    pub formula_bytes: Option<u64>,
    /// Against exact decisions on the scene as given.
    pub errors: Option<Errors>,
    /// Of several frames: when it built its list.
    pub builds: Option<Builds>,
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
            times: Blocks::new(),
            peak_bytes: None,
            formula_bytes: None,
            errors: None,
            builds: None,
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
    /// True pairs in the arithmetic, of all frames.
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

/// Ends those who are far behind the fastest in the probe.
pub(super) fn drop_far(standings: &mut [Standing]) {
    drop_if(standings, |standing, best| {
        standing
            .probe_ns
            .is_some_and(|probe| probe as f64 > FAR * best.probe_ns.unwrap_or_default() as f64)
    });
}

/// Ends those who are behind the fastest in the blocks.
pub(super) fn drop_behind(standings: &mut [Standing]) {
    drop_if(standings, |standing, best| {
        ratio(&standing.times, &best.times).is_some_and(|ratio| ratio.low > BEHIND)
    });
}

/// Ends those of whom `is_behind` holds, compared with the fastest; but two stay, so that there is
/// a margin to be told.
fn drop_if(standings: &mut [Standing], is_behind: impl Fn(&Standing, &Standing) -> bool) {
    let mut racing: Vec<usize> = (0..standings.len()).filter(|&k| standings[k].racing).collect();
    racing.sort_by(|&a, &b| standings[a].typical().total_cmp(&standings[b].typical()));
    let Some(&best) = racing.first() else { return };
    for &k in racing.iter().skip(2) {
        if !standings[k].who.stays && is_behind(&standings[k], &standings[best]) {
            standings[k].racing = false;
        }
    }
}
