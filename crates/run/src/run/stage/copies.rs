//! Measures how much k threads can gain: k copies of a detector with one thread each, on the same
//! scene at the same time.
//!
//! Copies share only the machine: caches, memory, clock, and cores. Each copy has its own process
//! and processor. So no parallel form of the algorithm can avoid what the copies lose. Each block
//! has one row. Its time is the harmonic mean of the copies' times, so that k copies with this time
//! have the measured throughput. The row also has the time of each copy alone on its processor, in
//! samples of the same length. (A copy timed on another processor gave ceilings above k.)

use std::sync::Barrier;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::run::machine::processors;
use crate::run::runner::client::{Client, Failure, Start};
use crate::run::runner::protocol::Sample;
use crate::run::stage::Stage;
use crate::run::stage::bench::{Bench, sample};
use crate::run::stage::passes::{Running, say};
use contactbench_record::record::row::{Outcome, Pass, Row};

/// Length of a sample of a copy. It is longer than other samples, because a copy is idle for some
/// tens of microseconds between two samples, while the other copies run undisturbed.
const SAMPLE_NS: u64 = 10_000_000;

impl Stage<'_, '_> {
    /// Returns whether the record states that copies of this detector failed on this scene.
    pub fn no_ceiling(&self, blank: &Row) -> bool {
        self.index.ended(&Row { pass: Pass::Ceiling, ..blank.clone() }).is_some()
    }

    /// Returns the command of the copies, if requested. If they are too slow to try, writes a row.
    pub fn copy(&mut self, running: &Running) -> anyhow::Result<Option<Start>> {
        let blank = Row { pass: Pass::Ceiling, ..running.blank.clone() };
        let start = running.subject.copy.clone().filter(|_| !self.no_ceiling(&blank));
        if start.is_some() && self.too_slow("copies ", &blank, Pass::Ceiling.rest())? {
            return Ok(None);
        }
        Ok(start)
    }

    /// Takes one sample of all copies at once. After a failure, the copies are given up, but the
    /// detector is still timed.
    pub fn ceiling(
        &mut self,
        running: &mut Running,
        block: u32,
        bench: &mut Bench<'_>,
    ) -> anyhow::Result<()> {
        let mut row = Row { pass: Pass::Ceiling, block, ..running.blank.clone() };
        let Some(start) = running.subject.copy.as_ref().filter(|_| !self.index.has(&row)) else {
            return Ok(());
        };
        let answers = processors::apart(running.subject.threads)
            .into_iter()
            .map(|place| bench.fresh(start, Some(&running.hello), place))
            .collect::<Result<Vec<Client>, Failure>>()
            .and_then(|mut copies| {
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
                running.subject.copy = None;
                // After a failure in block 1, copies are not tried again.
                let row = if block == 1 { Row { block: 0, ..row } } else { row };
                let reason = format!("of the copies: {}", failure.reason);
                return self.fail(&row, Failure { reason, ..failure }, Pass::Ceiling.rest());
            }
        };
        if let Some(copy) = copies.first() {
            row.process = self.log.origins.process(&running.subject, copy)?;
        }
        row.time_ns = Some(harmonic_mean(&answers));
        row.alone_ns = Some(harmonic_mean(&alone));
        row.calls = Some(answers.iter().map(|answer| answer.calls).sum());
        row.elapsed_ns = answers.iter().map(|answer| answer.elapsed_ns).max();
        for (copy, answer) in copies.iter_mut().zip(answers) {
            if row.outcome.is_good() {
                say(&mut row, &answer.found);
                self.judge(&mut row, running, copy, bench, &answer.found)?;
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

fn each_alone(copies: &mut [Client]) -> Result<Vec<Sample>, Failure> {
    let mut samples = Vec::new();
    for copy in copies.chunks_mut(1) {
        samples.extend(together(copy)?);
    }
    Ok(samples)
}

/// Takes one sample of all copies, started together. A copy that is done continues detecting until
/// all are done, so that no sample runs beside an idle processor.
fn together(copies: &mut [Client]) -> Result<Vec<Sample>, Failure> {
    let (start, answered, all) = (Barrier::new(copies.len()), AtomicUsize::new(0), copies.len());
    let work = |copy: &mut Client| {
        start.wait();
        let first = sample(copy, SAMPLE_NS);
        // A failed copy counts as done; otherwise the other copies would wait for it.
        let mut done = answered.fetch_add(1, Ordering::Relaxed) + 1;
        while first.is_ok() && done < all {
            if sample(copy, SAMPLE_NS).is_err() {
                break;
            }
            done = answered.load(Ordering::Relaxed);
        }
        first
    };
    std::thread::scope(|scope| {
        let threads: Vec<_> = copies.iter_mut().map(|copy| scope.spawn(|| work(copy))).collect();
        let reason = "a thread of the harness ended unexpectedly";
        let failed = || Failure { outcome: Outcome::Crashed, reason: reason.into() };
        threads.into_iter().map(|thread| thread.join().unwrap_or_else(|_| Err(failed()))).collect()
    })
}
