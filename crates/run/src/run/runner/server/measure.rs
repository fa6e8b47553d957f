//! The measurements of a runner: times, counts of operations, and memory.

use std::hint::black_box;
use std::time::Instant;

use crate::run::runner::alloc::Meter;
use crate::run::runner::possible::MOST_CALLS;
use crate::run::runner::protocol::{Counted, Found, Memory, Reply, Sample, Steps};
use crate::run::runner::server::{Answered, Server, refused};
use contactbench_ground::probe::Tally;
use contactbench_lists::searcher::Searcher;
use contactbench_lists::track::Step;

/// Maximum number of passes over several frames, because each reads all files.
const MOST_PASSES: u64 = 64;

#[derive(Default)]
struct Times {
    /// Time of each frame, summed over all passes, in nanoseconds.
    ns: Vec<u64>,
    passes: u64,
    /// Time for building neighbour lists, summed over all frames and passes, in nanoseconds.
    building: Option<u64>,
    steps: Steps,
}

impl Server {
    /// Returns the result of a pass. For a detector on a scene at rest, steps are left out.
    fn found(&self, steps: Steps) -> Found {
        let found = Found::from(steps);
        if self.tracker.is_some() { found } else { Found { steps: Steps::default(), ..found } }
    }

    pub(super) fn sample(&mut self, min_ns: u64) -> Answered<Sample> {
        let count = self.frames.frames.len() as u64;
        // The first pass is not timed; it warms caches and buffers.
        let mut first = 0;
        self.pass(None, |_, seen, _| first += seen.ns)?;
        let times = match &self.tracker {
            None => self.detections(min_ns)?,
            Some(_) => self.passes(min_ns)?,
        };
        let Times { ns, passes, building, steps } = times;
        let (elapsed_ns, calls) = (ns.iter().sum::<u64>(), passes * count);
        let mean = |ns: u64, calls: u64| (ns + calls / 2) / calls;
        Ok(Sample {
            time_ns: mean(elapsed_ns, calls),
            calls,
            elapsed_ns,
            step_ns: ns.into_iter().map(|ns| mean(ns, passes)).collect(),
            building_ns: building.map(|ns| mean(ns, calls)),
            first_ns: Some(first / count).filter(|&ns| ns > 0),
            found: self.found(steps),
        })
    }

    /// Repeats passes until they last `min_ns` nanoseconds together; with several frames, at most
    /// [`MOST_PASSES`] passes.
    fn passes(&mut self, min_ns: u64) -> Answered<Times> {
        let count = self.frames.frames.len();
        let most = if count == 1 { MOST_CALLS } else { MOST_PASSES };
        let mut times = Times { ns: vec![0; count], ..Times::default() };
        let mut building = 0;
        while times.passes == 0 || times.passes < most && times.ns.iter().sum::<u64>() < min_ns {
            let Times { ns, passes, steps, .. } = &mut times;
            self.pass(None, |k, seen, contacts| {
                ns[k] += seen.ns;
                building += seen.step.building.as_nanos() as u64;
                if *passes == 0 {
                    steps.push(contacts.digest(), &seen.step);
                }
            })?;
            *passes += 1;
        }
        Ok(Times { building: Some(building), ..times })
    }

    fn detections(&mut self, min_ns: u64) -> Answered<Times> {
        let (passes, elapsed_ns) = match self.calls {
            Some(calls) => (calls, self.repeat(calls)?),
            None => loop {
                let calls = self.calibrate(min_ns)?;
                let elapsed_ns = self.repeat(calls)?;
                // A disturbance of the calibration may have made the number of calls too small.
                if elapsed_ns >= min_ns / 2 || calls >= MOST_CALLS {
                    self.calls = Some(calls);
                    break (calls, elapsed_ns);
                }
            },
        };
        let mut steps = Steps::default();
        steps.push(self.contacts.digest(), &Step::default());
        Ok(Times { ns: vec![elapsed_ns], passes, building: None, steps })
    }

    fn calibrate(&mut self, min_ns: u64) -> Answered<u64> {
        let mut calls = 1;
        loop {
            let elapsed = self.repeat(calls)?;
            if elapsed >= min_ns || calls >= MOST_CALLS {
                return Ok(calls);
            }
            // The number grows at most tenfold at a time, because the first times are mostly
            // overhead of the clock.
            let wanted = u128::from(min_ns) * u128::from(calls) * 9 / 8;
            let wanted = wanted.div_ceil(u128::from(elapsed.max(1))) as u64;
            calls = wanted.clamp(calls + 1, (calls * 10).min(MOST_CALLS));
        }
    }

    /// The timed loop: runs `calls` detections into the same lists, and returns the nanoseconds.
    fn repeat(&mut self, calls: u64) -> Answered<u64> {
        let Server { searcher, contacts, arithmetic, .. } = self;
        let Some((_, scene)) = &self.frame else { return Ok(0) };
        let start = Instant::now();
        for _ in 0..calls {
            searcher.list(black_box(scene), *arithmetic, contacts).map_err(refused)?;
            black_box(&*contacts);
        }
        Ok(start.elapsed().as_nanos() as u64)
    }

    pub(super) fn count(&mut self) -> Answered {
        let (mut tally, mut steps) = (Tally::default(), Steps::default());
        self.pass(Some(&mut tally), |_, seen, contacts| {
            steps.push(contacts.digest(), &seen.step);
        })?;
        let counts = tally.iter().map(|(op, count)| (op.name().into(), count)).collect();
        Ok(Reply::Count(Counted { counts, found: self.found(steps) }.into()))
    }

    /// Measures two passes, the first with fresh buffers, with as many threads as are timed. The
    /// list of pairs has its memory before, so it is not counted.
    pub(super) fn memory(&mut self) -> Answered {
        // Before the measurement, a pass grows the list of pairs to its final size.
        self.pass(None, |_, _, _| ())?;
        // Buffers of that pass are freed, because they would count against the memory limit.
        self.searcher = Searcher::new(self.spec.detector().make(self.options));
        self.tracker = self.tracker.as_ref().map(|_| self.spec.make(self.options));
        let (mut steps, mut usage, mut formula) = (Steps::default(), Vec::new(), 0);
        for _ in 0..2 {
            steps = Steps::default();
            let meter = Meter::start();
            self.reset();
            for k in 0..self.frames.frames.len() {
                self.fetch(k)?;
                let seen = meter.during(|| self.step(k, None))?;
                steps.push(self.contacts.digest(), &seen.step);
                formula = formula.max(match &self.tracker {
                    Some(tracker) => tracker.formula_bytes(),
                    None => self.searcher.formula_bytes(),
                });
            }
            usage.push(meter.end());
        }
        let [Some(cold), Some(warm)] = usage[..] else { return Ok(Reply::Unsupported) };
        let memory = Memory {
            peak_bytes: cold.peak_bytes,
            live_bytes: cold.live_bytes,
            allocations: cold.allocations,
            warm_allocations: Some(warm.allocations),
            formula_bytes: Some(formula),
            found: self.found(steps),
        };
        Ok(Reply::Memory(memory.into()))
    }
}
