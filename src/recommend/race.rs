//! The race: who is slower by far drops out early, the others run blocks until the time is over.
//!
//! 1. A probe of each contender, one process at a time, in half of the time: the scene is loaded,
//!    one sample is taken, its answer is judged. It may take `PATIENCE` times as long as the
//!    fastest so far. Who takes over `FAR` times the time of the fastest is out, but for the
//!    second; of the others the memory is measured.
//! 2. Blocks: a sample of each in random order, and of the fastest once more as its own twin, every
//!    one in a fresh process and all of a block on the same processor. After `FEWEST` blocks those
//!    whose interval is above `BEHIND` times the fastest are out; two remain, so that the margin
//!    between them is measured.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::{Context, bail};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use crate::contact::Arithmetic;
use crate::detect::table::{Entry, Role, TABLE};
use crate::oracle::Errors;
use crate::record::row::Outcome;
use crate::run::client::{Client, Failure, Start};
use crate::run::contender;
use crate::run::judge::Judge;
use crate::run::passes::{self, SHORTEST_SAMPLE_NS, load_all};
use crate::run::processors;
use crate::run::protocol::{Reply, Request};
use crate::run::trajectory::Trajectory;
use crate::scene::Given;
use crate::stats::interval::{Blocks, Interval, median, ratio};

/// A probe may take so many times as long as the fastest one.
const PATIENCE: u32 = 20;
/// Who takes so many times the time of the fastest in a probe is out.
pub const FAR: f64 = 3.0;
/// Who is so many times slower after some blocks, with the whole interval, is out.
pub const BEHIND: f64 = 1.5;
/// Fewer blocks tell nothing with 95%.
const FEWEST: u32 = 6;
/// More blocks make intervals hardly narrower.
const MOST: u32 = 51;
/// Blocks go on until there are [`FEWEST`] of them, but not beyond so many times the time asked
/// for.
const BEYOND: f64 = 1.5;
/// A probe is given at least so long: a process must start.
const SHORTEST_PROBE: Duration = Duration::from_millis(100);
/// Those that are mostly fast are probed first, so that the others need not be waited for.
const FIRST: [&str; 9] = [
    "streamed-nbs",
    "cell-grid",
    "hash-grid",
    "hgrid",
    "nbs",
    "screening",
    "kd-tree",
    "bvh",
    "sorting",
];

/// What is asked.
pub struct Question<'a> {
    /// The scene.
    pub given: &'a Given,
    /// Scenes that detectors are given before, as some hard cases want it.
    pub history: &'a [Given],
    /// How contacts are decided.
    pub arithmetic: Arithmetic,
    /// For detectors that can use several.
    pub threads: usize,
    /// For a detector's arrays, in bytes.
    pub memory_limit: u64,
    /// For the race.
    pub time: Duration,
    /// This program, to be started as runner.
    pub program: PathBuf,
}

/// Where a contender stands in the race.
pub struct Standing {
    /// Its line in the table.
    pub entry: &'static Entry,
    /// Threads given to it.
    pub threads: usize,
    /// `ok`, or `lossy` with textbook filters: it has finished, or was only slow. All else: why
    /// not.
    pub outcome: Outcome,
    /// Why it is out; empty for those that were measured to the end.
    pub reason: String,
    /// Nanoseconds of the probe.
    pub probe_ns: Option<u64>,
    /// Nanoseconds by block.
    pub times: Blocks,
    /// Most bytes held at one time, without scene and pairs.
    pub peak_bytes: Option<u64>,
    /// Against exact decisions on the scene as given.
    pub errors: Option<Errors>,
    /// Is it in the race?
    racing: bool,
    /// How its processes are started.
    start: Start,
}

/// The outcome of the race.
pub struct Race {
    /// All who were asked, in the order of the table.
    pub standings: Vec<Standing>,
    /// True pairs in the arithmetic.
    pub contacts: u64,
    /// Blocks run.
    pub blocks: u32,
    /// The time of one of them over its own, measured again in every block: what equal code differs
    /// by. None with less than two blocks.
    pub twin: Option<Interval>,
}

/// Runs the race. `note` hears what is being done.
pub fn run(question: &Question<'_>, note: &mut dyn FnMut(&str)) -> anyhow::Result<Race> {
    let folder = tempfile::tempdir()
        .context("cannot make a temporary folder for scenes; set TMPDIR to a writable place")?;
    note("finding the true pairs");
    let mut judge = Judge::new(question.given, question.memory_limit)?;
    let arithmetic = question.arithmetic;
    if let Some(reason) = judge.hopeless(arithmetic)? {
        bail!("{reason}");
    }
    let Some(contacts) = judge.contacts(arithmetic)? else {
        bail!(
            "in {} arithmetic no answer could be checked: {}; choose another with --arithmetic",
            arithmetic.name(),
            judge.why_none(arithmetic)?
        );
    };
    let scenes = question.history.iter().chain([question.given]).enumerate();
    let loads = scenes
        .map(|(k, given)| {
            Trajectory::write_at_rest(&folder.path().join(format!("scene-{k}.npy")), given)
        })
        .collect::<anyhow::Result<Vec<_>>>()?;
    let mut course =
        Course { question, judge, contacts, loads, folder: folder.path(), started: Instant::now() };
    let mut standings = course.probe_all(note)?;
    let (blocks, twin) = course.blocks(&mut standings, note)?;
    standings
        .sort_by_key(|standing| TABLE.iter().position(|entry| entry.name == standing.entry.name));
    Ok(Race { standings, contacts, blocks, twin })
}

