//! Claims of experiments, checked from the record: does each hold, fail, or was it not shown?
//!
//! Only cells that ended well enter; cells that did not are named in the evidence, and a cell with a wrong answer makes the claim
//! fail, because a detector that loses contacts has no cost worth comparing. Controls enter only if `where` names the detector.

use std::collections::{BTreeMap, BTreeSet};

use super::fit::{self, Model};
use super::interval::{Interval, ratio};
use super::place::{over, place, varying};
use super::summary::is_control;
use super::value::{Cell, Expression, Key, Reading};
use super::{filter, text};
use crate::detect::table::{self, Entry};
use crate::harness::experiment::{Claim, ClaimKind, Experiment};
use crate::harness::record::{Outcome, Pass};

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

/// Checks every claim of an experiment; cells of other experiments are left aside. A claim that cannot be checked (an unknown
/// variable, say) fails and says why.
pub fn verdicts(experiment: &Experiment, cells: &[Cell]) -> Vec<Verdict> {
    let own: Vec<Cell> = cells.iter().filter(|cell| cell.key.experiment == experiment.name).cloned().collect();
    let judge = |claim: &Claim| {
        let (status, mut evidence) = check(claim, &own).unwrap_or_else(|e| (Status::Fails, format!("cannot be checked: {e:#}")));
        let of_times = of_times(claim);
        if of_times {
            evidence.insert_str(0, "of this machine: ");
        }
        Verdict {
            experiment: experiment.name.clone(),
            claim: claim.name.clone(),
            source: claim.source.clone(),
            status,
            machine_independent: !of_times,
            evidence,
        }
    };
    experiment.claims.iter().map(judge).collect()
}

/// Is the claim about times, which are of one machine? An expression that cannot be read is not: its failure must be seen.
fn of_times(claim: &Claim) -> bool {
    let uses_time = |text: &str| Expression::parse(text).is_ok_and(|expression| expression.uses_time());
    claim.kind == ClaimKind::Faster || uses_time(&claim.value) || uses_time(&claim.to)
}

type Finding = (Status, String);

fn check(claim: &Claim, own: &[Cell]) -> anyhow::Result<Finding> {
    if own.is_empty() {
        return Ok((Status::NotShown, "no rows of this experiment".into()));
    }
    let named = claim.filter.contains_key("detector");
    let mut cells = filter::select(own, &claim.filter)?;
    cells.retain(|cell| named || !is_control(&cell.key.detector));
    if cells.is_empty() {
        return Ok((Status::NotShown, "no cell matches".into()));
    }
    let wrong: Vec<&&Cell> = cells.iter().filter(|cell| cell.overall().0 == Outcome::Wrong).collect();
    if let Some(first) = wrong.first() {
        let place = place(&first.key, &varying(&cells));
        return Ok((Status::Fails, format!("wrong answers in {}, first at {place}", text::plural(wrong.len(), "cell"))));
    }
    if let Some(first) =
        cells.iter().find(|cell| cell.overall().0 == Outcome::Crashed && table::find(&cell.key.detector).is_some_and(Entry::is_ours))
    {
        return Ok((Status::Fails, format!("a detector of this program crashed, first at {}", place(&first.key, &varying(&cells)))));
    }
    let (status, mut evidence, used) = if claim.kind == ClaimKind::Faster {
        faster(claim, &cells, own)?
    } else {
        let value = Expression::parse_for(&claim.value, own)?;
        let mut points: Vec<(&Cell, f64)> = cells.iter().filter_map(|cell| Some((*cell, reading(&value, cell)?))).collect();
        let to = match claim.kind {
            ClaimKind::Equal | ClaimKind::AtMost => Some(Expression::parse_for(&claim.to, own)?),
            _ => None,
        };
        // A cell without the other side is named with those left out.
        points.retain(|(cell, _)| to.as_ref().is_none_or(|to| reading(to, cell).is_some()));
        let (status, evidence) = match claim.kind {
            _ if points.is_empty() => (Status::NotShown, "no cell has a value".into()),
            ClaimKind::Constant => constant(claim, &points),
            ClaimKind::Model => model(claim, &points)?,
            _ => to.map_or((Status::NotShown, String::new()), |to| compared(claim, &points, &to)),
        };
        (status, evidence, points.iter().map(|point| point.0.key.clone()).collect())
    };
    let left: Vec<&&Cell> = cells.iter().filter(|cell| !used.contains(&cell.key)).collect();
    if !left.is_empty() {
        evidence += &format!("; without {} of {}: {}", left.len(), text::plural(cells.len(), "cell"), reasons(&left));
    }
    Ok((status, evidence))
}

/// The value of a cell; an expression of what was asked (n, parameters) has one however the measurement ended.
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
        *counts.entry(if outcome.is_good() { "without a value" } else { outcome.name() }).or_default() += 1;
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

