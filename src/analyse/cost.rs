//! What an operation costs on one machine: time = constant + sum over kinds of operations of count times cost.
//!
//! * **One fit per detector, arithmetic and order of the elements.** A list step of one detector is a cache miss, of another a register;
//!   and the order of the elements changes no count, but what each costs. One cost for all would be an average of different things.
//! * **Operations that go together are one kind.** Counts of one detector are often multiples of each other (every element is pushed
//!   once and reset once). Where the columns of the fit enclose an angle whose cosine is over [`TOGETHER`], the times cannot tell them
//!   apart: their counts are added, and the cost is that of one of any of them.
//! * **Costs are not negative**, and each cell weighs alike: the sum of squares of (model - time) / time is made smallest.
//! * **How sure a cost is** is shown by leaving out one scene after the other: the range of what is then found.
//!
//! The model has one cost for an operation whether its data are in a cache or not: what it cannot say is in the residuals. Crossovers
//! follow from counts continued as powers of N, scene by scene; their range is where the two predictions differ by no more than the
//! typical residuals. Those beyond the N that were measured are marked.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use super::grid::{self, Line};
use super::interval::median;
use super::nnls;
use super::summary::is_control;
use super::value::Cell;
use crate::harness::record::Pass;
use crate::probe::Op;

/// Kinds of operations whose columns are nearer to each other than this are one.
pub const TOGETHER: f64 = 0.99;
/// What is counted besides operations.
const PAIRS: &str = "pair";

/// Kinds of operations, and what one of them costs.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// The operations; none: the constant per detection.
    pub operations: Vec<&'static str>,
    /// Nanoseconds for one.
    pub ns: f64,
    /// The least found when a scene is left out.
    pub low: f64,
    /// The most.
    pub high: f64,
}

/// The costs of one detector.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Which detector.
    pub line: Line,
    /// Order of the elements.
    pub order: String,
    /// The constant last.
    pub terms: Vec<Term>,
    /// Cells that entered.
    pub cells: usize,
    /// Median of the relative residuals, without sign.
    pub typical: f64,
    /// The largest.
    pub worst: f64,
    /// Where that is.
    pub place: String,
}

/// A detector on one scene: cells by N.
pub(super) struct Series<'a> {
    pub line: Line,
    pub scene: String,
    pub order: String,
    pub cells: BTreeMap<u64, &'a Cell>,
}

fn count(cell: &Cell, operation: &str) -> f64 {
    let name = if operation == PAIRS { "contacts" } else { operation };
    cell.variable(name, None).unwrap_or(0.0)
}

impl Term {
    /// How many of these operations a detection makes.
    pub fn count(&self, cell: &Cell) -> f64 {
        if self.operations.is_empty() { 1.0 } else { self.operations.iter().map(|operation| count(cell, operation)).sum() }
    }
}

impl Fit {
    /// The predicted nanoseconds of a cell.
    pub fn at(&self, cell: &Cell) -> f64 {
        self.terms.iter().map(|term| term.ns * term.count(cell)).sum()
    }
}

/// The cells that can enter: right, timed and counted, one thread, the first seed.
pub(super) fn series<'a>(cells: &[&'a Cell]) -> Vec<Series<'a>> {
    let mut found = Vec::new();
    for group in grid::groups(cells) {
        for (line, sizes) in group.lines.iter().filter(|(line, _)| line.threads == 1 && !is_control(&line.detector)) {
            let able =
                |cell: &Cell| cell.outcome(&[Pass::Time, Pass::Count]).0.is_good() && cell.counts.as_ref().is_some_and(|c| !c.is_empty());
            let first = |(&n, cells): (&u64, &grid::Seeds<'a>)| {
                cells.first().filter(|cell| able(cell) && cell.time().is_some()).map(|cell| (n, *cell))
            };
            let cells: BTreeMap<u64, &Cell> = sizes.iter().filter_map(first).collect();
            if let Some(cell) = cells.values().next() {
                found.push(Series { line: line.clone(), scene: group.title.clone(), order: cell.key.order.clone(), cells });
            }
        }
    }
    found
}

