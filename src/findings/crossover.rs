//! Where one detector overtakes another, by the cost model: counts are continued as powers of N,
//! scene by scene. The range of a crossover is where the two predictions differ by no more than the
//! typical residuals.

use std::collections::BTreeMap;

use crate::cells::Cell;
use crate::findings::cost::{Fit, Kind, Series, Term, fits, series};
use crate::stats::line::StraightLine;

/// Predictions are made from this N to that.
pub const RANGE: (f64, f64) = (1e2, 1e7);
/// Points of the search, evenly spaced in logarithms.
const STEPS: usize = 500;
/// Couples whose times differ by less, as ln of their ratio, are not predicted.
const APART: f64 = 0.1;

/// The cost model of all detectors on one machine, and what it predicts.
#[derive(Clone, Debug, PartialEq)]
pub struct CostModel {
    /// One for each detector and order of the particles that has cells enough.
    pub fits: Vec<Fit>,
    /// Do the orders differ?
    pub orders: bool,
    /// Couples of measured cells, more than a tenth apart, of which it names the faster one.
    pub right: usize,
    /// All such couples.
    pub couples: usize,
    /// Fitted without the largest N of each detector: the factors by which times there are missed.
    pub held_out: Vec<f64>,
    /// One per scene and arithmetic with two detectors.
    pub predictions: Vec<Prediction>,
}

/// What is predicted of the detectors on one scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// The scene, without its N.
    pub scene: String,
    /// From which N on who is the fastest, ascending; the first from the least N of [`RANGE`].
    pub reign: Vec<(f64, String)>,
    /// Who overtakes whom.
    pub crossings: Vec<Crossing>,
    /// Couples of detectors.
    pub couples: usize,
    /// Couples that never cross within [`RANGE`].
    pub uncrossed: usize,
}

/// One detector overtakes another.
#[derive(Clone, Debug, PartialEq)]
pub struct Crossing {
    /// The faster one below.
    pub below: String,
    /// The faster one above.
    pub above: String,
    /// The N where they are equal.
    pub n: f64,
    /// Where they differ by no more than the residuals of the fits.
    pub range: (f64, f64),
    /// Does `n` lie beyond the N that were measured on this scene?
    pub extrapolated: bool,
}

impl CostModel {
    /// Fits the model, with the caches of the machine (name and bytes); none where no detector has
    /// two cells for every kind of its operations.
    pub fn new(cells: &[&Cell], caches: &[(String, u64)]) -> Option<CostModel> {
        let series = series(cells);
        let fits = fits(&series, caches);
        let (right, couples) = score(&series, &fits);
        let mut scenes: BTreeMap<(&str, &str), Vec<&Series<'_>>> = BTreeMap::new();
        for one in &series {
            scenes.entry((&one.scene, &one.line.arithmetic)).or_default().push(one);
        }
        let predictions = scenes.values().filter_map(|members| predict(members, &fits)).collect();
        let orders = series.iter().any(|one| one.order != series[0].order);
        let held_out = fits.iter().flat_map(|fit| fit.held_out.clone()).collect();
        let found = CostModel { fits, orders, right, couples, held_out, predictions };
        (!found.fits.is_empty()).then_some(found)
    }
}

/// A scene's prediction for one detector: a cost and a power of N for every term.
struct Curve<'a> {
    fit: &'a Fit,
    /// Nanoseconds at N = 1, and the exponent.
    powers: Vec<(f64, f64)>,
}

impl<'a> Curve<'a> {
    /// None with a single N.
    fn new(fit: &'a Fit, series: &Series<'_>) -> Option<Curve<'a>> {
        let powers = fit.terms.iter().map(|term| power(term, &series.cells));
        Some(Curve { fit, powers: powers.collect::<Option<_>>()? })
    }

    /// ln of the predicted time.
    fn at(&self, n: f64) -> f64 {
        self.powers.iter().map(|(scale, power)| scale * n.powf(*power)).sum::<f64>().max(1e-3).ln()
    }
}

/// count = c N^b by least squares in logarithms, over the cells that have any; the constant is one.
/// None with a single N.
fn power(term: &Term, cells: &BTreeMap<u64, &Cell>) -> Option<(f64, f64)> {
    if term.kind == Kind::Detection {
        return Some((term.ns, 0.0));
    }
    let counts = cells.iter().map(|(&n, cell)| (n as f64, term.kind.count(cell)));
    let points: Vec<(f64, f64)> = counts
        .filter(|(n, count)| *n > 0.0 && *count > 0.0)
        .map(|p| (p.0.ln(), p.1.ln()))
        .collect();
    if points.is_empty() {
        return Some((0.0, 0.0));
    }
    let line = StraightLine::fit(&points)?;
    Some((term.ns * line.intercept.exp(), line.slope))
}

