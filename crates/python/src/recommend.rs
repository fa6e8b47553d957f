//! Recommends a detector for a scene.

use std::time::Duration;

use contactbench_ground::detect::Options;
use contactbench_ground::limits::memory::limit_for;
use contactbench_run::recommend::race::{self, Question};
use contactbench_run::recommend::verdict::Verdict;
use contactbench_run::recommend::words::as_json;
use contactbench_run::run::runner::server::Server;
use contactbench_scenes::Given;
use numpy::PyReadonlyArrayDyn;
use pyo3::prelude::*;

use crate::failure::{Failure, Stop, patient, pool, work};
use crate::given::{Arrays, Edges, arithmetic};

/// Measures like `contactbench recommend`, and returns the JSON of its option `--json`. Detectors
/// run in processes that `program` starts: Python interpreters that call [`serve`].
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn recommend(
    py: Python<'_>,
    x: PyReadonlyArrayDyn<'_, f64>,
    r: PyReadonlyArrayDyn<'_, f64>,
    edges: Option<Edges>,
    arithmetic: &str,
    threads: usize,
    seconds: f64,
    memory_limit: Option<u64>,
    program: Vec<String>,
) -> PyResult<String> {
    let arrays = Arrays::new(&x, &r, edges)?;
    let arithmetic = self::arithmetic(arithmetic)?;
    if !(0.1..1e6).contains(&seconds) {
        Err(Failure::value(format!("seconds is {seconds}; give a number from 0.1 to 10^6")))?;
    }
    if arrays.len() == 0 {
        Err(Failure::value("the scene has no particles; there is nothing to recommend"))?;
    }
    let given = match arrays.lattice()? {
        Some(lattice) => Given::in_box(arrays.owned()?, lattice).map_err(Failure::from)?,
        None => arrays.owned()?.into(),
    };
    let particles = arrays.len();
    let race = move |stop: &Stop| {
        let question = Question {
            given: &given,
            history: &[],
            arithmetic,
            threads,
            memory_limit: memory_limit.unwrap_or_else(|| limit_for(particles)),
            time: Duration::from_secs_f64(seconds),
            program,
        };
        let race = pool(threads)?.install(|| race::run(&question, &mut |_| stop.look()))?;
        Ok(as_json(Verdict::new(&race).as_ref(), &race, particles).to_string())
    };
    patient(py, race)
}

/// Serves the protocol of runners until standard input ends.
#[pyfunction]
pub fn serve(
    py: Python<'_>,
    detector: &str,
    arithmetic: &str,
    threads: usize,
    memory_limit: u64,
) -> PyResult<()> {
    work(py, || {
        if threads > 1 {
            // This only fails if a pool exists, and this process has not made one.
            let _ = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
        }
        let options = Options { memory_limit, threads };
        let mut server = Server::new(detector, self::arithmetic(arithmetic)?, options)?;
        let served = server.serve(std::io::stdin().lock(), std::io::stdout().lock());
        served.map_err(|error| Failure::value(format!("the harness is gone: {error}")))
    })
}
