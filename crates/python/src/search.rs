use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use contactbench_detectors::spec;
use contactbench_detectors::tracker;
use contactbench_detectors::tracker::TrackerSpec;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::detect::Options;
use contactbench_ground::limits::memory;
use contactbench_ground::pairs::normalise::smaller_first;
use contactbench_ground::pairs::pair_list::PAIR_BYTES;
use contactbench_ground::periodic::ContactList;
use contactbench_ground::periodic::Loaded;
use contactbench_ground::probe::{Op, Tally};
use contactbench_lists::track::{Step, Tracker};
use numpy::PyReadonlyArrayDyn;
use pyo3::prelude::*;
use rayon::ThreadPool;

use crate::failure::{Failure, patient, pool, work};
use crate::given::{Answer, Arrays, Edges, answer, arithmetic};

/// Prepares a scene for the search; fails if it certainly has too many pairs.
fn loaded<'a>(
    arrays: &'a Arrays<'_>,
    arithmetic: Arithmetic,
    limit: u64,
) -> Result<Loaded<'a>, Failure> {
    let loaded = Loaded::new(&arrays.scene()?, arrays.lattice()?, arithmetic)?;
    loaded.within(limit)?;
    Ok(loaded)
}

/// Default memory limit in bytes, for one detection of this many particles.
#[pyfunction]
pub fn limit_for(particles: usize) -> u64 {
    memory::limit_for(particles)
}

/// A value that only one call uses at a time, and that is made again after an interrupted call.
struct Owned<T> {
    of: Mutex<Arc<Mutex<T>>>,
    /// Number of the process that made the value.
    process: u32,
    /// Whether the value has threads, which a forked process lacks.
    threads: bool,
}

impl<T> Owned<T> {
    fn new(made: T, threads: usize) -> Owned<T> {
        let of = Mutex::new(Arc::new(Mutex::new(made)));
        Owned { of, process: std::process::id(), threads: threads > 1 }
    }

    /// Returns the value. A forked process gets it only if it has no threads and was not in use.
    fn lend(&self) -> Result<Arc<Mutex<T>>, Failure> {
        if self.process != std::process::id() {
            let idle = |lent: &Arc<Mutex<T>>| !self.threads && lent.try_lock().is_ok();
            return match self.of.try_lock() {
                Ok(lent) if idle(&lent) => Ok(lent.clone()),
                _ => Err(Failure::forked()),
            };
        }
        Ok(self.of.lock().unwrap_or_else(PoisonError::into_inner).clone())
    }

    /// Calls the search with the arrays, or with a copy of them if Ctrl-C may end the call first.
    /// After such an end the next call uses a new value, made by `fresh`.
    fn with<R: Send + 'static>(
        &self,
        py: Python<'_>,
        arrays: Arrays<'_>,
        fresh: impl FnOnce() -> Result<T, Failure>,
        search: impl FnOnce(&mut T, &Arrays<'_>) -> Result<R, Failure> + Send + 'static,
    ) -> PyResult<R>
    where
        T: Send + 'static,
    {
        let lent = self.lend()?;
        let done = Arc::new(AtomicBool::new(false));
        let ended = done.clone();
        let search = move |arrays: &Arrays<'_>| {
            let mut held = lent.lock().unwrap_or_else(PoisonError::into_inner);
            let result = search(&mut held, arrays);
            ended.store(true, Ordering::Relaxed);
            result
        };
        let result = if arrays.are_many() {
            let copy = py.detach(|| arrays.copied())?;
            patient(py, move |_| search(&copy))
        } else {
            work(py, || search(&arrays))
        };
        // A panic may leave the value in an invalid state.
        if !done.load(Ordering::Relaxed) {
            let made = Arc::new(Mutex::new(fresh()?));
            *self.of.lock().unwrap_or_else(PoisonError::into_inner) = made;
        }
        result
    }
}

pub type Working = (Box<dyn Tracker>, Option<ThreadPool>);
type Searched = (ContactList, Option<usize>, Step);

/// Steps, builds, dangerous builds, pairs in the last list, and whether the last step built it.
type Done = (u64, u64, u64, u64, bool);

/// State of the Python classes `Detector` and `Verlet`.
#[pyclass(frozen)]
pub struct Search {
    spec: TrackerSpec,
    arithmetic: Arithmetic,
    #[pyo3(get)]
    threads: usize,
    #[pyo3(get)]
    memory_limit: u64,
    finder: Owned<Working>,
    done: Mutex<Done>,
}

fn fresh(spec: &TrackerSpec, memory_limit: u64, threads: usize) -> Result<Working, Failure> {
    let finder = spec.make(Options { memory_limit, threads });
    // A single thread needs no pool.
    Ok((finder, if threads == 1 { None } else { Some(pool(threads)?) }))
}

