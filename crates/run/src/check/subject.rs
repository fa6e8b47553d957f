//! Subjects of the check: a detector, a runner (see [`crate::check::process`]), or a function of
//! the calling program.
//!
//! A detector runs in a thread of its own, so that a panic or an endless loop does not end the
//! check. The thread keeps the detector with its buffers between calls. After a panic, a new
//! detector is made. A thread that does not answer in time is abandoned, because a thread cannot be
//! killed, and a new one replaces it.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::Duration;

use anyhow::Context;
use contactbench_ground::limits::refusal::{no_memory, panic_text};

use crate::check::process::{Foreign, Process};
use crate::check::{Differences, Wrong};
use crate::run::judge::outcome;
use contactbench_detectors::oracle;
use contactbench_detectors::oracle::boxes::Truth;
use contactbench_detectors::table::DetectorSpec;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::detect::Options;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::{Digest, Sink};
use contactbench_ground::periodic::Loaded;
use contactbench_ground::periodic::{ContactList, ImagePair};
use contactbench_ground::scene::AnyScene;
use contactbench_io::Given;
use contactbench_lists::searcher::Searcher;

/// Name of the threads that run detectors; panics in them are findings, not defects of the check.
pub const THREAD: &str = "detector under test";

pub enum CheckedSubject {
    Detector {
        spec: DetectorSpec,
        name: String,
    },
    Runner(Foreign),
    Function {
        name: String,
        /// The function; it is called in the checking thread, so endless loops are not detected.
        ask: Arc<Function>,
    },
}

pub type Function = dyn Fn(&AnyScene<'static>) -> anyhow::Result<Answer> + Send + Sync;

impl<S: Into<DetectorSpec>> From<S> for CheckedSubject {
    fn from(spec: S) -> CheckedSubject {
        let spec = spec.into();
        CheckedSubject::Detector { name: spec.to_string(), spec }
    }
}

impl CheckedSubject {
    pub fn name(&self) -> &str {
        match self {
            CheckedSubject::Detector { name, .. } | CheckedSubject::Function { name, .. } => name,
            CheckedSubject::Runner(foreign) => &foreign.name,
        }
    }

    pub fn respondent(
        &self,
        options: Options,
        deadline: Duration,
    ) -> anyhow::Result<Box<dyn Respondent>> {
        Ok(match self {
            CheckedSubject::Detector { spec, .. } => {
                Box::new(Thread::new(spec.clone(), options, deadline)?)
            }
            CheckedSubject::Runner(foreign) => Box::new(Process::new(foreign, deadline)?),
            CheckedSubject::Function { ask, .. } => Box::new(Called(ask.clone())),
        })
    }

    pub(super) fn is_slow_to_make(&self) -> bool {
        matches!(self, CheckedSubject::Runner(_))
    }
}

pub struct Question<'a> {
    pub given: &'a Given,
    /// The scene as the arithmetic stores it.
    pub stored: &'a Arc<Loaded<'static>>,
    pub arithmetic: Arithmetic,
    /// Whether the subject must be restarted, so that no earlier scene affects the answer.
    pub fresh: bool,
    pub truth: &'a Truth,
}

/// A running subject. It keeps what earlier scenes left in its buffers, unless a question is
/// `fresh`.
pub trait Respondent {
    fn ask(&mut self, question: &Question<'_>) -> anyhow::Result<Answer>;
}

pub enum Answer {
    Right,
    Pairs(Vec<ImagePair>),
    Refused(Refusal, u64),
    Declined(String),
    Wrong(Wrong),
}

impl Answer {
    pub(super) fn of(pairs: Vec<ImagePair>, truth: &Truth, arithmetic: Arithmetic) -> Answer {
        let of_itself = |pair: ImagePair| pair.i == pair.j && pair.image == [0; 3];
        let errors = oracle::compare_by(&pairs, &truth.pairs, of_itself, |_| 0.0);
        let good = outcome(&errors, arithmetic).is_good();
        if good { Answer::Right } else { Answer::Pairs(pairs) }
    }

    pub fn refusal(&self) -> Option<String> {
        match self {
            Answer::Refused(refusal, 0) => Some(refusal.to_string()),
            Answer::Declined(reason) => Some(reason.clone()),
            _ => None,
        }
    }

