//! Where one detector overtakes another, by the cost model: counts are continued as powers of N, scene by scene.

use std::collections::BTreeMap;

use super::cost::{Fit, Series, Term, fits, series};
use super::grid::{self, Line};
use super::text;
use super::value::Cell;

/// Predictions are made from this N to that.
pub const RANGE: (f64, f64) = (1e2, 1e7);
/// Points of the search, evenly spaced in logarithms.
const STEPS: usize = 500;

const HOW: &str = "Time is modelled as a constant per detection and a cost for every operation, fitted to the times of this machine by \
    non-negative least squares of relative residuals, for every detector (and order of elements) on its own. Operations that always \
    go together share a cost, which is that of one of any of them; in brackets is what is found when one scene after the other is left out: a wide \
    range says that the times do not tell. The model knows no caches: what they do is in the residuals.";

/// A scene's prediction for one detector: a cost and a power of N for every term.
struct Curve<'a> {
    fit: &'a Fit,
    /// Nanoseconds at N = 1, and the exponent.
    powers: Vec<(f64, f64)>,
}

impl Curve<'_> {
    /// ln of the predicted time.
    fn at(&self, n: f64) -> f64 {
        self.powers.iter().map(|(scale, power)| scale * n.powf(*power)).sum::<f64>().max(1e-3).ln()
    }
}

/// One detector overtakes another.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Crossing {
    /// The faster one below.
    pub below: Line,
    /// The faster one above.
    pub above: Line,
    /// Where they are equal.
    pub n: f64,
    /// Where they differ by no more than the residuals of the fits.
    pub range: (f64, f64),
}

/// count = c N^b by least squares in logarithms, over the cells that have any; the constant is one. `None` with a single N.
fn power(term: &Term, cells: &BTreeMap<u64, &Cell>) -> Option<(f64, f64)> {
    if term.operations.is_empty() {
        return Some((term.ns, 0.0));
    }
    let points = cells.iter().map(|(&n, cell)| (n as f64, term.count(cell))).filter(|point| point.0 > 0.0 && point.1 > 0.0);
    let points: Vec<(f64, f64)> = points.map(|(n, count)| (n.ln(), count.ln())).collect();
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let spread: f64 = points.iter().map(|p| (p.0 - x).powi(2)).sum();
    if points.is_empty() {
        return Some((0.0, 0.0));
    }
    let slope = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>() / spread;
    (spread > 0.0).then(|| (term.ns * (y - slope * x).exp(), slope))
}

fn curve<'a>(fit: &'a Fit, series: &Series<'_>) -> Option<Curve<'a>> {
    Some(Curve { fit, powers: fit.terms.iter().map(|term| power(term, &series.cells)).collect::<Option<_>>()? })
}

fn places() -> impl Iterator<Item = f64> {
    (0..=STEPS).map(|k| RANGE.0 * (RANGE.1 / RANGE.0).powf(k as f64 / STEPS as f64))
}

/// Where two curves cross, in order.
fn crossings(a: &Curve<'_>, b: &Curve<'_>) -> Vec<Crossing> {
    let gap = |n: f64| a.at(n) - b.at(n);
    let unsure = a.fit.typical.hypot(b.fit.typical).ln_1p();
    let ns: Vec<f64> = places().collect();
    let mut found = Vec::new();
    for (k, pair) in ns.windows(2).enumerate() {
        let (left, right) = (gap(pair[0]), gap(pair[1]));
        if left * right > 0.0 || left == right || left == 0.0 {
            continue;
        }
        let n = pair[0] * (pair[1] / pair[0]).powf(left / (left - right));
        let low = ns[..=k].iter().rev().take_while(|&&n| gap(n).abs() <= unsure).last().copied().unwrap_or(n);
        let high = ns[k + 1..].iter().take_while(|&&n| gap(n).abs() <= unsure).last().copied().unwrap_or(n);
        let (below, above) = if left < 0.0 { (a, b) } else { (b, a) };
        found.push(Crossing { below: below.fit.line.clone(), above: above.fit.line.clone(), n, range: (low, high) });
    }
    found
}

/// Who is predicted to be the fastest from which N on, in order.
fn reign<'a>(curves: &'a [Curve<'_>]) -> Vec<(f64, &'a Line)> {
    let mut reign: Vec<(f64, &Line)> = Vec::new();
    for n in places() {
        let Some(first) = curves.iter().min_by(|a, b| a.at(n).total_cmp(&b.at(n))) else { break };
        if reign.last().is_none_or(|(_, line)| **line != first.fit.line) {
            reign.push((n, &first.fit.line));
        }
    }
    reign
}

/// `3·10^4`, with two digits.
fn about(n: f64) -> String {
    let power = n.log10().floor();
    let digits = format!("{:.1}", n / 10f64.powf(power));
    match digits.trim_end_matches(".0") {
        "1" => format!("10^{power}"),
        "10" => format!("10^{}", power + 1.0),
        digits => format!("{digits}·10^{power}"),
    }
}

