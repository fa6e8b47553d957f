//! The race: who is slower by far drops out early, the others run blocks until the time is over.
//!
//! 1. A probe of each detector, one process at a time: the scene is loaded, one sample is taken, its answer is checked. It may take
//!    `PATIENCE` times as long as the fastest so far. Who takes over `FAR` times the time of the fastest is out, but for the second.
//! 2. The memory of those left.
//! 3. Blocks: a sample of each in random order. After `FEWEST` blocks those whose interval is above `BEHIND` times the fastest are out; two remain,
//!    so that the margin between them is measured.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::{Context, bail};
use rand::{SeedableRng, seq::SliceRandom};
use rand_chacha::ChaCha8Rng;

use crate::analyse::interval::{Blocks, median, ratio};
use crate::contact::Arithmetic;
use crate::detect::table::{Entry, Role, TABLE};
use crate::harness::bake;
use crate::harness::child::{Failure, Runner, Start};
use crate::harness::contender;
use crate::harness::protocol::{Reply, Request};
use crate::harness::record::{Errors, Outcome};
use crate::harness::run::{SHORTEST_SAMPLE_NS, astray, load_all};
use crate::harness::truths::Truths;
use crate::scene::AnyScene;
use crate::sink::Digest;

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
const FIRST: [&str; 8] = ["streamed-nbs", "cell-grid", "hash-grid", "nbs", "screening", "kd-tree", "bvh", "sorting"];

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

/// A detector in the race, and what became of it.
pub struct Entrant {
    /// Its line in the table.
    pub entry: &'static Entry,
    /// Threads given to it.
    pub threads: usize,
    /// `ok`, or `lossy` with textbook filters: it has finished, or was only slow. All else: why not.
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
    runner: Option<Runner>,
}

/// The outcome of the race.
pub struct Race {
    /// All who were asked, in the order of the table.
    pub entrants: Vec<Entrant>,
    /// True pairs in the arithmetic.
    pub contacts: u64,
    /// Blocks run.
    pub blocks: u32,
}

/// Runs the race. `note` hears what is being done.
pub fn run(question: &Question<'_>, note: &mut dyn FnMut(&str)) -> anyhow::Result<Race> {
    let folder = tempfile::tempdir().context("cannot make a temporary folder for scenes; set TMPDIR to a writable place")?;
    note("finding the truth");
    let mut truths = Truths::new(question.scene);
    let arithmetic = question.arithmetic;
    let Some(truth) = truths.get(arithmetic)?.map(|truth| truth.digest) else {
        bail!(
            "in {} arithmetic no answer could be checked: {}; choose another with --arithmetic",
            arithmetic.name(),
            truths.why_none(arithmetic)
        );
    };
    let scenes = question.history.iter().chain([question.scene]).enumerate();
    let loads =
        scenes.map(|(k, scene)| bake::load(&folder.path().join(format!("scene-{k}.npy")), scene)).collect::<anyhow::Result<Vec<_>>>()?;
    let mut course = Course { question, truths, truth, loads, folder: folder.path(), started: Instant::now() };
    let mut entrants = course.probe_all(note)?;
    for entrant in entrants.iter_mut().filter(|entrant| entrant.runner.is_some()) {
        note(&format!("memory of {}", entrant.entry.name));
        course.memory(entrant)?;
    }
    let blocks = course.blocks(&mut entrants, note)?;
    entrants.sort_by_key(|entrant| TABLE.iter().position(|entry| entry.name == entrant.entry.name));
    Ok(Race { entrants, contacts: truth.contacts, blocks })
}

struct Course<'a> {
    question: &'a Question<'a>,
    truths: Truths<'a>,
    truth: Digest,
    loads: Vec<Request>,
    folder: &'a Path,
    started: Instant,
}

