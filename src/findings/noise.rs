//! The noise floor: what two measurements of the same code differ by.
//!
//! A twin is the same code as its original, timed again in every block. Where it differs from the
//! original no detector can be told from another.

use std::collections::BTreeMap;

use crate::cells::{Cell, CellId};
use crate::record::row::Pass;
use crate::stats::interval::{Blocks, Interval, median, ratio, typical_ratio};

/// Every twin against its original.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise {
    /// Twins with times.
    pub twins: Vec<Twin>,
    /// Nine in ten cells of the twins are within this factor of the original; 1 without twins. A
    /// smaller difference between detectors decides nothing.
    pub floor: f64,
}

/// A twin.
#[derive(Clone, Debug, PartialEq)]
pub struct Twin {
    /// Its name.
    pub name: String,
    /// The detector whose code it is.
    pub original: String,
    /// How many cells both were timed in.
    pub cells: usize,
    /// Its time over the original's: of each block the median over all cells.
    pub overall: Interval,
    /// The median over the cells of how far apart they are: 0.01 is 1%.
    pub typical: f64,
    /// The ratio that is farthest from 1.
    pub worst: Interval,
    /// Cells whose interval excludes 1.
    pub outside: usize,
    /// The fraction of cells in which chance alone does that.
    pub by_chance: f64,
}

impl Noise {
    /// From all cells of an experiment, or of one machine.
    pub fn new(cells: &[&Cell]) -> Noise {
        let by_id: BTreeMap<&CellId, &Cell> = cells.iter().map(|cell| (&cell.id, *cell)).collect();
        let good = |cell: &Cell| cell.outcome(&[Pass::Time]).0.is_good();
        let mut couples: BTreeMap<(&str, &str), Vec<(&Blocks, &Blocks)>> = BTreeMap::new();
        for &cell in cells.iter().filter(|cell| good(cell)) {
            let Some(original) = cell.role.twin_of() else { continue };
            let id = CellId { detector: original.into(), ..cell.id.clone() };
            if let Some(known) = by_id.get(&id).filter(|known| good(known)) {
                let name = cell.id.detector.as_str();
                couples.entry((name, original)).or_default().push((&cell.times, &known.times));
            }
        }
        let (mut twins, mut apart) = (Vec::new(), Vec::new());
        for ((name, original), couples) in couples {
            let ratios: Vec<Interval> = couples.iter().filter_map(|(a, b)| ratio(a, b)).collect();
            apart.extend(ratios.iter().map(distance));
            twins.extend(Twin::new(name, original, &ratios, typical_ratio(&couples)));
        }
        apart.sort_by(f64::total_cmp);
        let ninth = (apart.len() * 9 / 10).min(apart.len().saturating_sub(1));
        Noise { twins, floor: apart.get(ninth).map_or(1.0, |log| log.exp()) }
    }
}

impl Twin {
    fn new(
        name: &str,
        original: &str,
        ratios: &[Interval],
        overall: Option<Interval>,
    ) -> Option<Twin> {
        let worst = ratios.iter().max_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        let chance: f64 = ratios.iter().map(|ratio| 1.0 - ratio.coverage).sum();
        Some(Twin {
            name: name.into(),
            original: original.into(),
            cells: ratios.len(),
            overall: overall?,
            typical: median(&ratios.iter().map(distance).collect::<Vec<_>>())?.exp_m1(),
            worst: *worst,
            outside: ratios.iter().filter(|ratio| ratio.excludes(1.0)).count(),
            by_chance: chance / ratios.len() as f64,
        })
    }
}

/// From 1, as a logarithm.
fn distance(ratio: &Interval) -> f64 {
    ratio.median.ln().abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells;
    use crate::cells::testing::Lab;

    #[test]
    fn nine_in_ten_cells_are_within_the_floor() {
        let mut lab = Lab::new("e", "packed");
        for n in 1..=20_u64 {
            let apart = if n == 20 { 200 } else { 100 + n % 3 };
            lab.n(n).detector("nbs").time(&[100; 15]).detector("nbs-twin").time(&[apart; 15]);
        }
        let cells = cells::cells(&lab.rows());
        let all: Vec<&Cell> = cells.iter().collect();
        let found = Noise::new(&all);
        assert!((found.floor - 1.02).abs() < 1e-9, "{found:?}");
        let [twin] = &*found.twins else { panic!("{found:?}") };
        assert_eq!((&*twin.name, &*twin.original, twin.cells), ("nbs-twin", "nbs", 20));
        assert!((twin.typical - 0.01).abs() < 1e-9 && twin.outside == 14, "{twin:?}");
        assert!((twin.worst.median - 2.0).abs() < 1e-9 && twin.by_chance > 0.03, "{twin:?}");
        let none: Vec<&Cell> =
            all.iter().filter(|cell| cell.id.detector == "nbs").copied().collect();
        assert_eq!(Noise::new(&none), Noise { twins: Vec::new(), floor: 1.0 });
    }
}
