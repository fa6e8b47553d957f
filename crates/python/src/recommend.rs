//! Which detector for a scene.

use std::process::ExitCode;
use std::time::Duration;

use clap::Parser;
use contactbench::cli::{Cli, Verb, runner};
use contactbench::recommend::race::{self, Question};
use contactbench::recommend::verdict::Verdict;
use contactbench::scene::Given;
use contactbench::shown::recommendation;
use contactbench_core::memory::limit_for;
use numpy::PyReadonlyArrayDyn;
use pyo3::prelude::*;

use crate::failure::{Failure, by_threads, patient, work};
use crate::given::{Edges, Held, arithmetic};

/// The race of `contactbench recommend`, as the JSON of its option `--json`. Detectors work in
/// processes of their own, which `program` starts: an interpreter that calls [`serve`].
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
    let held = Held::new(&x, &r, edges)?;
    let arrays = held.arrays();
    let arithmetic = self::arithmetic(arithmetic)?;
    if !(0.1..1e6).contains(&seconds) {
        return Err(Failure::value(format!(
            "seconds is {seconds}; give a number from 0.1 to 10^6"
        ))
        .into());
    }
    if arrays.len() == 0 {
        return Err(
            Failure::value("the scene has no particles; there is nothing to recommend").into()
        );
    }
    patient(py, true, move |stop| {
        let arrays = held.arrays();
        let given = match arrays.lattice()? {
            Some(lattice) => Given::in_box(arrays.owned()?, lattice)?,
            None => arrays.owned()?.into(),
        };
        let question = Question {
            given: &given,
            history: &[],
            arithmetic,
            threads,
            memory_limit: memory_limit.unwrap_or_else(|| limit_for(arrays.len())),
            time: Duration::from_secs_f64(seconds),
            program,
        };
        let race = by_threads(threads, || Ok(race::run(&question, &mut |_| stop.look())?))?;
        Ok(recommendation::as_json(Verdict::new(&race).as_ref(), &race, arrays.len()).to_string())
    })
}

/// Serves as a runner, with the arguments of `contactbench runner`, until the end of the input.
#[pyfunction]
pub fn serve(py: Python<'_>, arguments: Vec<String>) -> PyResult<bool> {
    work(py, || {
        let arguments = std::iter::once("contactbench".to_string()).chain(arguments);
        match Cli::try_parse_from(arguments).map_err(Failure::value)?.verb {
            Some(Verb::Runner(options)) => Ok(runner::serve(&options)? == ExitCode::SUCCESS),
            _ => Err(Failure::value("a runner is started by the verb 'runner'")),
        }
    })
}
