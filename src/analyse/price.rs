//! What each arithmetic gains and costs: its error rate, and its time as a multiple of that of f64, per scene.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use super::interval::{Interval, median, typical_ratio};
use super::summary::{is_control, title, with_interval};
use super::value::{Cell, Key};
use super::{errors, place, text};
use crate::contact::Arithmetic;
use crate::harness::record::Pass;

/// The arithmetic that others are compared with in time.
const BASE: &str = "f64";

/// One line per scene: error rates by arithmetic, and paired ratios of times to f64. Before it, the price of exactness in a sentence. None
/// unless f64 and another arithmetic were timed on the same scene.
pub fn table(cells: &[&Cell]) -> Option<String> {
    let cells: Vec<&Cell> = cells.iter().filter(|cell| !is_control(&cell.key.detector)).copied().collect();
    let swept = place::swept(&cells);
    let names: BTreeSet<&str> = cells.iter().map(|cell| cell.key.arithmetic.as_str()).collect();
    let mut names: Vec<&str> = names.into_iter().collect();
    names.sort_by_key(|name| Arithmetic::ALL.iter().position(|known| known.name() == *name));
    let mut scenes: BTreeMap<Key, Vec<&Cell>> = BTreeMap::new();
    for &cell in &cells {
        scenes.entry(cell.key.clone().without("detector").without("arithmetic").without("threads")).or_default().push(cell);
    }
    let (mut rows, mut prices) = (Vec::new(), Vec::new());
    for (key, cells) in &scenes {
        let mut row = vec![title(key, &swept)];
        row.extend(names.iter().map(|name| rates(cells, name)));
        for name in names.iter().filter(|name| **name != BASE) {
            let ratio = against_base(cells, name);
            prices.extend(ratio.filter(|_| *name == Arithmetic::Exact.name()).map(|ratio| (key, ratio)));
            row.push(ratio.map_or("–".into(), |ratio| with_interval(&ratio)));
        }
        rows.push(row);
    }
    if rows.iter().all(|row| row.iter().skip(1 + names.len()).all(|ratio| ratio == "–")) {
        return None;
    }
    let heads: Vec<String> = std::iter::once("scene".into())
        .chain(names.iter().map(|name| format!(">errors, {name}")))
        .chain(names.iter().filter(|name| **name != BASE).map(|name| format!(">time, {name} / {BASE}")))
        .collect();
    let mut out = sentence(&prices, &swept);
    out += "Errors are wrong pairs per true contact, against the scene as given (and, behind the bar, against the scene as stored, where that \
            differs); a range is one over detectors. Times are ratios within a block, of each block the median over the detectors.\n\n";
    out += &text::markdown_table(&heads.iter().map(String::as_str).collect::<Vec<_>>(), &rows);
    Some(out)
}

/// `**Price of exactness:** ...`, over all scenes.
fn sentence(prices: &[(&Key, Interval)], swept: &[String]) -> String {
    let by_median = |a: &&(&Key, Interval), b: &&(&Key, Interval)| a.1.median.total_cmp(&b.1.median);
    let medians: Vec<f64> = prices.iter().map(|(_, ratio)| ratio.median).collect();
    let (Some(typical), Some(least), Some(most)) = (median(&medians), prices.iter().min_by(by_median), prices.iter().max_by(by_median))
    else {
        return String::new();
    };
    let mut out =
        format!("**Price of exactness: {typical:.2} times the time of {BASE}** (median of {}", text::plural(prices.len(), "scene"));
    if prices.len() > 1 {
        let at = |(key, ratio): &(&Key, Interval)| format!("{} on {}", with_interval(ratio), text::escape(&title(key, swept)));
        let _ = write!(out, "; least {}; most {}", at(least), at(most));
    }
    out + ").\n\n"
}

/// `12% | 0.3%`: against the scene as given and, where they differ, as stored.
fn rates(cells: &[&Cell], arithmetic: &str) -> String {
    let range = |of: fn(&Cell) -> Option<f64>| {
        let rates = cells.iter().filter(|cell| cell.key.arithmetic == arithmetic).filter_map(|cell| of(cell));
        let (low, high) = rates.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), rate| (low.min(rate), high.max(rate)));
        match (text::percent(low), text::percent(high)) {
            _ if low > high => "–".to_string(),
            (low, high) if low == high => low,
            (low, high) => format!("{low} to {high}"),
        }
    };
    let (given, stored) = (range(errors::rate), range(errors::stored_rate));
    if given == stored || stored == "–" { given } else { format!("{given} | {stored}") }
}

fn against_base(cells: &[&Cell], arithmetic: &str) -> Option<Interval> {
    let timed = |cell: &&&Cell| cell.outcome(&[Pass::Time]).0.is_good();
    let of = |name: &str, detector: &Cell| {
        let same = |cell: &&&Cell| cell.key.arithmetic == name && cell.key.detector == detector.key.detector;
        cells.iter().find(|cell| same(cell) && cell.key.threads == detector.key.threads).filter(timed).copied()
    };
    let own = cells.iter().filter(|cell| cell.key.arithmetic == arithmetic).filter(timed);
    let couples: Vec<_> = own.filter_map(|cell| Some((&cell.times, &of(BASE, cell)?.times))).collect();
    typical_ratio(&couples)
}

#[cfg(test)]
mod tests {
    use super::super::{fake::Lab, value};
    use super::*;
    use crate::harness::record::{Causes, Errors, Outcome};

    #[test]
    fn price_and_gain_stand_side_by_side() {
        let mut lab = Lab::new("e", "packed");
        let wrong = |missed| Errors { missed, ..Errors::default() };
        for (offset, price) in [(0, 105), (1000, 120)] {
            lab.param("offset", offset);
            for (detector, scale) in [("nbs", 1), ("sorting", 3)] {
                lab.detector(detector);
                let input = Causes { input: wrong(25), ..Causes::default() };
                lab.arithmetic("f32").time(&[80 * scale; 15]).errors(wrong(25), input);
                let lost = if detector == "nbs" { wrong(5) } else { wrong(0) };
                lab.arithmetic("textbook").time(&[99 * scale; 15]);
                lab.errors(lost, Causes { algorithm: lost, stored: lost, ..Causes::default() }).edit(|row| row.outcome = Outcome::Lossy);
                lab.arithmetic("f64").time(&[100 * scale; 15]).errors(wrong(0), Causes::default());
                lab.arithmetic("exact").time(&[price * scale; 15]).errors(wrong(0), Causes::default());
            }
        }
        let cells = value::cells(&lab.rows());
        let all: Vec<&Cell> = cells.iter().collect();
        let table = table(&all).unwrap();
        let price = "**Price of exactness: 1.12 times the time of f64** (median of 2 scenes; least 1.05 (1.05 to 1.05) on packed, 2D, N = 100, offset = 0; most 1.20";
        assert!(table.starts_with(price), "{table}");
        let line = "| packed, 2D, N = 100, offset = 1000 | 10% \\| 0% | 0% to 2.0% | 0% | 0% | 0.80 (0.80 to 0.80) | 0.99 (0.99 to 0.99) | 1.20 (1.20 to 1.20) |";
        assert!(table.contains(line), "{table}");
        assert_eq!(super::table(&all.iter().filter(|cell| cell.key.arithmetic == "f64").copied().collect::<Vec<_>>()), None);
    }
}
