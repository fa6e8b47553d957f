//! Conversion of errors to Python exceptions, and work that Ctrl-C can interrupt.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex, PoisonError, mpsc};
use std::time::Duration;

use contactbench_detectors::oracle::NoTruth;
use contactbench_ground::limits::refusal::{Refusal, no_memory, panic_text};
use contactbench_ground::periodic::LoadError;
use contactbench_ground::scene::SceneError;
use pyo3::exceptions::{PyMemoryError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;

pyo3::create_exception!(
    contactbench,
    Refused,
    PyValueError,
    "A detector cannot answer for this scene: its numbers, its size, or its box are beyond what \
     the detector or the arithmetic can hold."
);

/// An exception that needs no interpreter yet.
pub struct Failure(PyErr);

impl Failure {
    /// Invalid input.
    pub fn value(what: impl ToString) -> Failure {
        Failure(PyValueError::new_err(what.to_string()))
    }

    fn memory(what: String) -> Failure {
        Failure(PyMemoryError::new_err(what))
    }

    /// The object belongs to the process from which this one was forked.
    pub fn forked() -> Failure {
        Failure(PyRuntimeError::new_err(
            "this object is of the process that this one was forked from, where it had threads or \
             was at work; make a new one here",
        ))
    }

    /// A defect of this package.
    fn defect(what: String) -> Failure {
        Failure(PyRuntimeError::new_err(format!(
            "{what}; unless an array was written to by another thread meanwhile, this is a defect \
             of contactbench: report it with the input"
        )))
    }

    fn refused(refusal: &Refusal, what: String) -> Failure {
        if refusal.is_of_memory() { Failure::memory(what) } else { Failure(Refused::new_err(what)) }
    }
}

impl From<Refusal> for Failure {
    fn from(refusal: Refusal) -> Failure {
        Failure::refused(&refusal, refusal.to_string())
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Failure {
        Failure::value(error)
    }
}

impl From<LoadError> for Failure {
    fn from(error: LoadError) -> Failure {
        match error {
            LoadError::Stored(_) => Failure(Refused::new_err(error.to_string())),
            LoadError::Boxed(_) => Failure::value(error),
        }
    }
}

/// Finds the kind of an error that comes from crates with `anyhow`.
impl From<anyhow::Error> for Failure {
    fn from(error: anyhow::Error) -> Failure {
        let what = format!("{error:#}");
        for cause in error.chain() {
            let refusal = match cause.downcast_ref::<NoTruth>() {
                Some(NoTruth::Refused(refusal)) => Some(refusal),
                Some(NoTruth::Disagree { .. } | NoTruth::Sample { .. }) => {
                    return Failure::defect(what);
                }
                _ => cause.downcast_ref(),
            };
            if let Some(refusal) = refusal {
                return Failure::refused(refusal, what);
            }
        }
        Failure::value(what)
    }
}

impl From<PyErr> for Failure {
    fn from(error: PyErr) -> Failure {
        Failure(error)
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> PyErr {
        failure.0
    }
}

/// Source location of the last panic, for the exception.
static PANICKED: Mutex<String> = Mutex::new(String::new());

/// Keeps panics from being printed, because they become exceptions.
pub fn quiet() {
    std::panic::set_hook(Box::new(|panic| {
        let place = panic.location().map_or(String::new(), |place| format!(" ({place})"));
        *PANICKED.lock().unwrap_or_else(PoisonError::into_inner) = place;
    }));
}

/// Message of the panic of a detector whose arrays change while it reads them.
const CHANGED: &str = "changed during a detection";

fn caught<R>(work: impl FnOnce() -> Result<R, Failure>) -> Result<R, Failure> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|cause| {
        if let Some(refusal) = no_memory(&*cause) {
            return Err(refusal.into());
        }
        let words = panic_text(&*cause);
        if words.contains(CHANGED) {
            return Err(Failure(PyRuntimeError::new_err(
                "an array was written to by another thread while it was read; give a copy of it",
            )));
        }
        let place = PANICKED.lock().unwrap_or_else(PoisonError::into_inner);
        Err(Failure::defect(format!("{words}{place}")))
    })
}

#[derive(Clone, Default)]
pub struct Stop(Arc<AtomicBool>);

impl Stop {
    /// Ends the work if its caller no longer waits. Long work calls this function between pieces.
    pub fn look(&self) {
        if self.0.load(Relaxed) {
            std::panic::resume_unwind(Box::new("stopped"));
        }
    }
}

/// Interval between checks for signals.
const LOOK: Duration = Duration::from_millis(50);

/// Runs short work without the interpreter's lock, and converts panics to exceptions.
pub fn work<R: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> Result<R, Failure> + Send,
) -> PyResult<R> {
    Ok(py.detach(|| caught(work))?)
}

/// Does long work in another thread while this one checks for signals, so that Ctrl-C ends the call
/// at once. The other thread then continues with data of its own, and drops its result.
pub fn patient<R: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&Stop) -> Result<R, Failure> + Send + 'static,
) -> PyResult<R> {
    let stop = Stop::default();
    let (sender, receiver) = mpsc::sync_channel(1);
    let its = stop.clone();
    let begun = std::thread::Builder::new().name("contactbench".into()).spawn(move || {
        // Sending fails if the caller no longer waits.
        let _ = sender.send(caught(|| work(&its)));
    });
    begun.map_err(|error| Failure::memory(format!("a thread could not be started: {error}")))?;
    // Only this thread uses the channel, but work without the interpreter's lock requires `Sync`.
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
                return Err(Failure::defect("a thread has ended without an answer".into()).into());
            }
        }
    }
}

/// Makes a pool for one owner: a process that is forked later lacks the threads of a shared pool.
pub fn pool(threads: usize) -> Result<rayon::ThreadPool, Failure> {
    let made = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    made.map_err(|error| {
        Failure::memory(format!("{threads} threads could not be started: {error}"))
    })
}
