//! What goes wrong here, as an exception there.

use std::panic::{AssertUnwindSafe, catch_unwind};

use contactbench_core::Refusal;
use contactbench_core::oracle::NoTruth;
use contactbench_core::scene::{LatticeError, SceneError};
use contactbench_core::searcher::LoadError;
use pyo3::exceptions::{PyMemoryError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;

/// Why there is no answer, in one sentence.
pub enum Failure {
    /// What was given: a `ValueError`.
    Value(String),
    /// There is, or may be used, too little memory: a `MemoryError`.
    Memory(String),
    /// An exception of the caller's own code.
    Raised(PyErr),
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
            false => Failure::value(refusal),
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
        Failure::value(error)
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
            if let Some(Failure::Memory(_)) = refusal.cloned().map(Failure::from) {
                return Failure::Memory(what);
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
            Failure::Memory(what) => PyMemoryError::new_err(what),
            Failure::Raised(error) => error,
            Failure::Defect(what) => PyRuntimeError::new_err(format!(
                "{what}; this is a defect of contactbench: report it with the input"
            )),
        }
    }
}

/// Does work that needs no Python, without its lock. A panic becomes an exception like any other.
pub fn work<R: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> Result<R, Failure> + Send,
) -> PyResult<R> {
    let done = py.detach(|| catch_unwind(AssertUnwindSafe(work)));
    let words = |cause: Box<dyn std::any::Any + Send>| match cause.downcast::<String>() {
        Ok(text) => *text,
        Err(cause) => cause.downcast::<&str>().map_or("panic".into(), |text| text.to_string()),
    };
    Ok(done.unwrap_or_else(|cause| Err(Failure::Defect(words(cause))))?)
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
    made.map_err(|error| Failure::value(format!("{threads} threads could not be started: {error}")))
}
