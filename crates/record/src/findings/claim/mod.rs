//! Claims of experiments, checked from the record: does each hold over what was planned, fail, or
//! was it not covered or not shown?
//!
//! Only cells that ended well enter; cells that did not are named in the evidence, and a cell with
//! a wrong answer makes the claim fail, because a detector that loses contacts has no cost worth
//! comparing. Controls enter only if `where` names the detector.

mod evidence;

use std::collections::{BTreeMap, BTreeSet};

pub use evidence::{At, Evidence, Fitting, Found, Series, Without};

use crate::cells::label::{over, place, varying};
use crate::cells::series::Line;
use crate::cells::{Cell, CellId, Expression, Reading, select};
use crate::experiment::{Claim, ClaimKind, Experiment};
use crate::findings::coverage::Coverage;
use crate::findings::noise::Noise;
use crate::record::id::Projection;
use crate::record::row::{Outcome, Pass};
use crate::stats::growth;
use crate::stats::growth::{Model, Tail};
use crate::stats::interval::Interval;

/// Relative difference that rounding of an expression may cause.
const ROUNDING: f64 = 1e-12;

/// What came of a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// True in every cell planned.
    Holds,
    /// False somewhere, or it cannot be checked as written.
    Fails,
    /// True in what is there, and a part of what was planned is not there.
    NotCovered,
    /// No data, or too little to tell.
    NotShown,
}

impl Status {
    /// The word in verdict tables.
    pub fn name(self) -> &'static str {
        match self {
            Status::Holds => "holds",
            Status::Fails => "FAILS",
            Status::NotCovered => "not covered",
            Status::NotShown => "not shown",
        }
    }
}

/// A claim and what came of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    pub experiment: String,
    pub claim: String,
    /// Where the claim comes from.
    pub source: String,
    /// What it answers to the experiment's question if it holds; may be empty.
    pub answers: String,
    pub status: Status,
    /// False for times, which are of one machine.
    pub machine_independent: bool,
    pub evidence: Evidence,
}

/// True if a claim that does not depend on the machine fails: a reason for a non-zero exit.
pub fn any_failed(verdicts: &[Verdict]) -> bool {
    verdicts.iter().any(|verdict| verdict.machine_independent && verdict.status == Status::Fails)
}

/// Checks every claim of an experiment; cells of other experiments are left aside. A claim that
/// cannot be checked (an unknown variable, say) fails and says why.
pub fn verdicts(experiment: &Experiment, cells: &[Cell], coverage: &Coverage<'_>) -> Vec<Verdict> {
    let own: Vec<Cell> =
        cells.iter().filter(|cell| cell.id.experiment == experiment.name).cloned().collect();
    let judge = |claim: &Claim| {
        let Checked { status, found, without, time } = check(claim, &own).unwrap_or_else(|error| {
            Checked::new(Status::Fails, Found::Unusable(format!("{error:#}")))
        });
        let uncovered = coverage.uncovered(claim);
        let status = match (status, &found) {
            _ if uncovered.is_none() => status,
            // Another law may fit the whole.
            (Status::Fails, Found::Growth { .. }) => Status::NotCovered,
            (Status::Fails, _) => Status::Fails,
            _ => Status::NotCovered,
        };
        Verdict {
            experiment: experiment.name.clone(),
            claim: claim.name.clone(),
            source: claim.origin(),
            answers: claim.answers.clone(),
            status,
            machine_independent: !claim.uses_time(),
            evidence: Evidence { found, of_machine: claim.uses_time(), without, uncovered, time },
        }
    };
    experiment.claims.iter().map(judge).collect()
}

/// What a claim came to.
struct Checked {
    status: Status,
    found: Found,
    /// The cells without a value.
    without: Option<Without>,
    /// The times of those with one.
    time: Option<[f64; 2]>,
}

impl Checked {
    fn new(status: Status, found: Found) -> Checked {
        Checked { status, found, without: None, time: None }
    }
}

