//! Checks the claims of an experiment against the record.
//!
//! Only cells that ended well are used; the evidence counts the others. A cell with a wrong answer
//! makes the claim fail, because a detector that loses contacts cannot be compared. Controls are
//! used only if `where` names them.

pub mod every;
mod kinds;
pub mod verdicts;

use std::collections::{BTreeMap, BTreeSet};

use kinds::{Estimate, Valued, compared, constant, faster, grows};

use crate::cells::label::{place, varying};
use crate::cells::series::Line;
use crate::cells::{Cell, CellId, Expression, Reading, select};
use crate::experiment::{Claim, ClaimKind, Experiment};
use crate::findings::trust::coverage::{Coverage, Gaps};
use crate::findings::trust::noise::SURE;
use crate::record::row::Outcome;
use contactbench_terms::number::plural;

contactbench_terms::named! {
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum Status {
        /// The claim is true in every planned cell.
        Holds = "holds",
        /// The claim is false in some cell, or impossible to check as written.
        Fails = "FAILS",
        /// The claim is true in all measured cells, but some planned cells are missing.
        NotCovered = "not covered",
        /// There are no data, or too few to decide.
        #[default]
        NotShown = "not shown",
    }
}

#[derive(Clone, Debug)]
pub struct Verdict {
    pub experiment: String,
    pub claim: Claim,
    pub evidence: Evidence,
}

#[derive(Clone, Debug, Default)]
pub struct Evidence {
    pub status: Status,
    pub found: String,
    pub nothing: bool,
    /// Whether cells that are still missing may turn a failure into success.
    pub open: bool,
    pub used: BTreeSet<CellId>,
    /// Number of matching cells.
    pub cells: usize,
    /// Number of matching cells that were not used, by outcome; the key is `None` for cells that
    /// ended well but have no value.
    pub left_out: BTreeMap<Option<Outcome>, usize>,
    pub uncovered: Option<Gaps>,
    /// Smallest and largest time in nanoseconds per particle, if the claim is about counts or bytes
    /// of one detector.
    pub time: Option<[f64; 2]>,
}

impl Verdict {
    /// Withdraws a verdict about times, because the machine was disturbed.
    pub fn withdraw(&mut self) {
        // A wrong answer is wrong on any machine; such evidence uses no cell.
        let judged = [Status::Holds, Status::Fails].contains(&self.evidence.status);
        if self.claim.uses_time() && judged && !self.evidence.used.is_empty() {
            self.evidence.status = Status::NotShown;
            self.evidence.found += "; not judged, because times were disturbed";
        }
    }
}

/// Whether a claim fails whose failure changes the exit code.
pub fn any_failed(verdicts: &[Verdict]) -> bool {
    verdicts.iter().any(|it| it.claim.is_check() && it.evidence.status == Status::Fails)
}

/// Checks every claim of an experiment against the cells of that experiment.
pub fn verdicts(experiment: &Experiment, cells: &[Cell], coverage: &Coverage<'_>) -> Vec<Verdict> {
    let own: Vec<Cell> =
        cells.iter().filter(|cell| cell.id.experiment == experiment.name).cloned().collect();
    let judge = |claim: &Claim| {
        let mut evidence = check(claim, &own);
        evidence.uncovered = coverage.uncovered(claim);
        if evidence.uncovered.is_some() && (evidence.status != Status::Fails || evidence.open) {
            evidence.status = Status::NotCovered;
        }
        Verdict { experiment: experiment.name.clone(), claim: claim.clone(), evidence }
    };
    experiment.claims.iter().map(judge).collect()
}

fn check(claim: &Claim, own: &[Cell]) -> Evidence {
    if own.is_empty() {
        return Evidence::nothing("no rows of this experiment");
    }
    let named = claim.filter.contains_key("detector");
    let mut cells = select::select(own, &claim.filter);
    cells.retain(|cell| named || !cell.role.is_control());
    if cells.is_empty() {
        return Evidence::nothing("no cell matches");
    }
    let ended = |wanted: Outcome| cells.iter().filter(move |cell| cell.overall().0 == wanted);
    let at = |cell: &Cell| place(&cell.id, &varying(&cells));
    if let Some(first) = ended(Outcome::Wrong).next() {
        let count = plural(ended(Outcome::Wrong).count(), "cell");
        let words = format!("wrong answers in {count}, first at {}", at(first));
        return Evidence::new(Status::Fails, words);
    }
    if let Some(first) = ended(Outcome::Crashed).find(|cell| cell.role.is_ours()) {
        let words = format!("a detector of this program crashed, first at {}", at(first));
        return Evidence::new(Status::Fails, words);
    }
    let mut found = finding(&claim.kind, &cells, own);
    found.cells = cells.len();
    for cell in cells.iter().filter(|cell| !found.used.contains(&cell.id)) {
        let outcome = cell.overall().0;
        *found.left_out.entry((!outcome.is_good()).then_some(outcome)).or_default() += 1;
    }
    let of_law = matches!(claim.kind, ClaimKind::Constant { .. } | ClaimKind::Model { .. });
    if of_law && !claim.uses_time() {
        cells.retain(|cell| found.used.contains(&cell.id));
        found.time = times(&cells);
    }
    found
}

