//! The runner's end of a conversation: one detector in a process of its own, which answers the
//! requests of [`crate::run::protocol`] on standard input. A detector that crashes, hangs or eats
//! memory costs its own rows and nothing else.
//!
//! Of a scene at rest, a trajectory of one frame, a pass of a detector is one detection, and a
//! reset has nothing to drop: the detectors of the table keep buffers, and nothing that was
//! computed from coordinates. Trackers, and trajectories of several frames, are looked at in
//! walks (`run::walk`).

use std::collections::BTreeMap;
use std::hint::black_box;
use std::io::{BufRead, Write};
use std::path::Path;
use std::time::Instant;

use crate::plan::detectors;
use crate::run::alloc;
use crate::run::possible::MOST_CALLS;
use crate::run::protocol::{Counted, Memory, Reply, Request, Sample, VERSION};
use crate::run::trajectory::Trajectory;
use crate::run::walk::Walk;
use contactbench_core::contact::Arithmetic;
use contactbench_core::detect::{Options, Refusal};
use contactbench_core::periodic::Contacts;
use contactbench_core::searcher::{LoadError, Loaded, Searcher};
use contactbench_core::track::{self, TrackerSpec};
use contactbench_io as io;
use contactbench_record::record::built::build;
use contactbench_record::record::provenance;

/// A detector, its scene and its buffers.
pub struct Server {
    name: String,
    /// A detector alone is asked in every frame.
    tracker: TrackerSpec,
    /// At work, where this is a tracker or the trajectory has several frames.
    walk: Option<Walk>,
    arithmetic: Arithmetic,
    options: Options,
    searcher: Searcher,
    scene: Option<Loaded<'static>>,
    contacts: Contacts,
    calls: Option<u64>,
}

/// Either an answer or the reason why there is none.
pub(super) type Answer<T = Reply> = Result<T, Reply>;

