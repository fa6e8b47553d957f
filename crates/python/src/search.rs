//! Detectors and trackers that keep their buffers.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use contactbench_core::contact::Arithmetic;
use contactbench_core::detect::Options;
use contactbench_core::detect::spec::{self, DetectorSpec, SpecError};
use contactbench_core::memory;
use contactbench_core::pair_list::PAIR_BYTES;
use contactbench_core::periodic::Contacts;
use contactbench_core::probe::Op;
use contactbench_core::searcher::{Loaded, Searcher};
use contactbench_core::track::{self, Tracker, TrackerSpec};
use numpy::{PyArray2, PyReadonlyArrayDyn};
use pyo3::prelude::*;
use rayon::ThreadPool;

use crate::failure::{Failure, patient, pool};
use crate::given::{Arrays, Edges, Held, answer, arithmetic, tidy};

type Answer = (Py<PyArray2<u32>>, Option<Py<PyArray2<i32>>>);

/// Returns the detector of that name, if it can use this many threads.
fn detector(text: &str, threads: usize) -> Result<DetectorSpec, Failure> {
    let spec = spec::parse(text).map_err(Failure::value)?;
    usable(&spec, threads)?;
    Ok(spec)
}

fn usable(spec: &DetectorSpec, threads: usize) -> Result<(), Failure> {
    if spec.entry.is_control() {
        return Err(Failure::value(SpecError::Unknown { name: spec.entry.name.into() }));
    }
    if threads > 1 && !spec.entry.threads {
        return Err(Failure::value(format!(
            "{} is sequential and cannot use {threads} threads; give threads=1, or take \
             streamed-nbs, cell-grid or direct",
            spec.entry.name
        )));
    }
    Ok(())
}

/// One thread needs no pool.
fn crew(threads: usize) -> Result<Option<ThreadPool>, Failure> {
    if threads == 1 { Ok(None) } else { pool(threads).map(Some) }
}

fn by<R: Send>(crew: &Option<ThreadPool>, work: impl FnOnce() -> R + Send) -> R {
    match crew {
        Some(pool) => pool.install(work),
        None => work(),
    }
}

/// Refuses a scene whose pairs are sure to be too many.
fn loaded<'a>(
    arrays: &Arrays<'a>,
    arithmetic: Arithmetic,
    limit: u64,
) -> Result<Loaded<'a>, Failure> {
    let loaded = Loaded::new(&arrays.scene()?, arrays.lattice()?, arithmetic)?;
    loaded.within(limit)?;
    Ok(loaded)
}

/// An empty list with room for most answers, within a limit of bytes: while a list grows, its pages
/// are moved. Room that is not used is not touched, and given back in the end.
fn room(arrays: &Arrays<'_>, limit: u64) -> Contacts {
    let most = usize::try_from(limit / PAIR_BYTES).unwrap_or(usize::MAX);
    let mut contacts = Contacts::default();
    // Who has no room now finds out while the list grows.
    let _ = contacts.plain.try_reserve_exact(arrays.len().saturating_mul(4).min(most));
    contacts
}

/// In a box its dimension: so many numbers has an image.
fn boxed(loaded: &Loaded<'_>) -> Option<usize> {
    match loaded {
        Loaded::Open(_) => None,
        Loaded::InBox(periodic) => Some(periodic.scene().dim()),
    }
}

/// Bytes for one detection of so many particles, if nobody says how many.
#[pyfunction]
pub fn limit_for(particles: usize) -> u64 {
    memory::limit_for(particles)
}

/// Something that one call uses at a time, made again where a call was given up.
struct Owned<T> {
    of: Mutex<Arc<Mutex<T>>>,
    /// The process that has made it.
    process: u32,
    /// It has threads, which a forked process has not.
    threads: bool,
}

impl<T> Owned<T> {
    fn new(made: T, threads: usize) -> Owned<T> {
        let of = Mutex::new(Arc::new(Mutex::new(made)));
        Owned { of, process: std::process::id(), threads: threads > 1 }
    }

