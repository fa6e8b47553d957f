//! Records as columns, and scenes from generators.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use contactbench_record::record::column::COLUMNS;
use contactbench_record::record::folder;
use contactbench_record::record::origin::provenance;
use contactbench_record::record::role::Role;
use contactbench_record::record::row::{self, Record, Row};
use contactbench_record::record::value::AxisValue;
use contactbench_scenes::Given;
use contactbench_scenes::spec::Spec;
use pyo3::prelude::*;

use crate::failure::{Failure, pool, work};
use crate::given::{Edges, Made, made};

#[derive(IntoPyObject)]
pub enum Values {
    Text(Vec<Option<String>>),
    Whole(Vec<Option<i64>>),
    Number(Vec<Option<f64>>),
    Flag(Vec<Option<bool>>),
}

/// Reads a record from a result folder or from its file. Returns three values: the columns, each
/// with its kind (`text`, `whole`, `number` or `flag`); notes about skipped lines; and the
/// provenance as JSON.
#[pyfunction]
pub fn load(
    py: Python<'_>,
    path: PathBuf,
) -> PyResult<(Vec<(String, &'static str, Values)>, Vec<String>, Vec<String>)> {
    work(py, || {
        let file = if path.is_dir() { path.join(row::FILE) } else { path };
        let around = file.parent().filter(|folder| !folder.as_os_str().is_empty());
        let around = around.unwrap_or(Path::new(".")).to_path_buf();
        folder::sound(&around).map_err(Failure::value)?;
        let Record { rows, warnings, .. } = row::read(&file)?;
        let provenance = provenance::all(&around).iter().map(ToString::to_string).collect();
        Ok((columns(&rows), warnings, provenance))
    })
}

fn columns(rows: &[Row]) -> Vec<(String, &'static str, Values)> {
    let text = |name: &str, of: fn(&Row) -> Option<&str>| {
        let values = rows.iter().map(|row| of(row).map(str::to_string)).collect();
        (name.to_string(), "text", Values::Text(values))
    };
    let whole = |name: &str, of: fn(&Row) -> Option<u64>| {
        // A number beyond the range of i64 becomes an absent value.
        let values = rows.iter().map(|row| of(row).and_then(|x| x.try_into().ok())).collect();
        (name.to_string(), "whole", Values::Whole(values))
    };
    let mut columns = vec![
        text("experiment", |row| Some(&row.id.experiment)),
        text("scene", |row| Some(&row.id.scene)),
        whole("dim", |row| Some(row.id.dim.into())),
        text("order", |row| Some(&row.id.order)),
        whole("n", |row| Some(row.id.n)),
        whole("seed", |row| Some(row.id.seed)),
        text("arithmetic", |row| Some(&row.id.arithmetic)),
        whole("threads", |row| Some(row.id.threads().into())),
        text("detector", |row| Some(&row.id.detector)),
        text("machine", |row| row.id.machine.as_deref()),
    ];
    let known: BTreeSet<String> = columns.iter().map(|(name, ..)| name.clone()).collect();
    let scenes = rows.iter().flat_map(|row| row.id.parameters());
    let detectors = rows
        .iter()
        .flat_map(|row| row.id.detector_parameters().map(|(name, value)| (name, value.clone())));
    let names: BTreeSet<String> = scenes.chain(detectors).map(|(name, _)| name).collect();
    for name in names.difference(&known) {
        let values = rows.iter().map(|row| row.id.axis(name)).collect();
        columns.push(parameter(name, values));
    }
    let subject = rows.iter().map(|row| row.id.subject()).map(Some).collect();
    columns.push(("contender".into(), "text", Values::Text(subject)));
    let role = rows.iter().map(|row| Some(role_of(&row.role))).collect();
    columns.push(("role".into(), "text", Values::Text(role)));
    columns.extend([
        text("pass", |row| Some(row.pass.name())),
        whole("block", |row| Some(row.block.into())),
        text("outcome", |row| Some(row.outcome.name())),
        text("reason", |row| Some(&row.reason)),
        text("digest", |row| row.digest.as_deref()),
        whole("calls", |row| row.calls),
        whole("elapsed_ns", |row| row.elapsed_ns),
    ]);
    for column in COLUMNS.iter() {
        let name = column.name.to_string();
        let numbers = rows.iter().map(|row| column.read(row));
        columns.push(match column.is_whole() {
            // All numbers are below 2^53, or the reader has rounded them.
            true => {
                let values = numbers.map(|x| x.map(|x| x as i64)).collect();
                (name, "whole", Values::Whole(values))
            }
            false => (name, "number", Values::Number(numbers.collect())),
        });
    }
    columns.extend([
        text("scene_hash", |row| Some(&row.stats.scene_hash)),
        text("process", |row| row.process.as_deref()),
        text("span", |row| row.span.as_deref()),
    ]);
    columns
}

/// Returns the role as `detector`, `peer`, `runner`, `nothing`, `twin of NAME` or `base of NAME`.
fn role_of(role: &Role) -> String {
    match role {
        Role::Detector => "detector".into(),
        Role::Peer => "peer".into(),
        Role::Runner => "runner".into(),
        Role::Nothing => "nothing".into(),
        Role::Twin(name) => format!("twin of {name}"),
        Role::Base(name) => format!("base of {name}"),
    }
}

/// Returns a parameter's column with the simplest kind that holds all of its values.
fn parameter(name: &str, values: Vec<Option<AxisValue>>) -> (String, &'static str, Values) {
    let name = name.to_string();
    let all = |is: fn(&AxisValue) -> bool| values.iter().flatten().all(is);
    if all(|value| matches!(value, AxisValue::Bool(_))) {
        let flag = |value: &AxisValue| matches!(value, AxisValue::Bool(true));
        let values = values.iter().map(|value| value.as_ref().map(flag)).collect();
        return (name, "flag", Values::Flag(values));
    }
    if all(|value| value.number().is_some()) {
        let numbers: Vec<Option<f64>> =
            values.iter().map(|value| value.as_ref().and_then(AxisValue::number)).collect();
        return (name, "number", Values::Number(numbers));
    }
    let values = values.iter().map(|value| value.as_ref().map(ToString::to_string)).collect();
    (name, "text", Values::Text(values))
}

/// Makes a scene from a text such as `packed:dim=3,n=1000`, and returns its arrays and box.
#[pyfunction]
pub fn scene(py: Python<'_>, text: &str) -> PyResult<(Made, Option<Edges>)> {
    let given = work(py, || Ok(pool(1)?.install(|| Spec::parse(text)?.given())?))?;
    let Given { scene, lattice, .. } = given;
    let edges = lattice.map(|lattice| (*lattice.vectors(), lattice.periodic(), lattice.origin()));
    Ok((made(py, &scene)?, edges))
}
