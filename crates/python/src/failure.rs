//! What goes wrong here, as an exception there.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex, PoisonError, mpsc};
use std::time::Duration;

use contactbench_core::Refusal;
use contactbench_core::oracle::NoTruth;
use contactbench_core::refusal::no_memory;
use contactbench_core::scene::{LatticeError, SceneError};
use contactbench_core::searcher::LoadError;
use pyo3::exceptions::{PyMemoryError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;

pyo3::create_exception!(
    contactbench,
    Refused,
    PyValueError,
    "A detector cannot answer for this scene: its numbers, its size, or its box are beyond what \
     the detector or the arithmetic can hold."
);

/// Why there is no answer, in one sentence.
pub enum Failure {
    /// What was given: a `ValueError`.
    Value(String),
    /// A detector cannot answer: `Refused`.
    Refused(String),
    /// There is, or may be used, too little memory: a `MemoryError`.
    Memory(String),
    /// An exception of the caller's own code.
    Raised(PyErr),
    /// Another thread has written to an array: a `RuntimeError`.
    Changed,
    /// What a process may not use that was forked: a `RuntimeError`.
    Forked,
    /// A defect of this package: a `RuntimeError`.
    Defect(String),
}

impl Failure {
    /// Of what was given.
    pub fn value(what: impl ToString) -> Failure {
        Failure::Value(what.to_string())
    }
}

impl From<Refusal> for Failure {
    fn from(refusal: Refusal) -> Failure {
        match refusal.is_of_memory() {
            true => Failure::Memory(refusal.to_string()),
            false => Failure::Refused(refusal.to_string()),
        }
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Failure {
        Failure::value(error)
    }
}

impl From<LatticeError> for Failure {
    fn from(error: LatticeError) -> Failure {
        Failure::value(error)
    }
}

impl From<LoadError> for Failure {
    fn from(error: LoadError) -> Failure {
        match error {
            LoadError::Stored(_) => Failure::Refused(error.to_string()),
            LoadError::Boxed(_) => Failure::value(error),
        }
    }
}

/// Of the program around the core, whose errors are of many kinds.
impl From<anyhow::Error> for Failure {
    fn from(error: anyhow::Error) -> Failure {
        let what = format!("{error:#}");
        for cause in error.chain() {
            let refusal = match cause.downcast_ref::<NoTruth>() {
                Some(NoTruth::Refused(refusal)) => Some(refusal),
                Some(NoTruth::Disagree { .. } | NoTruth::Sample { .. }) => {
                    return Failure::Defect(what);
                }
                _ => cause.downcast_ref(),
            };
            match refusal.cloned().map(Failure::from) {
                Some(Failure::Memory(_)) => return Failure::Memory(what),
                Some(_) => return Failure::Refused(what),
                None => {}
            }
        }
        Failure::Value(what)
    }
}

impl From<PyErr> for Failure {
    fn from(error: PyErr) -> Failure {
        Failure::Raised(error)
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> PyErr {
        match failure {
            Failure::Value(what) => PyValueError::new_err(what),
            Failure::Refused(what) => Refused::new_err(what),
            Failure::Memory(what) => PyMemoryError::new_err(what),
            Failure::Raised(error) => error,
            Failure::Changed => PyRuntimeError::new_err(
                "an array was written to by another thread while it was read; give a copy of it",
            ),
            Failure::Forked => PyRuntimeError::new_err(
                "this object is of the process that this one was forked from, where it had threads \
                 or was at work; make a new one here",
            ),
            Failure::Defect(what) => PyRuntimeError::new_err(format!(
                "{what}; unless an array was written to by another thread meanwhile, this is a \
                 defect of contactbench: report it with the input"
            )),
        }
    }
}

/// Where the last panic was, for the exception; nothing is printed.
static PANICKED: Mutex<String> = Mutex::new(String::new());

/// Keeps panics from being printed: they become exceptions.
pub fn quiet() {
    std::panic::set_hook(Box::new(|panic| {
        let place = panic.location().map_or(String::new(), |place| format!(" ({place})"));
        *PANICKED.lock().unwrap_or_else(PoisonError::into_inner) = place;
    }));
}

/// What detectors panic with if arrays change while they are read.
const CHANGED: &str = "changed during a detection";

fn caught<R>(work: impl FnOnce() -> Result<R, Failure>) -> Result<R, Failure> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|cause| {
        if let Some(refusal) = no_memory(&*cause) {
            return Err(refusal.into());
        }
        let words = match (cause.downcast_ref::<String>(), cause.downcast_ref::<&str>()) {
            (Some(text), _) => text.as_str(),
            (_, Some(text)) => *text,
            _ => "panic",
        };
        if words.contains(CHANGED) {
            return Err(Failure::Changed);
        }
        let place = PANICKED.lock().unwrap_or_else(PoisonError::into_inner);
        Err(Failure::Defect(format!("{words}{place}")))
    })
}

/// A flag that ends abandoned work.
#[derive(Clone, Default)]
pub struct Stop(Arc<AtomicBool>);

impl Stop {
    /// Ends the thread's work if its caller has gone; called between pieces of long work.
    pub fn look(&self) {
        if self.0.load(Relaxed) {
            std::panic::resume_unwind(Box::new("stopped"));
        }
    }
}

/// How often signals are looked for.
const LOOK: Duration = Duration::from_millis(50);

/// Does short work that needs no Python, without the interpreter's lock. A panic becomes an
/// exception.
pub fn work<R: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> Result<R, Failure> + Send,
) -> PyResult<R> {
    Ok(py.detach(|| caught(work))?)
}

