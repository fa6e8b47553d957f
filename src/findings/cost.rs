//! What an operation costs on one machine: time = constant + sum over kinds of operations of count
//! times cost.
//!
//! * **One fit per detector, arithmetic and order of the particles.** A list step of one detector
//!   is a cache miss, of another a register; and the order of the particles changes no count, but
//!   what each costs. One cost for all would be an average of different things.
//! * **Operations that go together are one kind.** Counts of one detector are often multiples of
//!   each other (every particle is pushed once and reset once). Where the columns of the fit
//!   enclose an angle whose cosine is over [`TOGETHER`], the times cannot tell them apart: their
//!   counts are added, and the cost is that of one of any of them.
//! * **Costs are not negative**, and each cell weighs alike: the sum of squares of (model - time) /
//!   time is made smallest.
//! * **Caches.** What a detection touches (the scene, the detector's arrays, the list of pairs) is
//!   its footprint F. Beyond a cache of C bytes every operation costs more, by the same for each
//!   doubling: a term of (all operations) log2(F / C) for each of the second- and third-level
//!   caches.
//! * **How sure a cost is** is shown by leaving out one scene after the other: the range of what is
//!   then found.
//! * **What it is worth** is shown by leaving out the largest N of every scene: how far predicted
//!   times are from those measured there. Without the terms of caches they missed by a factor of
//!   2.8 (median, four detectors from 10^4 to 10^6 particles), with them by 1.3.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use crate::cells::machine::number_bytes;
use crate::cells::series::Line;
use crate::cells::{Cell, series};
use crate::record::row::Pass;
use crate::stats::interval::median;
use crate::stats::nnls;
use contactbench_terms::op::Op;

/// Kinds of operations whose columns are nearer to each other than this are one.
pub const TOGETHER: f64 = 0.99;
/// What is counted besides operations.
const PAIRS: &str = "pair";

/// What is paid for.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// These operations, one of any of them.
    Operations(Vec<&'static str>),
    /// Every operation for each doubling of the footprint beyond this cache: its name, its bytes.
    Beyond(String, u64),
    /// The detection.
    Detection,
}

/// A kind of cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// What is paid for.
    pub kind: Kind,
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
    /// How it is called.
    pub name: String,
    /// Order of the particles.
    pub order: String,
    /// The constant last.
    pub terms: Vec<Term>,
    /// Cells that entered.
    pub cells: usize,
    /// Median of the relative residuals, without sign.
    pub typical: f64,
    /// The largest of them.
    pub worst: f64,
    /// The scene and its N where that is.
    pub worst_at: (String, u64),
    /// Fitted without the largest N of every scene, by what factors the times there are missed, one
    /// for each cell; none if there are fewer cells left than costs.
    pub held_out: Vec<f64>,
}

/// A detector on one scene: cells by N.
pub(crate) struct Series<'a> {
    pub line: Line,
    pub name: String,
    pub scene: String,
    pub order: String,
    pub cells: BTreeMap<u64, &'a Cell>,
}

fn count(cell: &Cell, operation: &str) -> f64 {
    let name = if operation == PAIRS { "contacts" } else { operation };
    cell.variable(name, None).unwrap_or(0.0)
}

impl Kind {
    /// How many of these a detection has.
    pub fn count(&self, cell: &Cell) -> f64 {
        match self {
            Kind::Operations(operations) => {
                operations.iter().map(|operation| count(cell, operation)).sum()
            }
            Kind::Beyond(_, bytes) => {
                let doublings = (footprint(cell) / *bytes as f64).log2().max(0.0);
                doublings * Op::ALL.iter().map(|op| count(cell, op.name())).sum::<f64>()
            }
            Kind::Detection => 1.0,
        }
    }
}

/// Bytes of the scene, the detector's arrays and the list of pairs.
fn footprint(cell: &Cell) -> f64 {
    let scene = cell.id.n * u64::from(cell.id.dim) * number_bytes(&cell.id.arithmetic);
    let pairs = count(cell, PAIRS) * size_of::<[u32; 2]>() as f64;
    scene as f64 + pairs + cell.variable("peak_bytes", None).unwrap_or(0.0)
}

impl Fit {
    /// The predicted nanoseconds of a cell.
    pub fn at(&self, cell: &Cell) -> f64 {
        predicted(&self.terms, cell)
    }
}

/// The cells that can enter: right, timed and counted, one thread, the first seed.
pub(crate) fn series<'a>(cells: &[&'a Cell]) -> Vec<Series<'a>> {
    let able = |cell: &Cell| {
        cell.outcome(&[Pass::Time, Pass::Count]).0.is_good()
            && cell.has(Pass::Count)
            && cell.time().is_some()
    };
    let mut found = Vec::new();
    for group in series::groups(cells) {
        let lines = group.lines.iter();
        for (line, sizes) in lines.filter(|(line, _)| line.threads == 1 && !line.role.is_control())
        {
            let first = |(&n, seeds): (&u64, &series::Seeds<'a>)| Some((n, *seeds.first()?));
            let cells_by_n: BTreeMap<u64, &Cell> =
                sizes.iter().filter_map(first).filter(|(_, cell)| able(cell)).collect();
            let Some(cell) = cells_by_n.values().next() else { continue };
            found.push(Series {
                line: line.clone(),
                name: series::label(line, cells),
                scene: group.title.clone(),
                order: cell.id.order.clone(),
                cells: cells_by_n,
            });
        }
    }
    found
}