struct Course<'a> {
    question: &'a Question<'a>,
    judge: Judge<'a>,
    /// True pairs.
    contacts: u64,
    loads: Vec<Trajectory>,
    folder: &'a Path,
    started: Instant,
}

impl Course<'_> {
    /// What is left of this share of the time.
    fn left(&self, share: f64) -> Duration {
        self.question.time.mul_f64(share).saturating_sub(self.started.elapsed())
    }

    fn probe_all(&mut self, note: &mut dyn FnMut(&str)) -> anyhow::Result<Vec<Standing>> {
        let mut order: Vec<&'static Entry> = TABLE
            .iter()
            .filter(|entry| matches!(entry.role, Role::Detector | Role::Peer))
            .collect();
        order.sort_by_key(|entry| {
            FIRST
                .iter()
                .position(|name| *name == entry.name)
                .unwrap_or(FIRST.len() + usize::from(entry.name == "direct"))
        });
        let mut standings: Vec<Standing> = Vec::new();
        // The wall time of the fastest probe.
        let mut shortest: Option<Duration> = None;
        for entry in order {
            note(&format!("probing {}", entry.name));
            let mut standing = self.entered(entry);
            // The first may take all of the time, the others what the probes have left.
            let left = self.left(if shortest.is_none() { 1.0 } else { 0.5 });
            let asked = self.question.time.as_secs_f64();
            if left.is_zero() {
                let reason = format!("not tried: the {asked} s were over (--seconds)");
                out(&mut standing, Failure { outcome: Outcome::Timeout, reason });
                standings.push(standing);
                continue;
            }
            let patience = shortest.map_or(left, |shortest| (shortest * PATIENCE).min(left));
            let best = standings.iter().filter_map(|standing| standing.probe_ns).min();
            if let Some(took) = self.probe(&mut standing, patience.max(SHORTEST_PROBE), best)? {
                shortest = Some(shortest.map_or(took, |shortest| shortest.min(took)));
            }
            standings.push(standing);
        }
        drop_if(&mut standings, |standing, best| {
            standing
                .probe_ns
                .is_some_and(|probe| probe as f64 > FAR * best.probe_ns.unwrap_or_default() as f64)
        });
        let best = standings.iter().filter_map(|standing| standing.probe_ns).min();
        let slow = |standing: &&mut Standing| !standing.racing && standing.outcome.is_good();
        for standing in standings.iter_mut().filter(slow) {
            let times = standing
                .probe_ns
                .zip(best)
                .map_or(f64::NAN, |(probe, best)| probe as f64 / best.max(1) as f64);
            standing.reason =
                format!("some {times:.0} times slower than the fastest in a first probe");
        }
        Ok(standings)
    }

    fn entered(&self, entry: &'static Entry) -> Standing {
        let Question { given, arithmetic, memory_limit, program, .. } = self.question;
        let threads = if entry.threads { self.question.threads } else { 1 };
        let start = Start {
            command: contender::own(program, entry.name, *arithmetic, threads, *memory_limit),
            install: String::new(),
            time_limit: self.question.time.max(SHORTEST_PROBE),
            memory_limit: contender::address_space(*memory_limit, threads)
                .saturating_add(contender::room(given.scene.len() as u64, self.contacts)),
            processor: None,
        };
        Standing {
            entry,
            threads,
            outcome: Outcome::Ok,
            reason: String::new(),
            probe_ns: None,
            times: Blocks::new(),
            peak_bytes: None,
            errors: None,
            racing: true,
            start,
        }
    }

    /// Starts, loads, takes a first sample, and measures the memory unless others are far faster;
    /// how long that took. None: it is out.
    fn probe(
        &mut self,
        standing: &mut Standing,
        patience: Duration,
        best: Option<u64>,
    ) -> anyhow::Result<Option<Duration>> {
        let started = Instant::now();
        standing.start.time_limit = patience;
        let Some((time, mut client)) = self.sample(standing, None)? else {
            if standing.outcome == Outcome::Timeout {
                standing.reason = match best {
                    None => format!(
                        "not ready after {:.1} s: give more time with --seconds",
                        patience.as_secs_f64()
                    ),
                    Some(_) => {
                        format!("not ready after {:.1} s, and others are", patience.as_secs_f64())
                    }
                };
            }
            return Ok(None);
        };
        standing.probe_ns = Some(time);
        let took = started.elapsed();
        // From now on it has shown how long it takes.
        standing.start.time_limit = took * PATIENCE + Duration::from_secs(5);
        client.allow(standing.start.time_limit);
        if best.is_none_or(|best| time as f64 <= FAR * best as f64) {
            match client.ask(&Request::Memory) {
                Ok(Reply::Memory { peak_bytes, .. }) => standing.peak_bytes = Some(peak_bytes),
                // It is measured without.
                Ok(_) => {}
                Err(failure) => out(standing, failure),
            }
        }
        Ok(Some(took).filter(|_| standing.racing))
    }

    /// Nanoseconds of a detection in a fresh process, whose answer is judged; and the process.
    /// None: it is out.
    fn sample(
        &mut self,
        standing: &mut Standing,
        processor: Option<usize>,
    ) -> anyhow::Result<Option<(u64, Client)>> {
        let start = Start { processor, ..standing.start.clone() };
        let answer = Client::start(&start).and_then(|mut client| {
            client.allow(start.time_limit);
            load_all(&mut client, &self.loads)?;
            Ok((passes::sample(&mut client, SHORTEST_SAMPLE_NS)?, client))
        });
        let (sample, mut client) = match answer {
            Ok(answer) => answer,
            Err(failure) => {
                out(standing, failure);
                return Ok(None);
            }
        };
        let path = self.folder.join("pairs.npy");
        let box_dim = self.loads.last().and_then(Trajectory::box_dim);
        let fetch = || client.pairs(&path, box_dim, None);
        let (name, arithmetic) = (standing.entry.name, self.question.arithmetic);
        let said = (sample.contacts, &*sample.digest);
        let judged = self.judge.judge(name, arithmetic, said, fetch)?;
        standing.errors = judged.errors;
        if judged.outcome.is_good() {
            standing.outcome = judged.outcome;
            return Ok(Some((sample.time_ns, client)));
        }
        out(standing, Failure { outcome: judged.outcome, reason: judged.reason });
        Ok(None)
    }

    /// Samples of all that are left and of a twin, until the time is over; the number of blocks,
    /// and what the twin says.
    fn blocks(
        &mut self,
        standings: &mut [Standing],
        note: &mut dyn FnMut(&str),
    ) -> anyhow::Result<(u32, Option<Interval>)> {
        let racing = standings.iter().filter(|standing| standing.racing);
        let original = racing.min_by_key(|standing| standing.probe_ns);
        // With the limits that its original has since the probe.
        let mut twin = original.map(|original| Standing {
            start: original.start.clone(),
            ..self.entered(original.entry)
        });
        let mut done = 0;
        for block in 1..=MOST {
            let share = if block <= FEWEST { BEYOND } else { 1.0 };
            if block > 1 && self.left(share).is_zero() {
                break;
            }
            let mut order: Vec<&mut Standing> =
                standings.iter_mut().chain(&mut twin).filter(|standing| standing.racing).collect();
            note(&format!("block {block}: {} detectors", order.len().saturating_sub(1)));
            order.shuffle(&mut ChaCha8Rng::seed_from_u64(u64::from(block)));
            for standing in order {
                let processor = processors::in_block(block).filter(|_| standing.threads == 1);
                if let Some((time, _)) = self.sample(standing, processor)? {
                    standing.times.insert(block.into(), time);
                }
            }
            done = block;
            if block >= FEWEST {
                drop_those_behind(standings);
            }
        }
        let of = |twin: Standing| {
            let original = standings.iter().find(|it| it.entry.name == twin.entry.name)?;
            ratio(&twin.times, &original.times).filter(|ratio| ratio.count > 1)
        };
        Ok((done, twin.and_then(of)))
    }
}

