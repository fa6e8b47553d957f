//! The race: who is slower by far drops out early, the others run blocks until the time is over.
//!
//! 1. A probe of each contender, one process at a time: the scene is loaded, one sample is taken,
//!    its answer is judged. It may take `PATIENCE` times as long as the fastest so far. Who takes
//!    over `FAR` times the time of the fastest is out, but for the second.
//! 2. The memory of those left.
//! 3. Blocks: a sample of each in random order. After `FEWEST` blocks those whose interval is above
//!    `BEHIND` times the fastest are out; two remain, so that the margin between them is measured.

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
use crate::run::passes::{SHORTEST_SAMPLE_NS, astray, load_all};
use crate::run::protocol::{Reply, Request};
use crate::run::trajectory::Trajectory;
use crate::scene::AnyScene;
use crate::stats::interval::{Blocks, median, ratio};

/// A probe may take so many times as long as the fastest one.
const PATIENCE: u32 = 20;
/// Who takes so many times the time of the fastest in a probe is out.
pub const FAR: f64 = 3.0;
/// Who is so many times slower after some blocks, with the whole interval, is out.
pub const BEHIND: f64 = 1.5;
/// Fewer blocks tell nothing with 95%.
pub const FEWEST: u32 = 6;
/// More blocks make intervals hardly narrower.
const MOST: u32 = 51;
/// Loading a scene may take so long.
const LOADING: Duration = Duration::from_secs(600);
/// Those that are mostly fast are probed first, so that the others need not be waited for.
const FIRST: [&str; 8] =
    ["streamed-nbs", "cell-grid", "hash-grid", "nbs", "screening", "kd-tree", "bvh", "sorting"];

/// What is asked.
pub struct Question<'a> {
    /// The scene.
    pub scene: &'a AnyScene<'static>,
    /// Scenes that detectors are given before, as some hard cases want it.
    pub history: &'a [AnyScene<'static>],
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
    /// While it is in the race.
    client: Option<Client>,
}

/// The outcome of the race.
pub struct Race {
    /// All who were asked, in the order of the table.
    pub standings: Vec<Standing>,
    /// True pairs in the arithmetic.
    pub contacts: u64,
    /// Blocks run.
    pub blocks: u32,
}

