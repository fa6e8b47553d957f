//! Runs experiments: scenes are made, the truth is found, runners are started, rows are written.
//!
//! For each scene: one runner per (detector, arithmetic) loads it; then each counts, and measures its memory; then blocks of timed
//! samples, every detector once per block in a fresh random order, and right after one with several threads its copies, if the
//! experiment asks for them. Rows go to the record one by one. What the record
//! holds already (of a killed run) is not measured again.

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::Context;
use rand::{SeedableRng, seq::SliceRandom};
use rand_chacha::ChaCha8Rng;
use tempfile::TempDir;

use super::bake;
use super::child::{Failure, Runner};
use super::contender::{Contender, contenders};
use super::experiment::Experiment;
use super::index::{Index, TooSlow, owed, rest};
use super::interrupt;
use super::plan;
use super::protocol::{Reply, Request};
use super::record::{Causes, Outcome, Pass, Row, Stats, Writer};
use super::shard::Shard;
use super::truths::Truths;
use crate::contact::Arithmetic;
use crate::detect::table::Role;
use crate::scene::generate::hard;
use crate::scene::spec::Spec;
use crate::scene::{SceneError, stats};
use crate::sink::{Digest, splitmix64};

/// Samples are at least this long, or the clock would be measured.
pub(crate) const SHORTEST_SAMPLE_NS: u64 = 1_000_000;
/// Blocks done before the budget can end a scene: the range of six values covers the median in 96.9% of samples.
pub(super) const FEWEST_BLOCKS: u32 = 6;
/// Blocks of a quick run.
pub(super) const QUICK_BLOCKS: u32 = 3;

/// What is to be run, and where to.
pub struct Job<'a> {
    /// The experiments, in order.
    pub experiments: &'a [Experiment],
    /// Small scenes and few blocks.
    pub quick: bool,
    /// The program to start as runner: this one.
    pub program: PathBuf,
    /// Only a part of the scenes.
    pub shard: Option<Shard>,
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

/// A job that can begin.
pub struct Ready<'a> {
    job: &'a Job<'a>,
    scenes: Vec<(&'a Experiment, Spec)>,
    temporary: TempDir,
}

/// Plans a job, and says what can be known to go wrong before anything is measured.
pub fn prepare<'a>(job: &'a Job<'a>) -> anyhow::Result<Ready<'a>> {
    let scenes = plan::plan(job)?;
    let temporary = tempfile::tempdir().context("cannot make a temporary folder for scenes; set TMPDIR to a writable place")?;
    Ok(Ready { job, scenes, temporary })
}

impl Ready<'_> {
    /// How many scenes there are: a shard may have none.
    pub fn scenes(&self) -> usize {
        self.scenes.len()
    }

    /// An error unless files can be written into the result folder, and there is room for what will be.
    pub fn room(&self, folder: &Path) -> anyhow::Result<()> {
        plan::room(self.job, &self.scenes, folder, self.temporary.path())
    }

    /// Runs the experiments into a record.
    pub fn run(&self, record: &mut Writer, progress: &mut dyn Progress) -> anyhow::Result<()> {
        let (job, folder, total) = (self.job, self.temporary.path(), self.scenes.len());
        let index = Index::new(job.done);
        let mut too_slow = TooSlow::new(job.done);
        for (k, (experiment, spec)) in self.scenes.iter().enumerate() {
            progress.scene(k, total, &describe(experiment, spec));
            let mut stage = Stage { job, experiment, spec, index: &index, folder, record, too_slow: &mut too_slow, progress };
            stage.run().with_context(|| format!("in experiment {}, scene {}", experiment.name, describe(experiment, spec)))?;
        }
        progress.scene(total, total, "done");
        Ok(())
    }
}

pub(super) fn describe(experiment: &Experiment, spec: &Spec) -> String {
    let n = if spec.n == 0 { String::new() } else { format!(" N={}", spec.n) };
    let swept = spec
        .params
        .iter()
        .filter(|(name, _)| matches!(name.as_str(), "s" | "path" | "case" | "offset" | "diameter"))
        .map(|(name, value)| format!(" {name}={value}"));
    format!("{}: {} {}D{n}{}", experiment.name, spec.name, spec.dim, swept.collect::<String>())
}

