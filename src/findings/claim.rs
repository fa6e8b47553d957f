//! Claims of experiments, checked from the record: does each hold, fail, or was it not shown?
//!
//! Only cells that ended well enter; cells that did not are named in the evidence, and a cell with
//! a wrong answer makes the claim fail, because a detector that loses contacts has no cost worth
//! comparing. Controls enter only if `where` names the detector.

use std::collections::{BTreeMap, BTreeSet};

use crate::cells::label::{over, place, varying};
use crate::cells::{Cell, CellId, Expression, Reading, select};
use crate::experiment::{Claim, ClaimKind, Experiment};
use crate::number;
use crate::record::id::Projection;
use crate::record::row::{Outcome, Pass};
use crate::stats::growth;
use crate::stats::growth::Model;
use crate::stats::interval::{Interval, ratio};

/// Relative difference that rounding of an expression may cause.
const ROUNDING: f64 = 1e-12;

/// What came of a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// True in every cell measured.
    Holds,
    /// False somewhere, or it cannot be checked as written.
    Fails,
    /// No data, or too little to tell.
    NotShown,
}

impl Status {
    /// The word in verdict tables.
    pub fn name(self) -> &'static str {
        match self {
            Status::Holds => "holds",
            Status::Fails => "FAILS",
            Status::NotShown => "not shown",
        }
    }
}

/// A claim and what came of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// The experiment's name.
    pub experiment: String,
    /// The sentence claimed.
    pub claim: String,
    /// Where the claim comes from.
    pub source: String,
    /// What came of it.
    pub status: Status,
    /// False for times, which are of one machine.
    pub machine_independent: bool,
    /// The numbers.
    pub evidence: String,
}

/// True if a claim that does not depend on the machine fails: a reason for a non-zero exit.
pub fn any_failed(verdicts: &[Verdict]) -> bool {
    verdicts.iter().any(|verdict| verdict.machine_independent && verdict.status == Status::Fails)
}

/// Checks every claim of an experiment; cells of other experiments are left aside. A claim that
/// cannot be checked (an unknown variable, say) fails and says why.
pub fn verdicts(experiment: &Experiment, cells: &[Cell]) -> Vec<Verdict> {
    let own: Vec<Cell> =
        cells.iter().filter(|cell| cell.id.experiment == experiment.name).cloned().collect();
    let judge = |claim: &Claim| {
        let (status, mut evidence) = check(claim, &own)
            .unwrap_or_else(|e| (Status::Fails, format!("cannot be checked: {e:#}")));
        if claim.uses_time() {
            evidence.insert_str(0, "of this machine: ");
        }
        Verdict {
            experiment: experiment.name.clone(),
            claim: claim.name.clone(),
            source: claim.source.clone(),
            status,
            machine_independent: !claim.uses_time(),
            evidence,
        }
    };
    experiment.claims.iter().map(judge).collect()
}

type Finding = (Status, String);

