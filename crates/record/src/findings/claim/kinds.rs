//! Checks each kind of claim, and writes its evidence in one line.

use std::collections::BTreeMap;

use crate::cells::label::{over, place, varying};
use crate::cells::{Cell, CellId};
use crate::findings::claim::{Evidence, Status};
use crate::findings::trust::noise::Noise;
use crate::record::id::Projection;
use crate::record::row::Pass;
use crate::stats::growth::{self, Choice, LIMIT, Model, Tail};
use crate::stats::interval::{COVERAGE, Interval, at_least};
use contactbench_terms::number::{number, percent, times, with_interval};

const ROUNDING: f64 = 1e-12;
const SERIES: usize = 3;

impl Evidence {
    pub(super) fn new(status: Status, found: String) -> Evidence {
        Evidence { status, found, ..Evidence::default() }
    }

    pub(super) fn nothing(words: &str) -> Evidence {
        Evidence { nothing: true, ..Evidence::new(Status::NotShown, words.into()) }
    }

    fn about<'a>(self, cells: impl IntoIterator<Item = &'a Cell>) -> Evidence {
        Evidence { used: cells.into_iter().map(|cell| cell.id.clone()).collect(), ..self }
    }
}

/// A value and its 95% interval; counts and bytes have intervals of one number.
#[derive(Clone, Copy)]
pub(super) struct Estimate {
    pub value: f64,
    pub range: [f64; 2],
}

#[derive(Clone, Copy)]
pub(super) struct Valued<'a> {
    pub cell: &'a Cell,
    pub of: Estimate,
}

const NO_VALUE: &str = "no cell has a value";

/// The status of a claim that certainly holds, certainly fails, or neither.
fn decided(holds: bool, fails: bool) -> Status {
    match (holds, fails) {
        (true, _) => Status::Holds,
        (_, true) => Status::Fails,
        _ => Status::NotShown,
    }
}

fn cells_of<'a>(points: &[Valued<'a>]) -> Vec<&'a Cell> {
    points.iter().map(|point| point.cell).collect()
}

pub(super) fn constant(points: &[Valued], within: f64) -> Evidence {
    let by_value = |a: &&Valued, b: &&Valued| a.of.value.total_cmp(&b.of.value);
    let (Some(low), Some(high)) = (points.iter().min_by(by_value), points.iter().max_by(by_value))
    else {
        return Evidence::nothing(NO_VALUE);
    };
    let cells = cells_of(points);
    if points.len() < 2 {
        let words = format!("{} in the only cell; a constant needs two", number(low.of.value));
        return Evidence::new(Status::NotShown, words).about(cells);
    }
    let above = |low: f64, high: f64| match (low, high) {
        _ if high <= low => 0.0,
        _ if low > 0.0 => high / low - 1.0,
        _ => f64::INFINITY,
    };
    let ends = |end: usize, pick: fn(f64, f64) -> f64| {
        points.iter().map(|point| point.of.range[end]).reduce(pick).unwrap_or(f64::NAN)
    };
    let within = within + ROUNDING;
    let spread = above(low.of.value, high.of.value);
    let least_spread = above(ends(1, f64::min), ends(0, f64::max));
    let most_spread = above(ends(0, f64::min), ends(1, f64::max));
    let status = decided(most_spread <= within, least_spread > within);
    let (least, most, over) = (number(low.of.value), number(high.of.value), over(&cells));
    let at = |point: &Valued| place(&point.cell.id, &varying(&cells));
    let words = match spread {
        f64::INFINITY => format!("{least} to {most} ({over}); the smallest value is not positive"),
        0.0 => format!("always {least} ({over})"),
        _ if status == Status::Holds => {
            format!("varies by {}, from {least} to {most} ({over})", apart(spread, within))
        }
        _ => format!(
            "varies by {} ({} allowed), from {least} at {} to {most} at {}",
            apart(spread, within),
            apart(within, within),
            at(low),
            at(high)
        ),
    };
    let tell = if status == Status::NotShown { "; undecided" } else { "" };
    Evidence::new(status, words + tell).about(cells)
}