fn constant(claim: &Claim, points: &[(&Cell, f64)]) -> Finding {
    let Some((low, high)) = extremes(points) else { return (Status::NotShown, "no cell has a value".into()) };
    let cells: Vec<&Cell> = points.iter().map(|point| point.0).collect();
    if points.len() < 2 {
        return (Status::NotShown, format!("{} in the only cell; a constant needs two", text::number(low.1)));
    }
    let spread = if high.1 == low.1 { 0.0 } else { high.1 / low.1 - 1.0 };
    let range = format!("{} to {} over {}", text::number(low.1), text::number(high.1), over(&cells));
    if low.1 <= 0.0 && high.1 != low.1 {
        return (Status::Fails, format!("{range}; the smallest is not positive"));
    }
    if spread <= claim.within + ROUNDING {
        return (Status::Holds, format!("{range} ({})", text::percent(spread)));
    }
    let fields = varying(&cells);
    let (at_low, at_high) = (place(&low.0.key, &fields), place(&high.0.key, &fields));
    let allowed = text::percent(claim.within);
    (Status::Fails, format!("{range} ({}, allowed {allowed}); lowest at {at_low}, highest at {at_high}", text::percent(spread)))
}

/// `equal` and `at-most`.
fn compared(claim: &Claim, points: &[(&Cell, f64)], to: &Expression) -> Finding {
    // how far a cell is from the claim: relative difference, or value / limit - 1
    let gap = |value: f64, to: f64| match claim.kind {
        ClaimKind::Equal if value == to => 0.0,
        ClaimKind::Equal => (value - to).abs() / to.abs(),
        _ if value <= to => -(1.0 - value / to).abs(),
        _ => (value - to) / to.abs(),
    };
    let sides: Vec<(&Cell, f64, f64)> = points.iter().filter_map(|(cell, value)| Some((*cell, *value, reading(to, cell)?))).collect();
    let gaps: Vec<f64> = sides.iter().map(|(_, value, to)| gap(*value, *to)).map(|g| if g.is_nan() { 0.0 } else { g }).collect();
    let Some((worst, &(cell, value, limit))) = gaps.iter().zip(&sides).max_by(|a, b| a.0.total_cmp(b.0)) else {
        return (Status::NotShown, "no cell has both sides".into());
    };
    let cells: Vec<&Cell> = sides.iter().map(|side| side.0).collect();
    let at = place(&cell.key, &varying(&cells));
    let allowed = if claim.kind == ClaimKind::Equal { claim.within } else { 0.0 } + ROUNDING;
    let bad = gaps.iter().filter(|gap| **gap > allowed).count();
    let (count, value, limit) = (text::plural(sides.len(), "cell"), text::number(value), text::number(limit));
    if bad > 0 {
        let sign = if claim.kind == ClaimKind::Equal { "differs from" } else { "exceeds" };
        let size = if worst.is_finite() { format!(" by {}", text::percent(*worst)) } else { String::new() };
        return (Status::Fails, format!("in {bad} of {count}; worst: {value} {sign} {limit}{size} at {at}"));
    }
    let evidence = match claim.kind {
        ClaimKind::Equal if *worst == 0.0 => format!("exactly, in {count} over {}", over(&cells)),
        ClaimKind::Equal => format!("within {} in {count} over {}", text::percent(*worst), over(&cells)),
        _ => format!("in {count} over {}; nearest: {value} against {limit} at {at}", over(&cells)),
    };
    (Status::Holds, evidence)
}

fn model(claim: &Claim, points: &[(&Cell, f64)]) -> anyhow::Result<Finding> {
    let wanted =
        Model::parse(&claim.model).ok_or_else(|| anyhow::anyhow!("unknown model '{}'; the models are: N, N log N, N^2", claim.model))?;
    anyhow::ensure!(!of_times(claim), "a model is fitted to counts or bytes: the memory hierarchy makes linear times look like N log N");
    let mut series: BTreeMap<Key, Vec<(f64, f64)>> = BTreeMap::new();
    for (cell, value) in points {
        series.entry(cell.key.clone().without("n").without("seed")).or_default().push((cell.key.n as f64, *value));
    }
    let cells: Vec<&Cell> = points.iter().map(|point| point.0).collect();
    let fields: Vec<String> = varying(&cells).into_iter().filter(|name| name != "n" && name != "seed").collect();
    let (mut status, mut notes) = (Status::Holds, Vec::new());
    let (mut exponents, mut least_delta) = ((f64::INFINITY, f64::NEG_INFINITY), f64::INFINITY);
    for (key, points) in &series {
        let choice = fit::choose(points);
        let place = if fields.is_empty() { String::new() } else { format!("{}: ", place(key, &fields)) };
        let exponent = choice.slope.map_or(String::new(), |s| format!("exponent {:.3} [{:.3}, {:.3}], ", s.exponent, s.low, s.high));
        let (this, note) = match choice.model {
            Some(model) if model == wanted => {
                least_delta = least_delta.min(choice.delta().unwrap_or(0.0));
                if let Some(slope) = choice.slope {
                    exponents = (exponents.0.min(slope.exponent), exponents.1.max(slope.exponent));
                }
                continue;
            }
            Some(model) => (Status::Fails, format!("{} fits, not {}", model.name(), wanted.name())),
            None => (Status::NotShown, format!("cannot tell: {}", choice.why)),
        };
        notes.push((this, format!("{place}{exponent}{note}")));
        if this == Status::Fails || status == Status::Holds {
            status = this;
        }
    }
    let mut evidence = Vec::new();
    let shown = series.len() - notes.len();
    if shown > 0 {
        let range =
            if exponents.0 < exponents.1 { format!("{:.3} to {:.3}", exponents.0, exponents.1) } else { format!("{:.3}", exponents.0) };
        evidence.push(format!("{} fits {shown} series: exponent {range}, ΔAICc {least_delta:.0} or more to the next law", wanted.name()));
    }
    // what decided comes first, and a few are enough
    notes.sort_by_key(|(this, _)| *this != status);
    let more = notes.len().saturating_sub(3);
    evidence.extend(notes.into_iter().take(3).map(|note| note.1));
    if more > 0 {
        evidence.push(format!("and {more} more series"));
    }
    Ok((status, evidence.join("; ")))
}

