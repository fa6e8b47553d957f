//! Detectors and trackers that keep their buffers.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use contactbench_core::contact::Arithmetic;
use contactbench_core::crowd;
use contactbench_core::detect::Options;
use contactbench_core::detect::spec::{self, DetectorSpec};
use contactbench_core::memory;
use contactbench_core::pair_list::PAIR_BYTES;
use contactbench_core::periodic::Contacts;
use contactbench_core::probe::Op;
use contactbench_core::searcher::{Loaded, Searcher};
use contactbench_core::track::{self, Tracker};
use numpy::{PyArray2, PyReadonlyArrayDyn};
use pyo3::prelude::*;
use rayon::ThreadPool;

use crate::failure::{Failure, pool, work};
use crate::given::{Arrays, Edges, answer, arithmetic, tidy};

type Answer = (Py<PyArray2<u32>>, Option<Py<PyArray2<i32>>>);

/// A detector of the table, which can use so many threads.
fn detector(text: &str, threads: usize) -> Result<DetectorSpec, Failure> {
    let spec = spec::parse(text).map_err(Failure::value)?;
    within(&spec, threads)?;
    Ok(spec)
}

fn within(spec: &DetectorSpec, threads: usize) -> Result<(), Failure> {
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

/// Refuses an open scene whose pairs are sure to be too many.
fn loaded<'a>(
    arrays: &Arrays<'a>,
    arithmetic: Arithmetic,
    limit: u64,
) -> Result<Loaded<'a>, Failure> {
    let loaded = Loaded::new(&arrays.scene()?, arrays.lattice()?, arithmetic)?;
    if let Loaded::Open(scene) = &loaded {
        crowd::within(scene, limit)?;
    }
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

/// See the class of the package.
#[pyclass(frozen)]
pub struct Detector {
    spec: DetectorSpec,
    arithmetic: Arithmetic,
    threads: usize,
    limit: u64,
    searcher: Mutex<(Searcher, Option<ThreadPool>)>,
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
        let searcher = Mutex::new((Searcher::new(&spec, options), crew(threads)?));
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
        let arrays = Arrays::new(&x, &r, edges)?;
        let (found, boxed) = work(py, || {
            let scene = loaded(&arrays, self.arithmetic, self.limit)?;
            let mut held = self.searcher.lock().unwrap_or_else(PoisonError::into_inner);
            let (searcher, crew) = &mut *held;
            let mut contacts = room(&arrays, self.limit);
            by(crew, || searcher.list(&scene, self.arithmetic, &mut contacts))?;
            tidy(&mut contacts);
            Ok((contacts, boxed(&scene)))
        })?;
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
        let arrays = Arrays::new(&x, &r, edges)?;
        work(py, || {
            let scene = loaded(&arrays, self.arithmetic, self.limit)?;
            let mut held = self.searcher.lock().unwrap_or_else(PoisonError::into_inner);
            let mut contacts = Contacts::default();
            let tally = held.0.count(&scene, self.arithmetic, &mut contacts)?;
            let counted = Op::ALL.iter().map(|&op| (op.name(), tally.get(op)));
            Ok(counted.filter(|&(_, count)| count > 0).collect())
        })
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

struct Course {
    tracker: Box<dyn Tracker>,
    crew: Option<ThreadPool>,
    done: Done,
}

/// See the class of the package.
#[pyclass(frozen)]
pub struct Verlet {
    name: String,
    arithmetic: Arithmetic,
    limit: u64,
    course: Mutex<Course>,
}

impl Verlet {
    fn with<R>(&self, look: impl FnOnce(&mut Course) -> R) -> R {
        look(&mut self.course.lock().unwrap_or_else(PoisonError::into_inner))
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
        within(spec.detector(), threads)?;
        let limit = memory_limit.unwrap_or_else(memory::default_limit);
        let tracker = spec.make(Options { memory_limit: limit, threads });
        let course = Mutex::new(Course { tracker, crew: crew(threads)?, done: Done::default() });
        let arithmetic = self::arithmetic(arithmetic)?;
        Ok(Verlet { name: spec.to_string(), arithmetic, limit, course })
    }

    #[getter]
    fn name(&self) -> &str {
        &self.name
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
        let arrays = Arrays::new(&x, &r, edges)?;
        let (found, boxed) = work(py, || {
            let scene = loaded(&arrays, self.arithmetic, self.limit)?;
            let mut contacts = room(&arrays, self.limit);
            self.with(|Course { tracker, crew, done }| {
                let step = by(crew, || match &scene {
                    Loaded::Open(scene) => {
                        let test = self.arithmetic.test();
                        tracker.step(scene, test, None, &mut contacts.plain)
                    }
                    Loaded::InBox(scene) => {
                        tracker.step_in_box(scene, self.arithmetic, None, &mut contacts)
                    }
                })?;
                done.steps += 1;
                done.builds += u64::from(step.built);
                done.dangerous += u64::from(step.dangerous);
                (done.listed, done.built) = (step.listed, step.built);
                Ok::<_, Failure>(())
            })?;
            tidy(&mut contacts);
            Ok((contacts, boxed(&scene)))
        })?;
        answer(py, found, boxed)
    }

    /// The next frame is taken as the first.
    fn forget(&self, py: Python<'_>) {
        py.detach(|| self.with(|course| course.tracker.forget()));
    }

    /// Steps, builds, dangerous builds, pairs listed in the last step, and whether that built.
    #[getter]
    fn done(&self, py: Python<'_>) -> (u64, u64, u64, u64, bool) {
        let Done { steps, builds, dangerous, listed, built } =
            py.detach(|| self.with(|course| course.done));
        (steps, builds, dangerous, listed, built)
    }
}