/// Formats how far a value exceeds another, as a percentage or, if large, as a factor.
fn apart(spread: f64, within: f64) -> String {
    match within >= 1.0 || spread >= 1.0 {
        true => format!("a factor of {}", times(1.0 + spread)),
        false => percent(spread),
    }
}

pub(super) fn compared(
    points: &[Valued],
    to: impl Fn(&Cell) -> Option<Estimate>,
    equal: Option<f64>,
) -> Evidence {
    if points.is_empty() {
        return Evidence::nothing(NO_VALUE);
    }
    let sides = points.iter().filter_map(|point| {
        let limit = to(point.cell)?;
        let (gap, decided) = side(point.of, limit, equal);
        Some((point.cell, point.of.value, limit.value, gap, decided))
    });
    let sides: Vec<_> = sides.collect();
    let used = cells_of(points);
    // The worst of the cells that decide: false ones, otherwise undecided ones.
    let rank = |(.., (holds, fails)): &(&Cell, f64, f64, f64, (bool, bool))| (*fails, !holds);
    let Some(&(worst, value, limit, gap, _)) =
        sides.iter().max_by(|a, b| rank(a).cmp(&rank(b)).then(a.3.total_cmp(&b.3)))
    else {
        return Evidence::new(Status::NotShown, "no cell has both sides".into()).about(used);
    };
    let cells: Vec<&Cell> = points.iter().map(|it| it.cell).filter(|it| to(it).is_some()).collect();
    let bad = sides.iter().filter(|side| side.4.1).count();
    let open = sides.iter().filter(|side| side.4 == (false, false)).count();
    let (value, limit) = (number(value), number(limit));
    let at = || format!(", at {}", place(&worst.id, &varying(&cells)));
    let (all, at) = match sides.len() {
        1 => ("the only cell".into(), String::new()),
        2 => (format!("both cells ({})", over(&cells)), at()),
        count => (format!("all {count} cells ({})", over(&cells)), at()),
    };
    let by = if gap.is_finite() { format!("{} ", percent(gap)) } else { String::new() };
    let worst = match equal {
        Some(_) => format!("{value}, {by}off {limit}{at}"),
        None => format!("{value}, {by}above {limit}{at}"),
    };
    let words = match (bad, equal) {
        (0, _) if open > 0 => {
            format!("undecided in {open} of {}: {value} (limit {limit}){at}", sides.len())
        }
        (0, Some(_)) if gap == 0.0 => format!("exact in {all}"),
        (0, Some(_)) => format!("within {} in {all}", percent(gap)),
        (0, None) => format!("true in {all}; closest to the limit: {value} (limit {limit}){at}"),
        _ if sides.len() == 1 => worst,
        (bad, _) => format!("false in {bad} of {} cells; worst: {worst}", sides.len()),
    };
    Evidence::new(decided(bad + open == 0, bad > 0), words).about(used)
}

/// Returns how far a value is off, and whether it certainly is within its limit, or beyond. If
/// values must be equal, it is the relative difference; otherwise it is value / limit - 1.
fn side(value: Estimate, limit: Estimate, equal: Option<f64>) -> (f64, (bool, bool)) {
    let gap = |value: f64, to: f64| {
        let gap = match equal {
            Some(_) if value == to => 0.0,
            Some(_) => (value - to).abs() / to.abs(),
            _ if value <= to => -(1.0 - value / to).abs(),
            _ => (value - to) / to.abs(),
        };
        if gap.is_nan() { 0.0 } else { gap }
    };
    let allowed = equal.unwrap_or(0.0) + ROUNDING;
    let ends = [(0, 1), (1, 0)].map(|(a, b)| gap(value.range[a], limit.range[b]));
    let apart = value.range[0] > limit.range[1] || value.range[1] < limit.range[0];
    let nearest = if equal.is_none() || apart { ends[0].min(ends[1]) } else { 0.0 };
    let decided = (ends[0].max(ends[1]) <= allowed, nearest > allowed);
    (gap(value.value, limit.value), decided)
}

