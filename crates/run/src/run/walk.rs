//! A tracker at work on a trajectory, in passes: each frame is read from its file, outside the
//! clock, and looked at.

use std::path::Path;
use std::time::Instant;

use anyhow::Context;

use crate::run::alloc::Meter;
use crate::run::possible::MOST_CALLS;
use crate::run::protocol::{Counted, Memory, Reply, Sample, Steps};
use crate::run::server::{self, Answer, error};
use crate::run::trajectory::Trajectory;
use contactbench_core::contact::Arithmetic;
use contactbench_core::detect::Options;
use contactbench_core::periodic::Contacts;
use contactbench_core::probe::Tally;
use contactbench_core::searcher::Loaded;
use contactbench_core::track::{Step, Tracker, TrackerSpec};

/// Each reads all frames from their files.
const MOST_PASSES: u64 = 64;

/// A tracker with its trajectory and its buffers.
pub struct Walk {
    spec: TrackerSpec,
    arithmetic: Arithmetic,
    options: Options,
    trajectory: Trajectory,
    tracker: Box<dyn Tracker>,
    contacts: Contacts,
    /// Of a pass that went no farther than to the pairs of a frame: the frame after it.
    next: Option<usize>,
}

/// What became of a frame.
struct Seen {
    step: Step,
    ns: u64,
}

impl Walk {
    /// Takes a trajectory.
    pub fn new(
        spec: &TrackerSpec,
        arithmetic: Arithmetic,
        options: Options,
        trajectory: &Trajectory,
    ) -> Result<Walk, Reply> {
        if trajectory.frames.is_empty() {
            return Err(Reply::Refused { reason: "the trajectory has no frames".into() });
        }
        let walk = Walk {
            spec: spec.clone(),
            arithmetic,
            options,
            trajectory: trajectory.clone(),
            tracker: spec.make(options),
            contacts: Contacts::default(),
            next: None,
        };
        // What is wrong with all frames, or not there, is said at once.
        walk.frame(0)?;
        for path in &trajectory.frames {
            std::fs::metadata(path)
                .with_context(|| format!("cannot read {}", path.display()))
                .map_err(error)?;
        }
        Ok(walk)
    }