/// What the values of cells say of a claim.
struct Finding {
    status: Status,
    found: Found,
    /// The cells that it is about.
    used: BTreeSet<CellId>,
}

fn check(claim: &Claim, own: &[Cell]) -> anyhow::Result<Checked> {
    if own.is_empty() {
        return Ok(Checked::new(Status::NotShown, Found::NoRows));
    }
    let named = claim.filter.contains_key("detector");
    let mut cells = select::select(own, &claim.filter)?;
    cells.retain(|cell| named || !cell.role.is_control());
    if cells.is_empty() {
        return Ok(Checked::new(Status::NotShown, Found::NoCell));
    }
    let wrong: Vec<&&Cell> =
        cells.iter().filter(|cell| cell.overall().0 == Outcome::Wrong).collect();
    if let Some(first) = wrong.first() {
        let first = place(&first.id, &varying(&cells));
        return Ok(Checked::new(Status::Fails, Found::Wrong { cells: wrong.len(), first }));
    }
    if let Some(first) =
        cells.iter().find(|cell| cell.overall().0 == Outcome::Crashed && cell.role.is_ours())
    {
        let first = place(&first.id, &varying(&cells));
        return Ok(Checked::new(Status::Fails, Found::Crashed { first }));
    }
    // A cell without one of these is named with those left out.
    let points = |sides: &[&Expression]| -> anyhow::Result<Vec<Valued>> {
        sides.iter().try_for_each(|side| side.check(own))?;
        let mut points = Vec::new();
        for &cell in &cells {
            let values: Option<Vec<f64>> = sides.iter().map(|side| reading(side, cell)).collect();
            points.extend(values.map(|values| Valued { cell, value: values[0] }));
        }
        Ok(points)
    };
    let Finding { status, found, used } = match &claim.kind {
        ClaimKind::Constant { value, within } => constant(&points(&[value])?, *within),
        ClaimKind::Equal { value, to, within } => {
            compared(&points(&[value, to])?, |cell| reading(to, cell), Some(*within))
        }
        ClaimKind::AtMost { value, to, than: None } => {
            compared(&points(&[value, to])?, |cell| reading(to, cell), None)
        }
        ClaimKind::AtMost { value, to, than: Some(than) } => {
            to.check(own)?;
            let by_id: BTreeMap<&CellId, &Cell> = own.iter().map(|cell| (&cell.id, cell)).collect();
            let other = |cell: &Cell| {
                let id = cell.id.clone().with_contender(than);
                by_id.get(&id).and_then(|other| reading(to, other))
            };
            let mut points = points(&[value])?;
            points.retain(|point| point.cell.id.contender() != *than);
            compared(&points, other, None)
        }
        ClaimKind::Model { value, model } => grows(&points(&[value])?, *model),
        ClaimKind::Faster { than, by } => faster(than, *by, &cells, own),
    };
    let mut outcomes = BTreeMap::new();
    for cell in cells.iter().filter(|cell| !used.contains(&cell.id)) {
        let outcome = cell.overall().0;
        *outcomes.entry((!outcome.is_good()).then_some(outcome)).or_default() += 1;
    }
    let without = Without { outcomes, of: cells.len() };
    let without = Some(without).filter(|without| !without.outcomes.is_empty());
    let of_law = matches!(claim.kind, ClaimKind::Constant { .. } | ClaimKind::Model { .. });
    cells.retain(|cell| used.contains(&cell.id));
    let time = if of_law && !claim.uses_time() { times(&cells) } else { None };
    Ok(Checked { status, found, without, time })
}

/// Smallest and largest median time per particle, if all cells have one and are of one detector in
/// one arithmetic with as many threads.
fn times(cells: &[&Cell]) -> Option<[f64; 2]> {
    let one: BTreeSet<Line> = cells.iter().map(|cell| Line::new(cell)).collect();
    let per_particle = |cell: &&Cell| Some(cell.time()?.median / cell.id.n.max(1) as f64);
    let times: Option<Vec<f64>> = cells.iter().map(per_particle).collect();
    let times = times.filter(|times| one.len() == 1 && !times.is_empty())?;
    let [low, high] = [f64::min, f64::max].map(|pick| times.iter().copied().reduce(pick));
    Some([low?, high?])
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

/// A cell and its value.
#[derive(Clone, Copy)]
struct Valued<'a> {
    cell: &'a Cell,
    value: f64,
}

