//! One scene of an experiment: makes the scene, finds its truth, starts subjects, and writes rows.
//!
//! Each runner loads the scene, counts operations, and measures memory. Then come blocks of timed
//! samples: every subject once per block, in random order and in a new process. If the experiment
//! requests it, copies of a subject with several threads follow. Rows already in the record are not
//! measured again.

pub(crate) mod bench;
mod block;
mod copies;
pub(crate) mod passes;

use std::collections::BTreeSet;
use std::path::Path;
use std::time::Instant;

use crate::plan::memory_limit;
use crate::run::machine::interrupt;
use crate::run::machine::load::Watch;
use crate::run::origins::Origins;
use crate::run::plan::{self, Job, describe};
use crate::run::runner::client::Failure;
use crate::run::stage::bench::{Bench, race};
use crate::run::stage::passes::Running;
use crate::run::subject::{Subject, subjects};
use crate::tracking::Moved;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::scene::SceneError;
use contactbench_io::Given;
use contactbench_record::cells::cells;
use contactbench_record::experiment::{Experiment, FEWEST_BLOCKS};
use contactbench_record::findings::winners::{Contest, winners};
use contactbench_record::record::folder::done::{Index, TooSlow};
use contactbench_record::record::folder::ledger::Span;
use contactbench_record::record::id::CellId;
use contactbench_record::record::row::{Outcome, Pass, Row, Writer};
use contactbench_scenes::generate::hard;
use contactbench_scenes::spec::Spec;
use contactbench_scenes::stats::{self, Stats};
use contactbench_terms::mix::splitmix64;

pub trait Progress {
    fn scene(&mut self, done: usize, total: usize, next: &str);
    /// Gets the fastest detector and the others of the scene that has just ended, and its contacts,
    /// each compared with the exact truth.
    fn found(&mut self, scene: &str, contest: &Contest, contacts: Option<u64>);
    fn note(&mut self, text: &str);
}

pub(crate) struct Stage<'a, 'l> {
    pub job: &'a Job,
    pub experiment: &'a Experiment,
    pub spec: &'a Spec,
    pub index: &'a Index,
    pub folder: &'a Path,
    pub log: &'a mut Log<'l>,
}

/// The outputs of a run, and what it keeps from scene to scene.
pub(crate) struct Log<'a> {
    pub record: Writer,
    pub origins: Origins,
    pub progress: &'a mut dyn Progress,
    pub too_slow: TooSlow,
    pub noted: BTreeSet<String>,
    pub span: Option<String>,
    /// The rows of this run on the present scene.
    pub latest: Vec<Row>,
}

impl Stage<'_, '_> {
    pub fn run(&mut self) -> anyhow::Result<()> {
        self.log.latest.clear();
        let blocks = self.experiment.all_blocks(self.job.quick);
        let subjects = subjects(self.experiment, &self.job.program, self.job.against.as_deref());
        let given = match self.spec.given() {
            Ok(given) => given,
            Err(error) => return self.invalid(&subjects, error),
        };
        interrupt::check()?;
        if self.is_complete(&subjects, &given)? {
            return Ok(());
        }
        self.note(&given);
        let limit = memory_limit(self.experiment);
        let mut moving = self.spec.frames(&given)?;
        let (folder, history) = (self.folder, self.spec.history()?);
        let (mut bench, moved) = match &mut moving {
            Some((frames, count)) => Bench::moving(frames, *count, folder, limit)?,
            None => (Bench::at_rest(&given, &history, folder, limit)?, None),
        };
        let running = self.enter_all(subjects, &given, moved, &mut bench)?;
        self.blocks(running, blocks, &mut bench)?;
        bench.remove();
        let cells = cells(&self.log.latest);
        if let Some(contest) = winners(&cells.iter().collect::<Vec<_>>()).contests.first() {
            let mut right = self.log.latest.iter().filter(|row| row.outcome == Outcome::Ok);
            let contacts = right.find_map(|row| row.contacts);
            let scene = describe(self.experiment, self.spec);
            self.log.progress.found(&scene, contest, contacts);
        }
        Ok(())
    }

