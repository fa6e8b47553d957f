//! The runner's side of the protocol: one detector in a process of its own, which answers requests
//! on standard input. If a detector crashes, hangs or uses too much memory, only its own rows are
//! lost.
//!
//! A pass of a trajectory searches each frame in turn; reading a frame from its file is not timed.
//! A scene at rest stays in memory; a pass is then one detection. A reset does nothing for a
//! detector, which keeps only buffers between detections.

mod measure;

use std::collections::BTreeMap;
use std::io::{BufRead, Write};
use std::path::Path;
use std::time::Instant;

use anyhow::Context;

use crate::plan::detectors;
use crate::run::runner::protocol::{Hello, Reply, Request, VERSION};
use crate::run::runner::trajectory::Trajectory;
use contactbench_detectors::tracker::{self, TrackerSpec};
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::detect::Options;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::periodic::{ContactList, ImagePair, Loaded};
use contactbench_ground::probe::Tally;
use contactbench_io::exchange;
use contactbench_lists::searcher::Searcher;
use contactbench_lists::track::{Step, Tracker};
use contactbench_record::record::origin::built::build;
use contactbench_record::record::origin::provenance;

pub struct Server {
    name: String,
    spec: TrackerSpec,
    arithmetic: Arithmetic,
    options: Options,
    searcher: Searcher,
    /// Searches instead of `searcher` if the subject is a tracker or there are several frames.
    tracker: Option<Box<dyn Tracker>>,
    frames: Trajectory,
    frame: Option<(usize, Loaded<'static>)>,
    contacts: ContactList,
    /// Number of detections per sample of a scene at rest; `None` before the first sample.
    calls: Option<u64>,
    /// The frame at which the next request for pairs continues, unless it is for an earlier one.
    next: Option<usize>,
}

type Answered<T = Reply> = Result<T, Reply>;

struct Seen {
    step: Step,
    ns: u64,
}

impl Server {
    /// Returns a server without a scene. Fails if `text` is not a detector or tracker.
    pub fn new(text: &str, arithmetic: Arithmetic, options: Options) -> anyhow::Result<Server> {
        let spec = tracker::parse(text)?;
        Ok(Server {
            name: detectors::normal(text),
            searcher: Searcher::new(spec.detector().make(options)),
            spec,
            arithmetic,
            options,
            tracker: None,
            frames: Trajectory::default(),
            frame: None,
            contacts: ContactList::default(),
            calls: None,
            next: None,
        })
    }

    pub fn serve(&mut self, input: impl BufRead, mut output: impl Write) -> std::io::Result<()> {
        let mut say = |reply: &Reply| -> std::io::Result<()> {
            serde_json::to_writer(&mut output, reply)?;
            output.write_all(b"\n")?;
            output.flush()
        };
        let hello = Hello {
            protocol: VERSION,
            detector: self.name.clone(),
            arithmetic: self.arithmetic.name().into(),
            version: env!("CARGO_PKG_VERSION").into(),
            build: self.build(),
            at_rest: false,
        };
        say(&Reply::Hello(hello.into()))?;
        for line in input.lines() {
            match serde_json::from_str(&line?) {
                Ok(Request::Quit) => break,
                Ok(request) => say(&self.answer(request).unwrap_or_else(|reply| reply))?,
                Err(e) => say(&Reply::Error { reason: format!("this is not a request: {e}") })?,
            }
        }
        Ok(())
    }

    /// Returns properties of this build, and the instruction set that the detector uses.
    fn build(&self) -> BTreeMap<String, String> {
        let sources = match provenance::dirty() {
            Some(true) => "changed",
            Some(false) => "as committed",
            None => "unknown",
        };
        let build = build();
        let said = [
            ("level", self.spec.detector().level().unwrap_or_default()),
            ("profile", build.profile),
            ("revision", provenance::revision().unwrap_or("unknown")),
            ("rustflags", build.rustflags),
            ("sources", sources),
        ];
        let said = said.into_iter().filter(|(_, value)| !value.is_empty());
        said.map(|(name, value)| (name.to_string(), value.to_string())).collect()
    }

    fn answer(&mut self, request: Request) -> Answered {
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

    fn load(&mut self, trajectory: Trajectory) -> Answered {
        (self.frames, self.frame) = (Trajectory::default(), None);
        (self.calls, self.next) = (None, None);
        if trajectory.frames.is_empty() {
            return Err(Reply::Refused { reason: "the trajectory has no frames".into() });
        }
        let tracked = trajectory.frames.len() > 1 || detectors::is_tracker(&self.name);
        self.tracker = tracked.then(|| self.spec.make(self.options));
        // Reading the first frame reports missing files before the first pass.
        let frame = self.read(&trajectory, 0)?;
        for path in &trajectory.frames {
            std::fs::metadata(path)
                .with_context(|| format!("cannot read {}", path.display()))
                .map_err(error)?;
        }
        (self.frame, self.frames) = (Some((0, frame)), trajectory);
        Ok(Reply::Loaded)
    }

    fn read(&self, trajectory: &Trajectory, k: usize) -> Answered<Loaded<'static>> {
        let given = trajectory.read_frame(k).map_err(error)?;
        given.loaded(self.arithmetic).map_err(|e| {
            let place = place(trajectory, k, " ");
            Reply::Refused { reason: format!("{place}in {}: {e}", self.arithmetic.name()) }
        })
    }

    fn step(&mut self, k: usize, tally: Option<&mut Tally>) -> Answered<Seen> {
        let Server { tracker, searcher, contacts, arithmetic, .. } = self;
        let Some((_, scene)) = &self.frame else {
            return Err(Reply::Error { reason: format!("frame {k} is not there") });
        };
        let start = Instant::now();
        contacts.clear();
        let frame = scene.frame(*arithmetic);
        let step = match tracker {
            None => searcher.find(frame, tally, contacts).map(|()| Step::default()),
            Some(tracker) => tracker.find(frame, tally, contacts),
        };
        let ns = start.elapsed().as_nanos() as u64;
        let refused = |refusal| format!("{}{refusal}", place(&self.frames, k, ": "));
        let step = step.map_err(|refusal: Refusal| Reply::Refused { reason: refused(refusal) })?;
        Ok(Seen { step, ns })
    }

    fn fetch(&mut self, k: usize) -> Answered<()> {
        if self.frame.as_ref().is_none_or(|(last, _)| *last != k) {
            // Only one frame is in memory at a time.
            self.frame = None;
            self.frame = Some((k, self.read(&self.frames, k)?));
        }
        Ok(())
    }

    fn pass(
        &mut self,
        mut tally: Option<&mut Tally>,
        mut each: impl FnMut(usize, &Seen, &ContactList),
    ) -> Answered<()> {
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

    /// Writes the pairs of a frame, by default the last; pairs in a box are sorted. Frames
    /// requested in ascending order share one pass.
    fn write(&mut self, path: &Path, frame: Option<u64>) -> Answered {
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

fn place(trajectory: &Trajectory, k: usize, then: &str) -> String {
    if trajectory.frames.len() > 1 { format!("frame {k}{then}") } else { String::new() }
}

fn refused(refusal: Refusal) -> Reply {
    Reply::Refused { reason: refusal.to_string() }
}

fn error(error: anyhow::Error) -> Reply {
    Reply::Error { reason: format!("{error:#}") }
}
