//! Runs experiments: scenes are made, the truth is found, runners are started, rows are written.
//!
//! For each scene: one runner per (detector, arithmetic) loads it; then each counts, and measures its memory; then blocks of timed
//! samples, every detector once per block in a fresh random order. Rows go to the record one by one. What the record
//! holds already (of a killed run) is not measured again.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::Context;
use rand::{SeedableRng, seq::SliceRandom};
use rand_chacha::ChaCha8Rng;

use super::bake;
use super::child::{Failure, Runner, Start};
use super::experiment::Experiment;
use super::index::{Index, TooSlow, owed, rest};
use super::protocol::{Reply, Request};
use super::record::{Causes, Outcome, Pass, Row, Stats, Writer};
use super::truths::Truths;
use crate::contact::Arithmetic;
use crate::detect::table::{self, Role};
use crate::scene::spec::{Order, Spec};
use crate::scene::{AnyScene, stats};
use crate::sink::{Digest, splitmix64};

/// Samples are at least this long, or the clock would be measured.
const SHORTEST_SAMPLE_NS: u64 = 1_000_000;
/// Blocks done before the budget can end a scene: the range of six values covers the median in 96.9% of samples.
const FEWEST_BLOCKS: u32 = 6;
/// Blocks of a quick run.
const QUICK_BLOCKS: u32 = 3;
/// Address space for a runner beside a detector's arrays and the scene: the program, its stacks, its libraries.
const PROGRAM_BYTES: u64 = 1 << 30;

/// What is to be run, and where to.
pub struct Job<'a> {
    /// The experiments, in order.
    pub experiments: &'a [Experiment],
    /// Small scenes and few blocks.
    pub quick: bool,
    /// The program to start as runner: this one.
    pub program: PathBuf,
    /// Rows already in the record.
    pub done: &'a [Row],
}

/// Hears how far a run has come.
pub trait Progress {
    /// `done` of `total` scenes are complete; `next` is being worked on.
    fn scene(&mut self, done: usize, total: usize, next: &str);
    /// Something the user should know now.
    fn note(&mut self, text: &str);
}

/// A detector with an arithmetic, as a runner.
#[derive(Clone)]
struct Contender {
    name: String,
    /// `None`: the runner says.
    arithmetic: Option<Arithmetic>,
    role: Role,
    threads: usize,
    start: Start,
}

/// Runs all experiments of a job into a record.
pub fn run(job: &Job<'_>, record: &mut Writer, progress: &mut dyn Progress) -> anyhow::Result<()> {
    let mut plans = Vec::new();
    for experiment in job.experiments {
        let plan = experiment.plan(job.quick).with_context(|| format!("in experiment {}", experiment.name))?;
        plans.extend(plan.into_iter().map(|spec| (experiment, spec)));
    }
    let folder = tempfile::tempdir().context("cannot make a temporary folder for scenes; set TMPDIR to a writable place")?;
    let index = Index::new(job.done);
    let mut too_slow = TooSlow::new(job.done);
    for (k, (experiment, spec)) in plans.iter().enumerate() {
        progress.scene(k, plans.len(), &describe(experiment, spec));
        let mut stage = Stage { job, experiment, spec, index: &index, folder: folder.path(), record, too_slow: &mut too_slow, progress };
        stage.run().with_context(|| format!("in experiment {}, scene {}", experiment.name, describe(experiment, spec)))?;
    }
    progress.scene(plans.len(), plans.len(), "done");
    Ok(())
}

fn describe(experiment: &Experiment, spec: &Spec) -> String {
    let n = if spec.n == 0 { String::new() } else { format!(" N={}", spec.n) };
    let swept = spec.params.iter().filter(|(name, _)| *name == "s" || *name == "path").map(|(name, value)| format!(" {name}={value}"));
    format!("{}: {} {}D{n}{}", experiment.name, spec.name, spec.dim, swept.collect::<String>())
}

/// An answer that does not belong to the request.
fn astray(request: &Request, reply: &Reply) -> Failure {
    // The variant's name alone: what else there is holds paths that differ from run to run.
    let word = |text: String| text.split(' ').next().unwrap_or_default().to_string();
    let reason = format!("the runner answered {} with {}", word(format!("{request:?}")), word(format!("{reply:?}")));
    Failure { outcome: Outcome::Crashed, reason }
}

/// One scene of one experiment.
struct Stage<'a> {
    job: &'a Job<'a>,
    experiment: &'a Experiment,
    spec: &'a Spec,
    index: &'a Index,
    folder: &'a Path,
    record: &'a mut Writer,
    too_slow: &'a mut TooSlow,
    progress: &'a mut dyn Progress,
}

/// A contender that is still in the race on this scene.
struct Racer {
    contender: Contender,
    runner: Runner,
    arithmetic: Arithmetic,
    blank: Row,
}