fn faster(claim: &Claim, cells: &[&Cell], own: &[Cell]) -> anyhow::Result<(Status, String, BTreeSet<Key>)> {
    anyhow::ensure!(!claim.than.is_empty(), "'than' is missing: the detector to compare with");
    let other: BTreeMap<&Key, &Cell> = own.iter().map(|cell| (&cell.key, cell)).collect();
    let mut found: Vec<(&Cell, Interval)> = Vec::new();
    for &cell in cells.iter().filter(|cell| cell.key.detector != claim.than) {
        let twin = Key { detector: claim.than.clone(), ..cell.key.clone() };
        let good = |cell: &Cell| cell.outcome(&[Pass::Time]).0.is_good();
        if let Some(&than) = other.get(&twin).filter(|than| good(than) && good(cell)) {
            found.extend(ratio(&cell.times, &than.times).map(|ratio| (cell, ratio)));
        }
    }
    let used =
        found.iter().map(|(cell, _)| cell.key.clone()).chain(cells.iter().map(|c| c.key.clone()).filter(|k| k.detector == claim.than));
    let used: BTreeSet<Key> = used.collect();
    let Some((worst, interval)) = found.iter().max_by(|a, b| a.1.high.total_cmp(&b.1.high)) else {
        return Ok((Status::NotShown, format!("no cell has times of both it and {}", claim.than), used));
    };
    let lower = found.iter().map(|(_, ratio)| ratio.median).fold(f64::INFINITY, f64::min);
    let upper = found.iter().map(|(_, ratio)| ratio.median).fold(0.0, f64::max);
    let slower = found.iter().filter(|(_, ratio)| ratio.count > 1 && ratio.low >= 1.0).count();
    let open = found.iter().filter(|(_, ratio)| ratio.count < 2 || (ratio.low < 1.0 && ratio.high >= 1.0)).count();
    let status = match (slower, open) {
        (0, 0) => Status::Holds,
        (0, _) => Status::NotShown,
        _ => Status::Fails,
    };
    let compared: Vec<&Cell> = found.iter().map(|(cell, _)| *cell).collect();
    let (count, at) = (text::plural(found.len(), "cell"), place(&worst.key, &varying(&compared)));
    let tell = match status {
        Status::Holds => String::new(),
        Status::NotShown => format!("cannot tell in {open} of them; "),
        Status::Fails => format!("slower in {slower} of them; "),
    };
    let evidence = format!(
        "{lower:.2} to {upper:.2} times the time of {} in {count}; {tell}worst {:.2} [{:.2}, {:.2}] at {at}",
        claim.than, interval.median, interval.low, interval.high
    );
    Ok((status, evidence, used))
}

/// `26 claims: 25 hold, 0 fail, 1 could not be shown`.
pub fn score(verdicts: &[Verdict]) -> String {
    let count = |status: Status| verdicts.iter().filter(|verdict| verdict.status == status).count();
    let (holds, fails, open) = (count(Status::Holds), count(Status::Fails), count(Status::NotShown));
    format!("{}: {holds} hold, {fails} fail, {open} could not be shown", text::plural(verdicts.len(), "claim"))
}

/// The verdict table for a terminal, at most 110 columns wide.
pub fn plain(verdicts: &[Verdict]) -> String {
    let several = verdicts.iter().any(|verdict| verdict.experiment != verdicts[0].experiment);
    let named = |v: &Verdict| if several { format!("{}: {}", v.experiment, v.claim) } else { v.claim.clone() };
    let row = |v: &Verdict| vec![v.status.name().to_string(), named(v), v.evidence.clone()];
    text::plain_table(&[9, 42, 55], &verdicts.iter().map(row).collect::<Vec<_>>()) + &score(verdicts) + "\n"
}

/// The verdict table in Markdown.
pub fn markdown(verdicts: &[Verdict]) -> String {
    let row = |v: &Verdict| vec![v.claim.clone(), v.status.name().to_string(), v.evidence.clone(), v.source.clone()];
    text::markdown_table(&["claim", "verdict", "evidence", "source"], &verdicts.iter().map(row).collect::<Vec<_>>())
}

#[cfg(test)]
#[path = "claim_tests.rs"]
mod tests;