    fn note(&mut self, given: &Given) {
        let path = self.spec.params.get("path").and_then(|path| path.as_str()).unwrap_or_default();
        for notice in &given.notices {
            let text = format!("{path}: {notice}");
            if self.log.noted.insert(text.clone()) {
                self.log.progress.note(&text);
            }
        }
    }

    fn enter_all(
        &mut self,
        subjects: Vec<Subject>,
        given: &Given,
        moved: Option<Moved>,
        bench: &mut Bench<'_>,
    ) -> anyhow::Result<Vec<Running>> {
        let (count, nothing) = bench.judge.count(Arithmetic::Exact)?;
        let hopeless = nothing.filter(|nothing| nothing.hopeless);
        let (scene, stats) = (&given.scene, stats::stats(given, count.first));
        let mut running = Vec::new();
        for subject in subjects {
            let subject = subject.allowing(scene, count.most);
            let blank = subject.blank(self.experiment, self.spec, Some(scene), &stats);
            let blank = Row { moved: moved.clone(), ..blank };
            if self.give_up(&blank)? {
                continue;
            }
            if let Some(nothing) = &hopeless {
                let reason = nothing.reason.clone();
                let failure = Failure { outcome: Outcome::Refused, reason };
                self.fail(&blank, failure, &Pass::ALL)?;
            } else {
                running.extend(self.enter(subject, blank, bench)?);
            }
        }
        Ok(running)
    }

    /// Takes timed samples until all blocks are done or their time is over, and records the
    /// machine's load.
    fn blocks(
        &mut self,
        running: Vec<Running>,
        blocks: u32,
        bench: &mut Bench<'_>,
    ) -> anyhow::Result<()> {
        let (watch, rows) = (Watch::start(), self.log.record.rows());
        self.log.span = watch.as_ref().map(|watch| watch.id.clone());
        let result = self.samples(running, blocks, bench);
        self.log.span = None;
        let span = watch.and_then(|watch| watch.end(describe(self.experiment, self.spec)));
        let rows = self.log.record.rows() - rows;
        if let Some(span) = span.filter(|_| rows > 0) {
            let noted = self.log.origins.span(Span { rows: Some(rows), ..span });
            return result.and(noted);
        }
        result
    }

    fn samples(
        &mut self,
        running: Vec<Running>,
        blocks: u32,
        bench: &mut Bench<'_>,
    ) -> anyhow::Result<()> {
        // The order differs between blocks and scenes, but is the same in every run.
        let seed = plan::seeding(self.experiment, self.spec)
            .bytes()
            .fold(self.spec.seed, |seed, byte| splitmix64(seed ^ u64::from(byte)));
        let (started, budget) = (Instant::now(), self.experiment.block_budget_s);
        let in_time = |block, _: &mut Vec<_>| {
            block <= FEWEST_BLOCKS || started.elapsed().as_secs_f64() <= budget
        };
        let mut warm = 0;
        race(block::entries(running), blocks, seed, in_time, |block, entry| {
            let mut entry = self.block(entry, block, &mut warm, bench)?;
            for one in &mut entry {
                self.ceiling(one, block, bench)?;
            }
            Ok(Some(entry).filter(|entry| !entry.is_empty()))
        })?;
        Ok(())
    }

    /// Returns whether the record has all rows of the subjects on this scene. Fails if the record
    /// has rows of a different scene.
    fn is_complete(&self, subjects: &[Subject], given: &Given) -> anyhow::Result<bool> {
        let blank = |subject: &Subject| {
            subject.blank(self.experiment, self.spec, Some(&given.scene), &Stats::default())
        };
        if let Some(one) = subjects.first() {
            let before = self.index.scene_hash(&blank(one));
            // Hashing is slow, so it is done only if the record has rows of the scene.
            if before.is_some() {
                plan::same_scene(&stats::hash(given), before)?;
            }
        }
        Ok(subjects.iter().all(|subject| self.complete(subject, &blank(subject))))
    }