/// The one with the smallest median.
pub fn fastest(standings: &[Standing]) -> Option<usize> {
    let timed = standings
        .iter()
        .enumerate()
        .filter(|(_, standing)| standing.outcome.is_good() && !standing.times.is_empty());
    timed.min_by(|a, b| typical(a.1).total_cmp(&typical(b.1))).map(|(k, _)| k)
}

fn drop_those_behind(standings: &mut [Standing]) {
    drop_if(standings, |standing, best| {
        ratio(&standing.times, &best.times).is_some_and(|ratio| ratio.low > BEHIND)
    });
}

/// Ends those of whom `is_behind` holds, compared with the fastest; but two stay, so that there is
/// a margin to be told.
fn drop_if(standings: &mut [Standing], is_behind: impl Fn(&Standing, &Standing) -> bool) {
    let mut racing: Vec<usize> = (0..standings.len()).filter(|&k| standings[k].racing).collect();
    racing.sort_by(|&a, &b| typical(&standings[a]).total_cmp(&typical(&standings[b])));
    let Some(&best) = racing.first() else { return };
    for &k in racing.iter().skip(2) {
        if is_behind(&standings[k], &standings[best]) {
            standings[k].racing = false;
        }
    }
}

/// The median of the times, or the probe; in nanoseconds.
fn typical(standing: &Standing) -> f64 {
    let times: Vec<f64> = standing.times.values().map(|&time| time as f64).collect();
    median(&times).or(standing.probe_ns.map(|probe| probe as f64)).unwrap_or(f64::INFINITY)
}

fn out(standing: &mut Standing, failure: Failure) {
    standing.outcome = failure.outcome;
    standing.reason = failure.reason;
    standing.racing = false;
    standing.times = BTreeMap::new();
}
