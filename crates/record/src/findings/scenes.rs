//! Every contender on the scenes that an answer shows, in every setting that was measured.

use std::collections::BTreeSet;

use crate::cells::Cell;
use crate::findings::every::{Scene, every};
use crate::findings::winners::{by_ratio, time};
use crate::record::row::Outcome;
use crate::stats::interval::Interval;

#[derive(Clone, Debug, PartialEq)]
pub struct SceneResults {
    pub title: String,
    pub results: Vec<Contender>,
}

/// What was measured of a contender; numbers are per particle.
#[derive(Clone, Debug, PartialEq)]
pub struct Contender {
    pub name: String,
    /// Nanoseconds; of a wrong answer, too.
    pub time: Option<f64>,
    /// The same of the blocks in which the machine was not slow.
    pub quiet: Option<f64>,
    /// Nanoseconds per particle of the first detection in a process.
    pub first: Option<f64>,
    pub blocks: usize,
    /// Its time over that of the fastest, which has 1.
    pub versus: Versus,
    /// Pairs whose distance was compared.
    pub contact_tests: Option<f64>,
    pub list_operations: Option<f64>,
    /// Most heap bytes at one time.
    pub peak_bytes: Option<f64>,
    /// The same by the detector's formula.
    pub formula_bytes: Option<f64>,
    pub outcome: Outcome,
}

/// A time beside that of the fastest contender of any setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Versus {
    Fastest,
    Slower(Interval),
    /// No time, or no common block.
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
            let mut name = cell.id.contender();
            if arithmetics {
                name += &format!(" {}", cell.id.arithmetic);
            }
            match cell.id.threads() {
                1 if threads => name += " (1 thread)",
                count if threads => name += &format!(" ({count} threads)"),
                _ => {}
            }
            contender(cell, name, scene.n.max(1) as f64, fastest)
        };
        SceneResults { title: scene.title, results: cells.iter().map(result).collect() }
    };
    every(cells).into_iter().filter(|scene| scene.shown).map(results).collect()
}

fn contender(cell: &Cell, name: String, n: f64, fastest: Option<&Cell>) -> Contender {
    let per = |name: &str| cell.variable(name, None).map(|value| value / n);
    // As the time is that of a step.
    let per_step = |name: &str| per(name).map(|value| value / cell.frames());
    let lists = ["list_push", "list_step", "list_reset"];
    Contender {
        name,
        time: cell.wrong_time().or(cell.time().map(|time| time.median)).map(|time| time / n),
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
        formula_bytes: per("formula_bytes"),
        outcome: cell.overall().0,
    }
}