impl Course<'_> {
    fn probe_all(&mut self, note: &mut dyn FnMut(&str)) -> anyhow::Result<Vec<Entrant>> {
        let mut order: Vec<&'static Entry> = TABLE.iter().filter(|entry| matches!(entry.role, Role::Detector | Role::Peer)).collect();
        order.sort_by_key(|entry| {
            FIRST.iter().position(|name| *name == entry.name).unwrap_or(FIRST.len() + usize::from(entry.name == "direct"))
        });
        let mut entrants: Vec<Entrant> = Vec::new();
        // The wall time of the fastest probe.
        let mut shortest: Option<Duration> = None;
        for entry in order {
            note(&format!("probing {}", entry.name));
            let threads = if entry.threads { self.question.threads } else { 1 };
            let blank = Entrant {
                entry,
                threads,
                outcome: Outcome::Ok,
                reason: String::new(),
                probe_ns: None,
                times: Blocks::new(),
                peak_bytes: None,
                errors: None,
                runner: None,
            };
            entrants.push(blank);
            let Some(entrant) = entrants.last_mut() else { continue };
            let patience = shortest.map_or(self.question.time, |shortest| shortest * PATIENCE).max(Duration::from_millis(500));
            match self.probe(entrant, patience)? {
                Some(took) => shortest = Some(shortest.map_or(took, |shortest| shortest.min(took))),
                None => continue,
            }
            // Who is far behind is ended now: with a large scene, so that its memory is free.
            drop_if(&mut entrants, |entrant, best| {
                entrant.probe_ns.is_some_and(|probe| probe as f64 > FAR * best.probe_ns.unwrap_or_default() as f64)
            });
        }
        // Against the fastest of all, which may have come later.
        let best = entrants.iter().filter_map(|entrant| entrant.probe_ns).min();
        for entrant in entrants.iter_mut().filter(|entrant| entrant.runner.is_none() && entrant.outcome.is_good()) {
            let times = entrant.probe_ns.zip(best).map_or(f64::NAN, |(probe, best)| probe as f64 / best.max(1) as f64);
            entrant.reason = format!("some {times:.0} times slower than the fastest in a first probe");
        }
        Ok(entrants)
    }

    /// Starts, loads, and takes a first sample; how long the request took. None: it is out.
    fn probe(&mut self, entrant: &mut Entrant, patience: Duration) -> anyhow::Result<Option<Duration>> {
        let Question { scene, arithmetic, memory_limit, program, .. } = self.question;
        let start = Start {
            command: contender::own(program, entrant.entry.name, *arithmetic, entrant.threads, *memory_limit),
            install: String::new(),
            time_limit: LOADING,
            memory_limit: contender::address_space(*memory_limit, entrant.threads)
                .saturating_add(contender::room(scene.len() as u64, self.truth.contacts)),
        };
        let loaded = Runner::start(&start).and_then(|mut runner| load_all(&mut runner, &self.loads).map(|()| runner));
        match loaded {
            Ok(runner) => entrant.runner = Some(runner),
            Err(failure) => {
                out(entrant, failure);
                return Ok(None);
            }
        }
        if let Some(runner) = &mut entrant.runner {
            runner.allow(patience);
        }
        let started = Instant::now();
        let Some(time) = self.sample(entrant)? else {
            if entrant.outcome == Outcome::Timeout {
                entrant.reason = format!("not ready after {:.1} s, and others are {PATIENCE} times faster or more", patience.as_secs_f64());
            }
            return Ok(None);
        };
        entrant.probe_ns = Some(time);
        if let Some(runner) = &mut entrant.runner {
            // From now on it has shown how long it takes: two detections for a sample, with much to spare.
            runner.allow(patience.max(Duration::from_secs(5)) + Duration::from_nanos(time) * PATIENCE);
        }
        Ok(Some(started.elapsed()))
    }

    /// Nanoseconds of a detection, whose answer is checked. None: it is out.
    fn sample(&mut self, entrant: &mut Entrant) -> anyhow::Result<Option<u64>> {
        let Some(runner) = &mut entrant.runner else { return Ok(None) };
        let request = Request::Sample { min_ns: SHORTEST_SAMPLE_NS };
        let (time, contacts, digest) = match runner.ask(&request) {
            Ok(Reply::Sample { time_ns, contacts, digest, .. }) => (time_ns, contacts, digest),
            Ok(other) => {
                out(entrant, astray(&request, &other));
                return Ok(None);
            }
            Err(failure) => {
                out(entrant, failure);
                return Ok(None);
            }
        };
        // A fingerprint that is no number is not the right one.
        let sum = u64::from_str_radix(digest.trim_start_matches("0x"), 16).unwrap_or(!self.truth.sum);
        let answer = Digest { contacts, sum };
        let path = self.folder.join("pairs.npy");
        let fetch = || {
            runner.ask(&Request::Pairs { path: path.clone() }).map_err(|failure| failure.reason)?;
            bake::read_pairs(&path).map_err(|e| e.to_string())
        };
        let arithmetic = self.question.arithmetic;
        let errors = self.truths.errors(arithmetic, entrant.entry.name, answer, fetch)?;
        let mut reason = "its pairs differ from the truth".to_string();
        if let Ok(Some((errors, causes))) = errors {
            entrant.errors = Some(errors);
            let own = causes.algorithm;
            if own.wrong() == own.missed && own.missed > 0 && !arithmetic.is_safe() {
                entrant.outcome = Outcome::Lossy;
                return Ok(Some(time));
            }
            reason = format!("against all pairs tested in {}: {own}", arithmetic.name());
        }
        if answer == self.truth {
            return Ok(Some(time));
        }
        out(entrant, Failure { outcome: Outcome::Wrong, reason });
        Ok(None)
    }

    fn memory(&mut self, entrant: &mut Entrant) -> anyhow::Result<()> {
        let Some(runner) = &mut entrant.runner else { return Ok(()) };
        match runner.ask(&Request::Memory) {
            Ok(Reply::Memory { peak_bytes, .. }) => entrant.peak_bytes = Some(peak_bytes),
            // It is measured without.
            Ok(_) => {}
            Err(failure) => out(entrant, failure),
        }
        Ok(())
    }

    /// Samples of all that are left, until the time is over; the number of blocks.
    fn blocks(&mut self, entrants: &mut [Entrant], note: &mut dyn FnMut(&str)) -> anyhow::Result<u32> {
        let time = self.question.time;
        for block in 1..=MOST {
            // At least so many that there is an interval; as many as tell something, if that takes not much longer.
            let wanted = if self.started.elapsed() < 2 * time { FEWEST } else { 2 };
            if block > wanted && self.started.elapsed() > time {
                return Ok(block - 1);
            }
            let mut order: Vec<usize> = (0..entrants.len()).filter(|&k| entrants[k].runner.is_some()).collect();
            note(&format!("block {block}: {} detectors", order.len()));
            order.shuffle(&mut ChaCha8Rng::seed_from_u64(u64::from(block)));
            for k in order {
                if let Some(time) = self.sample(&mut entrants[k])? {
                    entrants[k].times.insert(block, time);
                }
            }
            if block >= FEWEST {
                drop_those_behind(entrants);
            }
        }
        Ok(MOST)
    }
}

