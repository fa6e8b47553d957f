//! What a machine lets several threads gain: as many copies of a detector as it has threads, with one thread each, at work on the same
//! scene at the same time.
//!
//! Copies share nothing but the machine: caches, memory, clock, and the cores that it really gives. What they lose beside each other no
//! parallel form of the same algorithm can win back. One row per block: the harmonic mean of their times, so that k copies at `time_ns`
//! each have the throughput that was measured.

use std::sync::Barrier;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::child::{Failure, Runner};
use super::index::rest;
use super::protocol::{Reply, Request};
use super::record::{Outcome, Pass, Row};
use super::run::{Racer, Stage, astray, load_all};
use super::truths::Truths;

/// Longer than other samples: between two of its own a copy is idle for some tens of microseconds, in which its neighbours are not
/// disturbed.
const SAMPLE_NS: u64 = 10_000_000;

impl Stage<'_> {
    /// The record says that the copies of this detector failed on this scene.
    pub fn no_ceiling(&self, blank: &Row) -> bool {
        self.index.ended(&Row { pass: Pass::Ceiling, ..blank.clone() }).is_some()
    }

    /// Starts the copies of a detector with several threads, if they are asked for; a row says so if they cannot be started.
    pub fn start_copies(&mut self, racer: &mut Racer, loads: &[Request]) -> anyhow::Result<()> {
        let blank = Row { pass: Pass::Ceiling, ..racer.blank.clone() };
        let Some(start) = racer.contender.copy.clone().filter(|_| !self.no_ceiling(&blank)) else { return Ok(()) };
        if let Some(n) = self.too_slow.at(&blank) {
            let reason = format!("copies not tried: over the time limit at N = {n} already");
            return self.fail(&blank, Failure { outcome: Outcome::Timeout, reason }, rest(Pass::Ceiling));
        }
        for _ in 0..racer.contender.threads {
            let mut contender = racer.contender.clone();
            contender.copy = None;
            let started = Runner::start(&start).and_then(|mut runner| load_all(&mut runner, loads).map(|()| runner));
            match started {
                Ok(runner) => {
                    racer.copies.push(Racer { contender, runner, arithmetic: racer.arithmetic, blank: blank.clone(), copies: Vec::new() })
                }
                Err(failure) => {
                    racer.copies.clear();
                    return self.fail(&blank, of_copies(failure), rest(Pass::Ceiling));
                }
            }
        }
        Ok(())
    }

    /// One sample of all copies of a detector at once, if it has any. They are given up after a failure, the detector is not.
    pub fn ceiling(&mut self, racer: &mut Racer, block: u32, truths: &mut Truths<'_>) -> anyhow::Result<()> {
        let mut row = Row { pass: Pass::Ceiling, block, ..racer.blank.clone() };
        if racer.copies.is_empty() || self.index.has(&row) {
            return Ok(());
        }
        let answers = match together(&mut racer.copies) {
            Ok(answers) => answers,
            Err(failure) => {
                racer.copies.clear();
                return self.fail(&row, of_copies(failure), rest(Pass::Ceiling));
            }
        };
        let rate: f64 = answers.iter().map(|answer| 1.0 / answer.time_ns.max(1) as f64).sum();
        row.time_ns = Some((answers.len() as f64 / rate).round() as u64);
        row.calls = Some(answers.iter().map(|answer| answer.calls).sum());
        row.elapsed_ns = answers.iter().map(|answer| answer.elapsed_ns).max();
        for (copy, answer) in racer.copies.iter_mut().zip(answers) {
            // The first wrong answer speaks for all.
            if row.outcome.is_good() {
                (row.contacts, row.digest) = (Some(answer.contacts), Some(answer.digest));
                self.judge(&mut row, copy, truths)?;
            }
        }
        self.write(&row)?;
        Ok(())
    }
}

fn of_copies(failure: Failure) -> Failure {
    Failure { reason: format!("of the copies: {}", failure.reason), ..failure }
}

/// The first sample of a copy.
struct Answer {
    time_ns: u64,
    calls: u64,
    elapsed_ns: u64,
    contacts: u64,
    digest: String,
}

/// One sample of each copy, begun together. A copy that has answered goes on detecting until all have: no clock runs beside an idle
/// neighbour.
fn together(copies: &mut [Racer]) -> Result<Vec<Answer>, Failure> {
    let (start, answered, all) = (Barrier::new(copies.len()), AtomicUsize::new(0), copies.len());
    let work = |copy: &mut Racer| {
        start.wait();
        let first = sample(&mut copy.runner);
        // One that failed counts as well, or the others would wait for it.
        let mut done = answered.fetch_add(1, Ordering::Relaxed) + 1;
        while first.is_ok() && done < all {
            if sample(&mut copy.runner).is_err() {
                // It will fail in the next block again, and be given up there.
                break;
            }
            done = answered.load(Ordering::Relaxed);
        }
        first
    };
    std::thread::scope(|scope| {
        let threads: Vec<_> = copies.iter_mut().map(|copy| scope.spawn(|| work(copy))).collect();
        let failed = || Failure { outcome: Outcome::Crashed, reason: "the harness lost the thread that asked".into() };
        threads.into_iter().map(|thread| thread.join().unwrap_or_else(|_| Err(failed()))).collect()
    })
}

fn sample(runner: &mut Runner) -> Result<Answer, Failure> {
    let request = Request::Sample { min_ns: SAMPLE_NS };
    match runner.ask(&request)? {
        Reply::Sample { time_ns, calls, elapsed_ns, contacts, digest } => Ok(Answer { time_ns, calls, elapsed_ns, contacts, digest }),
        other => Err(astray(&request, &other)),
    }
}