/// Gives a runner the steps of a scene, one after the other.
pub(crate) fn load_all(runner: &mut Runner, loads: &[Request]) -> Result<(), Failure> {
    for (k, load) in loads.iter().enumerate() {
        let last = k + 1 == loads.len();
        let answer = runner.ask(load).and_then(|reply| if reply == Reply::Loaded { Ok(()) } else { Err(astray(load, &reply)) });
        // What a detector makes of the steps before the last is not judged; only, they are to leave their traces.
        let answer = if last { answer } else { answer.and_then(|()| runner.ask(&Request::Sample { min_ns: 1 }).map(|_| ())) };
        match answer {
            Err(failure) if failure.outcome != Outcome::Refused || last => return Err(failure),
            _ => {}
        }
    }
    Ok(())
}

/// An answer that does not belong to the request.
pub(crate) fn astray(request: &Request, reply: &Reply) -> Failure {
    // The variant's name alone: what else there is holds paths that differ from run to run.
    let word = |text: String| text.split(' ').next().unwrap_or_default().to_string();
    let reason = format!("the runner answered {} with {}", word(format!("{request:?}")), word(format!("{reply:?}")));
    Failure { outcome: Outcome::Crashed, reason }
}

/// One scene of one experiment.
pub(super) struct Stage<'a> {
    job: &'a Job<'a>,
    experiment: &'a Experiment,
    spec: &'a Spec,
    pub index: &'a Index,
    folder: &'a Path,
    record: &'a mut Writer,
    pub too_slow: &'a mut TooSlow,
    progress: &'a mut dyn Progress,
}

/// A contender that is still in the race on this scene.
pub(super) struct Racer {
    pub contender: Contender,
    pub runner: Runner,
    pub arithmetic: Arithmetic,
    pub blank: Row,
    /// With one thread each; none if the ceiling is not asked for.
    pub copies: Vec<Racer>,
}