    fn frame(&self, k: usize) -> Result<Loaded<'static>, Reply> {
        let given = self.trajectory.read_frame(k).map_err(error)?;
        given.loaded(self.arithmetic).map_err(|e| Reply::Refused {
            reason: format!("frame {k} in {}: {e}", self.arithmetic.name()),
        })
    }

    /// One frame, in the place of what is in the list.
    fn step(
        &mut self,
        scene: &Loaded<'_>,
        k: usize,
        tally: Option<&mut Tally>,
    ) -> Result<Seen, Reply> {
        let Walk { tracker, arithmetic, contacts, .. } = self;
        contacts.clear();
        let start = Instant::now();
        let step = match scene {
            Loaded::Open(scene) => {
                tracker.step(scene, arithmetic.test(), tally, &mut contacts.plain)
            }
            Loaded::InBox(scene) => tracker.step_in_box(scene, *arithmetic, tally, contacts),
        };
        let ns = start.elapsed().as_nanos() as u64;
        let step = step.map_err(|refusal| Reply::Refused {
            reason: match self.trajectory.frames.len() {
                1 => refusal.to_string(),
                _ => format!("frame {k}: {refusal}"),
            },
        })?;
        Ok(Seen { step, ns })
    }

    /// All frames, as if nothing had been seen before.
    fn pass(
        &mut self,
        mut tally: Option<&mut Tally>,
        mut each: impl FnMut(usize, &Seen, &Contacts),
    ) -> Answer<()> {
        for k in 0..self.trajectory.frames.len() {
            let scene = self.frame(k)?;
            let start = Instant::now();
            if k == 0 {
                self.reset();
            }
            let reset = start.elapsed().as_nanos() as u64;
            let mut seen = self.step(&scene, k, tally.as_deref_mut())?;
            seen.ns += reset;
            each(k, &seen, &self.contacts);
        }
        Ok(())
    }

    fn reset(&mut self) {
        self.tracker.forget();
        self.next = None;
    }

    /// Passes of at least so many nanoseconds together, after one that warms caches and buffers; of
    /// several frames at most [`MOST_PASSES`].
    pub fn sample(&mut self, min_ns: u64) -> Answer {
        let count = self.trajectory.frames.len();
        let mut first = 0;
        self.pass(None, |_, seen, _| first += seen.ns)?;
        let first_ns = Some(first / count as u64).filter(|&ns| ns > 0);
        let most = if count == 1 { MOST_CALLS } else { MOST_PASSES };
        let (mut ns, mut steps) = (vec![0; count], Steps::default());
        let (mut passes, mut building) = (0, 0);
        while passes == 0 || passes < most && ns.iter().sum::<u64>() < min_ns {
            self.pass(None, |k, seen, contacts| {
                ns[k] += seen.ns;
                building += seen.step.building.as_nanos() as u64;
                if passes == 0 {
                    steps.push(contacts.digest(), &seen.step);
                }
            })?;
            passes += 1;
        }
        let (elapsed_ns, calls) = (ns.iter().sum::<u64>(), passes * count as u64);
        let mean = |ns: u64, calls: u64| (ns + calls / 2) / calls;
        let sample = Sample {
            time_ns: mean(elapsed_ns, calls),
            calls,
            elapsed_ns,
            step_ns: ns.into_iter().map(|ns| mean(ns, passes)).collect(),
            building_ns: Some(mean(building, calls)),
            first_ns,
            found: steps.into(),
        };
        Ok(Reply::Sample(sample.into()))
    }

    /// One pass, counted.
    pub fn count(&mut self) -> Answer {
        let (mut tally, mut steps) = (Tally::default(), Steps::default());
        self.pass(Some(&mut tally), |_, seen, contacts| {
            steps.push(contacts.digest(), &seen.step);
        })?;
        let counts = tally.iter().map(|(op, count)| (op.name().into(), count)).collect();
        Ok(Reply::Count(Counted { counts, found: steps.into() }.into()))
    }

    /// Two passes of a fresh tracker. The list of pairs goes where there is room for it already,
    /// and is not measured.
    pub fn memory(&mut self) -> Answer {
        // Makes that room.
        self.pass(None, |_, _, _| ())?;
        self.tracker = self.spec.make(self.options);
        let (mut steps, mut usage, mut formula) = (Steps::default(), Vec::new(), 0);
        for _ in 0..2 {
            steps = Steps::default();
            let meter = Meter::start();
            self.reset();
            for k in 0..self.trajectory.frames.len() {
                let scene = self.frame(k)?;
                let seen = meter.during(|| self.step(&scene, k, None))?;
                steps.push(self.contacts.digest(), &seen.step);
                formula = self.tracker.formula_bytes().max(formula);
            }
            usage.push(meter.end());
        }
        let [Some(cold), Some(warm)] = usage[..] else { return Ok(Reply::Unsupported) };
        let ours = self.spec.detector().entry.is_ours();
        let memory = Memory {
            peak_bytes: cold.peak_bytes,
            live_bytes: cold.live_bytes,
            allocations: cold.allocations,
            warm_allocations: Some(warm.allocations),
            formula_bytes: ours.then_some(formula),
            found: steps.into(),
        };
        Ok(Reply::Memory(memory.into()))
    }

    /// Writes the pairs of a frame, of the last if none is named. Frames that are asked for in
    /// order are of one pass.
    pub fn write(&mut self, path: &Path, frame: Option<u64>) -> Answer {
        let count = self.trajectory.frames.len();
        let wanted = frame.unwrap_or(count as u64 - 1);
        if wanted >= count as u64 {
            let reason = format!("there is no frame {wanted}; the trajectory has {count}");
            return Err(Reply::Error { reason });
        }
        let wanted = wanted as usize;
        if self.next.is_none_or(|next| next > wanted) {
            self.reset();
        }
        for k in self.next.take().unwrap_or(0)..wanted {
            let scene = self.frame(k)?;
            self.step(&scene, k, None)?;
        }
        let scene = self.frame(wanted)?;
        self.step(&scene, wanted, None)?;
        self.next = Some(wanted + 1);
        server::write(path, &scene, &self.contacts, self.options.memory_limit)
    }
}
