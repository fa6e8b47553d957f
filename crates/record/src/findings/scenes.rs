//! The table of details: every subject on every shown scene, in every measured setting.

use std::collections::BTreeSet;

use crate::cells::Cell;
use crate::findings::claim::every::{Scene, every};
use crate::findings::winners::{by_ratio, time};
use crate::record::row::Outcome;
use crate::stats::interval::Interval;

#[derive(Clone, Debug, PartialEq)]
pub struct SceneResults {
    pub title: String,
    pub results: Vec<SubjectResult>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct SubjectResult {
    pub name: String,
    /// Median time in nanoseconds, even of a wrong answer.
    pub time: Option<f64>,
    pub time_per_pair: Option<f64>,
    /// Median time in nanoseconds of the blocks in which the machine was not slow.
    pub quiet: Option<f64>,
    /// Time of the first detection in a process, in nanoseconds.
    pub first: Option<f64>,
    pub blocks: usize,
    pub versus: Versus,
    pub contact_tests: Option<f64>,
    pub list_operations: Option<f64>,
    pub peak_bytes: Option<f64>,
    pub bytes_per_pair: Option<f64>,
    pub formula_bytes: Option<f64>,
    pub outcome: Outcome,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Versus {
    Fastest,
    Slower(Interval),
    Unknown,
}

pub fn scenes(cells: &[&Cell]) -> Vec<SceneResults> {
    let results = |scene: Scene<'_>| {
        let right = |cell: &&Cell| !cell.role.is_control() && time(cell).is_finite();
        let (right, others): (Vec<&Cell>, Vec<&Cell>) = scene.cells.into_iter().partition(right);
        let right = by_ratio(right);
        let fastest = right.first().copied();
        let mut cells = [right, others].concat();
        let place = |cell: &Cell| {
            let ratio = fastest.and_then(|fastest| cell.ratio(fastest));
            ratio.map_or(f64::INFINITY, |ratio| ratio.median)
        };
        cells.sort_by(|a, b| place(a).total_cmp(&place(b)));
        let several = |field: &str| {
            cells.iter().map(|cell| cell.id.axis(field)).collect::<BTreeSet<_>>().len() > 1
        };
        let (arithmetics, threads) = (several("arithmetic"), several("threads"));
        let result = |cell: &&Cell| {
            let mut name = cell.id.subject();
            if arithmetics {
                name += &format!(" {}", cell.id.arithmetic);
            }
            match cell.id.threads() {
                1 if threads => name += " (1 thread)",
                count if threads => name += &format!(" ({count} threads)"),
                _ => {}
            }
            subject(cell, name, scene.n.max(1) as f64, fastest)
        };
        SceneResults { title: scene.title, results: cells.iter().map(result).collect() }
    };
    every(cells).into_iter().filter(|scene| scene.shown).map(results).collect()
}

fn subject(cell: &Cell, name: String, n: f64, fastest: Option<&Cell>) -> SubjectResult {
    let per = |name: &str| cell.variable(name, None).map(|value| value / n);
    let per_step = |name: &str| per(name).map(|value| value / cell.frames());
    let lists = ["list_push", "list_step", "list_reset"];
    SubjectResult {
        name,
        time: cell.wrong_time().or(cell.time().map(|time| time.median)).map(|time| time / n),
        time_per_pair: cell.time().and_then(|time| cell.per_pair(time.median)),
        quiet: cell.quiet_time().map(|time| time / n),
        first: per("first_ns"),
        blocks: cell.times.len(),
        versus: match (fastest, cell.time()) {
            (Some(fastest), Some(_)) if fastest.id == cell.id => Versus::Fastest,
            (Some(fastest), Some(_)) => cell.ratio(fastest).map_or(Versus::Unknown, Versus::Slower),
            _ => Versus::Unknown,
        },
        contact_tests: per_step("contact_test"),
        list_operations: lists.into_iter().map(per_step).sum(),
        peak_bytes: per("peak_bytes"),
        bytes_per_pair: cell.variable("peak_bytes", None).and_then(|bytes| cell.per_pair(bytes)),
        formula_bytes: per("formula_bytes"),
        outcome: cell.overall().0,
    }
}
