//! Checks a Python function that finds contacts on small hard scenes.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use contactbench_ground::periodic::ImagePair;
use contactbench_ground::scene::AnyScene;
use contactbench_run::check::answer::Answer;
use contactbench_run::check::subject::CheckedSubject;
use contactbench_run::check::{Failure as Found, Limits, Wrong, battery};
use numpy::{PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::exceptions::{PyException, PyMemoryError, PyNotImplementedError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::failure::{Failure, Refused, work};
use crate::given::{arithmetic, made};

/// Calls `function(x, r)`, which returns an array of whole numbers (M, 2), for every scene in open
/// space. Returns a dictionary with the fields of the Python class `Check`.
#[pyfunction]
pub fn check<'py>(
    py: Python<'py>,
    function: Py<PyAny>,
    name: String,
    arithmetic: &str,
    seconds: f64,
) -> PyResult<Bound<'py, PyDict>> {
    let arithmetic = self::arithmetic(arithmetic)?;
    if !(0.0..1e6).contains(&seconds) {
        Err(Failure::value(format!("seconds is {seconds}; give a number from 0 to 10^6")))?;
    }
    let limits = Limits { time: Duration::from_secs_f64(seconds), ..Limits::default() };
    let stopped = Arc::new(Mutex::new(None));
    let stop = stopped.clone();
    let ask = move |scene: &AnyScene<'static>| {
        let answered = Python::attach(|py| answer(py, &function, scene));
        let mut stop = stop.lock().unwrap_or_else(PoisonError::into_inner);
        // After a stop, the function must not be called again.
        anyhow::ensure!(stop.is_none(), "stopped");
        answered.map_err(|error| {
            *stop = Some(error);
            anyhow::anyhow!("stopped")
        })
    };
    let subjects = [CheckedSubject::Function { name, ask: Arc::new(ask) }];
    // The function runs on the caller's thread, where Ctrl-C can interrupt it.
    let report = work(py, || {
        let report = battery(&subjects, &[arithmetic], &limits);
        match stopped.lock().unwrap_or_else(PoisonError::into_inner).take() {
            Some(error) => Err(error.into()),
            None => Ok(report?),
        }
    })?;
    let failures = report.failures.iter().map(|failure| found(py, failure));
    let out = dict!(py, report => cases, scenes, cut);
    out.set_item("failures", failures.collect::<PyResult<Vec<_>>>()?)?;
    out.set_item("refused", report.refused.into_iter().collect::<BTreeMap<_, _>>())?;
    Ok(out)
}

/// Calls the user's function for one scene; fails if the check must stop, as after Ctrl-C.
fn answer(py: Python<'_>, function: &Py<PyAny>, scene: &AnyScene<'static>) -> PyResult<Answer> {
    py.check_signals()?;
    let (x, r, _) = made(py, scene)?;
    let pairs = match function.call1(py, (x, r)) {
        Ok(pairs) => pairs,
        Err(error)
            if error.is_instance_of::<PyNotImplementedError>(py)
                || error.is_instance_of::<Refused>(py)
                || error.is_instance_of::<PyMemoryError>(py) =>
        {
            return Ok(Answer::Declined(error.value(py).to_string()));
        }
        Err(error) if error.is_instance_of::<PyException>(py) => {
            return Ok(Answer::Wrong(Wrong::Fails(format!("raises {error}"))));
        }
        Err(error) => return Err(error),
    };
    let pairs = pairs.bind(py).cast::<PyArray2<i64>>()?;
    let pairs: PyReadonlyArray2<'_, i64> = pairs.readonly();
    let mut named = Vec::new();
    for row in pairs.as_array().rows() {
        let place = |name: i64| u32::try_from(name).ok().filter(|&k| (k as usize) < scene.len());
        let (Some(i), Some(j)) = (place(row[0]), place(row[1])) else {
            return Ok(Answer::Wrong(Wrong::Fails(format!(
                "reports the pair {},{} in a scene of {} particles",
                row[0],
                row[1],
                scene.len()
            ))));
        };
        named.push(ImagePair::new(i, j, [0; 3]));
    }
    Ok(Answer::Pairs(named))
}

fn found<'py>(py: Python<'py>, failure: &Found) -> PyResult<Bound<'py, PyDict>> {
    let scene = |scene| made(py, scene).map(|(x, r, _)| (x, r));
    Ok(dict!(py;
        found_on: &failure.found_on,
        found: failure.found.to_string(),
        given: scene(&failure.given.scene)?,
        wrong: failure.wrong.as_ref().map(Wrong::to_string),
        smallest: scene(&failure.smallest.scene)?,
    ))
}