impl Stage<'_> {
    fn run(&mut self) -> anyhow::Result<()> {
        let blocks = if self.job.quick { self.experiment.blocks.min(QUICK_BLOCKS) } else { self.experiment.blocks };
        let contenders = contenders(self.experiment, &self.job.program);
        let scene = match self.spec.make() {
            Ok(scene) => scene,
            Err(error) => return self.invalid(&contenders, error),
        };
        interrupt::check()?;
        let blank = |contender: &Contender, stats: &Stats| contender.blank(self.experiment, self.spec, Some(&scene), stats);
        if let Some(one) = contenders.first() {
            let before = self.index.scene_hash(&blank(one, &Stats::default()));
            // Only where the record has rows of it: fingerprints of large scenes take a while.
            if before.is_some() {
                plan::same_scene(&stats::scene_hash(&scene), before)?;
            }
        }
        if contenders.iter().all(|contender| self.complete(contender, &blank(contender, &Stats::default()), blocks)) {
            return Ok(());
        }
        let mut truths = Truths::new(&scene);
        let contacts = truths.get(Arithmetic::Exact)?.map_or(0, |truth| truth.digest.contacts);
        let stats = stats::stats(&scene, contacts);
        let mut loads = Vec::new();
        for (k, scene) in self.spec.history()?.iter().chain([&scene]).enumerate() {
            loads.push(bake::load(&self.folder.join(format!("scene-{k}.npy")), scene)?);
        }
        let contenders: Vec<Contender> = contenders.into_iter().map(|contender| contender.allowing(&scene, contacts)).collect();
        let blanks: Vec<Row> = contenders.iter().map(|contender| blank(contender, &stats)).collect();
        let mut racers = Vec::new();
        for (contender, blank) in contenders.into_iter().zip(blanks) {
            if self.give_up(&blank)? {
                continue;
            }
            if let Some(racer) = self.enter(contender, blank, &loads, &mut truths)? {
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
                    self.ceiling(&mut racer, block, &mut truths)?;
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
        let beside = |block| contender.copy.is_none() || self.no_ceiling(blank) || has(Pass::Ceiling, block);
        let over = self.index.ended(blank).is_some_and(|last| owed(last.pass).iter().all(|&pass| has(pass, 0)));
        contender.arithmetic.is_some()
            && (over || has(Pass::Count, 0) && has(Pass::Memory, 0) && (1..=enough).all(|block| has(Pass::Time, block) && beside(block)))
    }

    /// The rows of a case of the catalogue whose scene is not valid, as it should be. Any other scene that cannot be made is an error.
    fn invalid(&mut self, contenders: &[Contender], error: anyhow::Error) -> anyhow::Result<()> {
        let Some(invalid) = error.chain().find_map(|cause| cause.downcast_ref::<SceneError>()).filter(|_| self.spec.name == hard::NAME)
        else {
            return Err(error);
        };
        for contender in contenders {
            let blank = contender.blank(self.experiment, self.spec, None, &Stats::default());
            self.fail(&blank, Failure { outcome: Outcome::Refused, reason: format!("invalid scene: {invalid}") }, &[Pass::Count])?;
        }
        Ok(())
    }

    /// True if the record says that this cell ended badly. Rows that the killed run still owed are written now.
    fn give_up(&mut self, blank: &Row) -> anyhow::Result<bool> {
        let Some(last) = self.index.ended(blank) else { return Ok(false) };
        for &pass in owed(last.pass) {
            let row = Row { pass, outcome: last.outcome, reason: last.reason.clone(), ..blank.clone() };
            if !self.index.has(&row) {
                self.write(&row)?;
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
    fn enter(&mut self, contender: Contender, mut blank: Row, loads: &[Request], truths: &mut Truths<'_>) -> anyhow::Result<Option<Racer>> {
        if self.too_slow(&blank)? {
            return Ok(None);
        }
        let missing = contender.missing.clone().map(|reason| Failure { outcome: Outcome::Unavailable, reason });
        let mut runner = match missing.map_or_else(|| Runner::start(&contender.start), Err) {
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
        if let Err(failure) = load_all(&mut runner, loads) {
            self.fail(&blank, failure, &Pass::ALL)?;
            return Ok(None);
        }
        let mut racer = Racer { contender, runner, arithmetic, blank, copies: Vec::new() };
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
            self.write(&row)?;
        }
        self.start_copies(&mut racer, loads)?;
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
                self.write(&row)?;
                return Ok(true);
            }
            Ok(other) => astray(&request, &other),
            Err(failure) => failure,
        };
        self.fail(&row, failure, rest(Pass::Time))?;
        Ok(false)
    }

    /// Holds a row's answer to the truth before it is written.
    pub fn judge(&mut self, row: &mut Row, racer: &mut Racer, truths: &mut Truths<'_>) -> anyhow::Result<()> {
        if racer.contender.role == Role::Nothing {
            row.outcome = Outcome::Control;
            row.reason = "control: reports nothing by design".into();
            return Ok(());
        }
        let (Some(contacts), Some(digest)) = (row.contacts, row.digest.as_deref()) else { return Ok(()) };
        let Some(expected) = truths.get(racer.arithmetic)?.map(|truth| truth.digest) else {
            // No time without an answer that is known to be right.
            row.outcome = Outcome::Refused;
            row.reason = format!("the answer cannot be checked: {}", truths.why_none(racer.arithmetic));
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
        let errors = truths.errors(racer.arithmetic, &racer.contender.name, answer, fetch)?;
        interrupt::check()?;
        if let Ok(Some((errors, causes))) = errors {
            (row.errors, row.causes) = (Some(errors), Some(causes));
        }
        if answer == expected {
            return Ok(());
        }
        row.outcome = Outcome::Wrong;
        match errors {
            Ok(Some((_, Causes { algorithm, .. }))) => {
                let only_missed = algorithm.missed > 0 && algorithm.wrong() == algorithm.missed;
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

    /// Writes a row; after a signal none, because a runner may have been stopped in the midst of it.
    pub fn write(&mut self, row: &Row) -> anyhow::Result<()> {
        interrupt::check()?;
        Ok(self.record.write(row)?)
    }

    pub fn fail(&mut self, blank: &Row, failure: Failure, passes: &[Pass]) -> anyhow::Result<()> {
        interrupt::check()?;
        if failure.outcome == Outcome::Timeout {
            self.too_slow.note(blank);
        }
        if failure.outcome == Outcome::Crashed {
            self.progress.note(&format!("CRASHED: {} on {}: {}", blank.detector, describe(self.experiment, self.spec), failure.reason));
        }
        for &pass in passes {
            let row = Row { pass, outcome: failure.outcome, reason: failure.reason.clone(), ..blank.clone() };
            if !self.index.has(&row) {
                self.write(&row)?;
            }
        }
        Ok(())
    }
}