/// Does work, of which some may be `long`, without the interpreter's lock. Where signals arrive, in
/// the main thread, the work has a thread of its own, and this one looks for signals: an exception
/// of theirs ends the call at once. The work's thread then ends by itself, and what it has is
/// dropped there.
pub fn patient<R: Send + 'static>(
    py: Python<'_>,
    long: bool,
    work: impl FnOnce(&Stop) -> Result<R, Failure> + Send + 'static,
) -> PyResult<R> {
    let stop = Stop::default();
    if !long || !is_main_thread() {
        return Ok(py.detach(|| caught(|| work(&stop)))?);
    }
    let (sender, receiver) = mpsc::sync_channel(1);
    let its = stop.clone();
    let begun = std::thread::Builder::new().name("contactbench".into()).spawn(move || {
        // Nobody may be waiting any more.
        let _ = sender.send(caught(|| work(&its)));
    });
    begun.map_err(|error| Failure::Memory(format!("a thread could not be started: {error}")))?;
    // The channel is used by this thread alone; only a `Sync` one may be used without the lock.
    let receiver = Mutex::new(receiver);
    loop {
        let waited = py
            .detach(|| receiver.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(LOOK));
        match waited {
            Ok(done) => return Ok(done?),
            Err(mpsc::RecvTimeoutError::Timeout) => {
                if let Err(signal) = py.check_signals() {
                    stop.0.store(true, Relaxed);
                    return Err(signal);
                }
            }
            Err(mpsc::RecvTimeoutError::Disconnected) => {
                return Err(Failure::Defect("a thread has ended without an answer".into()).into());
            }
        }
    }
}

/// Python handles signals in the main thread alone.
#[cfg(target_os = "linux")]
fn is_main_thread() -> bool {
    // SAFETY: both calls only give a number.
    unsafe { libc::getpid() == libc::gettid() }
}

#[cfg(not(target_os = "linux"))]
fn is_main_thread() -> bool {
    true
}

/// The same, where the truth is looked for, by so many threads: a pool that lasts no longer, so
/// that a process that forks meets none of them.
pub fn by_threads<R: Send>(
    threads: usize,
    work: impl FnOnce() -> Result<R, Failure> + Send,
) -> Result<R, Failure> {
    pool(threads)?.install(work)
}

/// Threads.
pub fn pool(threads: usize) -> Result<rayon::ThreadPool, Failure> {
    if threads == 0 || threads > 1024 {
        return Err(Failure::value(format!("threads is {threads}; give a number from 1 to 1024")));
    }
    let made = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    made.map_err(|error| {
        Failure::Memory(format!("{threads} threads could not be started: {error}"))
    })
}
