//! The race: detectors that are much slower drop out early, and the others are timed in blocks
//! until the time is over.
//!
//! * Probes take up to half of the time. Each detector is started, loads the scene, and takes one
//!   sample, whose answer is judged. A probe may take `PATIENCE` times as long as the fastest, but
//!   at most a third of the time left for probes. For detectors that are not hopelessly slow,
//!   memory is measured.
//! * In each block, each detector takes one sample, in random order; the fastest takes another one
//!   as its own twin. Each sample has a new process; a block's processes run on one processor.
//! * Before each block, slow detectors drop out (`drop_slow`).

use std::time::{Duration, Instant};

use crate::recommend::subject::{HOPELESS, Race, RacedSubject, drop_slow};
use crate::run::judge::Said;
use crate::run::machine::load::Watch;
use crate::run::machine::{processors, temporary};
use crate::run::runner::client::{Client, Failure, Start};
use crate::run::stage::bench::{self, Bench, sample};
use crate::run::stage::passes::{SHORTEST_SAMPLE_NS, measure};
use crate::run::subject;
use anyhow::bail;
use contactbench_detectors::table::{Entry, Role, TABLE};
use contactbench_ground::contact::Arithmetic;
use contactbench_io::Given;
use contactbench_record::findings::trust::conditions::disturbance;
use contactbench_record::record::row::{Outcome, Pass, Row};
use contactbench_record::stats::interval::ratio;
use contactbench_terms::number::plural;

/// A probe may take this multiple of the fastest probe's time.
const PATIENCE: u32 = 20;
/// Number of blocks that an interval of 95% needs.
pub(super) const FEWEST: u32 = 6;
/// Maximum number of blocks; more would hardly narrow the interval.
const MOST: u32 = 51;
/// Multiple of its time that the race may take to reach [`FEWEST`] blocks.
const BEYOND: f64 = 1.5;
/// Minimum time limit of a probe, because starting a process takes time.
const SHORTEST_PROBE: Duration = Duration::from_millis(100);
pub struct Question<'a> {
    pub given: &'a Given,
    /// Scenes that every detector processes first, as in some hard cases.
    pub history: &'a [Given],
    pub arithmetic: Arithmetic,
    pub threads: usize,
    /// Maximum size of a detector's arrays, in bytes.
    pub memory_limit: u64,
    pub time: Duration,
    /// This program with the first arguments of the command that starts a runner.
    pub program: Vec<String>,
}

pub fn run(question: &Question<'_>, note: &mut dyn FnMut(&str)) -> anyhow::Result<Race> {
    let folder = temporary()?;
    note("finding the true pairs");
    let Question { given, history, arithmetic, memory_limit, .. } = *question;
    let mut bench = Bench::at_rest(given, history, folder.path(), memory_limit)?;
    let (count, nothing) = bench.judge.count(arithmetic)?;
    if let Some(nothing) = nothing {
        if nothing.hopeless {
            bail!("{}", nothing.reason);
        }
        bail!(
            "in {} arithmetic no answer could be checked: {}; choose another with --arithmetic",
            arithmetic.name(),
            nothing.reason
        );
    }
    let contacts = count.first;
    let mut entries: Vec<_> = TABLE.iter().filter(|entry| entry.role == Role::Detector).collect();
    // Detectors that are usually fast come first, so that probes of slow ones can be cut short.
    entries.sort_by_key(|entry| entry.speed);
    let room = subject::room(given.scene.len() as u64, contacts);
    let mut ground = Ground { question, bench, room, started: Instant::now() };
    let mut subjects = ground.probe_all(entries, note)?;
    let active = subjects.iter().filter(|subject| subject.active);
    let original = active.min_by_key(|subject| subject.probe_ns);
    // The twin has the limits that its original was given after the probe.
    let twin = original.map(RacedSubject::twin);
    subjects.extend(twin);
    let watch = Watch::start();
    let (blocks, mut subjects) = ground.blocks(subjects, note)?;
    let disturbed = watch.and_then(|watch| disturbance(&watch.end(String::new())?));
    let twin = subjects.extract_if(.., |subject| subject.is_twin).next();
    subjects.sort_by_key(|subject| TABLE.iter().position(|entry| entry.name == subject.entry.name));
    let twin = twin.and_then(|twin| {
        let original = subjects.iter().find(|it| it.entry.name == twin.entry.name)?;
        ratio(&twin.times, &original.times).filter(|ratio| ratio.count > 1)
    });
    Ok(Race { subjects, contacts, blocks, twin, disturbed })
}

struct Ground<'a> {
    question: &'a Question<'a>,
    bench: Bench<'a>,
    /// Memory for the scene and its pairs, in bytes.
    room: u64,
    started: Instant,
}

