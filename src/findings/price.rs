//! What each arithmetic gains and costs: its error rate, and its time as a multiple of that of f64,
//! per scene.

use std::collections::{BTreeMap, BTreeSet};

use crate::cells::label::title;
use crate::cells::{Cell, CellId, errors, label};
use crate::record::id::Projection;
use crate::record::row::Pass;
use crate::stats::interval::{Interval, median, typical_ratio};
use contactbench_terms::arithmetic::Arithmetic;

/// The arithmetic that others are compared with in time.
pub const BASE: &str = "f64";

/// Errors and times by arithmetic.
#[derive(Clone, Debug, PartialEq)]
pub struct Price {
    /// Those that were measured, in their usual order.
    pub arithmetics: Vec<String>,
    /// One per scene and N.
    pub scenes: Vec<ScenePrice>,
    /// What exact decisions cost over all scenes; none where they were not timed.
    pub exactness: Option<Exactness>,
}

/// A scene in every arithmetic.
#[derive(Clone, Debug, PartialEq)]
pub struct ScenePrice {
    /// The scene.
    pub title: String,
    /// Error rates over detectors, one for each arithmetic.
    pub errors: Vec<Rates>,
    /// Times over those of [`BASE`], one for each arithmetic; none for [`BASE`] itself.
    pub times: Vec<Option<Interval>>,
}

/// Wrong pairs per true contact: the least and the largest over detectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates {
    /// Against the scene as given.
    pub given: Option<(f64, f64)>,
    /// Against the scene as stored.
    pub stored: Option<(f64, f64)>,
}

/// The time of exact arithmetic over that of [`BASE`].
#[derive(Clone, Debug, PartialEq)]
pub struct Exactness {
    /// The median over scenes.
    pub typical: f64,
    /// How many scenes.
    pub scenes: usize,
    /// Where it is least.
    pub least: (String, Interval),
    /// Where it is largest.
    pub most: (String, Interval),
}

impl Price {
    /// Compares the arithmetics; none unless f64 and another were timed on the same scene.
    pub fn new(cells: &[&Cell]) -> Option<Price> {
        let cells: Vec<&Cell> =
            cells.iter().filter(|cell| !cell.role.is_control()).copied().collect();
        let swept = label::swept(&cells);
        let names: BTreeSet<&str> = cells.iter().map(|cell| &*cell.id.arithmetic).collect();
        let mut arithmetics: Vec<String> = names.into_iter().map(String::from).collect();
        arithmetics
            .sort_by_key(|name| Arithmetic::ALL.iter().position(|known| known.name() == *name));
        let mut scenes: BTreeMap<Projection, Vec<&Cell>> = BTreeMap::new();
        for &cell in &cells {
            scenes.entry(cell.id.scene_id()).or_default().push(cell);
        }
        let price = |(key, cells): (&Projection, &Vec<&Cell>)| ScenePrice {
            title: title(key, &swept),
            errors: arithmetics.iter().map(|name| rates(cells, name)).collect(),
            times: arithmetics.iter().map(|name| time(cells, name)).collect(),
        };
        let scenes: Vec<ScenePrice> = scenes.iter().map(price).collect();
        let timed = scenes.iter().any(|scene| scene.times.iter().any(Option::is_some));
        let exact = arithmetics.iter().position(|name| *name == Arithmetic::Exact.name());
        let exactness = exact.and_then(|exact| exactness(&scenes, exact));
        timed.then_some(Price { arithmetics, scenes, exactness })
    }
}

fn exactness(scenes: &[ScenePrice], exact: usize) -> Option<Exactness> {
    let prices: Vec<(&ScenePrice, Interval)> =
        scenes.iter().filter_map(|scene| Some((scene, scene.times[exact]?))).collect();
    let medians: Vec<f64> = prices.iter().map(|(_, ratio)| ratio.median).collect();
    let by_median = |a: &&(&ScenePrice, Interval), b: &&(&ScenePrice, Interval)| {
        a.1.median.total_cmp(&b.1.median)
    };
    let at = |(scene, ratio): &(&ScenePrice, Interval)| (scene.title.clone(), *ratio);
    Some(Exactness {
        typical: median(&medians)?,
        scenes: prices.len(),
        least: at(prices.iter().min_by(by_median)?),
        most: at(prices.iter().max_by(by_median)?),
    })
}

