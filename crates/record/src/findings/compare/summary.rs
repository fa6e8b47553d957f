//! Totals of a comparison.

use std::collections::BTreeMap;

use super::{Compared, Judgement, SEEN, Timing};
use crate::stats::interval::{at_least, median};

#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct Summary {
    pub cells: usize,
    pub changed: usize,
    pub absent: usize,
    pub lacking: usize,
    #[serde(rename = "times")]
    pub judged: BTreeMap<Judgement, usize>,
    /// Upper limit for the number of slower cells expected by chance, for equal code.
    pub by_chance: f64,
    /// Smallest slowdown that would have been detected: median and maximum over the judged cells.
    pub least: Option<(f64, f64)>,
    pub small: usize,
    /// A twin that became slower or faster, and the factor. If present, no verdict is given.
    pub moved: Option<(String, f64)>,
}

impl Summary {
    pub(super) fn new(cells: &[Compared], moved: Option<(String, f64)>) -> Summary {
        let count = |wanted: fn(&&Compared) -> bool| cells.iter().filter(wanted).count();
        let mut judged = BTreeMap::new();
        for timing in cells.iter().filter_map(|cell| cell.timing.as_ref()) {
            *judged.entry(timing.judgement).or_default() += 1;
        }
        let timings = cells.iter().filter_map(|cell| cell.timing.as_ref());
        let timings: Vec<&Timing> = timings.filter(|timing| timing.is_decidable()).collect();
        let least: Vec<f64> = timings.iter().map(|timing| timing.least).collect();
        Summary {
            cells: cells.len(),
            changed: count(|cell| !cell.changes.is_empty()),
            absent: count(|cell| cell.absent.is_some()),
            lacking: count(|cell| !cell.lacks.is_empty()),
            judged,
            by_chance: timings.iter().map(|timing| (1.0 - timing.ratio.coverage) / 2.0).sum(),
            least: median(&least)
                .map(|typical| (typical, least.iter().copied().fold(1.0, f64::max))),
            small: timings.iter().filter(|timing| timing.is_small()).count(),
            moved,
        }
    }

    /// Whether more cells are slower than chance explains. For equal code this is true in at most
    /// one of twenty comparisons.
    pub fn is_slower(&self) -> bool {
        use Judgement::NotJudged;
        let slower = self.judged.get(&Judgement::Slower).copied().unwrap_or(0);
        let cells = self.judged.iter().filter(|(verdict, _)| **verdict != NotJudged);
        let cells: usize = cells.map(|(_, count)| count).sum();
        slower > 0 && at_least(slower, cells, self.by_chance / cells as f64) <= 0.05
    }

    pub fn sees(&self) -> bool {
        self.least.is_some_and(|(typical, _)| typical <= SEEN)
    }

    pub fn decides(&self) -> bool {
        use Judgement::{NotJudged, Undecided};
        self.judged.keys().any(|verdict| !matches!(verdict, NotJudged | Undecided))
    }
}