fn check(claim: &Claim, own: &[Cell]) -> anyhow::Result<Finding> {
    if own.is_empty() {
        return Ok((Status::NotShown, "no rows of this experiment".into()));
    }
    let named = claim.filter.contains_key("detector");
    let mut cells = select::select(own, &claim.filter)?;
    cells.retain(|cell| named || !cell.role.is_control());
    if cells.is_empty() {
        return Ok((Status::NotShown, "no cell matches".into()));
    }
    let wrong: Vec<&&Cell> =
        cells.iter().filter(|cell| cell.overall().0 == Outcome::Wrong).collect();
    if let Some(first) = wrong.first() {
        let place = place(&first.id, &varying(&cells));
        return Ok((
            Status::Fails,
            format!("wrong answers in {}, first at {place}", number::plural(wrong.len(), "cell")),
        ));
    }
    if let Some(first) =
        cells.iter().find(|cell| cell.overall().0 == Outcome::Crashed && cell.role.is_ours())
    {
        return Ok((
            Status::Fails,
            format!(
                "a detector of this program crashed, first at {}",
                place(&first.id, &varying(&cells))
            ),
        ));
    }
    // A cell without one of these is named with those left out.
    let points = |sides: &[&Expression]| -> anyhow::Result<Vec<Valued>> {
        sides.iter().try_for_each(|side| side.check(own))?;
        let mut points = Vec::new();
        for &cell in &cells {
            let values: Option<Vec<f64>> = sides.iter().map(|side| reading(side, cell)).collect();
            points.extend(values.map(|values| (cell, values[0])));
        }
        Ok(points)
    };
    let (status, mut evidence, used) = match &claim.kind {
        ClaimKind::Constant { value, within } => {
            judged(points(&[value])?, |points| constant(points, *within))
        }
        ClaimKind::Equal { value, to, within } => {
            judged(points(&[value, to])?, |points| compared(points, to, Some(*within)))
        }
        ClaimKind::AtMost { value, to } => {
            judged(points(&[value, to])?, |points| compared(points, to, None))
        }
        ClaimKind::Model { value, model } => {
            judged(points(&[value])?, |points| grows(points, *model))
        }
        ClaimKind::Faster { than } => faster(than, &cells, own),
    };
    let left: Vec<&&Cell> = cells.iter().filter(|cell| !used.contains(&cell.id)).collect();
    if !left.is_empty() {
        evidence += &format!(
            "; without {} of {}: {}",
            left.len(),
            number::plural(cells.len(), "cell"),
            reasons(&left)
        );
    }
    Ok((status, evidence))
}

/// The finding, and the cells that it is about.
fn judged(
    points: Vec<Valued>,
    finding: impl FnOnce(&[Valued]) -> Finding,
) -> (Status, String, BTreeSet<CellId>) {
    let (status, evidence) = if points.is_empty() {
        (Status::NotShown, "no cell has a value".into())
    } else {
        finding(&points)
    };
    (status, evidence, points.iter().map(|point| point.0.id.clone()).collect())
}

/// The value of a cell; an expression of what was asked (n, parameters) has one however the
/// measurement ended.
fn reading(value: &Expression, cell: &Cell) -> Option<f64> {
    if value.passes().is_empty() {
        return value.at(cell, None);
    }
    match value.read(cell) {
        Reading::Value(value) => Some(value),
        _ => None,
    }
}

/// `3 refused, 1 timeout`.
fn reasons(cells: &[&&Cell]) -> String {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for cell in cells {
        let outcome = cell.overall().0;
        *counts
            .entry(if outcome.is_good() { "without a value" } else { outcome.name() })
            .or_default() += 1;
    }
    counts.iter().map(|(name, count)| format!("{count} {name}")).collect::<Vec<_>>().join(", ")
}

/// A cell and its value.
type Valued<'a> = (&'a Cell, f64);

fn extremes<'a>(points: &[Valued<'a>]) -> Option<(Valued<'a>, Valued<'a>)> {
    let low = points.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let high = points.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some((low, high))
}

fn constant(points: &[Valued], within: f64) -> Finding {
    let Some((low, high)) = extremes(points) else {
        return (Status::NotShown, "no cell has a value".into());
    };
    let cells: Vec<&Cell> = points.iter().map(|point| point.0).collect();
    if points.len() < 2 {
        return (
            Status::NotShown,
            format!("{} in the only cell; a constant needs two", number::number(low.1)),
        );
    }
    let spread = if high.1 == low.1 { 0.0 } else { high.1 / low.1 - 1.0 };
    let range =
        format!("{} to {} over {}", number::number(low.1), number::number(high.1), over(&cells));
    if low.1 <= 0.0 && high.1 != low.1 {
        return (Status::Fails, format!("{range}; the smallest is not positive"));
    }
    if spread <= within + ROUNDING {
        return (Status::Holds, format!("{range} ({})", number::percent(spread)));
    }
    let fields = varying(&cells);
    let (at_low, at_high) = (place(&low.0.id, &fields), place(&high.0.id, &fields));
    let allowed = number::percent(within);
    (
        Status::Fails,
        format!(
            "{range} ({}, allowed {allowed}); lowest at {at_low}, highest at {at_high}",
            number::percent(spread)
        ),
    )
}