    /// It, for a call; in a forked process only if nothing of it is left in the other.
    fn lend(&self) -> Result<Arc<Mutex<T>>, Failure> {
        if self.process != std::process::id() {
            let idle = |lent: &Arc<Mutex<T>>| !self.threads && lent.try_lock().is_ok();
            return match self.of.try_lock() {
                Ok(lent) if idle(&lent) => Ok(lent.clone()),
                _ => Err(Failure::Forked),
            };
        }
        Ok(self.of.lock().unwrap_or_else(PoisonError::into_inner).clone())
    }

    /// Does long work with it. If the call is given up, the next one has what `fresh` makes.
    fn patient<R: Send + 'static>(
        &self,
        py: Python<'_>,
        long: bool,
        fresh: impl FnOnce() -> Result<T, Failure>,
        work: impl FnOnce(&mut T) -> Result<R, Failure> + Send + 'static,
    ) -> PyResult<R>
    where
        T: Send + 'static,
    {
        let lent = self.lend()?;
        let done = Arc::new(AtomicBool::new(false));
        let ended = done.clone();
        let result = patient(py, long, move |_| {
            let mut held = lent.lock().unwrap_or_else(PoisonError::into_inner);
            let result = work(&mut held);
            ended.store(true, Ordering::Relaxed);
            result
        });
        // A panic, too, may leave it half changed.
        if !done.load(Ordering::Relaxed) {
            let made = Arc::new(Mutex::new(fresh()?));
            *self.of.lock().unwrap_or_else(PoisonError::into_inner) = made;
        }
        result
    }
}

/// See the class of the package.
#[pyclass(frozen)]
pub struct Detector {
    spec: DetectorSpec,
    arithmetic: Arithmetic,
    threads: usize,
    limit: u64,
    searcher: Owned<Search>,
}

type Search = (Searcher, Option<ThreadPool>);

impl Detector {
    fn fresh(&self) -> Result<Search, Failure> {
        let options = Options { memory_limit: self.limit, threads: self.threads };
        Ok((Searcher::new(&self.spec, options), crew(self.threads)?))
    }
}

#[pymethods]
impl Detector {
    #[new]
    fn new(
        detector: &str,
        arithmetic: &str,
        threads: usize,
        memory_limit: Option<u64>,
    ) -> Result<Detector, Failure> {
        let spec = self::detector(detector, threads)?;
        let limit = memory_limit.unwrap_or_else(memory::default_limit);
        let options = Options { memory_limit: limit, threads };
        let searcher = Owned::new((Searcher::new(&spec, options), crew(threads)?), threads);
        Ok(Detector { arithmetic: self::arithmetic(arithmetic)?, spec, threads, limit, searcher })
    }

    /// The name with its parameters.
    #[getter]
    fn name(&self) -> String {
        self.spec.to_string()
    }

    #[getter]
    fn arithmetic(&self) -> &'static str {
        self.arithmetic.name()
    }

    #[getter]
    fn threads(&self) -> usize {
        self.threads
    }

    #[getter]
    fn memory_limit(&self) -> u64 {
        self.limit
    }

    fn contacts(
        &self,
        py: Python<'_>,
        x: PyReadonlyArrayDyn<'_, f64>,
        r: PyReadonlyArrayDyn<'_, f64>,
        edges: Option<Edges>,
    ) -> PyResult<Answer> {
        let held = Held::new(&x, &r, edges)?;
        let (arithmetic, limit, long) = (self.arithmetic, self.limit, held.are_many());
        let search = move |(searcher, crew): &mut Search| {
            let arrays = held.arrays();
            let scene = loaded(&arrays, arithmetic, limit)?;
            let mut contacts = room(&arrays, limit);
            by(crew, || searcher.list(&scene, arithmetic, &mut contacts))?;
            tidy(&mut contacts);
            Ok((contacts, boxed(&scene)))
        };
        let (found, boxed) = self.searcher.patient(py, long, || self.fresh(), search)?;
        answer(py, found, boxed)
    }

    /// How often each operation happens, without those that do not.
    fn count(
        &self,
        py: Python<'_>,
        x: PyReadonlyArrayDyn<'_, f64>,
        r: PyReadonlyArrayDyn<'_, f64>,
        edges: Option<Edges>,
    ) -> PyResult<BTreeMap<&'static str, u64>> {
        let held = Held::new(&x, &r, edges)?;
        let (arithmetic, limit, long) = (self.arithmetic, self.limit, held.are_many());
        let search = move |(searcher, _): &mut Search| {
            let scene = loaded(&held.arrays(), arithmetic, limit)?;
            let tally = searcher.count(&scene, arithmetic, &mut Contacts::default())?;
            let counted = Op::ALL.iter().map(|&op| (op.name(), tally.get(op)));
            Ok(counted.filter(|&(_, count)| count > 0).collect())
        };
        self.searcher.patient(py, long, || self.fresh(), search)
    }
}