impl Ground<'_> {
    fn left(&self, share: f64) -> Duration {
        self.question.time.mul_f64(share).saturating_sub(self.started.elapsed())
    }

    fn probe_all(
        &mut self,
        entries: Vec<&'static Entry>,
        note: &mut dyn FnMut(&str),
    ) -> anyhow::Result<Vec<RacedSubject>> {
        let mut subjects: Vec<RacedSubject> = Vec::new();
        let mut shortest: Option<Duration> = None;
        for entry in entries {
            note(&format!("probing {}", entry.name));
            let mut subject = self.entered(entry);
            // The first probe may use the whole time, later probes what is left of its first half.
            let left = self.left(if shortest.is_none() { 1.0 } else { 0.5 });
            if left.is_zero() {
                let reason = "not tried: time was up (--seconds)".into();
                subject.fail(Failure { outcome: Outcome::Unavailable, reason });
            } else {
                // A slow probe must not use up the time of those that follow.
                let patience =
                    shortest.map_or(left, |shortest| (shortest * PATIENCE).min(left / 3));
                let best = subjects.iter().filter_map(|subject| subject.probe_ns).min();
                let took = self.probe(&mut subject, patience.max(SHORTEST_PROBE), best)?;
                shortest = shortest.into_iter().chain(took).min();
            }
            subjects.push(subject);
        }
        drop_slow(&mut subjects);
        Ok(subjects)
    }

    fn entered(&self, entry: &'static Entry) -> RacedSubject {
        let Question { ref program, arithmetic, memory_limit: limit, time, .. } = *self.question;
        let threads = if entry.threads { self.question.threads } else { 1 };
        let command = subject::own(program, entry.name, arithmetic, threads, limit);
        let room = subject::address_space(limit, threads).saturating_add(self.room);
        RacedSubject::new(entry, threads, Start::of(&command, time.max(SHORTEST_PROBE), room))
    }

    /// Starts a detector, takes a first sample and, unless another detector is much faster,
    /// measures memory. Returns the time that this took, or `None` if the detector is out.
    fn probe(
        &mut self,
        subject: &mut RacedSubject,
        patience: Duration,
        best: Option<u64>,
    ) -> anyhow::Result<Option<Duration>> {
        let started = Instant::now();
        subject.start.time_limit = patience;
        let Some((time, mut client)) = self.sample(subject, None)? else {
            if subject.row.outcome == Outcome::Timeout {
                let seconds = patience.as_secs_f64();
                subject.row.reason = format!("no answer after {seconds:.1} s; give more --seconds");
            }
            return Ok(None);
        };
        let took = started.elapsed();
        // The time limit of later requests is derived from the time of the probe.
        subject.start.time_limit = took * PATIENCE + Duration::from_secs(5);
        client.time_limit = subject.start.time_limit;
        subject.probe_ns = Some(time);
        let hopeless = best.is_some_and(|best| time as f64 > HOPELESS * best as f64);
        if !hopeless {
            let mut row = Row { pass: Pass::Memory, ..subject.row.clone() };
            match measure(&mut client, &mut row) {
                Ok(_) => subject.row = row,
                Err(failure) => subject.fail(failure),
            }
        }
        Ok(Some(took).filter(|_| subject.active))
    }

    /// Takes one judged sample in a new process. Returns nanoseconds per detection and the process,
    /// or `None` if the detector is out.
    fn sample(
        &mut self,
        subject: &mut RacedSubject,
        processor: Option<usize>,
    ) -> anyhow::Result<Option<(u64, Client)>> {
        let client = self.bench.fresh(&subject.start, None, processor);
        let answer =
            client.and_then(|mut client| Ok((sample(&mut client, SHORTEST_SAMPLE_NS)?, client)));
        let (sample, mut client) = match answer {
            Ok(answer) => answer,
            Err(failure) => {
                subject.fail(failure);
                return Ok(None);
            }
        };
        let arithmetic = self.question.arithmetic;
        let said = Said { arithmetic, may_miss: false, found: &sample.found };
        let (judged, _) = self.bench.judge(subject.entry.name, said, &mut client)?;
        subject.row.errors = judged.errors;
        if judged.outcome.is_good() {
            subject.row.outcome = judged.outcome;
            return Ok(Some((sample.time_ns, client)));
        }
        subject.fail(Failure { outcome: judged.outcome, reason: judged.reason });
        Ok(None)
    }

    /// Times all subjects in blocks; returns the number of blocks, and the subjects in any order.
    fn blocks(
        &mut self,
        subjects: Vec<RacedSubject>,
        note: &mut dyn FnMut(&str),
    ) -> anyhow::Result<(u32, Vec<RacedSubject>)> {
        let (time, started) = (self.question.time, self.started);
        let in_time = |block, subjects: &mut Vec<RacedSubject>| {
            drop_slow(subjects);
            let active = subjects.iter().filter(|subject| subject.active && !subject.is_twin);
            note(&format!("block {block}: {}", plural(active.count(), "detector")));
            let share = if block <= FEWEST { BEYOND } else { 1.0 };
            block == 1 || started.elapsed() < time.mul_f64(share)
        };
        bench::race(subjects, MOST, 0, in_time, |block, mut subject| {
            let processor = processors::in_block(block).filter(|_| subject.threads == 1);
            if subject.active
                && let Some((time, _)) = self.sample(&mut subject, processor)?
            {
                subject.times.insert(block.into(), time);
            }
            Ok(Some(subject))
        })
    }
}