/// The fits of all detectors that have at least two cells per term.
pub(crate) fn fits(series: &[Series<'_>], caches: &[(String, u64)]) -> Vec<Fit> {
    let mut by_line: BTreeMap<(&str, &Line), Vec<&Series<'_>>> = BTreeMap::new();
    for one in series {
        by_line.entry((&one.order, &one.line)).or_default().push(one);
    }
    by_line.values().filter_map(|series| fit(series, caches)).collect()
}

fn fit(series: &[&Series<'_>], caches: &[(String, u64)]) -> Option<Fit> {
    let all: Vec<(usize, &Cell)> = series
        .iter()
        .enumerate()
        .flat_map(|(k, one)| one.cells.values().map(move |cell| (k, *cell)))
        .collect();
    let kinds = kinds(&all.iter().map(|(_, cell)| *cell).collect::<Vec<_>>(), caches);
    let costs = |each: usize, wanted: &dyn Fn(usize, &Cell) -> bool| {
        let cells: Vec<&Cell> =
            all.iter().filter(|(k, cell)| wanted(*k, cell)).map(|(_, cell)| *cell).collect();
        if cells.len() < each * kinds.len() { None } else { least_squares(&kinds, &cells) }
    };
    // Two cells for each cost.
    let found = costs(2, &|_, _| true)?;
    let others: Vec<Vec<f64>> = (0..series.len())
        .filter(|_| series.len() > 2)
        .filter_map(|left_out| costs(2, &|k, _| k != left_out))
        .collect();
    // A scene of one size cannot be continued.
    let is_top = |k: usize, cell: &Cell| {
        let sizes = &series[k].cells;
        sizes.len() > 1 && sizes.keys().next_back() == Some(&cell.id.n)
    };
    let smaller = costs(1, &|k, cell| !is_top(k, cell));
    let held_out = smaller.map_or(Vec::new(), |costs| {
        let top = all.iter().filter(|(k, cell)| is_top(*k, cell)).map(|(_, cell)| *cell);
        top.filter_map(|cell| Some(apart(total(&kinds, &costs, cell), cell.time()?.median)))
            .collect()
    });
    let terms = kinds.into_iter().enumerate().map(|(k, kind)| {
        let range = others.iter().map(|costs| costs[k]).chain([found[k]]);
        let (low, high) = range
            .fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), v| (low.min(v), high.max(v)));
        Term { kind, ns: found[k], low, high }
    });
    let terms: Vec<Term> = terms.collect();
    let residual = |cell: &Cell| Some((predicted(&terms, cell) / cell.time()?.median - 1.0).abs());
    let residuals: Vec<f64> = all.iter().map(|(_, cell)| residual(cell).unwrap_or(0.0)).collect();
    let (worst, (at, cell)) = residuals.iter().zip(&all).max_by(|a, b| a.0.total_cmp(b.0))?;
    let first = series.first()?;
    Some(Fit {
        line: first.line.clone(),
        name: first.name.clone(),
        order: first.order.clone(),
        cells: all.len(),
        held_out,
        typical: median(&residuals)?,
        worst: *worst,
        worst_at: (series[*at].scene.clone(), cell.id.n),
        terms,
    })
}

/// The nanoseconds of a detection at these costs.
fn predicted(terms: &[Term], cell: &Cell) -> f64 {
    terms.iter().map(|term| term.ns * term.kind.count(cell)).sum()
}

fn total(kinds: &[Kind], costs: &[f64], cell: &Cell) -> f64 {
    kinds.iter().zip(costs).map(|(kind, ns)| ns * kind.count(cell)).sum()
}

/// The factor by which one is larger than the other.
fn apart(a: f64, b: f64) -> f64 {
    (a.max(1.0) / b.max(1.0)).ln().abs().exp()
}

/// Costs of these kinds, by non-negative least squares on relative residuals.
fn least_squares(kinds: &[Kind], cells: &[&Cell]) -> Option<Vec<f64>> {
    let times: Vec<f64> = cells
        .iter()
        .map(|cell| cell.time().map(|time| time.median.max(1.0)))
        .collect::<Option<_>>()?;
    let matrix = DMatrix::from_fn(cells.len(), kinds.len(), |row, column| {
        kinds[column].count(cells[row]) / times[row]
    });
    Some(nnls::solve(&matrix, &DVector::from_element(cells.len(), 1.0))?.iter().copied().collect())
}

/// What the times of these cells can tell apart: kinds of operations, caches that they outgrow, and
/// the constant last.
fn kinds(cells: &[&Cell], caches: &[(String, u64)]) -> Vec<Kind> {
    let column = |operations: &[&str]| -> DVector<f64> {
        let relative = |cell: &&Cell| {
            operations.iter().map(|name| count(cell, name)).sum::<f64>()
                / cell.time().map_or(1.0, |t| t.median.max(1.0))
        };
        DVector::from_iterator(cells.len(), cells.iter().map(relative))
    };
    let names = Op::ALL.into_iter().map(Op::name).chain([PAIRS]);
    let mut groups: Vec<Vec<&'static str>> =
        names.map(|name| vec![name]).filter(|group| column(group).norm() > 0.0).collect();
    loop {
        let columns: Vec<DVector<f64>> =
            groups.iter().map(|group| column(group).normalize()).collect();
        let pairs = (0..groups.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
        let nearest = pairs
            .map(|(a, b)| (columns[a].dot(&columns[b]), a, b))
            .max_by(|x, y| x.0.total_cmp(&y.0));
        let Some((_, a, b)) = nearest.filter(|(cosine, ..)| *cosine > TOGETHER) else { break };
        let joined = groups.remove(b);
        groups[a].extend(joined);
    }
    let caches = caches.iter().map(|(name, bytes)| Kind::Beyond(name.clone(), *bytes));
    let outgrown = caches.filter(|kind| cells.iter().any(|cell| kind.count(cell) > 0.0));
    groups.into_iter().map(Kind::Operations).chain(outgrown).chain([Kind::Detection]).collect()
}

#[cfg(test)]
mod tests;