pub(super) fn grows(points: &[Valued], wanted: Model) -> Evidence {
    if points.is_empty() {
        return Evidence::nothing(NO_VALUE);
    }
    let mut series: BTreeMap<Projection, Vec<(f64, f64)>> = BTreeMap::new();
    for Valued { cell, of } in points {
        series
            .entry(cell.id.without(&["n", "seed"]))
            .or_default()
            .push((cell.id.n as f64, of.value));
    }
    let cells = cells_of(points);
    let fields: Vec<String> =
        varying(&cells).into_iter().filter(|name| name != "n" && name != "seed").collect();
    // For series that the law fits: exponent and distance to the next law. For other series:
    // whether the claim fails, and why.
    let (mut fitting, mut others) = (Vec::new(), Vec::new());
    for (key, points) in &series {
        let choice = growth::choose(points);
        let off = Tail::new(points, wanted).filter(Tail::is_off);
        if choice.law == Ok(wanted) && off.is_none() {
            let exponent = choice.slope.map_or(f64::NAN, |slope| slope.exponent);
            fitting.push((exponent, choice.delta().unwrap_or(0.0)));
        } else {
            let place = match fields.is_empty() {
                true => String::new(),
                false => format!("{}: ", place(key, &fields)),
            };
            let fails = off.is_some() || choice.law.is_ok();
            others.push((fails, place + &misfit(&choice, off, wanted.name())));
        }
    }
    let status = decided(others.is_empty(), others.iter().any(|(fails, _)| *fails));
    let mut parts: Vec<String> = Vec::new();
    if !fitting.is_empty() {
        let least =
            |of: fn(&(f64, f64)) -> f64| fitting.iter().map(of).fold(f64::INFINITY, f64::min);
        let (low, high) = (least(|it| it.0), -least(|it| -it.0));
        let range = if low < high { format!("{low:.3} to {high:.3}") } else { format!("{low:.3}") };
        let count = match series.len() {
            1 => String::new(),
            all => format!(" in {} of {all} series", fitting.len()),
        };
        parts.push(format!(
            "{} fits best{count}: exponent {range}; the next law is behind by ΔAICc {:.0} or more",
            wanted.name(),
            least(|it| it.1)
        ));
    }
    others.sort_by_key(|(fails, _)| !fails);
    let more = others.len().saturating_sub(SERIES);
    parts.extend(others.into_iter().take(SERIES).map(|(_, words)| words));
    if more > 0 {
        parts.push(format!("and {more} more series"));
    }
    let found = Evidence::new(status, parts.join("; ")).about(cells);
    // Another law may fit when the missing cells are measured.
    Evidence { open: true, ..found }
}

fn misfit(choice: &Choice, off: Option<Tail>, wanted: &str) -> String {
    let exponent = choice.slope.map_or_else(String::new, |slope| {
        format!("exponent {:.3} ({:.3} to {:.3}), ", slope.exponent, slope.low, slope.high)
    });
    let law = match (&choice.law, off) {
        (Ok(law), _) if law.name() != wanted => format!("{} fits, not {wanted}", law.name()),
        (_, Some(Tail { sizes: [first, last], found, law })) => format!(
            "exponent {found:.3} for n = {first} to {last}, where {wanted} has {law:.3}: {:.3} \
             off, {LIMIT} allowed",
            (found - law).abs()
        ),
        (Ok(_), None) => format!("{wanted} fits"),
        (Err(doubt), None) => format!("undecided: {doubt}"),
    };
    exponent + &law
}

/// A cell beside that of another detector on the same scene.
struct Raced<'a> {
    cell: &'a Cell,
    other: &'a Cell,
    ratio: Interval,
    side: Side,
}

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Side {
    Faster,
    Undecided,
    Slower,
}