fn fit_of<'a>(series: &Series<'_>, fits: &'a [Fit]) -> Option<&'a Fit> {
    fits.iter().find(|fit| fit.line == series.line && fit.order == series.order)
}

fn places() -> impl Iterator<Item = f64> {
    (0..=STEPS).map(|k| RANGE.0 * (RANGE.1 / RANGE.0).powf(k as f64 / STEPS as f64))
}

/// Where two curves cross, in order.
fn crossings(a: &Curve<'_>, b: &Curve<'_>, measured: (f64, f64)) -> Vec<Crossing> {
    let gap = |n: f64| a.at(n) - b.at(n);
    let unsure = a.fit.typical.hypot(b.fit.typical).ln_1p();
    let near = |n: &&f64| gap(**n).abs() <= unsure;
    let ns: Vec<f64> = places().collect();
    let mut found = Vec::new();
    for (k, pair) in ns.windows(2).enumerate() {
        let (left, right) = (gap(pair[0]), gap(pair[1]));
        if left * right > 0.0 || left == right || left == 0.0 {
            continue;
        }
        let n = pair[0] * (pair[1] / pair[0]).powf(left / (left - right));
        let low = ns[..=k].iter().rev().take_while(near).last().copied().unwrap_or(n);
        let high = ns[k + 1..].iter().take_while(near).last().copied().unwrap_or(n);
        let (below, above) = if left < 0.0 { (a, b) } else { (b, a) };
        found.push(Crossing {
            below: below.fit.name.clone(),
            above: above.fit.name.clone(),
            n,
            range: (low, high),
            extrapolated: n < measured.0 || n > measured.1,
        });
    }
    found
}

/// Who is predicted to be the fastest from which N on, in order.
fn reign(curves: &[Curve<'_>]) -> Vec<(f64, String)> {
    let mut reign: Vec<(f64, String)> = Vec::new();
    for n in places() {
        let Some(first) = curves.iter().min_by(|a, b| a.at(n).total_cmp(&b.at(n))) else { break };
        if reign.last().is_none_or(|(_, name)| *name != first.fit.name) {
            reign.push((n, first.fit.name.clone()));
        }
    }
    reign
}

/// In how many couples of measured cells the model names the faster one: right ones, and all.
fn score(series: &[Series<'_>], fits: &[Fit]) -> (usize, usize) {
    let (mut right, mut all) = (0, 0);
    for (k, a) in series.iter().enumerate() {
        for b in series[..k]
            .iter()
            .filter(|b| b.scene == a.scene && b.line.arithmetic == a.line.arithmetic)
        {
            let (Some(fit_a), Some(fit_b)) = (fit_of(a, fits), fit_of(b, fits)) else { continue };
            for (n, cell) in &a.cells {
                let Some(other) = b.cells.get(n) else { continue };
                let (Some(time), Some(than)) = (cell.time(), other.time()) else { continue };
                let measured = time.median.ln() - than.median.ln();
                if measured.abs() > APART {
                    let predicted = fit_a.at(cell).ln() - fit_b.at(other).ln();
                    all += 1;
                    right += usize::from(measured * predicted > 0.0);
                }
            }
        }
    }
    (right, all)
}

/// None with fewer than two detectors.
fn predict(members: &[&Series<'_>], fits: &[Fit]) -> Option<Prediction> {
    let curves: Vec<Curve<'_>> =
        members.iter().filter_map(|one| Curve::new(fit_of(one, fits)?, one)).collect();
    let sizes = || members.iter().flat_map(|one| one.cells.keys());
    let measured = (*sizes().min()? as f64, *sizes().max()? as f64);
    let couples = (0..curves.len()).flat_map(|a| (0..a).map(move |b| (a, b)));
    let found: Vec<Vec<Crossing>> =
        couples.map(|(a, b)| crossings(&curves[a], &curves[b], measured)).collect();
    (curves.len() > 1).then(|| Prediction {
        scene: members[0].scene.clone(),
        reign: reign(&curves),
        couples: found.len(),
        uncrossed: found.iter().filter(|crossings| crossings.is_empty()).count(),
        crossings: found.into_iter().flatten().collect(),
    })
}

#[cfg(test)]
mod tests;