    pub fn wrong(self, truth: &Truth) -> Option<Wrong> {
        match self {
            Answer::Right => None,
            Answer::Pairs(pairs) => Some(Wrong::Pairs(Differences::new(pairs, &truth.pairs))),
            Answer::Refused(_, 0) | Answer::Declined(_) => None,
            Answer::Wrong(wrong) => Some(wrong),
            Answer::Refused(_, reported) => Some(Wrong::RefusesLate(reported)),
        }
    }
}

/// The first `most` reported pairs, so that a detector that reports without end does not fill the
/// memory.
struct Kept {
    pairs: Vec<[u32; 2]>,
    most: usize,
    reported: u64,
}

impl Sink for Kept {
    fn contact(&mut self, i: u32, j: u32) {
        self.reported += 1;
        if self.pairs.len() < self.most {
            if self.pairs.len() == self.pairs.capacity() && self.pairs.try_reserve(1).is_err() {
                self.most = self.pairs.len();
                return;
            }
            self.pairs.push([i, j]);
        }
    }
}

/// Runs a detector in the calling thread: first a form that counts, which is safe if pairs are
/// reported without end; if it is right, the timed form, which is compiled separately.
pub fn answer(
    searcher: &mut Searcher,
    scene: &Loaded<'_>,
    arithmetic: Arithmetic,
    expected: Expected,
) -> Answer {
    let mut contacts = ContactList::default();
    let mut reported = 0;
    let both = || {
        match scene {
            Loaded::Open(scene) => {
                let mut kept = Kept { pairs: Vec::new(), most: expected.most, reported: 0 };
                let visited = searcher.detector_mut().visit(scene, arithmetic.test(), &mut kept);
                (contacts.plain, reported) = (kept.pairs, kept.reported);
                visited?;
            }
            Loaded::InBox(_) => {
                let counted = searcher.count(scene, arithmetic, &mut contacts);
                reported = searcher.found_in_box();
                counted?;
            }
        }
        if contacts.digest() == expected.digest {
            searcher.list(scene, arithmetic, &mut contacts)?;
        }
        Ok(())
    };
    match catch_unwind(AssertUnwindSafe(both)) {
        Ok(Ok(())) if contacts.digest() == expected.digest => Answer::Right,
        Ok(Ok(())) => match contacts.sorted(scene.particles(), searcher.memory_limit()) {
            Ok(pairs) => Answer::Pairs(pairs),
            Err(_) => {
                let (said, truth) = (contacts.digest(), expected.digest);
                Answer::Wrong(Wrong::Counts { said, truth })
            }
        },
        Ok(Err(refusal)) => Answer::Refused(refusal, reported),
        Err(cause) => {
            if let Some(refusal) = no_memory(&*cause) {
                return Answer::Wrong(Wrong::Panics(refusal.to_string()));
            }
            Answer::Wrong(Wrong::Panics(panic_text(&*cause).into()))
        }
    }
}

#[derive(Clone, Copy, Default)]
pub struct Expected {
    digest: Digest,
    /// Number of pairs to store: enough to show that an answer is wrong, and how.
    most: usize,
}

impl From<&Truth> for Expected {
    fn from(truth: &Truth) -> Expected {
        Expected { digest: truth.digest, most: 2 * truth.pairs.len() + 1000 }
    }
}

struct Called(Arc<Function>);

impl Respondent for Called {
    fn ask(&mut self, question: &Question<'_>) -> anyhow::Result<Answer> {
        let Question { given, truth, arithmetic, .. } = *question;
        if given.lattice.is_some() {
            return Ok(Answer::Declined("it takes open scenes only".into()));
        }
        Ok(match (self.0)(&given.scene)? {
            Answer::Pairs(mut pairs) => {
                pairs.sort_unstable();
                Answer::of(pairs, truth, arithmetic)
            }
            other => other,
        })
    }
}

struct Job {
    scene: Arc<Loaded<'static>>,
    arithmetic: Arithmetic,
    fresh: bool,
    expected: Expected,
}

struct Thread {
    spec: DetectorSpec,
    options: Options,
    deadline: Duration,
    jobs: Sender<Job>,
    answers: Receiver<Answer>,
}

impl Thread {
    fn new(spec: DetectorSpec, options: Options, deadline: Duration) -> anyhow::Result<Thread> {
        let (jobs, to_do) = channel();
        let (done, answers) = channel();
        let served = spec.clone();
        let work = move || serve(&served, options, &to_do, &done);
        std::thread::Builder::new()
            .name(THREAD.into())
            .spawn(work)
            .context("cannot start a thread for a detector")?;
        Ok(Thread { spec, options, deadline, jobs, answers })
    }
}

impl Respondent for Thread {
    fn ask(&mut self, question: &Question<'_>) -> anyhow::Result<Answer> {
        let Question { stored, arithmetic, fresh, truth, .. } = *question;
        let job = Job { scene: stored.clone(), arithmetic, fresh, expected: truth.into() };
        let _ = self.jobs.send(job);
        let lost = match self.answers.recv_timeout(self.deadline) {
            Ok(answer) => return Ok(answer),
            Err(RecvTimeoutError::Timeout) => Wrong::Hangs(self.deadline),
            Err(RecvTimeoutError::Disconnected) => Wrong::Panics("its thread ended".into()),
        };
        *self = Thread::new(self.spec.clone(), self.options, self.deadline)?;
        Ok(Answer::Wrong(lost))
    }
}

fn serve(spec: &DetectorSpec, options: Options, jobs: &Receiver<Job>, answers: &Sender<Answer>) {
    let mut searcher = None;
    for job in jobs {
        if job.fresh {
            searcher = None;
        }
        let answer = answer(
            searcher.get_or_insert_with(|| Searcher::new(spec.make(options))),
            &job.scene,
            job.arithmetic,
            job.expected,
        );
        if matches!(answer, Answer::Wrong(Wrong::Panics(_))) {
            searcher = None;
        }
        if answers.send(answer).is_err() {
            return;
        }
    }
}