/// Cells of `cells` whose detector is not `than`, beside that of `than`, if both have times.
fn raced<'a>(than: &str, by: f64, cells: &[&'a Cell], own: &'a [Cell]) -> Vec<Raced<'a>> {
    let noise = Noise::new(&own.iter().collect::<Vec<_>>());
    let all: BTreeMap<&CellId, &Cell> = own.iter().map(|cell| (&cell.id, cell)).collect();
    let good = |cell: &Cell| cell.outcome(&[Pass::Time]).0.is_good() && !cell.misses_by_rule();
    let pair = |&cell: &&'a Cell| {
        let other = *all.get(&cell.id.clone().with_subject(than))?;
        let ratio = cell.ratio(other).filter(|_| good(other) && good(cell))?;
        let side = match ratio.scaled(by) {
            ratio if !noise.decides(&ratio, cell.id.n) => Side::Undecided,
            ratio if ratio.median > 1.0 => Side::Slower,
            _ => Side::Faster,
        };
        Some(Raced { cell, other, ratio, side })
    };
    cells.iter().filter(|cell| cell.id.subject() != than).filter_map(pair).collect()
}

/// Whether cells are slower beyond chance. A comparison of many cells finds some slower by chance;
/// therefore more are slower than that, or one by an interval that allows for the number of cells.
fn beyond_chance(found: &[Raced], by: f64) -> bool {
    let slower: Vec<&Raced> = found.iter().filter(|it| it.side == Side::Slower).collect();
    let strict = 1.0 - (1.0 - COVERAGE) / found.len() as f64;
    let surely = |it: &&Raced| {
        let ratio = it.cell.ratio_at(it.other, strict).filter(|ratio| ratio.coverage >= strict);
        ratio.is_some_and(|ratio| ratio.low * by > 1.0)
    };
    let chance = at_least(slower.len(), found.len(), (1.0 - COVERAGE) / 2.0);
    chance < 1.0 - COVERAGE || slower.iter().any(surely)
}

pub(super) fn faster(than: &str, by: f64, cells: &[&Cell], own: &[Cell]) -> Evidence {
    let found = raced(than, by, cells, own);
    let compared: Vec<&Cell> = found.iter().map(|it| it.cell).collect();
    let those = cells.iter().copied().filter(|cell| cell.id.subject() == than);
    let used = compared.iter().copied().chain(those);
    // The worst of the cells that decide.
    let Some(worst) =
        found.iter().max_by(|a, b| a.side.cmp(&b.side).then(a.ratio.high.total_cmp(&b.ratio.high)))
    else {
        let words = format!("no cell has times of both it and {than}");
        return Evidence::nothing(&words).about(used);
    };
    let count = |side: Side| found.iter().filter(|it| it.side == side).count();
    let (slower, open) = (count(Side::Slower), count(Side::Undecided));
    let fails = beyond_chance(&found, by);
    let status = decided(slower + open == 0, fails);
    let misses = match by {
        1.0 => "not faster".into(),
        by if by < 1.0 => format!("over {} times", times(1.0 / by)),
        by => format!("not {by} times as fast"),
    };
    let tell = if found.len() == 1 {
        let one = [misses, "undecided".into()].into_iter().zip([slower, open]);
        one.filter(|(_, count)| *count > 0).map(|(words, _)| format!("; {words}")).collect()
    } else {
        let chance = if fails { "" } else { ", perhaps by chance" };
        let slow = (slower > 0).then(|| format!("; {misses} in {slower}{chance}"));
        let open = (open > 0).then(|| format!("; undecided in {open}"));
        [slow, open].into_iter().flatten().collect::<String>()
    };
    let end = |pick: fn(f64, f64) -> f64| {
        times(found.iter().map(|it| it.ratio.median).reduce(pick).unwrap_or(f64::NAN))
    };
    let interval = with_interval(&worst.ratio);
    let words = match &found[..] {
        [_] => format!("{interval} times the time of {than} in the only cell{tell}"),
        all => format!(
            "{} to {} times the time of {than} in {} cells{tell}; {} {interval} at {}",
            end(f64::min),
            end(f64::max),
            all.len(),
            if status == Status::Holds { "closest to the limit:" } else { "worst:" },
            place(&worst.cell.id, &varying(&compared))
        ),
    };
    Evidence::new(status, words).about(used)
}