/// `equal`, within a tolerance, or `at-most`.
fn compared(points: &[Valued], to: &Expression, equal: Option<f64>) -> Finding {
    // how far a cell is from the claim: relative difference, or value / limit - 1
    let gap = |value: f64, to: f64| match equal {
        Some(_) if value == to => 0.0,
        Some(_) => (value - to).abs() / to.abs(),
        _ if value <= to => -(1.0 - value / to).abs(),
        _ => (value - to) / to.abs(),
    };
    let sides: Vec<(&Cell, f64, f64)> = points
        .iter()
        .filter_map(|(cell, value)| Some((*cell, *value, reading(to, cell)?)))
        .collect();
    let gaps: Vec<f64> = sides
        .iter()
        .map(|(_, value, to)| gap(*value, *to))
        .map(|g| if g.is_nan() { 0.0 } else { g })
        .collect();
    let Some((worst, &(cell, value, limit))) =
        gaps.iter().zip(&sides).max_by(|a, b| a.0.total_cmp(b.0))
    else {
        return (Status::NotShown, "no cell has both sides".into());
    };
    let cells: Vec<&Cell> = sides.iter().map(|side| side.0).collect();
    let at = place(&cell.id, &varying(&cells));
    let allowed = equal.unwrap_or(0.0) + ROUNDING;
    let bad = gaps.iter().filter(|gap| **gap > allowed).count();
    let (count, value, limit) =
        (number::plural(sides.len(), "cell"), number::number(value), number::number(limit));
    if bad > 0 {
        let sign = if equal.is_some() { "differs from" } else { "exceeds" };
        let size = if worst.is_finite() {
            format!(" by {}", number::percent(*worst))
        } else {
            String::new()
        };
        return (
            Status::Fails,
            format!("in {bad} of {count}; worst: {value} {sign} {limit}{size} at {at}"),
        );
    }
    let evidence = match equal {
        Some(_) if *worst == 0.0 => format!("exactly, in {count} over {}", over(&cells)),
        Some(_) => format!("within {} in {count} over {}", number::percent(*worst), over(&cells)),
        _ => format!("in {count} over {}; nearest: {value} against {limit} at {at}", over(&cells)),
    };
    (Status::Holds, evidence)
}

