//! Subjects of the check: a detector, a runner (see [`crate::check::process`]), or a function of
//! the calling program.
//!
//! A detector runs in a thread of its own, so that a panic or an endless loop does not end the
//! check. The thread keeps the detector with its buffers between calls. After a panic, a new
//! detector is made. A thread that does not answer in time is abandoned, because a thread cannot be
//! killed, and a new one replaces it.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::Duration;

use anyhow::Context;

use crate::check::Wrong;
use crate::check::answer::{Answer, Expected, Question, Respondent, answer};
use crate::check::process::{Foreign, Process};
use contactbench_detectors::table::DetectorSpec;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::detect::Options;
use contactbench_ground::periodic::Loaded;
use contactbench_ground::scene::AnyScene;
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
            CheckedSubject::Function { ask, .. } => Box::new(ask.clone()),
        })
    }
}

impl Respondent for Arc<Function> {
    fn ask(&mut self, question: &Question<'_>) -> anyhow::Result<Answer> {
        let Question { given, truth, arithmetic, .. } = *question;
        if given.lattice.is_some() {
            return Ok(Answer::Declined("it takes open scenes only".into()));
        }
        Ok(match self(&given.scene)? {
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
