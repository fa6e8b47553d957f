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
pub enum Cell {
    Text(String),
    Whole(i64),
    Number(f64),
    Flag(bool),
}

/// A column: its name, its kind and its values.
type Column = (String, &'static str, Vec<Option<Cell>>);

/// Reads a record from a result folder or from its file. Returns three values: the columns, each
/// with its kind (`text`, `whole`, `number` or `flag`); notes about skipped lines; and the
/// provenance as JSON.
#[pyfunction]
pub fn load(py: Python<'_>, path: PathBuf) -> PyResult<(Vec<Column>, Vec<String>, Vec<String>)> {
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

fn text<'a>(name: &str, values: impl Iterator<Item = Option<&'a str>>) -> Column {
    (name.into(), "text", values.map(|value| Some(Cell::Text(value?.into()))).collect())
}

/// A number beyond the range of i64 becomes an absent value.
fn whole(name: &str, values: impl Iterator<Item = Option<u64>>) -> Column {
    (name.into(), "whole", values.map(|value| Some(Cell::Whole(value?.try_into().ok()?))).collect())
}

fn number(name: &str, values: impl Iterator<Item = Option<f64>>) -> Column {
    (name.into(), "number", values.map(|value| Some(Cell::Number(value?))).collect())
}

fn columns(rows: &[Row]) -> Vec<Column> {
    let all = || rows.iter();
    let subjects: Vec<String> = all().map(|row| row.id.subject()).collect();
    let roles: Vec<String> = all().map(|row| role_of(&row.role)).collect();
    let mut columns = vec![
        text("experiment", all().map(|row| Some(&*row.id.experiment))),
        text("scene", all().map(|row| Some(&*row.id.scene))),
        whole("dim", all().map(|row| Some(row.id.dim.into()))),
        text("order", all().map(|row| Some(&*row.id.order))),
        whole("n", all().map(|row| Some(row.id.n))),
        whole("seed", all().map(|row| Some(row.id.seed))),
        text("arithmetic", all().map(|row| Some(&*row.id.arithmetic))),
        whole("threads", all().map(|row| Some(row.id.threads().into()))),
        text("detector", all().map(|row| Some(&*row.id.detector))),
        text("machine", all().map(|row| row.id.machine.as_deref())),
    ];
    columns.extend(parameters(rows, &columns));
    columns.extend([
        text("contender", subjects.iter().map(|subject| Some(&**subject))),
        text("role", roles.iter().map(|role| Some(&**role))),
        text("pass", all().map(|row| Some(row.pass.name()))),
        whole("block", all().map(|row| Some(row.block.into()))),
        text("outcome", all().map(|row| Some(row.outcome.name()))),
        text("reason", all().map(|row| Some(&*row.reason))),
        text("digest", all().map(|row| row.digest.as_deref())),
        whole("calls", all().map(|row| row.calls)),
        whole("elapsed_ns", all().map(|row| row.elapsed_ns)),
    ]);
    columns.extend(COLUMNS.iter().map(|column| {
        let numbers = all().map(|row| column.read(row));
        match column.is_whole() {
            // All numbers are below 2^53, or the reader has rounded them.
            true => whole(&column.name, numbers.map(|x| x.map(|x| x as u64))),
            false => number(&column.name, numbers),
        }
    }));
    columns.extend([
        text("scene_hash", all().map(|row| Some(&*row.stats.scene_hash))),
        text("process", all().map(|row| row.process.as_deref())),
        text("span", all().map(|row| row.span.as_deref())),
    ]);
    columns
}

/// Returns a column for each parameter of scenes and detectors that is not among `known`.
fn parameters(rows: &[Row], known: &[Column]) -> Vec<Column> {
    let scenes = rows.iter().flat_map(|row| row.id.parameters()).map(|(name, _)| name);
    let detectors = rows.iter().flat_map(|row| row.id.detector_parameters());
    let names: BTreeSet<String> = scenes.chain(detectors.map(|(name, _)| name)).collect();
    let new = names.iter().filter(|name| known.iter().all(|(known, ..)| known != *name));
    new.map(|name| parameter(name, rows.iter().map(|row| row.id.axis(name)).collect())).collect()
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
fn parameter(name: &str, values: Vec<Option<AxisValue>>) -> Column {
    if values.iter().flatten().all(|value| matches!(value, AxisValue::Bool(_))) {
        let flag = |value: &AxisValue| Cell::Flag(matches!(value, AxisValue::Bool(true)));
        return (
            name.into(),
            "flag",
            values.iter().map(|value| value.as_ref().map(flag)).collect(),
        );
    }
    if values.iter().flatten().all(|value| value.number().is_some()) {
        return number(name, values.iter().map(|value| value.as_ref()?.number()));
    }
    let texts: Vec<_> =
        values.iter().map(|value| value.as_ref().map(AxisValue::to_string)).collect();
    text(name, texts.iter().map(Option::as_deref))
}

/// Makes a scene from a text such as `packed:dim=3,n=1000`, and returns its arrays and box.
#[pyfunction]
pub fn scene(py: Python<'_>, text: &str) -> PyResult<(Made, Option<Edges>)> {
    let given = work(py, || Ok(pool(1)?.install(|| Spec::parse(text)?.given())?))?;
    let Given { scene, lattice, .. } = given;
    let edges = lattice.map(|lattice| (*lattice.vectors(), lattice.periodic(), lattice.origin()));
    Ok((made(py, &scene)?, edges))
}