impl Finding {
    /// A finding about all cells with a value.
    fn new(points: &[Valued], status: Status, found: Found) -> Finding {
        let used = points.iter().map(|point| point.cell.id.clone()).collect();
        Finding { status, found, used }
    }
}

fn constant(points: &[Valued], within: f64) -> Finding {
    let by_value = |a: &&Valued, b: &&Valued| a.value.total_cmp(&b.value);
    let (Some(low), Some(high)) = (points.iter().min_by(by_value), points.iter().max_by(by_value))
    else {
        return Finding::new(points, Status::NotShown, Found::NoValue);
    };
    if points.len() < 2 {
        return Finding::new(points, Status::NotShown, Found::Single(low.value));
    }
    let spread = match high.value == low.value {
        true => Some(0.0),
        false => (low.value > 0.0).then(|| high.value / low.value - 1.0),
    };
    let within = within + ROUNDING;
    let holds = spread.is_some_and(|spread| spread <= within);
    let cells: Vec<&Cell> = points.iter().map(|point| point.cell).collect();
    let fields = varying(&cells);
    let at = |it: &Valued| At { value: it.value, place: place(&it.cell.id, &fields) };
    let found =
        Found::Constant { low: at(low), high: at(high), spread, within, over: over(&cells) };
    Finding::new(points, if holds { Status::Holds } else { Status::Fails }, found)
}

/// `equal`, within a tolerance, or `at-most`, to what `to` gives for a cell.
fn compared(points: &[Valued], to: impl Fn(&Cell) -> Option<f64>, equal: Option<f64>) -> Finding {
    // how far a cell is from the claim: relative difference, or value / limit - 1
    let gap = |value: f64, to: f64| match equal {
        Some(_) if value == to => 0.0,
        Some(_) => (value - to).abs() / to.abs(),
        _ if value <= to => -(1.0 - value / to).abs(),
        _ => (value - to) / to.abs(),
    };
    struct Sides<'a> {
        point: &'a Valued<'a>,
        limit: f64,
        gap: f64,
    }
    if points.is_empty() {
        return Finding::new(points, Status::NotShown, Found::NoValue);
    }
    let sides: Vec<Sides> = points
        .iter()
        .filter_map(|point| {
            let limit = to(point.cell)?;
            let gap = gap(point.value, limit);
            Some(Sides { point, limit, gap: if gap.is_nan() { 0.0 } else { gap } })
        })
        .collect();
    let Some(worst) = sides.iter().max_by(|a, b| a.gap.total_cmp(&b.gap)) else {
        return Finding::new(points, Status::NotShown, Found::NoSides);
    };
    let cells: Vec<&Cell> = sides.iter().map(|side| side.point.cell).collect();
    let allowed = equal.unwrap_or(0.0) + ROUNDING;
    let bad = sides.iter().filter(|side| side.gap > allowed).count();
    let found = Found::Compared {
        equal: equal.is_some(),
        cells: sides.len(),
        bad,
        worst: At {
            value: worst.point.value,
            place: place(&worst.point.cell.id, &varying(&cells)),
        },
        limit: worst.limit,
        gap: worst.gap,
        over: over(&cells),
    };
    Finding::new(points, if bad > 0 { Status::Fails } else { Status::Holds }, found)
}

