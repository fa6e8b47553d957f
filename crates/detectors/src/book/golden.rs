//! Worked examples of the book, for tests. The book prints integerised coordinates, not centres.

use contactbench_ground::contact::{Margin, Particles, Slack};
use contactbench_ground::filter::Cells;
use contactbench_ground::probe::{Op, Probe};

/// Example G5: ten particles in 10 x 10 cells. The book does not print the column of particle 9
/// (counted from 1), so the column here is arbitrary.
pub const TEN: [[u32; 2]; 10] =
    [[4, 7], [5, 8], [4, 6], [5, 7], [4, 5], [5, 6], [3, 7], [6, 6], [9, 6], [4, 7]];
/// Example G2: nine particles for screening.
pub const NINE: [[u32; 2]; 9] =
    [[5, 7], [5, 7], [2, 7], [5, 7], [2, 7], [5, 6], [2, 7], [6, 6], [2, 7]];

/// Particles in the given cells of a 10 x 10 (x 10) grid. Neighbours are 1.01 edges apart, so the
/// difference of two cells does not depend on the grid's origin. All pairs count as touching, so a
/// detector reports all pairs that the contact mask compares.
#[derive(Clone, Copy)]
pub struct InCells<'a, const D: usize>(pub &'a [[u32; D]]);

impl<const D: usize> InCells<'_, D> {
    /// Returns the grid with cells 1 to 10 along every axis.
    pub fn grid(&self) -> Cells<D> {
        Cells::spanning([0.0; D], [9.1; D], self.reach(), Margin::Safe).unwrap()
    }
}

impl<const D: usize> Particles<f64, D> for InCells<'_, D> {
    fn len(&self) -> usize {
        self.0.len()
    }
    fn position(&self, i: u32) -> [f64; D] {
        self.0[i as usize].map(|cell| 1.01 * (f64::from(cell) - 1.0))
    }
    fn touch<P: Probe>(&self, _: u32, _: u32, probe: &mut P) -> bool {
        probe.count(Op::ContactTest);
        true
    }
    fn reach(&self) -> f64 {
        1.0
    }
    fn radius(&self, _: u32) -> f64 {
        0.5
    }
    fn uniform(&self) -> Option<f64> {
        Some(0.5)
    }
    /// Returns unlimited slack, so that `touch` decides every pair.
    fn slack(&self) -> Slack {
        Slack { relative: 0.0, absolute: f64::INFINITY }
    }
}

/// Formats pairs like the book: numbers from 1, sorted. Pairs with a particle listed in `without`
/// are left out.
pub fn printed(pairs: &[[u32; 2]], without: &[u32]) -> String {
    let mut pairs: Vec<[u32; 2]> = pairs
        .iter()
        .map(|pair| pair.map(|k| k + 1))
        .filter(|pair| !pair.iter().any(|k| without.contains(k)))
        .collect();
    contactbench_ground::pairs::normalise::normalise(&mut pairs);
    pairs.iter().map(|[i, j]| format!("{i}-{j}")).collect::<Vec<_>>().join(" ")
}