/// The one with the smallest median.
pub fn fastest(entrants: &[Entrant]) -> Option<usize> {
    let timed = entrants.iter().enumerate().filter(|(_, entrant)| entrant.outcome.is_good() && !entrant.times.is_empty());
    timed.min_by(|a, b| typical(a.1).total_cmp(&typical(b.1))).map(|(k, _)| k)
}

fn drop_those_behind(entrants: &mut [Entrant]) {
    drop_if(entrants, |entrant, best| ratio(&entrant.times, &best.times).is_some_and(|ratio| ratio.low > BEHIND));
}

/// Ends those of whom `is_behind` holds, compared with the fastest; but two stay, so that there is a margin to be told.
fn drop_if(entrants: &mut [Entrant], is_behind: impl Fn(&Entrant, &Entrant) -> bool) {
    let mut racing: Vec<usize> = (0..entrants.len()).filter(|&k| entrants[k].runner.is_some()).collect();
    racing.sort_by(|&a, &b| typical(&entrants[a]).total_cmp(&typical(&entrants[b])));
    let Some(&best) = racing.first() else { return };
    for &k in racing.iter().skip(2) {
        if is_behind(&entrants[k], &entrants[best]) {
            entrants[k].runner = None;
        }
    }
}

/// The median of the times, or the probe; in nanoseconds.
fn typical(entrant: &Entrant) -> f64 {
    let times: Vec<f64> = entrant.times.values().map(|&time| time as f64).collect();
    median(&times).or(entrant.probe_ns.map(|probe| probe as f64)).unwrap_or(f64::INFINITY)
}

fn out(entrant: &mut Entrant, failure: Failure) {
    (entrant.outcome, entrant.reason, entrant.runner) = (failure.outcome, failure.reason, None);
    entrant.times = BTreeMap::new();
}