    fn complete(&self, subject: &Subject, blank: &Row) -> bool {
        let has = |pass, block| self.index.has(&Row { pass, block, ..blank.clone() });
        // A time budget may have ended the blocks early. The arithmetic of a runner is unknown
        // before it is started, so its rows cannot be found.
        // A line that was deleted is measured again.
        let enough = self.experiment.enough_blocks(self.job.quick).max(self.index.blocks(blank));
        let ceiling =
            |block| subject.copy.is_none() || self.no_ceiling(blank) || has(Pass::Ceiling, block);
        let over = self
            .index
            .ended(blank)
            .is_some_and(|last| last.pass.owed().iter().all(|&pass| has(pass, 0)));
        subject.arithmetic.is_some()
            && (over
                || has(Pass::Count, 0)
                    && has(Pass::Memory, 0)
                    && (1..=enough).all(|block| has(Pass::Time, block) && ceiling(block)))
    }

    /// Writes rows for a hard case that is invalid by design. For any other invalid scene, returns
    /// the error.
    fn invalid(&mut self, subjects: &[Subject], error: anyhow::Error) -> anyhow::Result<()> {
        let Some(invalid) = error
            .chain()
            .find_map(|cause| cause.downcast_ref::<SceneError>())
            .filter(|_| self.spec.name == hard::NAME)
        else {
            return Err(error);
        };
        for subject in subjects {
            let blank = subject.blank(self.experiment, self.spec, None, &Stats::default());
            let reason = format!("invalid scene: {invalid}");
            self.fail(&blank, Failure { outcome: Outcome::Refused, reason }, &[Pass::Count])?;
        }
        Ok(())
    }

    /// Returns whether the record states that this cell failed. If so, writes the rows that a
    /// killed run has left out.
    pub fn give_up(&mut self, blank: &Row) -> anyhow::Result<bool> {
        let Some(last) = self.index.ended(blank) else { return Ok(false) };
        // The failed process is recorded as the origin of these rows, too.
        let blank = Row { process: last.process.clone(), ..blank.clone() };
        let failure = Failure { outcome: last.outcome, reason: last.reason.clone() };
        self.write_missing(&blank, &failure, last.pass.owed())?;
        Ok(true)
    }

    /// Whether the detector, or `what` of it, was too slow with fewer particles; if so, writes rows
    /// of these passes that state it.
    pub fn too_slow(&mut self, what: &str, blank: &Row, passes: &[Pass]) -> anyhow::Result<bool> {
        let Some(n) = self.log.too_slow.at(blank) else { return Ok(false) };
        let reason = format!("{what}not tried: over the time limit at N = {n} already");
        self.fail(blank, Failure { outcome: Outcome::Timeout, reason }, passes)?;
        Ok(true)
    }

    /// Writes a row, with the name of this machine. After a signal, no row is written, because a
    /// runner may have been interrupted.
    pub fn write(&mut self, row: &Row) -> anyhow::Result<()> {
        interrupt::check()?;
        let id = CellId { machine: Some(self.job.machine.clone()), ..row.id.clone() };
        let row = Row { id, span: self.log.span.clone(), ..row.clone() };
        self.log.record.write(&row)?;
        self.log.latest.push(row);
        Ok(())
    }

    pub fn fail(&mut self, blank: &Row, failure: Failure, passes: &[Pass]) -> anyhow::Result<()> {
        interrupt::check()?;
        if failure.outcome == Outcome::Timeout {
            self.log.too_slow.note(blank);
        }
        if failure.outcome == Outcome::Crashed {
            self.note_first("CRASHED", blank, &failure.reason);
        }
        self.write_missing(blank, &failure, passes)
    }

    /// Writes the rows of a failure that the record does not have yet.
    fn write_missing(
        &mut self,
        blank: &Row,
        failure: &Failure,
        passes: &[Pass],
    ) -> anyhow::Result<()> {
        for &pass in passes {
            let Failure { outcome, reason } = failure.clone();
            let row = Row { pass, outcome, reason, ..blank.clone() };
            if !self.index.has(&row) {
                self.write(&row)?;
            }
        }
        Ok(())
    }
}
