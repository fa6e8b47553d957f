//! The runner's end of a conversation: one detector in a process of its own, which answers the
//! requests of [`crate::run::protocol`] on standard input. A detector that crashes, hangs or eats
//! memory costs its own rows and nothing else.
//!
//! A pass of a trajectory looks at each frame in turn, which is read from its file outside the
//! clock. A scene at rest, a trajectory of one frame, stays in memory: a pass of a detector is then
//! one detection, and a reset has nothing to drop, because the detectors of the table keep buffers,
//! and nothing that was computed from coordinates.

use std::collections::BTreeMap;
use std::hint::black_box;
use std::io::{BufRead, Write};
use std::path::Path;
use std::time::Instant;

use anyhow::Context;

use crate::plan::detectors;
use crate::run::alloc::Meter;
use crate::run::possible::MOST_CALLS;
use crate::run::protocol::{Counted, Found, Memory, Reply, Request, Sample, Steps, VERSION};
use crate::run::trajectory::Trajectory;
use crate::truth;
use contactbench_core::contact::Arithmetic;
use contactbench_core::detect::{Options, Refusal};
use contactbench_core::periodic::{Contacts, ImagePair};
use contactbench_core::probe::Tally;
use contactbench_core::searcher::{Loaded, Searcher};
use contactbench_core::track::{self, Step, Tracker, TrackerSpec};
use contactbench_io::exchange;
use contactbench_record::record::built::build;
use contactbench_record::record::provenance;

/// Passes over several frames, at most: each reads all of them from their files.
const MOST_PASSES: u64 = 64;

/// A detector or a tracker, its trajectory and its buffers.
pub struct Server {
    name: String,
    spec: TrackerSpec,
    arithmetic: Arithmetic,
    options: Options,
    /// Keeps its buffers from scene to scene.
    searcher: Searcher,
    /// At work in its place, if this is a tracker or the trajectory has several frames.
    tracker: Option<Box<dyn Tracker>>,
    /// Without frames if none is loaded.
    frames: Trajectory,
    /// The frame that was read last, and its number.
    frame: Option<(usize, Loaded<'static>)>,
    contacts: Contacts,
    /// Detections of a sample of a scene at rest, once they are known.
    calls: Option<u64>,
    /// After a pass that ended at the pairs of a frame: the frame after it.
    next: Option<usize>,
}

/// Either an answer or the reason why there is none.
type Answer<T = Reply> = Result<T, Reply>;

/// What became of a frame.
struct Seen {
    step: Step,
    ns: u64,
}

/// Times of a sample.
#[derive(Default)]
struct Times {
    /// Of each frame, in all passes together, in nanoseconds.
    ns: Vec<u64>,
    passes: u64,
    /// Of all frames, for building lists that are kept.
    building: Option<u64>,
    steps: Steps,
}

impl Server {
    /// A server without a scene: of a detector or of a tracker.
    ///
    /// # Errors
    /// It is neither.
    pub fn new(text: &str, arithmetic: Arithmetic, options: Options) -> anyhow::Result<Server> {
        let spec = track::parse(text)?;
        Ok(Server {
            name: detectors::normal(text),
            searcher: Searcher::new(spec.detector(), options),
            spec,
            arithmetic,
            options,
            tracker: None,
            frames: Trajectory::default(),
            frame: None,
            contacts: Contacts::default(),
            calls: None,
            next: None,
        })
    }

    /// Answers requests until `quit` or the end of the input.
    pub fn serve(&mut self, input: impl BufRead, mut output: impl Write) -> std::io::Result<()> {
        let mut say = |reply: &Reply| -> std::io::Result<()> {
            serde_json::to_writer(&mut output, reply)?;
            output.write_all(b"\n")?;
            output.flush()
        };
        say(&Reply::Hello {
            protocol: VERSION,
            detector: self.name.clone(),
            arithmetic: self.arithmetic.name().into(),
            version: env!("CARGO_PKG_VERSION").into(),
            build: self.build(),
            at_rest: false,
        })?;
        for line in input.lines() {
            match serde_json::from_str(&line?) {
                Ok(Request::Quit) => break,
                Ok(request) => say(&self.answer(request).unwrap_or_else(|reply| reply))?,
                Err(e) => say(&Reply::Error { reason: format!("this is not a request: {e}") })?,
            }
        }
        Ok(())
    }

    /// What is compiled into this program, and which of its instructions the detector uses.
    fn build(&self) -> BTreeMap<String, String> {
        let sources = match provenance::dirty() {
            Some(true) => "changed",
            Some(false) => "as committed",
            None => "unknown",
        };
        let build = build();
        let said = [
            ("features", build.features),
            ("level", self.spec.detector().level().unwrap_or_default()),
            ("profile", build.profile),
            ("revision", provenance::revision().unwrap_or("unknown")),
            ("rustflags", build.rustflags),
            ("sources", sources),
        ];
        let said = said.into_iter().filter(|(_, value)| !value.is_empty());
        said.map(|(name, value)| (name.to_string(), value.to_string())).collect()
    }