fn finding(kind: &ClaimKind, cells: &[&Cell], own: &[Cell]) -> Evidence {
    let points = |sides: &[&Expression]| -> Vec<Valued<'_>> {
        let all = |cell: &&&Cell| sides.iter().all(|side| reading(side, cell).is_some());
        let point = |&cell| Some(Valued { cell, of: reading(sides[0], cell)? });
        cells.iter().filter(all).filter_map(point).collect()
    };
    match kind {
        ClaimKind::Constant { value, within } => constant(&points(&[value]), *within),
        ClaimKind::Equal { value, to, within } => {
            compared(&points(&[value, to]), |cell| reading(to, cell), Some(*within))
        }
        ClaimKind::AtMost { value, to, than: None, than_dim: None } => {
            compared(&points(&[value, to]), |cell| reading(to, cell), None)
        }
        ClaimKind::AtMost { value, to, than, than_dim } => {
            let mut points = points(&[value]);
            points.retain(|point| than.as_deref() != Some(&point.cell.id.subject()));
            let other = |cell: &Cell| reading(to, beside(cell, than.as_deref(), *than_dim, own)?);
            compared(&points, other, None)
        }
        ClaimKind::Model { value, model } => grows(&points(&[value]), *model),
        ClaimKind::Faster { than, by } => faster(than, *by, cells, own),
    }
}

/// Returns the cell of another subject on the same scene, or of the same scene in another
/// dimension, where parameters may have other defaults.
fn beside<'a>(
    cell: &Cell,
    subject: Option<&str>,
    dim: Option<u32>,
    own: &'a [Cell],
) -> Option<&'a Cell> {
    let mut id = cell.id.clone();
    if let Some(subject) = subject {
        id = id.with_subject(subject);
    }
    let Some(dim) = dim else { return own.iter().find(|other| other.id == id) };
    // If several scenes match, none is the same scene.
    let mut same = own.iter().filter(|other| {
        let params = other.id.params.clone();
        other.id == CellId { dim, params, ..id.clone() }
    });
    same.next().filter(|_| same.next().is_none())
}

/// Smallest and largest median time per particle, if all cells have one, and have the same
/// detector, arithmetic and threads.
fn times(cells: &[&Cell]) -> Option<[f64; 2]> {
    let one: BTreeSet<Line> = cells.iter().map(|cell| Line::new(cell)).collect();
    let per_particle = |cell: &&Cell| Some(cell.time()?.median / cell.id.n.max(1) as f64);
    let times: Option<Vec<f64>> = cells.iter().map(per_particle).collect();
    let times = times.filter(|times| one.len() == 1 && !times.is_empty())?;
    let [low, high] = [f64::min, f64::max].map(|pick| times.iter().copied().reduce(pick));
    Some([low?, high?])
}

/// Returns the value of a cell, with an interval if it depends on the time. An expression of n and
/// parameters needs no good outcome.
fn reading(value: &Expression, cell: &Cell) -> Option<Estimate> {
    let point = |value, range| Some(Estimate { value, range });
    if value.passes().is_empty() {
        let value = value.at(cell, None)?;
        return point(value, [value; 2]);
    }
    let Reading::Value(number) = value.read(cell) else { return None };
    if !value.uses_time() {
        return point(number, [number; 2]);
    }
    let time = cell.time()?;
    if time.coverage < SURE {
        return point(number, [0.0, f64::INFINITY]);
    }
    let [a, b] = [time.low, time.high].map(|time| value.at(cell, Some(time)));
    point(number, [a?.min(b?), a?.max(b?)])
}

#[cfg(test)]
mod tests;