/// What a tracker has done.
#[derive(Clone, Copy, Default)]
struct Done {
    steps: u64,
    builds: u64,
    dangerous: u64,
    listed: u64,
    built: bool,
}

type Course = (Box<dyn Tracker>, Option<ThreadPool>);

/// See the class of the package.
#[pyclass(frozen)]
pub struct Verlet {
    spec: TrackerSpec,
    arithmetic: Arithmetic,
    limit: u64,
    threads: usize,
    course: Owned<Course>,
    done: Mutex<Done>,
}

impl Verlet {
    fn fresh(&self) -> Result<Course, Failure> {
        let options = Options { memory_limit: self.limit, threads: self.threads };
        Ok((self.spec.make(options), crew(self.threads)?))
    }

    fn done(&self) -> MutexGuard<'_, Done> {
        self.done.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl Verlet {
    #[new]
    fn new(
        tracker: &str,
        arithmetic: &str,
        threads: usize,
        memory_limit: Option<u64>,
    ) -> Result<Verlet, Failure> {
        let spec = track::parse(tracker).map_err(Failure::value)?;
        usable(spec.detector(), threads)?;
        let limit = memory_limit.unwrap_or_else(memory::default_limit);
        let arithmetic = self::arithmetic(arithmetic)?;
        let made = spec.make(Options { memory_limit: limit, threads });
        let course = Owned::new((made, crew(threads)?), threads);
        Ok(Verlet { spec, arithmetic, limit, threads, course, done: Mutex::default() })
    }

    #[getter]
    fn name(&self) -> String {
        self.spec.to_string()
    }

    #[getter]
    fn arithmetic(&self) -> &'static str {
        self.arithmetic.name()
    }

    #[getter]
    fn memory_limit(&self) -> u64 {
        self.limit
    }

    fn contacts(
        &self,
        py: Python<'_>,
        x: PyReadonlyArrayDyn<'_, f64>,
        r: PyReadonlyArrayDyn<'_, f64>,
        edges: Option<Edges>,
    ) -> PyResult<Answer> {
        let held = Held::new(&x, &r, edges)?;
        let (arithmetic, limit, long) = (self.arithmetic, self.limit, held.are_many());
        let search = move |(tracker, crew): &mut Course| {
            let arrays = held.arrays();
            let scene = loaded(&arrays, arithmetic, limit)?;
            let mut contacts = room(&arrays, limit);
            let frame = scene.frame(arithmetic);
            let step = by(crew, || tracker.find(frame, None, &mut contacts))?;
            tidy(&mut contacts);
            Ok((contacts, boxed(&scene), step))
        };
        let (found, boxed, step) = self.course.patient(py, long, || self.fresh(), search)?;
        let mut done = self.done();
        done.steps += 1;
        done.builds += u64::from(step.built);
        done.dangerous += u64::from(step.dangerous);
        (done.listed, done.built) = (step.listed, step.built);
        drop(done);
        answer(py, found, boxed)
    }

    /// The next frame is taken as the first.
    fn forget(&self, py: Python<'_>) -> PyResult<()> {
        self.course.patient(
            py,
            true,
            || self.fresh(),
            |(tracker, _)| {
                tracker.forget();
                Ok(())
            },
        )
    }

    /// Steps, builds, dangerous builds, pairs listed in the last step, and whether that built.
    #[getter(done)]
    fn told(&self) -> (u64, u64, u64, u64, bool) {
        let Done { steps, builds, dangerous, listed, built } = *self.done();
        (steps, builds, dangerous, listed, built)
    }
}