/// Runs the race. `note` hears what is being done.
pub fn run(question: &Question<'_>, note: &mut dyn FnMut(&str)) -> anyhow::Result<Race> {
    let folder = tempfile::tempdir()
        .context("cannot make a temporary folder for scenes; set TMPDIR to a writable place")?;
    note("finding the true pairs");
    let mut judge = Judge::new(question.scene);
    let arithmetic = question.arithmetic;
    let Some(contacts) = judge.truth(arithmetic)?.map(|truth| truth.digest.contacts) else {
        bail!(
            "in {} arithmetic no answer could be checked: {}; choose another with --arithmetic",
            arithmetic.name(),
            judge.why_none(arithmetic)
        );
    };
    let scenes = question.history.iter().chain([question.scene]).enumerate();
    let loads = scenes
        .map(|(k, scene)| {
            Trajectory::write_at_rest(&folder.path().join(format!("scene-{k}.npy")), scene)
        })
        .collect::<anyhow::Result<Vec<_>>>()?;
    let mut course =
        Course { question, judge, contacts, loads, folder: folder.path(), started: Instant::now() };
    let mut standings = course.probe_all(note)?;
    for standing in standings.iter_mut().filter(|standing| standing.client.is_some()) {
        note(&format!("memory of {}", standing.entry.name));
        course.memory(standing)?;
    }
    let blocks = course.blocks(&mut standings, note)?;
    standings
        .sort_by_key(|standing| TABLE.iter().position(|entry| entry.name == standing.entry.name));
    Ok(Race { standings, contacts, blocks })
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
            let threads = if entry.threads { self.question.threads } else { 1 };
            let blank = Standing {
                entry,
                threads,
                outcome: Outcome::Ok,
                reason: String::new(),
                probe_ns: None,
                times: Blocks::new(),
                peak_bytes: None,
                errors: None,
                client: None,
            };
            standings.push(blank);
            let Some(standing) = standings.last_mut() else { continue };
            let patience = shortest
                .map_or(self.question.time, |shortest| shortest * PATIENCE)
                .max(Duration::from_millis(500));
            match self.probe(standing, patience)? {
                Some(took) => shortest = Some(shortest.map_or(took, |shortest| shortest.min(took))),
                None => continue,
            }
            // Who is far behind is ended now: with a large scene, so that its memory is free.
            drop_if(&mut standings, |standing, best| {
                standing.probe_ns.is_some_and(|probe| {
                    probe as f64 > FAR * best.probe_ns.unwrap_or_default() as f64
                })
            });
        }
        // Against the fastest of all, which may have come later.
        let best = standings.iter().filter_map(|standing| standing.probe_ns).min();
        for standing in standings
            .iter_mut()
            .filter(|standing| standing.client.is_none() && standing.outcome.is_good())
        {
            let times = standing
                .probe_ns
                .zip(best)
                .map_or(f64::NAN, |(probe, best)| probe as f64 / best.max(1) as f64);
            standing.reason =
                format!("some {times:.0} times slower than the fastest in a first probe");
        }
        Ok(standings)
    }

    /// Starts, loads, and takes a first sample; how long the request took. None: it is out.
    fn probe(
        &mut self,
        standing: &mut Standing,
        patience: Duration,
    ) -> anyhow::Result<Option<Duration>> {
        let Question { scene, arithmetic, memory_limit, program, .. } = self.question;
        let start = Start {
            command: contender::own(
                program,
                standing.entry.name,
                *arithmetic,
                standing.threads,
                *memory_limit,
            ),
            install: String::new(),
            time_limit: LOADING,
            memory_limit: contender::address_space(*memory_limit, standing.threads)
                .saturating_add(contender::room(scene.len() as u64, self.contacts)),
        };
        let loaded = Client::start(&start)
            .and_then(|mut client| load_all(&mut client, &self.loads).map(|()| client));
        match loaded {
            Ok(client) => standing.client = Some(client),
            Err(failure) => {
                out(standing, failure);
                return Ok(None);
            }
        }
        if let Some(client) = &mut standing.client {
            client.allow(patience);
        }
        let started = Instant::now();
        let Some(time) = self.sample(standing)? else {
            if standing.outcome == Outcome::Timeout {
                standing.reason = format!(
                    "not ready after {:.1} s, and others are {PATIENCE} times faster or more",
                    patience.as_secs_f64()
                );
            }
            return Ok(None);
        };
        standing.probe_ns = Some(time);
        if let Some(client) = &mut standing.client {
            // From now on it has shown how long it takes: two detections for a sample, with much to
            // spare.
            client.allow(
                patience.max(Duration::from_secs(5)) + Duration::from_nanos(time) * PATIENCE,
            );
        }
        Ok(Some(started.elapsed()))
    }

    /// Nanoseconds of a detection, whose answer is judged. None: it is out.
    fn sample(&mut self, standing: &mut Standing) -> anyhow::Result<Option<u64>> {
        let Some(client) = &mut standing.client else { return Ok(None) };
        let request = Request::Sample { min_ns: SHORTEST_SAMPLE_NS };
        let (time, contacts, digest) = match client.ask(&request) {
            Ok(Reply::Sample { time_ns, contacts, digest, .. }) => (time_ns, contacts, digest),
            Ok(other) => {
                out(standing, astray(&request, &other));
                return Ok(None);
            }
            Err(failure) => {
                out(standing, failure);
                return Ok(None);
            }
        };
        let path = self.folder.join("pairs.npy");
        let fetch = || client.pairs(&path);
        let (name, arithmetic) = (standing.entry.name, self.question.arithmetic);
        let judged = self.judge.judge(name, arithmetic, (contacts, &digest), fetch)?;
        standing.errors = judged.errors;
        if judged.outcome.is_good() {
            standing.outcome = judged.outcome;
            return Ok(Some(time));
        }
        out(standing, Failure { outcome: judged.outcome, reason: judged.reason });
        Ok(None)
    }

    fn memory(&mut self, standing: &mut Standing) -> anyhow::Result<()> {
        let Some(client) = &mut standing.client else { return Ok(()) };
        match client.ask(&Request::Memory) {
            Ok(Reply::Memory { peak_bytes, .. }) => standing.peak_bytes = Some(peak_bytes),
            // It is measured without.
            Ok(_) => {}
            Err(failure) => out(standing, failure),
        }
        Ok(())
    }

    /// Samples of all that are left, until the time is over; the number of blocks.
    fn blocks(
        &mut self,
        standings: &mut [Standing],
        note: &mut dyn FnMut(&str),
    ) -> anyhow::Result<u32> {
        let time = self.question.time;
        for block in 1..=MOST {
            // At least so many that there is an interval; as many as tell something, if that takes
            // not much longer.
            let wanted = if self.started.elapsed() < 2 * time { FEWEST } else { 2 };
            if block > wanted && self.started.elapsed() > time {
                return Ok(block - 1);
            }
            let mut order: Vec<usize> =
                (0..standings.len()).filter(|&k| standings[k].client.is_some()).collect();
            note(&format!("block {block}: {} detectors", order.len()));
            order.shuffle(&mut ChaCha8Rng::seed_from_u64(u64::from(block)));
            for k in order {
                if let Some(time) = self.sample(&mut standings[k])? {
                    standings[k].times.insert(block, time);
                }
            }
            if block >= FEWEST {
                drop_those_behind(standings);
            }
        }
        Ok(MOST)
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
    let mut racing: Vec<usize> =
        (0..standings.len()).filter(|&k| standings[k].client.is_some()).collect();
    racing.sort_by(|&a, &b| typical(&standings[a]).total_cmp(&typical(&standings[b])));
    let Some(&best) = racing.first() else { return };
    for &k in racing.iter().skip(2) {
        if is_behind(&standings[k], &standings[best]) {
            standings[k].client = None;
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
    standing.client = None;
    standing.times = BTreeMap::new();
}
