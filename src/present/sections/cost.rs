//! What an operation costs, and where detectors would overtake each other by that.

use crate::findings::cost::{Fit, Kind, Term};
use crate::findings::crossover::{CostModel, Crossing, Prediction, RANGE};
use crate::number::{number, percent, plural};
use crate::present::document::{Block, Text};
use crate::present::table::{Cell, Column, Table};
use crate::stats::interval::median;

/// Fewer cells than this say nothing about predictions.
const FEWEST: usize = 10;

/// The section of a report; `None` where nothing could be fitted.
pub fn blocks(found: Option<&CostModel>) -> Vec<Block> {
    let Some(found) = found else {
        return vec![Block::paragraph(
            "No detector has two cells with times and counts for every kind of its operations: \
             nothing can be fitted.",
        )];
    };
    let how = "Time is modelled as a constant per detection and a cost for every operation, \
               fitted to the times of this machine by non-negative least squares of relative \
               residuals, for every detector (and order of particles) on its own. Operations that \
               always go together share a cost, which is that of one of any of them; in brackets \
               is what is found when one scene after the other is left out: where that range is \
               wide, the times do not determine the cost. Beyond a cache every operation costs \
               more, by the same for each doubling of what a detection touches.";
    let mut out = vec![Block::paragraph(how), Block::Table(costs(found))];
    if found.couples > 0 {
        out.push(Block::paragraph(format!(
            "Of {} of detectors at the N it was fitted to (and more than a tenth apart) it names \
             the faster one in {}.",
            plural(found.couples, "couple"),
            percent(found.right as f64 / found.couples as f64)
        )));
    }
    let enough = found.held_out.len() >= FEWEST;
    if let Some(typical) = median(&found.held_out).filter(|_| enough) {
        let worst = found.held_out.iter().copied().fold(1.0, f64::max);
        out.push(Block::Paragraph(
            Text::from("Fitted without the largest N of every scene, it misses the times there ")
                .strong(format!("by a factor of {typical:.2}"))
                .plain(format!(
                    " (median of {}; at most {worst:.2}): what it foretells beyond the N measured \
                     is no better than that.",
                    plural(found.held_out.len(), "cell")
                )),
        ));
    }
    if !found.predictions.is_empty() {
        out.extend(predictions(&found.predictions));
    }
    out
}

fn costs(found: &CostModel) -> Table {
    let columns = vec![
        Column::left("detector"),
        Column::left("residual: median / largest"),
        Column::right("cells", ""),
        Column::left("operations"),
        Column::right("ns for one", ""),
    ];
    let rows = found.fits.iter().flat_map(|fit| {
        let first = head(fit, found.orders);
        let rest = || [(); 3].map(|()| Cell::from(""));
        fit.terms.iter().enumerate().map(move |(k, term)| {
            let left = if k == 0 { first.clone() } else { rest() };
            left.into_iter().chain(cost(term)).collect()
        })
    });
    Table::new("", columns).with(rows)
}

fn head(fit: &Fit, orders: bool) -> [Cell; 3] {
    let (scene, n) = &fit.worst_at;
    let (typical, worst) = (percent(fit.typical), percent(fit.worst));
    let name = if orders { format!("{}, {}", fit.name, fit.order) } else { fit.name.clone() };
    let residual = format!("{typical} / {worst} at {scene}, N = {n}");
    [name.into(), residual.into(), Cell::count(fit.cells as u64)]
}

fn cost(term: &Term) -> [Cell; 2] {
    let range = format!(" ({} to {})", number(term.low), number(term.high));
    let cost = number(term.ns) + if term.low < term.high { &range } else { "" };
    let words = match &term.kind {
        Kind::Detection => "(per detection)".to_string(),
        Kind::Beyond(cache, _) => format!("(every operation, per doubling beyond {cache})"),
        Kind::Operations(operations) => operations.join(" + "),
    };
    [words.into(), cost.into()]
}

fn predictions(found: &[Prediction]) -> Vec<Block> {
    let range = [RANGE.0, RANGE.1].map(about);
    let reign = |prediction: &Prediction| {
        let parts = prediction.reign.iter().enumerate().map(|(k, (n, name))| match k {
            0 => name.clone(),
            _ => format!("from {} {name}", about(*n)),
        });
        vec![prediction.scene.as_str().into(), parts.collect::<Vec<_>>().join("; ").into()]
    };
    let heads = ["scene".into(), format!("fastest at {}, and from which N on", range[0])];
    let reigns = Table::new("", heads.map(Column::left).into()).with(found.iter().map(reign));
    let mut out = vec![
        Block::paragraph(format!(
            "Predicted from {} to {} particles, who is the fastest:",
            range[0], range[1]
        )),
        Block::Table(reigns),
    ];
    let columns = vec![
        Column::left("scene"),
        Column::left("faster below"),
        Column::left("faster above"),
        Column::right("at N =", ""),
    ];
    let crossings =
        found.iter().flat_map(|one| one.crossings.iter().map(|crossing| row(&one.scene, crossing)));
    let crossings = Table::new("", columns).with(crossings);
    if !crossings.rows.is_empty() {
        out.push(Block::paragraph(
            "Where one overtakes the other (in brackets, where they differ by no more than the \
             fits' median residuals):",
        ));
        out.push(Block::Table(crossings));
    }
    let uncrossed: usize = found.iter().map(|prediction| prediction.uncrossed).sum();
    let couples: usize = found.iter().map(|prediction| prediction.couples).sum();
    out.push(Block::paragraph(format!(
        "No crossover in {}..{}: {uncrossed} of {}.",
        range[0],
        range[1],
        plural(couples, "couple")
    )));
    out
}

fn row(scene: &str, crossing: &Crossing) -> Vec<Cell> {
    let [n, low, high] = [crossing.n, crossing.range.0, crossing.range.1].map(about);
    let beyond = if crossing.extrapolated { ", extrapolated" } else { "" };
    let place = format!("{n} ({low} to {high}){beyond}");
    vec![scene.into(), (&*crossing.below).into(), (&*crossing.above).into(), place.into()]
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_predicted_n_has_two_digits() {
        for (n, text) in
            [(1e4, "10^4"), (99_990.0, "10^5"), (3.14e5, "3.1·10^5"), (250.0, "2.5·10^2")]
        {
            assert_eq!(about(n), text);
        }
    }
}