impl Search {
    /// Returns a function that finds the contacts, the number of components of an image (`None` in
    /// open space), and what a tracker did.
    pub fn finding(
        &self,
    ) -> impl FnOnce(&mut Working, &Arrays<'_>) -> Result<Searched, Failure> + Send + use<> {
        let (arithmetic, limit) = (self.arithmetic, self.memory_limit);
        move |(finder, crew), arrays| {
            let scene = loaded(arrays, arithmetic, limit)?;
            let mut contacts = ContactList::default();
            // Unused capacity costs nothing; if the reservation fails, the list grows step by step.
            let most = arrays.len().saturating_mul(4).min((limit / PAIR_BYTES) as usize);
            let _ = contacts.plain.try_reserve_exact(most);
            let mut find = || finder.find(scene.frame(arithmetic), None, &mut contacts);
            let step = match crew {
                Some(pool) => pool.install(find),
                None => find(),
            }?;
            smaller_first(&mut contacts.plain);
            let boxed = match &scene {
                Loaded::Open(_) => None,
                Loaded::InBox(periodic) => Some(periodic.scene().dim()),
            };
            Ok((contacts, boxed, step))
        }
    }

    pub fn with<R: Send + 'static>(
        &self,
        py: Python<'_>,
        arrays: Arrays<'_>,
        search: impl FnOnce(&mut Working, &Arrays<'_>) -> Result<R, Failure> + Send + 'static,
    ) -> PyResult<R> {
        let fresh = || fresh(&self.spec, self.memory_limit, self.threads);
        self.finder.with(py, arrays, fresh, search)
    }

    fn done(&self) -> MutexGuard<'_, Done> {
        self.done.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl Search {
    /// Makes a detector or, if `tracks` is true, a tracker.
    #[new]
    fn new(
        text: &str,
        tracks: bool,
        arithmetic: &str,
        threads: usize,
        memory_limit: Option<u64>,
    ) -> Result<Search, Failure> {
        let spec = match tracks {
            true => tracker::parse(text).map_err(Failure::value)?,
            false => TrackerSpec::EveryStep(spec::parse(text).map_err(Failure::value)?),
        };
        spec.detector().usable(threads).map_err(Failure::value)?;
        let memory_limit = memory_limit.unwrap_or_else(memory::default_limit);
        let finder = Owned::new(fresh(&spec, memory_limit, threads)?, threads);
        let (arithmetic, done) = (self::arithmetic(arithmetic)?, Mutex::default());
        Ok(Search { spec, arithmetic, threads, memory_limit, finder, done })
    }

    #[getter]
    fn name(&self) -> String {
        match &self.spec {
            TrackerSpec::EveryStep(detector) => detector.to_string(),
            spec => spec.to_string(),
        }
    }

    #[getter]
    fn arithmetic(&self) -> &'static str {
        self.arithmetic.name()
    }

    fn contacts(
        &self,
        py: Python<'_>,
        x: PyReadonlyArrayDyn<'_, f64>,
        r: PyReadonlyArrayDyn<'_, f64>,
        edges: Option<Edges>,
    ) -> PyResult<Answer> {
        let (found, boxed, step) = self.with(py, Arrays::new(&x, &r, edges)?, self.finding())?;
        let mut done = self.done();
        done.0 += 1;
        done.1 += u64::from(step.built);
        done.2 += u64::from(step.dangerous);
        (done.3, done.4) = (step.listed, step.built);
        drop(done);
        answer(py, found, boxed)
    }

    /// Returns how often a detector did each elementary operation, without those that are 0.
    fn count(
        &self,
        py: Python<'_>,
        x: PyReadonlyArrayDyn<'_, f64>,
        r: PyReadonlyArrayDyn<'_, f64>,
        edges: Option<Edges>,
    ) -> PyResult<BTreeMap<&'static str, u64>> {
        let (arithmetic, limit) = (self.arithmetic, self.memory_limit);
        self.with(py, Arrays::new(&x, &r, edges)?, move |(finder, _), arrays| {
            let (scene, mut tally) = (loaded(arrays, arithmetic, limit)?, Tally::default());
            finder.find(scene.frame(arithmetic), Some(&mut tally), &mut ContactList::default())?;
            let counted = Op::ALL.iter().map(|&op| (op.name(), tally.get(op)));
            Ok(counted.filter(|&(_, count)| count > 0).collect())
        })
    }

    fn forget(&self, py: Python<'_>) -> PyResult<()> {
        let lent = self.finder.lend()?;
        patient(py, move |_| {
            let mut held = lent.lock().unwrap_or_else(PoisonError::into_inner);
            held.0.forget();
            Ok(())
        })
    }

    #[getter(done)]
    fn told(&self) -> Done {
        *self.done()
    }
}