/// In how many couples of measured cells the model names the faster one: right ones, and all. Couples within a tenth are left out.
fn score(series: &[Series<'_>], fits: &[Fit]) -> (usize, usize) {
    let fit = |one: &Series<'_>| fits.iter().find(|fit| fit.line == one.line && fit.order == one.order);
    let (mut right, mut all) = (0, 0);
    for (k, a) in series.iter().enumerate() {
        for b in series[..k].iter().filter(|b| b.scene == a.scene && b.line.arithmetic == a.line.arithmetic) {
            let (Some(fit_a), Some(fit_b)) = (fit(a), fit(b)) else { continue };
            for (n, cell) in &a.cells {
                let Some(other) = b.cells.get(n) else { continue };
                let (Some(time), Some(than)) = (cell.time(), other.time()) else { continue };
                let measured = time.median.ln() - than.median.ln();
                if measured.abs() > 0.1 {
                    all += 1;
                    right += usize::from(measured * (fit_a.at(cell).ln() - fit_b.at(other).ln()) > 0.0);
                }
            }
        }
    }
    (right, all)
}

/// The section of a report.
pub fn section(cells: &[&Cell]) -> String {
    let series = series(cells);
    let fits = fits(&series);
    if fits.is_empty() {
        return "No detector has two cells with times and counts for every kind of its operations: nothing can be fitted.".into();
    }
    let orders = series.iter().any(|one| one.order != series[0].order);
    let name = |line: &Line| grid::label(line, cells);
    let mut rows = Vec::new();
    for fit in &fits {
        for (k, term) in fit.terms.iter().enumerate() {
            let words = if term.operations.is_empty() { "(per detection)".into() } else { term.operations.join(" + ") };
            let range = format!(" ({} to {})", text::number(term.low), text::number(term.high));
            let cost = text::number(term.ns) + if term.low < term.high { &range } else { "" };
            let order = if orders { format!(", {}", fit.order) } else { String::new() };
            let residual = format!("{} / {} at {}", text::percent(fit.typical), text::percent(fit.worst), fit.place);
            let head = if k == 0 { vec![name(&fit.line) + &order, residual, fit.cells.to_string()] } else { vec![String::new(); 3] };
            rows.push([head, vec![words, cost]].concat());
        }
    }
    let heads = ["detector", "residual: median / largest", ">cells", "operations", ">ns for one"];
    let (right, all) = score(&series, &fits);
    let mut out = format!("{HOW}\n\n{}\n", text::markdown_table(&heads, &rows));
    if all > 0 {
        let share = text::percent(right as f64 / all as f64);
        out += &format!(
            "Of {} of detectors at the N measured (and more than a tenth apart) it names the faster one in {share}.\n\n",
            text::plural(all, "couple")
        );
    }
    out + &predictions(&series, &fits, &name)
}

fn predictions(series: &[Series<'_>], fits: &[Fit], name: &impl Fn(&Line) -> String) -> String {
    let mut scenes: BTreeMap<(&str, &str), Vec<&Series<'_>>> = BTreeMap::new();
    for one in series {
        scenes.entry((&one.scene, &one.line.arithmetic)).or_default().push(one);
    }
    let (mut reigns, mut rows, mut none) = (Vec::new(), Vec::new(), 0);
    for ((scene, _), members) in &scenes {
        let fit = |one: &Series<'_>| fits.iter().find(|fit| fit.line == one.line && fit.order == one.order);
        let curves: Vec<Curve<'_>> = members.iter().filter_map(|one| curve(fit(one)?, one)).collect();
        let sizes: Vec<f64> = members.iter().flat_map(|one| one.cells.keys().map(|&n| n as f64)).collect();
        let measured = sizes.iter().fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), &n| (low.min(n), high.max(n)));
        if curves.len() < 2 {
            continue;
        }
        let parts = reign(&curves)
            .into_iter()
            .enumerate()
            .map(|(k, (n, line))| if k == 0 { name(line) } else { format!("from {} {}", about(n), name(line)) });
        reigns.push(vec![scene.to_string(), parts.collect::<Vec<_>>().join("; ")]);
        for (k, a) in curves.iter().enumerate() {
            for b in &curves[..k] {
                let found = crossings(a, b);
                none += usize::from(found.is_empty());
                rows.extend(found.into_iter().map(|crossing| {
                    let beyond = if crossing.n < measured.0 || crossing.n > measured.1 { ", extrapolated" } else { "" };
                    let range = format!("{} ({} to {}){beyond}", about(crossing.n), about(crossing.range.0), about(crossing.range.1));
                    vec![scene.to_string(), name(&crossing.below), name(&crossing.above), range]
                }));
            }
        }
    }
    if reigns.is_empty() {
        return String::new();
    }
    let mut out = format!(
        "Predicted from 10^2 to 10^7 elements, who is the fastest:\n\n{}\n",
        text::markdown_table(&["scene", "fastest at 10^2, and from which N on"], &reigns)
    );
    if !rows.is_empty() {
        out += "Where one overtakes the other (in brackets, where they differ by no more than the fits' median residuals):\n\n";
        out += &(text::markdown_table(&["scene", "faster below", "faster above", ">at N ="], &rows) + "\n");
    }
    out + &format!("No crossover in 10^2..10^7: {} of {}.", none, text::plural(none + distinct(&rows), "couple"))
}

/// Couples in the table: two that cross twice are one.
fn distinct(rows: &[Vec<String>]) -> usize {
    let couple = |row: &Vec<String>| {
        let mut names = [row[1].clone(), row[2].clone()];
        names.sort();
        (row[0].clone(), names)
    };
    rows.iter().map(couple).collect::<std::collections::BTreeSet<_>>().len()
}

#[cfg(test)]
#[path = "crossover_tests.rs"]
mod tests;