impl Stage<'_> {
    fn run(&mut self) -> anyhow::Result<()> {
        let blocks = if self.job.quick { self.experiment.blocks.min(QUICK_BLOCKS) } else { self.experiment.blocks };
        let scene = self.spec.make()?;
        let mut truths = Truths::new(&scene);
        let exact_contacts = truths.get(Arithmetic::Exact)?.map_or(0, |truth| truth.digest.contacts);
        let stats = stats::stats(&scene, exact_contacts);
        let contenders = self.contenders(&scene, exact_contacts);
        let blanks: Vec<Row> = contenders.iter().map(|contender| self.blank(contender, &scene, &stats)).collect();
        if contenders.iter().zip(&blanks).all(|(contender, blank)| self.complete(contender, blank, blocks)) {
            return Ok(());
        }
        let path = self.folder.join("scene.npy");
        let radius = bake::write(&path, &scene)?;
        let load = Request::Load { path, dim: scene.dim() as u32, n: scene.len() as u64, radius };
        let mut racers = Vec::new();
        for (contender, blank) in contenders.into_iter().zip(blanks) {
            if self.give_up(&blank)? {
                continue;
            }
            if let Some(racer) = self.enter(contender, blank, &load, &mut truths)? {
                racers.push(racer);
            }
        }
        let started = Instant::now();
        for block in 1..=blocks {
            if block > FEWEST_BLOCKS && started.elapsed().as_secs_f64() > self.experiment.block_budget_s {
                break;
            }
            // Another order in each block of each scene, the same whenever the scene is run.
            let of_scene =
                describe(self.experiment, self.spec).bytes().fold(self.spec.seed, |seed, byte| splitmix64(seed ^ u64::from(byte)));
            let mut random = ChaCha8Rng::seed_from_u64(of_scene.wrapping_add(u64::from(block)));
            racers.shuffle(&mut random);
            let mut still = Vec::new();
            for mut racer in racers {
                let blank = Row { pass: Pass::Time, block, ..racer.blank.clone() };
                if self.index.has(&blank) || self.sample(&mut racer, blank, &mut truths)? {
                    still.push(racer);
                }
            }
            racers = still;
        }
        Ok(())
    }

    /// Everything of this detector on this scene is in the record.
    fn complete(&self, contender: &Contender, blank: &Row, blocks: u32) -> bool {
        let has = |pass, block| self.index.has(&Row { pass, block, ..blank.clone() });
        // A budget may have ended the blocks early; an external runner says only when started which arithmetic it is held to.
        let enough = if self.experiment.block_budget_s.is_finite() { blocks.min(FEWEST_BLOCKS) } else { blocks };
        let over = self.index.ended(blank).is_some_and(|last| owed(last.pass).iter().all(|&pass| has(pass, 0)));
        contender.arithmetic.is_some()
            && (over || has(Pass::Count, 0) && has(Pass::Memory, 0) && (1..=enough).all(|block| has(Pass::Time, block)))
    }

    fn contenders(&self, scene: &AnyScene<'_>, contacts: u64) -> Vec<Contender> {
        let experiment = self.experiment;
        let limit = experiment.memory_limit_mib << 20;
        // The scene (twice while it is read); the list of pairs (up to twice its size, and twice while it grows), with some to spare.
        let allowance = PROGRAM_BYTES + scene.len() as u64 * (2 * 32 + 128) + contacts * 4 * 8;
        let start = |command: Vec<String>, install: String| Start {
            command,
            install,
            time_limit: Duration::from_secs_f64(experiment.time_limit_s),
            memory_limit: limit + allowance,
        };
        let mut contenders = Vec::new();
        for &arithmetic in &experiment.arithmetics {
            for name in &experiment.detectors {
                // The names were checked when the experiment was read.
                let Some(entry) = table::find(name) else { continue };
                // A sequential detector has one thread, whatever the others are given.
                let threads = if entry.threads { experiment.threads } else { 1 };
                let mut command = vec![self.job.program.display().to_string(), "runner".into(), "--detector".into(), name.clone()];
                command.extend(["--arithmetic".into(), arithmetic.name().into(), "--threads".into(), threads.to_string()]);
                command.extend(["--memory-limit".into(), limit.to_string()]);
                contenders.push(Contender {
                    name: name.clone(),
                    arithmetic: Some(arithmetic),
                    role: entry.role,
                    threads,
                    start: start(command, String::new()),
                });
            }
        }
        for runner in &experiment.runners {
            let start = start(runner.command.clone(), runner.install.clone());
            contenders.push(Contender {
                name: runner.name.clone(),
                arithmetic: None,
                role: Role::Detector,
                threads: experiment.threads,
                start,
            });
        }
        contenders
    }

    /// A row of this scene and detector without a measurement.
    fn blank(&self, contender: &Contender, scene: &AnyScene<'_>, stats: &Stats) -> Row {
        Row {
            experiment: self.experiment.name.clone(),
            scene: self.spec.name.clone(),
            params: self.spec.params.clone(),
            dim: scene.dim() as u32,
            n: scene.len() as u64,
            seed: self.spec.seed,
            order: match self.spec.order {
                Order::Shuffled => "shuffled",
                Order::Generated => "generated",
                Order::Morton => "morton",
            }
            .into(),
            detector: contender.name.clone(),
            arithmetic: contender.arithmetic.unwrap_or_default().name().into(),
            threads: contender.threads as u32,
            pass: Pass::Count,
            block: 0,
            time_ns: None,
            calls: None,
            elapsed_ns: None,
            outcome: Outcome::Ok,
            reason: String::new(),
            contacts: None,
            digest: None,
            counts: BTreeMap::new(),
            peak_bytes: None,
            live_bytes: None,
            allocations: None,
            warm_allocations: None,
            formula_bytes: None,
            errors: None,
            causes: None,
            stats: stats.clone(),
        }
    }

    /// True if the record says that this cell ended badly. Rows that the killed run still owed are written now.
    fn give_up(&mut self, blank: &Row) -> anyhow::Result<bool> {
        let Some(last) = self.index.ended(blank) else { return Ok(false) };
        for &pass in owed(last.pass) {
            let row = Row { pass, outcome: last.outcome, reason: last.reason.clone(), ..blank.clone() };
            if !self.index.has(&row) {
                self.record.write(&row)?;
            }
        }
        Ok(true)
    }

    /// True, with rows that say so, if the detector was too slow with fewer elements already.
    fn too_slow(&mut self, blank: &Row) -> anyhow::Result<bool> {
        let Some(n) = self.too_slow.at(blank) else { return Ok(false) };
        let reason = format!("not tried: over the time limit at N = {n} already");
        self.fail(blank, Failure { outcome: Outcome::Timeout, reason }, &Pass::ALL)?;
        Ok(true)
    }

    /// Starts a contender, loads the scene, counts and measures the memory. `None` if it is out; its rows say why.
    fn enter(&mut self, contender: Contender, mut blank: Row, load: &Request, truths: &mut Truths<'_>) -> anyhow::Result<Option<Racer>> {
        if self.too_slow(&blank)? {
            return Ok(None);
        }
        let mut runner = match Runner::start(&contender.start) {
            Ok(runner) => runner,
            Err(failure) => {
                self.fail(&blank, failure, &Pass::ALL)?;
                return Ok(None);
            }
        };
        let arithmetic = match contender.arithmetic {
            Some(arithmetic) => arithmetic,
            None => match Arithmetic::ALL.into_iter().find(|a| a.name() == runner.arithmetic) {
                Some(arithmetic) => arithmetic,
                None => {
                    let reason = format!("the runner says arithmetic '{}'; it must be one of {}", runner.arithmetic, Arithmetic::names());
                    self.fail(&blank, Failure { outcome: Outcome::Unavailable, reason }, &Pass::ALL)?;
                    return Ok(None);
                }
            },
        };
        // An external runner has just said which arithmetic its rows bear.
        blank.arithmetic = arithmetic.name().into();
        if self.give_up(&blank)? || self.too_slow(&blank)? {
            return Ok(None);
        }
        let answer = runner.ask(load).and_then(|reply| if reply == Reply::Loaded { Ok(()) } else { Err(astray(load, &reply)) });
        if let Err(failure) = answer {
            self.fail(&blank, failure, &Pass::ALL)?;
            return Ok(None);
        }
        let mut racer = Racer { contender, runner, arithmetic, blank };
        for (pass, request) in [(Pass::Count, Request::Count), (Pass::Memory, Request::Memory)] {
            let mut row = Row { pass, ..racer.blank.clone() };
            if self.index.has(&row) {
                continue;
            }
            let answer = racer.runner.ask(&request).and_then(|reply| match (pass, &reply) {
                (Pass::Count, Reply::Count { .. }) | (Pass::Memory, Reply::Memory { .. }) | (_, Reply::Unsupported) => Ok(reply),
                _ => Err(astray(&request, &reply)),
            });
            match answer {
                Ok(Reply::Count { counts, contacts, digest }) => {
                    row.counts = counts;
                    (row.contacts, row.digest) = (Some(contacts), Some(digest));
                }
                Ok(Reply::Memory { peak_bytes, live_bytes, allocations, warm_allocations, formula_bytes, contacts, digest }) => {
                    (row.peak_bytes, row.live_bytes, row.allocations) = (Some(peak_bytes), Some(live_bytes), Some(allocations));
                    (row.warm_allocations, row.formula_bytes) = (warm_allocations, formula_bytes);
                    (row.contacts, row.digest) = (Some(contacts), Some(digest));
                }
                // The only other reply let through above.
                Ok(_) => row.reason = "the runner does not measure this".into(),
                Err(failure) => {
                    self.fail(&racer.blank, failure, rest(pass))?;
                    return Ok(None);
                }
            }
            self.judge(&mut row, &mut racer, truths)?;
            self.record.write(&row)?;
        }
        Ok(Some(racer))
    }

    /// One timed sample. False if the contender is out.
    fn sample(&mut self, racer: &mut Racer, mut row: Row, truths: &mut Truths<'_>) -> anyhow::Result<bool> {
        let request = Request::Sample { min_ns: SHORTEST_SAMPLE_NS };
        let failure = match racer.runner.ask(&request) {
            Ok(Reply::Sample { time_ns, calls, elapsed_ns, contacts, digest }) => {
                (row.time_ns, row.calls, row.elapsed_ns) = (Some(time_ns), Some(calls), Some(elapsed_ns));
                (row.contacts, row.digest) = (Some(contacts), Some(digest));
                self.judge(&mut row, racer, truths)?;
                self.record.write(&row)?;
                return Ok(true);
            }
            Ok(other) => astray(&request, &other),
            Err(failure) => failure,
        };
        self.fail(&row, failure, rest(Pass::Time))?;
        Ok(false)
    }

    /// Holds a row's answer to the truth before it is written.
    fn judge(&mut self, row: &mut Row, racer: &mut Racer, truths: &mut Truths<'_>) -> anyhow::Result<()> {
        if racer.contender.role == Role::Nothing {
            row.outcome = Outcome::Control;
            row.reason = "control: reports nothing by design".into();
            return Ok(());
        }
        let (Some(contacts), Some(digest)) = (row.contacts, row.digest.as_deref()) else { return Ok(()) };
        let Some(expected) = truths.get(racer.arithmetic)?.map(|truth| truth.digest) else {
            // No time without an answer that is known to be right.
            row.outcome = Outcome::Refused;
            row.reason =
                "the answer cannot be checked: fewer than two detectors take this scene, and it is too large to test all pairs".into();
            row.time_ns = None;
            return Ok(());
        };
        // A fingerprint that is no number is not the right one.
        let sum = u64::from_str_radix(digest.trim_start_matches("0x"), 16).unwrap_or(!expected.sum);
        let answer = Digest { contacts, sum };
        let path = self.folder.join("pairs.npy");
        let fetch = || {
            // What another runner wrote there is not this one's answer; mostly there is nothing to remove.
            let _ = std::fs::remove_file(&path);
            racer.runner.ask(&Request::Pairs { path: path.clone() }).map_err(|failure| failure.reason)?;
            bake::read_pairs(&path).map_err(|e| e.to_string())
        };
        let errors = truths.errors(racer.arithmetic, answer, fetch)?;
        if let Ok(Some((errors, causes))) = errors {
            (row.errors, row.causes) = (Some(errors), Some(causes));
        }
        if answer == expected {
            return Ok(());
        }
        row.outcome = Outcome::Wrong;
        match errors {
            Ok(Some((_, Causes { algorithm, .. }))) => {
                let only_missed = algorithm.wrong() == algorithm.missed;
                if only_missed && !racer.arithmetic.is_safe() {
                    row.outcome = Outcome::Lossy;
                }
                row.reason = format!("against all pairs tested in {}: {algorithm}", racer.arithmetic.name());
            }
            Ok(None) => row.reason = "the pairs differ from the truth".into(),
            Err(reason) => row.reason = format!("the pairs differ from the truth, and could not be read: {reason}"),
        }
        if row.outcome == Outcome::Wrong {
            let scene = describe(self.experiment, self.spec);
            self.progress.note(&format!("WRONG: {} ({}) on {scene}: {}", row.detector, row.arithmetic, row.reason));
        }
        Ok(())
    }

    fn fail(&mut self, blank: &Row, failure: Failure, passes: &[Pass]) -> anyhow::Result<()> {
        if failure.outcome == Outcome::Timeout {
            self.too_slow.note(blank);
        }
        if failure.outcome == Outcome::Crashed {
            self.progress.note(&format!("CRASHED: {} on {}: {}", blank.detector, describe(self.experiment, self.spec), failure.reason));
        }
        for &pass in passes {
            let row = Row { pass, outcome: failure.outcome, reason: failure.reason.clone(), ..blank.clone() };
            if !self.index.has(&row) {
                self.record.write(&row)?;
            }
        }
        Ok(())
    }
}