fn rates(cells: &[&Cell], arithmetic: &str) -> Rates {
    let range = |rate: fn(&Cell) -> Option<f64>| {
        let cells = cells.iter().filter(|cell| cell.id.arithmetic == arithmetic);
        cells.filter_map(|cell| rate(cell)).fold(None, |range: Option<(f64, f64)>, rate| {
            let (low, high) = range.unwrap_or((rate, rate));
            Some((low.min(rate), high.max(rate)))
        })
    };
    Rates { given: range(errors::rate), stored: range(errors::stored_rate) }
}

/// Of each block the median over the detectors.
fn time(cells: &[&Cell], arithmetic: &str) -> Option<Interval> {
    if arithmetic == BASE {
        return None;
    }
    let timed = |cell: &&&Cell| cell.outcome(&[Pass::Time]).0.is_good();
    let base = |of: &CellId| {
        let same = |cell: &&&Cell| {
            let key = &cell.id;
            key.arithmetic == BASE
                && key.contender() == of.contender()
                && key.threads() == of.threads()
        };
        cells.iter().find(same).filter(timed)
    };
    let own = cells.iter().filter(|cell| cell.id.arithmetic == arithmetic).filter(timed);
    let couples: Vec<_> =
        own.filter_map(|cell| Some((&cell.times, &base(&cell.id)?.times))).collect();
    typical_ratio(&couples)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells;
    use crate::cells::testing::Lab;
    use crate::record::row::Outcome;
    use contactbench_terms::errors::{Causes, Errors};

    #[test]
    fn every_arithmetic_has_its_errors_and_its_time() {
        let mut lab = Lab::new("e", "packed");
        let wrong = |missed| Errors { missed, ..Errors::default() };
        for (offset, price) in [(0, 105), (1000, 120)] {
            lab.param("offset", offset);
            for (detector, scale) in [("nbs", 1), ("sorting", 3)] {
                lab.detector(detector);
                let input = Causes { representation: wrong(25), ..Causes::default() };
                lab.arithmetic("f32").time(&[80 * scale; 15]).errors(wrong(25), input);
                let lost = if detector == "nbs" { wrong(5) } else { wrong(0) };
                lab.arithmetic("textbook").time(&[99 * scale; 15]);
                lab.errors(lost, Causes { search: lost, stored: lost, ..Causes::default() })
                    .edit(|row| row.outcome = Outcome::Lossy);
                lab.arithmetic("f64").time(&[100 * scale; 15]).errors(wrong(0), Causes::default());
                lab.arithmetic("exact")
                    .time(&[price * scale; 15])
                    .errors(wrong(0), Causes::default());
            }
        }
        let cells = cells::cells(&lab.rows());
        let all: Vec<&Cell> = cells.iter().collect();
        let found = Price::new(&all).unwrap();
        assert_eq!(found.arithmetics, ["f32", "textbook", "f64", "exact"]);
        let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
        let exactness = found.exactness.unwrap();
        assert!(near(exactness.typical, 1.125) && exactness.scenes == 2, "{exactness:?}");
        assert!(exactness.least.0.ends_with("offset = 0") && near(exactness.least.1.median, 1.05));
        assert!(exactness.most.0.ends_with("offset = 1000") && near(exactness.most.1.high, 1.2));
        let scene = &found.scenes[1];
        let times: Vec<_> = scene.times.iter().map(|time| time.map(|time| time.median)).collect();
        for (found, wanted) in times.iter().zip([Some(0.8), Some(0.99), None, Some(1.2)]) {
            assert!(
                found.zip(wanted).map_or(found.is_none() && wanted.is_none(), |(a, b)| near(a, b)),
                "{times:?}"
            );
        }
        let [f32, textbook, ..] = &*scene.errors else { panic!("{scene:?}") };
        assert_eq!((f32.given, f32.stored), (Some((0.1, 0.1)), Some((0.0, 0.0))));
        assert_eq!((textbook.given, textbook.stored), (Some((0.0, 0.02)), Some((0.0, 0.02))));
        let only: Vec<&Cell> =
            all.iter().filter(|cell| cell.id.arithmetic == "f64").copied().collect();
        assert_eq!(Price::new(&only), None);
    }
}
