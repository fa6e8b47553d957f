//! What a machine lets several threads gain: as many copies of a detector as it has threads, with
//! one thread each, at work on the same scene at the same time.
//!
//! Copies share nothing but the machine: caches, memory, clock, and the cores that it really gives.
//! Each has a process and a processor of its own. What they lose beside each other no parallel form
//! of the same algorithm can win back. One row per block: the harmonic mean of their times at work
//! together, so that k copies at `time_ns` each have the throughput that was measured; and, by the
//! same path with samples of the same length, that of each of them alone on its processor. One copy
//! timed elsewhere made ceilings of k copies that were beyond k.

use std::sync::Barrier;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::run::client::{Client, Failure, Start};
use crate::run::judge::Judge;
use crate::run::passes::{Running, fresh, sample, say};
use crate::run::processors;
use crate::run::protocol::Sample;
use crate::run::stage::Stage;
use contactbench_record::record::row::{Outcome, Pass, Row};

/// Longer than other samples: between two of its own a copy is idle for some tens of microseconds,
/// in which its neighbours are not disturbed.
const SAMPLE_NS: u64 = 10_000_000;

impl Stage<'_, '_> {
    /// The record says that the copies of this detector failed on this scene.
    pub fn no_ceiling(&self, blank: &Row) -> bool {
        self.index.ended(&Row { pass: Pass::Ceiling, ..blank.clone() }).is_some()
    }

    /// How the copies of a detector are started, if they are asked for; a row says so if they are
    /// not tried.
    pub fn copy(&mut self, running: &Running) -> anyhow::Result<Option<Start>> {
        let blank = Row { pass: Pass::Ceiling, ..running.blank.clone() };
        let Some(start) = running.contender.copy.clone().filter(|_| !self.no_ceiling(&blank))
        else {
            return Ok(None);
        };
        if let Some(n) = self.log.too_slow.at(&blank) {
            let reason = format!("copies not tried: over the time limit at N = {n} already");
            let failure = Failure { outcome: Outcome::Timeout, reason };
            self.fail(&blank, failure, Pass::Ceiling.rest())?;
            return Ok(None);
        }
        Ok(Some(start))
    }

    /// One sample of all copies of a detector at once, if it has any. They are given up after a
    /// failure, the detector is not.
    pub fn ceiling(
        &mut self,
        running: &mut Running,
        block: u32,
        judge: &mut Judge<'_>,
    ) -> anyhow::Result<()> {
        let mut row = Row { pass: Pass::Ceiling, block, ..running.blank.clone() };
        let Some(start) = running.copy.as_ref().filter(|_| !self.index.has(&row)) else {
            return Ok(());
        };
        let answers = processors::apart(running.contender.threads)
            .into_iter()
            .map(|place| fresh(start, Some(&running.hello), &running.loads, place))
            .collect::<Result<Vec<Client>, Failure>>()
            .and_then(|mut copies| {
                // What comes first in one block comes last in the next.
                let (alone, answers) = if block.is_multiple_of(2) {
                    (each_alone(&mut copies)?, together(&mut copies)?)
                } else {
                    let answers = together(&mut copies)?;
                    (each_alone(&mut copies)?, answers)
                };
                Ok((alone, answers, copies))
            });
        let (alone, answers, mut copies) = match answers {
            Ok(answers) => answers,
            Err(failure) => {
                running.copy = None;
                // The first of all says that there are none.
                let row = if block == 1 { Row { block: 0, ..row } } else { row };
                return self.fail(&row, copies_failed(failure), Pass::Ceiling.rest());
            }
        };
        if let Some(copy) = copies.first() {
            row.process = self.log.origins.process(&running.contender, copy)?;
        }
        row.time_ns = Some(harmonic_mean(&answers));
        row.alone_ns = Some(harmonic_mean(&alone));
        row.calls = Some(answers.iter().map(|answer| answer.calls).sum());
        row.elapsed_ns = answers.iter().map(|answer| answer.elapsed_ns).max();
        for (copy, answer) in copies.iter_mut().zip(answers) {
            // The first wrong answer speaks for all.
            if row.outcome.is_good() {
                say(&mut row, &answer.found);
                self.judge(&mut row, running, copy, judge, &answer.found)?;
            }
        }
        self.write(&row)?;
        Ok(())
    }
}

fn harmonic_mean(samples: &[Sample]) -> u64 {
    let rate: f64 = samples.iter().map(|sample| 1.0 / sample.time_ns.max(1) as f64).sum();
    (samples.len() as f64 / rate).round() as u64
}

/// A sample of each copy while the others wait.
fn each_alone(copies: &mut [Client]) -> Result<Vec<Sample>, Failure> {
    let mut samples = Vec::new();
    for copy in copies.chunks_mut(1) {
        samples.extend(together(copy)?);
    }
    Ok(samples)
}

fn copies_failed(failure: Failure) -> Failure {
    Failure { reason: format!("of the copies: {}", failure.reason), ..failure }
}

/// One sample of each copy, begun together. A copy that has answered goes on detecting until all
/// have: no clock runs beside an idle neighbour.
fn together(copies: &mut [Client]) -> Result<Vec<Sample>, Failure> {
    let (start, answered, all) = (Barrier::new(copies.len()), AtomicUsize::new(0), copies.len());
    let work = |copy: &mut Client| {
        start.wait();
        let first = sample(copy, SAMPLE_NS);
        // One that failed counts as well, or the others would wait for it.
        let mut done = answered.fetch_add(1, Ordering::Relaxed) + 1;
        while first.is_ok() && done < all {
            if sample(copy, SAMPLE_NS).is_err() {
                // The sample that counts is complete.
                break;
            }
            done = answered.load(Ordering::Relaxed);
        }
        first
    };
    std::thread::scope(|scope| {
        let threads: Vec<_> = copies.iter_mut().map(|copy| scope.spawn(|| work(copy))).collect();
        let failed = || Failure {
            outcome: Outcome::Crashed,
            reason: "the harness lost the thread that asked".into(),
        };
        threads.into_iter().map(|thread| thread.join().unwrap_or_else(|_| Err(failed()))).collect()
    })
}