fn grows(points: &[Valued], wanted: Model) -> Finding {
    let mut series: BTreeMap<Projection, Vec<(f64, f64)>> = BTreeMap::new();
    for (cell, value) in points {
        series.entry(cell.id.without(&["n", "seed"])).or_default().push((cell.id.n as f64, *value));
    }
    let cells: Vec<&Cell> = points.iter().map(|point| point.0).collect();
    let fields: Vec<String> =
        varying(&cells).into_iter().filter(|name| name != "n" && name != "seed").collect();
    let (mut status, mut notes) = (Status::Holds, Vec::new());
    let (mut exponents, mut least_delta) = ((f64::INFINITY, f64::NEG_INFINITY), f64::INFINITY);
    for (key, points) in &series {
        let choice = growth::choose(points);
        let place =
            if fields.is_empty() { String::new() } else { format!("{}: ", place(key, &fields)) };
        let exponent = choice.slope.map_or(String::new(), |s| {
            format!("exponent {:.3} [{:.3}, {:.3}], ", s.exponent, s.low, s.high)
        });
        let (this, note) = match choice.law {
            Ok(model) if model == wanted => {
                least_delta = least_delta.min(choice.delta().unwrap_or(0.0));
                if let Some(slope) = choice.slope {
                    exponents = (exponents.0.min(slope.exponent), exponents.1.max(slope.exponent));
                }
                continue;
            }
            Ok(model) => (Status::Fails, format!("{} fits, not {}", model.name(), wanted.name())),
            Err(doubt) => (Status::NotShown, format!("undecided: {doubt}")),
        };
        notes.push((this, format!("{place}{exponent}{note}")));
        if this == Status::Fails || status == Status::Holds {
            status = this;
        }
    }
    let mut evidence = Vec::new();
    let shown = series.len() - notes.len();
    if shown > 0 {
        let range = if exponents.0 < exponents.1 {
            format!("{:.3} to {:.3}", exponents.0, exponents.1)
        } else {
            format!("{:.3}", exponents.0)
        };
        evidence.push(format!(
            "{} fits {shown} series: exponent {range}, ΔAICc {least_delta:.0} or more to the next \
             law",
            wanted.name()
        ));
    }
    // what decided comes first, and a few are enough
    notes.sort_by_key(|(this, _)| *this != status);
    let more = notes.len().saturating_sub(3);
    evidence.extend(notes.into_iter().take(3).map(|note| note.1));
    if more > 0 {
        evidence.push(format!("and {more} more series"));
    }
    (status, evidence.join("; "))
}

fn faster(than: &str, cells: &[&Cell], own: &[Cell]) -> (Status, String, BTreeSet<CellId>) {
    let other: BTreeMap<&CellId, &Cell> = own.iter().map(|cell| (&cell.id, cell)).collect();
    let mut found: Vec<(&Cell, Interval)> = Vec::new();
    for &cell in cells.iter().filter(|cell| cell.id.contender() != than) {
        let twin = cell.id.clone().with_contender(than);
        let good = |cell: &Cell| cell.outcome(&[Pass::Time]).0.is_good();
        if let Some(&other) = other.get(&twin).filter(|other| good(other) && good(cell)) {
            found.extend(ratio(&cell.times, &other.times).map(|ratio| (cell, ratio)));
        }
    }
    let used = found
        .iter()
        .map(|(cell, _)| cell.id.clone())
        .chain(cells.iter().map(|c| c.id.clone()).filter(|id| id.contender() == than));
    let used: BTreeSet<CellId> = used.collect();
    let Some((worst, interval)) = found.iter().max_by(|a, b| a.1.high.total_cmp(&b.1.high)) else {
        return (Status::NotShown, format!("no cell has times of both it and {than}"), used);
    };
    let lower = found.iter().map(|(_, ratio)| ratio.median).fold(f64::INFINITY, f64::min);
    let upper = found.iter().map(|(_, ratio)| ratio.median).fold(0.0, f64::max);
    let slower = found.iter().filter(|(_, ratio)| ratio.count > 1 && ratio.low >= 1.0).count();
    let open = found
        .iter()
        .filter(|(_, ratio)| ratio.count < 2 || (ratio.low < 1.0 && ratio.high >= 1.0))
        .count();
    let status = match (slower, open) {
        (0, 0) => Status::Holds,
        (0, _) => Status::NotShown,
        _ => Status::Fails,
    };
    let compared: Vec<&Cell> = found.iter().map(|(cell, _)| *cell).collect();
    let (count, at) = (number::plural(found.len(), "cell"), place(&worst.id, &varying(&compared)));
    let tell = match status {
        Status::Holds => String::new(),
        Status::NotShown => format!("undecided in {open} of them; "),
        Status::Fails => format!("slower in {slower} of them; "),
    };
    let evidence = format!(
        "{lower:.2} to {upper:.2} times the time of {than} in {count}; {tell}worst {:.2} [{:.2}, \
         {:.2}] at {at}",
        interval.median, interval.low, interval.high
    );
    (status, evidence, used)
}

#[cfg(test)]
mod tests;
