//! The noise floor: by how much two measurements of equal code differ.
//!
//! A twin is the code of a detector measured a second time in every block. Differences as small as
//! between twin and original are not decided.
//!
//! One rule decides everywhere whether a time is larger than another. The interval of their ratio
//! has a coverage of at least [`SURE`] and excludes 1, and the ratio exceeds that of twins with the
//! same n in the same experiment. The same rule applies to limits other than 1.

use std::collections::BTreeMap;

use crate::cells::{Cell, CellId};
use crate::record::row::Pass;
use crate::stats::interval::{Blocks, Interval, median, typical_ratio};

/// Least coverage of an interval that decides. The five blocks of the shortest full run give 0.94.
pub const SURE: f64 = 0.9;

/// If fewer cells than this have the same n, their floor is at least that of all n.
const FEW: usize = 5;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Noise {
    pub twins: Vec<Twin>,
    /// Factor within which nine in ten cells of the twins are of the original; 1 without twins.
    pub floor: f64,
    pub(in crate::findings) floors: BTreeMap<u64, f64>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Twin {
    pub name: String,
    pub original: String,
    pub cells: usize,
    /// The twin's time over the original's: the median over all cells in each block.
    pub overall: Interval,
    /// Median over the cells of the relative difference; 0.01 means 1%.
    pub typical: f64,
    pub worst: Interval,
    pub outside: usize,
    pub by_chance: f64,
}

impl Noise {
    pub fn new(cells: &[&Cell]) -> Noise {
        let by_id: BTreeMap<&CellId, &Cell> = cells.iter().map(|cell| (&cell.id, *cell)).collect();
        let good = |cell: &Cell| cell.outcome(&[Pass::Time]).0.is_good();
        let mut pairs: BTreeMap<(&str, &str), Vec<(&Cell, &Cell)>> = BTreeMap::new();
        for &cell in cells.iter().filter(|cell| good(cell)) {
            let Some(original) = cell.role.twin_of() else { continue };
            let id = CellId { detector: original.into(), ..cell.id.clone() };
            if let Some(known) = by_id.get(&id).filter(|known| good(known)) {
                let name = cell.id.detector.as_str();
                pairs.entry((name, original)).or_default().push((cell, known));
            }
        }
        let (mut twins, mut apart) = (Vec::new(), BTreeMap::<u64, Vec<f64>>::new());
        for ((name, original), pairs) in pairs {
            let mut ratios = Vec::new();
            for (twin, known) in &pairs {
                if let Some(ratio) = twin.ratio(known) {
                    apart.entry(twin.id.n).or_default().push(distance(&ratio));
                    ratios.push(ratio);
                }
            }
            let times: Vec<(&Blocks, &Blocks)> =
                pairs.iter().map(|(a, b)| (&a.times, &b.times)).collect();
            twins.extend(Twin::new(name, original, &ratios, typical_ratio(&times)));
        }
        let floor = nine_in_ten(&apart.values().flatten().copied().collect::<Vec<_>>());
        let floor_of = |logs: &Vec<f64>| {
            let own = nine_in_ten(logs);
            if logs.len() < FEW { own.max(floor) } else { own }
        };
        let floors = apart.iter().map(|(&n, logs)| (n, floor_of(logs))).collect();
        Noise { twins, floor, floors }
    }

    /// Returns the noise of a single twin. Its floor is the end of the interval farther from 1.
    pub fn of_twin(ratio: Option<Interval>) -> Noise {
        let floor = ratio.map_or(1.0, |ratio| ratio.high.max(1.0 / ratio.low));
        Noise { floor, ..Noise::default() }
    }

    /// Returns the noise floor at this n, or that of all n if no twin was timed at this n.
    pub fn floor_at(&self, n: u64) -> f64 {
        self.floors.get(&n).copied().unwrap_or(self.floor)
    }

    pub fn by_size(&self) -> impl Iterator<Item = (u64, f64)> {
        self.floors.iter().map(|(&n, &floor)| (n, floor))
    }

    /// Returns whether this ratio of two times at N = `n` shows that one of them is larger.
    pub fn decides(&self, ratio: &Interval, n: u64) -> bool {
        let beyond = distance(ratio) > self.floor_at(n).ln();
        ratio.coverage >= SURE && ratio.excludes(1.0) && beyond
    }

    pub fn slower(&self, ratio: Option<&Interval>, n: u64) -> bool {
        ratio.is_some_and(|ratio| ratio.median > 1.0 && self.decides(ratio, n))
    }
}

/// Returns the factor within which nine in ten of these logarithms lie; 1 if there are none.
pub(in crate::findings) fn nine_in_ten(logs: &[f64]) -> f64 {
    let mut logs = logs.to_vec();
    logs.sort_by(f64::total_cmp);
    let ninth = (logs.len() * 9 / 10).min(logs.len().saturating_sub(1));
    logs.get(ninth).map_or(1.0, |log| log.exp())
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

fn distance(ratio: &Interval) -> f64 {
    ratio.median.ln().abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells::testing::Lab;

    #[test]
    fn nine_in_ten_cells_are_within_the_floor() {
        let mut lab = Lab::new("e", "packed");
        for n in 1..=20_u64 {
            let apart = if n == 20 { 200 } else { 100 + n % 3 };
            lab.n(n).detector("nbs").time(&[100; 15]).detector("nbs-twin").time(&[apart; 15]);
        }
        let found = lab.find(Noise::new);
        let [twin] = &*found.twins else { panic!("{found:?}") };
        assert_eq!((&*twin.name, &*twin.original, twin.cells), ("nbs-twin", "nbs", 20));
        assert_eq!(twin.outside, 14);
        for (value, expected) in
            [(found.floor, 1.02), (twin.typical, 0.01), (twin.worst.median, 2.0)]
        {
            assert!((value - expected).abs() < 1e-9, "{value} {expected}");
        }
        assert!(twin.by_chance > 0.03, "{twin:?}");
        // The floor is that of n; a single cell is too few; without cells it is that of all n.
        assert!((found.floor_at(20) - 2.0).abs() < 1e-9);
        assert_eq!([3, 1000].map(|n| found.floor_at(n)), [found.floor; 2]);
        for seed in 2..=5 {
            lab.n(3).seed(seed).detector("nbs").time(&[100; 15]);
            lab.detector("nbs-twin").time(&[100; 15]);
        }
        let five = lab.find(Noise::new);
        assert!(five.floor_at(3) == 1.0 && five.floor > 1.0, "{five:?}");
        let silent = lab.find(|cells| {
            let own = cells.iter().filter(|cell| cell.id.detector == "nbs");
            Noise::new(&own.copied().collect::<Vec<_>>())
        });
        assert_eq!((silent.twins.len(), silent.floor, silent.floor_at(20)), (0, 1.0, 1.0));
        let one = Interval { median: 1.0, low: 0.99, high: 1.01, coverage: 0.95, count: 15 };
        for (ratio, n, decided) in
            [(1.5, 3, true), (0.4, 20, true), (1.5, 20, false), (0.6, 20, false)]
        {
            assert_eq!(found.decides(&one.scaled(ratio), n), decided, "{ratio} {n}");
        }
        let few = Interval { coverage: 0.75, count: 3, ..one.scaled(1.5) };
        assert!(!found.decides(&few, 3), "three blocks decide nothing");
    }
}