    fn answer(&mut self, request: Request) -> Answer {
        match request {
            Request::Load(trajectory) => self.load(trajectory),
            Request::Quit => Ok(Reply::Loaded),
            _ if self.frames.frames.is_empty() => {
                Err(Reply::Error { reason: "no scene is loaded; send load first".into() })
            }
            Request::Sample { min_ns } => self.sample(min_ns).map(|it| Reply::Sample(it.into())),
            Request::Count => self.count(),
            Request::Memory => self.memory(),
            Request::Pairs { path, frame } => self.write(&path, frame),
        }
    }

    fn load(&mut self, trajectory: Trajectory) -> Answer {
        (self.frames, self.frame) = (Trajectory::default(), None);
        (self.calls, self.next) = (None, None);
        if trajectory.frames.is_empty() {
            return Err(Reply::Refused { reason: "the trajectory has no frames".into() });
        }
        let tracked = trajectory.frames.len() > 1 || detectors::is_tracker(&self.name);
        self.tracker = tracked.then(|| self.spec.make(self.options));
        // What is wrong with all frames, or not there, is said at once.
        let frame = self.read(&trajectory, 0)?;
        for path in &trajectory.frames {
            std::fs::metadata(path)
                .with_context(|| format!("cannot read {}", path.display()))
                .map_err(error)?;
        }
        (self.frame, self.frames) = (Some((0, frame)), trajectory);
        Ok(Reply::Loaded)
    }

    fn read(&self, trajectory: &Trajectory, k: usize) -> Answer<Loaded<'static>> {
        let given = trajectory.read_frame(k).map_err(error)?;
        given.loaded(self.arithmetic).map_err(|e| {
            let place = place(trajectory, k, " ");
            Reply::Refused { reason: format!("{place}in {}: {e}", self.arithmetic.name()) }
        })
    }

    /// Looks at a frame, in the place of what is in the list.
    fn step(&mut self, k: usize, tally: Option<&mut Tally>) -> Answer<Seen> {
        let Server { tracker, searcher, contacts, arithmetic, .. } = self;
        let Some((_, scene)) = &self.frame else {
            return Err(Reply::Error { reason: format!("frame {k} is not there") });
        };
        let start = Instant::now();
        let step = match (tracker, tally) {
            (None, None) => searcher.list(scene, *arithmetic, contacts).map(|()| Step::default()),
            (None, Some(tally)) => searcher.count(scene, *arithmetic, contacts).map(|counted| {
                *tally = counted;
                Step::default()
            }),
            (Some(tracker), tally) => {
                contacts.clear();
                tracker.find(truth::frame(scene, *arithmetic), tally, contacts)
            }
        };
        let ns = start.elapsed().as_nanos() as u64;
        match step {
            Ok(step) => Ok(Seen { step, ns }),
            Err(refusal) => {
                let reason = format!("{}{refusal}", place(&self.frames, k, ": "));
                Err(Reply::Refused { reason })
            }
        }
    }

    /// Reads a frame, unless it is there.
    fn fetch(&mut self, k: usize) -> Answer<()> {
        if self.frame.as_ref().is_none_or(|(last, _)| *last != k) {
            self.frame = Some((k, self.read(&self.frames, k)?));
        }
        Ok(())
    }

    /// Looks at all frames, as if none had been seen before.
    fn pass(
        &mut self,
        mut tally: Option<&mut Tally>,
        mut each: impl FnMut(usize, &Seen, &Contacts),
    ) -> Answer<()> {
        for k in 0..self.frames.frames.len() {
            self.fetch(k)?;
            let start = Instant::now();
            if k == 0 {
                self.reset();
            }
            let reset = start.elapsed().as_nanos() as u64;
            let mut seen = self.step(k, tally.as_deref_mut())?;
            seen.ns += if self.tracker.is_some() { reset } else { 0 };
            each(k, &seen, &self.contacts);
        }
        Ok(())
    }

    fn reset(&mut self) {
        self.tracker.iter_mut().for_each(|tracker| tracker.forget());
        self.next = None;
    }

    /// What was found in a pass: of a detector of a scene at rest, without steps.
    fn found(&self, steps: Steps) -> Found {
        let found = Found::from(steps);
        if self.tracker.is_some() { found } else { Found { steps: Steps::default(), ..found } }
    }