fn grows(points: &[Valued], wanted: Model) -> Finding {
    if points.is_empty() {
        return Finding::new(points, Status::NotShown, Found::NoValue);
    }
    let mut series: BTreeMap<Projection, Vec<(f64, f64)>> = BTreeMap::new();
    for Valued { cell, value } in points {
        series.entry(cell.id.without(&["n", "seed"])).or_default().push((cell.id.n as f64, *value));
    }
    let cells: Vec<&Cell> = points.iter().map(|point| point.cell).collect();
    let fields: Vec<String> =
        varying(&cells).into_iter().filter(|name| name != "n" && name != "seed").collect();
    let mut fitting: Option<Fitting> = None;
    let mut others = Vec::new();
    for (key, points) in &series {
        let choice = growth::choose(points);
        let tail = Tail::new(points, wanted);
        let off = tail.filter(Tail::is_off);
        if choice.law == Ok(wanted) && off.is_none() {
            let exponent = choice.slope.map_or(f64::NAN, |slope| slope.exponent);
            let delta = choice.delta().unwrap_or(0.0);
            let fitting =
                fitting.get_or_insert(Fitting { series: 0, exponents: [exponent; 2], delta });
            let [low, high] = fitting.exponents;
            fitting.exponents = [low.min(exponent), high.max(exponent)];
            fitting.delta = fitting.delta.min(delta);
            fitting.series += 1;
        } else {
            let place = if fields.is_empty() { String::new() } else { place(key, &fields) };
            others.push(Series { place, slope: choice.slope, law: choice.law, off });
        }
    }
    let fails = |series: &Series| series.off.is_some() || series.law.is_ok();
    let status = match (others.is_empty(), others.iter().any(fails)) {
        (true, _) => Status::Holds,
        (_, true) => Status::Fails,
        _ => Status::NotShown,
    };
    // What decided comes first.
    others.sort_by_key(|series| !fails(series));
    Finding::new(points, status, Found::Growth { law: wanted, fitting, others })
}

fn faster(than: &str, by: f64, cells: &[&Cell], own: &[Cell]) -> Finding {
    let other: BTreeMap<&CellId, &Cell> = own.iter().map(|cell| (&cell.id, cell)).collect();
    let mut found: Vec<(&Cell, Interval)> = Vec::new();
    for &cell in cells.iter().filter(|cell| cell.id.contender() != than) {
        let twin = cell.id.clone().with_contender(than);
        let good = |cell: &Cell| cell.outcome(&[Pass::Time]).0.is_good() && !cell.misses_by_rule();
        if let Some(&other) = other.get(&twin).filter(|other| good(other) && good(cell)) {
            found.extend(cell.ratio(other).map(|ratio| (cell, ratio)));
        }
    }
    let used = found
        .iter()
        .map(|(cell, _)| cell.id.clone())
        .chain(cells.iter().map(|c| c.id.clone()).filter(|id| id.contender() == than));
    let used: BTreeSet<CellId> = used.collect();
    let Some((worst, interval)) = found.iter().max_by(|a, b| a.1.high.total_cmp(&b.1.high)) else {
        let found = Found::NoTimes { than: than.into() };
        return Finding { status: Status::NotShown, found, used };
    };
    let low = found.iter().map(|(_, ratio)| ratio.median).fold(f64::INFINITY, f64::min);
    let high = found.iter().map(|(_, ratio)| ratio.median).fold(0.0, f64::max);
    let noise = Noise::new(&own.iter().collect::<Vec<_>>());
    // Against 1 / by, as others are against 1.
    let decided = |(cell, ratio): &(&Cell, Interval)| {
        let [low, median, high] = [ratio.low, ratio.median, ratio.high].map(|ratio| ratio * by);
        noise.decides(&Interval { low, median, high, ..*ratio }, cell.id.n)
    };
    let slower = found.iter().filter(|pair| decided(pair) && pair.1.median * by > 1.0).count();
    let open = found.iter().filter(|pair| !decided(pair)).count();
    let status = match (slower, open) {
        (0, 0) => Status::Holds,
        (0, _) => Status::NotShown,
        _ => Status::Fails,
    };
    let compared: Vec<&Cell> = found.iter().map(|(cell, _)| *cell).collect();
    let found = Found::Faster {
        than: than.into(),
        by,
        cells: found.len(),
        low,
        high,
        slower,
        open,
        worst: *interval,
        place: place(&worst.id, &varying(&compared)),
    };
    Finding { status, found, used }
}