impl Server {
    /// A server without a scene: of a detector or of a tracker.
    ///
    /// # Errors
    /// It is neither.
    pub fn new(text: &str, arithmetic: Arithmetic, options: Options) -> anyhow::Result<Server> {
        let tracker = track::parse(text)?;
        Ok(Server {
            name: detectors::normal(text),
            searcher: Searcher::new(tracker.detector(), options),
            tracker,
            walk: None,
            arithmetic,
            options,
            scene: None,
            contacts: Contacts::default(),
            calls: None,
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
            ("level", self.tracker.detector().level().unwrap_or_default()),
            ("profile", build.profile),
            ("revision", provenance::revision().unwrap_or("unknown")),
            ("rustflags", build.rustflags),
            ("sources", sources),
        ];
        let said = said.into_iter().filter(|(_, value)| !value.is_empty());
        said.map(|(name, value)| (name.to_string(), value.to_string())).collect()
    }

    fn answer(&mut self, request: Request) -> Answer {
        if let Some(walk) = &mut self.walk {
            match &request {
                Request::Sample { min_ns } => return walk.sample(*min_ns),
                Request::Count => return walk.count(),
                Request::Memory => return walk.memory(),
                Request::Pairs { path, frame } => return walk.write(path, *frame),
                Request::Load(_) | Request::Quit => {}
            }
        }
        match request {
            Request::Load(trajectory) => self.load(&trajectory),
            Request::Sample { min_ns } => self.sample(min_ns),
            Request::Count => {
                let scene = loaded(&self.scene)?;
                let tally = self
                    .searcher
                    .count(scene, self.arithmetic, &mut self.contacts)
                    .map_err(refused)?;
                let counts = tally.iter().map(|(op, count)| (op.name().into(), count)).collect();
                let found = self.contacts.digest().into();
                Ok(Reply::Count(Counted { counts, found }.into()))
            }
            Request::Memory => self.memory(),
            Request::Pairs { frame: Some(frame @ 1..), .. } => {
                let reason = format!("there is no frame {frame}; a scene at rest has frame 0");
                Err(Reply::Error { reason })
            }
            Request::Pairs { path, .. } => {
                self.detect()?;
                let limit = self.options.memory_limit;
                write(&path, loaded(&self.scene)?, &self.contacts, limit)
            }
            Request::Quit => Ok(Reply::Loaded),
        }
    }

    fn load(&mut self, trajectory: &Trajectory) -> Answer {
        (self.scene, self.walk, self.calls) = (None, None, None);
        if trajectory.frames.len() != 1 || detectors::is_tracker(&self.name) {
            let Server { tracker, arithmetic, options, .. } = self;
            self.walk = Some(Walk::new(tracker, *arithmetic, *options, trajectory)?);
            return Ok(Reply::Loaded);
        }
        let given = trajectory.read_frame(0).map_err(error)?;
        let refused =
            |e: LoadError| Reply::Refused { reason: format!("in {}: {e}", self.arithmetic.name()) };
        self.scene = Some(given.loaded(self.arithmetic).map_err(refused)?);
        Ok(Reply::Loaded)
    }

    /// One detection into the list of pairs.
    fn detect(&mut self) -> Result<(), Reply> {
        let scene = loaded(&self.scene)?;
        self.searcher.list(scene, self.arithmetic, &mut self.contacts).map_err(refused)
    }

    fn sample(&mut self, min_ns: u64) -> Answer {
        // The first detection warms caches and buffers.
        let start = Instant::now();
        self.detect()?;
        let first_ns = Some(start.elapsed().as_nanos() as u64).filter(|&ns| ns > 0);
        let (calls, elapsed_ns) = match self.calls {
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
        let time_ns = (elapsed_ns + calls / 2) / calls;
        let (step_ns, found) = (vec![time_ns], self.contacts.digest().into());
        let sample =
            Sample { time_ns, calls, elapsed_ns, step_ns, building_ns: None, first_ns, found };
        Ok(Reply::Sample(sample.into()))
    }

    /// How many detections make a sample of `min_ns`.
    fn calibrate(&mut self, min_ns: u64) -> Result<u64, Reply> {
        let mut calls = 1;
        loop {
            let elapsed = self.repeat(calls)?;
            if elapsed >= min_ns || calls >= MOST_CALLS {
                return Ok(calls);
            }
            calls = more(min_ns, calls, elapsed);
        }
    }

    /// Nanoseconds of so many detections, each into the same lists: the timed loop.
    fn repeat(&mut self, calls: u64) -> Result<u64, Reply> {
        let (scene, arithmetic) = (loaded(&self.scene)?, self.arithmetic);
        let start = Instant::now();
        for _ in 0..calls {
            self.searcher
                .list(black_box(scene), arithmetic, &mut self.contacts)
                .map_err(refused)?;
            black_box(&self.contacts);
        }
        Ok(start.elapsed().as_nanos() as u64)
    }

    /// Measures what is timed, with as many threads: the list of pairs goes where there is room for
    /// it already, and is not measured.
    fn memory(&mut self) -> Answer {
        // Makes that room.
        self.detect()?;
        // The buffers of the detector at hand must not count against the limit of the one that is
        // measured.
        self.searcher = Searcher::new(self.tracker.detector(), self.options);
        let (scene, arithmetic) = (loaded(&self.scene)?, self.arithmetic);
        let contacts = &mut self.contacts;
        let ((result, mut searcher), cold) = alloc::measure(|| {
            let mut searcher = Searcher::new(self.tracker.detector(), self.options);
            (searcher.list(scene, arithmetic, contacts), searcher)
        });
        result.map_err(refused)?;
        let found = contacts.digest().into();
        // A library declares no formula.
        let formula_bytes =
            self.tracker.detector().entry.is_ours().then(|| searcher.formula_bytes(scene));
        let (again, warm) = alloc::measure(|| searcher.list(scene, arithmetic, contacts));
        again.map_err(refused)?;
        let (Some(cold), Some(warm)) = (cold, warm) else { return Ok(Reply::Unsupported) };
        // The detector itself is one allocation of a few hundred bytes: its box is not part of the
        // algorithm.
        let frame = std::mem::size_of_val(searcher.detector()) as u64;
        let boxed = u64::from(frame > 0);
        let memory = Memory {
            // Threads of rayon's may have given back, meanwhile, more than that.
            peak_bytes: cold.peak_bytes.saturating_sub(frame),
            live_bytes: cold.live_bytes.saturating_sub(frame),
            allocations: cold.allocations - boxed,
            warm_allocations: Some(warm.allocations),
            formula_bytes,
            found,
        };
        Ok(Reply::Memory(memory.into()))
    }
}

/// Detections that may last `min_ns`, where fewer than [`MOST_CALLS`] took `elapsed` ns.
fn more(min_ns: u64, calls: u64, elapsed: u64) -> u64 {
    // Ten times as many at once: the first guesses are mostly the cost of the clock.
    let wanted =
        (u128::from(min_ns) * u128::from(calls) * 9 / 8).div_ceil(u128::from(elapsed.max(1)));
    (wanted as u64).clamp(calls + 1, (calls * 10).min(MOST_CALLS))
}

/// Writes the contacts of a scene; those in a box in order, in a list of at most `limit` bytes.
pub(super) fn write(path: &Path, scene: &Loaded<'_>, contacts: &Contacts, limit: u64) -> Answer {
    match scene {
        Loaded::Open(_) => io::write::pairs(path, &contacts.plain),
        Loaded::InBox(periodic) => {
            let scene = periodic.scene();
            let pairs = contacts.sorted(scene.len(), limit).map_err(refused)?;
            io::write::images(path, &pairs, scene.dim())
        }
    }
    .map_err(error)?;
    Ok(Reply::Pairs { contacts: contacts.len() })
}

fn loaded<'a>(scene: &'a Option<Loaded<'static>>) -> Result<&'a Loaded<'static>, Reply> {
    scene
        .as_ref()
        .ok_or_else(|| Reply::Error { reason: "no scene is loaded; send load first".into() })
}

fn refused(refusal: Refusal) -> Reply {
    Reply::Refused { reason: refusal.to_string() }
}

pub(super) fn error(error: anyhow::Error) -> Reply {
    Reply::Error { reason: format!("{error:#}") }
}