/// The fits of all detectors that have at least two cells per term.
pub(super) fn fits(series: &[Series<'_>]) -> Vec<Fit> {
    let mut by_line: BTreeMap<(&str, &Line), Vec<&Series<'_>>> = BTreeMap::new();
    for one in series {
        by_line.entry((&one.order, &one.line)).or_default().push(one);
    }
    by_line.values().filter_map(|series| fit(series)).collect()
}

fn fit(series: &[&Series<'_>]) -> Option<Fit> {
    let all: Vec<(usize, &Cell)> = series.iter().enumerate().flat_map(|(k, one)| one.cells.values().map(move |cell| (k, *cell))).collect();
    let groups = kinds(&all.iter().map(|(_, cell)| *cell).collect::<Vec<_>>());
    if all.len() < 2 * (groups.len() + 1) {
        return None;
    }
    let costs = |left_out: Option<usize>| {
        let cells: Vec<&Cell> = all.iter().filter(|(k, _)| Some(*k) != left_out).map(|(_, cell)| *cell).collect();
        least_squares(&groups, &cells)
    };
    let found = costs(None)?;
    let others: Vec<Vec<f64>> = (0..series.len()).filter(|_| series.len() > 2).filter_map(|k| costs(Some(k))).collect();
    let terms = groups.into_iter().enumerate().map(|(k, operations)| {
        let range = others.iter().map(|costs| costs[k]).chain([found[k]]);
        let (low, high) = range.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), v| (low.min(v), high.max(v)));
        Term { operations, ns: found[k], low, high }
    });
    let (line, order) = (series.first()?.line.clone(), series.first()?.order.clone());
    let mut fit = Fit { line, order, terms: terms.collect(), cells: all.len(), typical: 0.0, worst: 0.0, place: String::new() };
    let residual = |cell: &Cell| cell.time().map_or(0.0, |time| (fit.at(cell) / time.median - 1.0).abs());
    let residuals: Vec<f64> = all.iter().map(|(_, cell)| residual(cell)).collect();
    let (worst, (at, cell)) = residuals.iter().zip(&all).max_by(|a, b| a.0.total_cmp(b.0))?;
    (fit.typical, fit.worst, fit.place) = (median(&residuals)?, *worst, format!("{}, N = {}", series[*at].scene, cell.key.n));
    Some(fit)
}

/// Costs of these kinds, by non-negative least squares on relative residuals.
fn least_squares(groups: &[Vec<&'static str>], cells: &[&Cell]) -> Option<Vec<f64>> {
    let times: Vec<f64> = cells.iter().map(|cell| cell.time().map(|time| time.median.max(1.0))).collect::<Option<_>>()?;
    let term = |operations: &Vec<&'static str>| Term { operations: operations.clone(), ns: 0.0, low: 0.0, high: 0.0 };
    let terms: Vec<Term> = groups.iter().map(term).collect();
    let matrix = DMatrix::from_fn(cells.len(), terms.len(), |row, column| terms[column].count(cells[row]) / times[row]);
    Some(nnls::solve(&matrix, &DVector::from_element(cells.len(), 1.0))?.iter().copied().collect())
}

/// The kinds of operations that the times of these cells can tell apart; the constant last.
fn kinds(cells: &[&Cell]) -> Vec<Vec<&'static str>> {
    let column = |operations: &[&str]| -> DVector<f64> {
        let relative =
            |cell: &&Cell| operations.iter().map(|name| count(cell, name)).sum::<f64>() / cell.time().map_or(1.0, |t| t.median.max(1.0));
        DVector::from_iterator(cells.len(), cells.iter().map(relative))
    };
    let names = Op::ALL.into_iter().map(Op::name).chain([PAIRS]);
    let mut groups: Vec<Vec<&'static str>> = names.map(|name| vec![name]).filter(|group| column(group).norm() > 0.0).collect();
    loop {
        let columns: Vec<DVector<f64>> = groups.iter().map(|group| column(group).normalize()).collect();
        let pairs = (0..groups.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
        let nearest = pairs.map(|(a, b)| (columns[a].dot(&columns[b]), a, b)).max_by(|x, y| x.0.total_cmp(&y.0));
        let Some((_, a, b)) = nearest.filter(|(cosine, ..)| *cosine > TOGETHER) else { break };
        let joined = groups.remove(b);
        groups[a].extend(joined);
    }
    groups.push(Vec::new());
    groups
}

#[cfg(test)]
#[path = "cost_tests.rs"]
mod tests;