    fn sample(&mut self, min_ns: u64) -> Answer<Sample> {
        let count = self.frames.frames.len() as u64;
        // The first pass warms caches and buffers.
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

    /// Passes of at least `min_ns` nanoseconds together; over several frames at most
    /// [`MOST_PASSES`].
    fn passes(&mut self, min_ns: u64) -> Answer<Times> {
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

    /// Detections in a scene at rest, as many as last `min_ns` nanoseconds in the first sample.
    fn detections(&mut self, min_ns: u64) -> Answer<Times> {
        let (passes, elapsed_ns) = match self.calls {
            Some(calls) => (calls, self.repeat(calls)?),
            None => loop {
                let calls = self.calibrate(min_ns)?;
                let elapsed_ns = self.repeat(calls)?;
                // Found out beside a busy neighbour, it may be too few.
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

    /// How many detections make a sample of `min_ns`.
    fn calibrate(&mut self, min_ns: u64) -> Answer<u64> {
        let mut calls = 1;
        loop {
            let elapsed = self.repeat(calls)?;
            if elapsed >= min_ns || calls >= MOST_CALLS {
                return Ok(calls);
            }
            // Ten times as many at once: the first guesses are mostly the cost of the clock.
            let wanted = u128::from(min_ns) * u128::from(calls) * 9 / 8;
            let wanted = wanted.div_ceil(u128::from(elapsed.max(1))) as u64;
            calls = wanted.clamp(calls + 1, (calls * 10).min(MOST_CALLS));
        }
    }

    /// Nanoseconds of so many detections, each into the same lists: the timed loop.
    fn repeat(&mut self, calls: u64) -> Answer<u64> {
        let Server { searcher, contacts, arithmetic, .. } = self;
        let Some((_, scene)) = &self.frame else { return Ok(0) };
        let start = Instant::now();
        for _ in 0..calls {
            searcher.list(black_box(scene), *arithmetic, contacts).map_err(refused)?;
            black_box(&*contacts);
        }
        Ok(start.elapsed().as_nanos() as u64)
    }

    /// One pass, counted.
    fn count(&mut self) -> Answer {
        let (mut tally, mut steps) = (Tally::default(), Steps::default());
        self.pass(Some(&mut tally), |_, seen, contacts| {
            steps.push(contacts.digest(), &seen.step);
        })?;
        let counts = tally.iter().map(|(op, count)| (op.name().into(), count)).collect();
        Ok(Reply::Count(Counted { counts, found: self.found(steps) }.into()))
    }

    /// Two passes with fresh buffers, and as many threads as are timed. The list of pairs goes
    /// where there is room for it already, and is not measured.
    fn memory(&mut self) -> Answer {
        // Makes that room.
        self.pass(None, |_, _, _| ())?;
        // The buffers at hand must not count against the limit of those that are measured.
        self.searcher = Searcher::new(self.spec.detector(), self.options);
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
                let of_frame = match (&self.tracker, &self.frame) {
                    (Some(tracker), _) => tracker.formula_bytes(),
                    (None, Some((_, scene))) => self.searcher.formula_bytes(scene),
                    (None, None) => 0,
                };
                formula = formula.max(of_frame);
            }
            usage.push(meter.end());
        }
        let [Some(cold), Some(warm)] = usage[..] else { return Ok(Reply::Unsupported) };
        // A library declares no formula.
        let ours = self.spec.detector().entry.is_ours();
        let memory = Memory {
            peak_bytes: cold.peak_bytes,
            live_bytes: cold.live_bytes,
            allocations: cold.allocations,
            warm_allocations: Some(warm.allocations),
            formula_bytes: ours.then_some(formula),
            found: self.found(steps),
        };
        Ok(Reply::Memory(memory.into()))
    }

    /// Writes the pairs of a frame, of the last if none is named; those in a box in order. Frames
    /// that are asked for in order are of one pass.
    fn write(&mut self, path: &Path, frame: Option<u64>) -> Answer {
        let count = self.frames.frames.len();
        let wanted = frame.unwrap_or(count as u64 - 1);
        if wanted >= count as u64 {
            let reason = format!("there is no frame {wanted}; the trajectory has {count}");
            return Err(Reply::Error { reason });
        }
        let wanted = wanted as usize;
        if self.next.is_none_or(|next| next > wanted) {
            self.reset();
        }
        for k in self.next.take().unwrap_or(0)..=wanted {
            self.fetch(k)?;
            self.step(k, None)?;
        }
        self.next = Some(wanted + 1);
        let contacts = &self.contacts;
        match &self.frame {
            Some((_, Loaded::InBox(periodic))) => {
                let scene = periodic.scene();
                let pairs = contacts.sorted(scene.len(), self.options.memory_limit);
                let pairs = pairs.map_err(refused)?;
                exchange::write_contacts(path, pairs.iter().copied(), Some(scene.dim()))
            }
            _ => {
                let pairs = &contacts.plain;
                let pairs = pairs.iter().map(|&[i, j]| ImagePair { i, j, image: [0; 3] });
                exchange::write_contacts(path, pairs, None)
            }
        }
        .map_err(error)?;
        Ok(Reply::Pairs { contacts: contacts.len() })
    }
}

/// Which of several frames.
fn place(trajectory: &Trajectory, k: usize, then: &str) -> String {
    if trajectory.frames.len() > 1 { format!("frame {k}{then}") } else { String::new() }
}

fn refused(refusal: Refusal) -> Reply {
    Reply::Refused { reason: refusal.to_string() }
}

fn error(error: anyhow::Error) -> Reply {
    Reply::Error { reason: format!("{error:#}") }
}
