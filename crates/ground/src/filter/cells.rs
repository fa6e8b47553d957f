//! Cells: integerised coordinates, such that touching particles are never two cells apart.
//!
//! The book uses cells of edge d (the largest diameter) and i = Int((x - xmin) / d). In real
//! numbers two particles that touch are then at most one cell apart per axis. After rounding they
//! can be two cells apart, and a textbook filter loses the contact. Example: three discs of radius
//! 1/2 at x = 0, 1 - 2^-53 and 2.
//!
//! **The margin.** The code computes q(x) = fl(fl(x - xmin) · s) and i = 1 + floor(q), with s =
//! fl((1 - 2^-18) / reach). Let u = 2^-53, and Q the largest q; scenes with Q >= 2^31 are refused.
//! Two particles with |xj - xi| <= reach (true values) have true quotients that differ by at most
//! reach · s <= (1 - 2^-18)(1 + 2u). Each computed quotient differs from its true one by at most
//! Q(2u + u²) < 2^-21 · (1 + u). (An underflowing product adds less than 2^-1074. If the reach is
//! so large that s is subnormal, s has fewer bits, but then Q < 8.) So the computed quotients
//! differ by less than 1 - 2^-18 + 2^-19.9 < 1, and floor(b) <= floor(a) + 1 whenever a <= b <= a +
//! 1. The wider cells, by 4 parts in a million, have no measurable cost.
//!
//! Cells of f32 scenes are computed in f64, too: the conversion is exact, so the proof holds.
//!
//! **Without the margin.** [`Margin::Textbook`] selects the book's cells, i = 1 + Int((x - xmin) /
//! d), with a division instead of a product. It shows which contacts are lost without the margin.
//!
//! **Borders.** Cell numbers start at 1 (one of the book's two conventions). Each axis has one
//! empty cell at either end, so that code that reads the neighbours of a cell needs no bounds
//! checks. `count` includes both: "nx" in every memory formula is the number of other cells plus 2.

use super::bounds;
use crate::contact::{Margin, Particles};
use crate::limits::refusal::Refusal;
use crate::probe::{Op, Probe};
use crate::scene::Real;

/// Limit for cell numbers along each axis: scenes that need 2^31 or more cells are refused.
pub const MOST_CELLS: f64 = (1u64 << 31) as f64;

/// The grid of a scene: its origin, the width of its cells and their number along each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cells<const D: usize> {
    origin: [f64; D],
    scale: f64,
    /// Edge of a cell if the grid is the textbook's, without the margin.
    textbook: Option<f64>,
    /// Number of cells along each axis, including two border cells.
    pub count: [u32; D],
}

impl<const D: usize> Cells<D> {
    /// Creates the grid with the smallest cells for `particles`: the edge is the reach of the
    /// contact test plus the margin.
    pub fn new<T: Real, B: Particles<T, D>>(particles: &B) -> Result<Cells<D>, Refusal> {
        let (low, high) = bounds(particles);
        Cells::spanning(low, high, cell_reach(particles, low, high), particles.margin())
    }

    /// Creates the grid of a size class with radii of at most `largest`, between two corners. The
    /// edge is the reach of two particles of that radius, or `least` if that is more. If there were
    /// too many such cells, they are wider, up to the reach of all particles.
    pub fn of_class<T: Real, B: Particles<T, D>>(
        particles: &B,
        (low, high): ([f64; D], [f64; D]),
        largest: f64,
        least: f64,
    ) -> Result<Cells<D>, Refusal> {
        let numbered = (extent(low, high) / (0.5 * MOST_CELLS)).min(particles.reach());
        let reach = particles.class_reach(largest, largest).max(least).max(numbered);
        Cells::spanning(low, high, reach, particles.margin())
    }

    /// Creates the grid between two corners for a given reach (see [`Particles::reach`]).
    pub fn spanning(
        low: [f64; D],
        high: [f64; D],
        reach: f64,
        margin: Margin,
    ) -> Result<Cells<D>, Refusal> {
        // The reach is infinite if a diameter overflows; there are then at most two cells.
        let reach = reach.clamp(f64::MIN_POSITIVE * 4.0, f64::MAX);
        let scale = (1.0 - 1.0 / (1u64 << 18) as f64) / reach;
        let mut cells = Cells {
            origin: low,
            scale,
            textbook: (margin == Margin::Textbook).then_some(reach),
            count: [0; D],
        };
        for k in 0..D {
            let axis = ["x", "y", "z"][k.min(2)];
            if !(high[k] - low[k]).is_finite() {
                return Err(Refusal::Extent { axis, low: low[k], high: high[k] });
            }
            let quotient = cells.quotient(high[k], k);
            if quotient >= MOST_CELLS - 4.0 {
                let edge = cells.textbook.unwrap_or(1.0 / scale);
                return Err(Refusal::Domain {
                    axis,
                    low: low[k],
                    high: high[k],
                    edge,
                    cells: quotient,
                });
            }
            cells.count[k] = quotient as u32 + 3;
        }
        Ok(cells)
    }

    /// Returns the number of the cell that contains `x` along axis `k`, from 1 to `count[k] - 2`.
    #[inline(always)]
    pub fn index<P: Probe>(&self, x: f64, k: usize, probe: &mut P) -> u32 {
        probe.count(Op::Integerise);
        // The quotient is in 0..2^31 for every particle of the scene, so truncating rounds down.
        self.quotient(x, k) as i64 as u32 + 1
    }

    /// Returns the index of a point's cell in an array of all cells, in which x varies fastest.
    #[inline(always)]
    pub fn place<P: Probe>(&self, position: [f64; D], probe: &mut P) -> usize {
        (0..D).rev().fold(0, |place, axis| {
            place * self.count[axis] as usize + self.index(position[axis], axis, probe) as usize
        })
    }

    /// Returns the cell numbers along x and y of an index in an array of all cells.
    pub fn of_place(&self, place: usize) -> [u32; 2] {
        let [nx, ny] = [self.count[0] as usize, self.count.get(1).map_or(1, |&ny| ny as usize)];
        [(place % nx) as u32, (place / nx % ny) as u32]
    }

    /// Returns the lower corner of the cell with number 1 along every axis.
    pub fn origin(&self) -> [f64; D] {
        self.origin
    }

    /// Returns the edge of a cell, rounded.
    pub fn edge(&self) -> f64 {
        self.textbook.unwrap_or(1.0 / self.scale)
    }

    #[inline(always)]
    fn quotient(&self, x: f64, k: usize) -> f64 {
        match self.textbook {
            None => (x - self.origin[k]) * self.scale,
            Some(edge) => divided(x - self.origin[k], edge),
        }
    }

    /// Returns the number of all cells: the product over the axes, at most 2^64 - 1.
    pub fn volume(&self) -> u64 {
        self.count.iter().fold(1, |product, &n| product.saturating_mul(u64::from(n)))
    }
}

/// Returns the least width that cells for `particles` must have: the reach of the contact test. If
/// all radii are 0, particles touch only if they coincide (or squares underflow); then cells are
/// larger, about one particle each.
pub fn cell_reach<T: Real, const D: usize>(
    particles: &impl Particles<T, D>,
    low: [f64; D],
    high: [f64; D],
) -> f64 {
    let points = spacing(low, high, particles.len());
    if particles.reach() <= particles.underflow() {
        particles.reach().max(points)
    } else {
        particles.reach()
    }
}

/// Divides out of line, so that the compiler does not also divide for other arithmetics.
#[cold]
#[inline(never)]
fn divided(distance: f64, edge: f64) -> f64 {
    distance / edge
}

/// Returns the spacing of `count` points that evenly fill a cube around the corners.
pub fn spacing<const D: usize>(low: [f64; D], high: [f64; D], count: usize) -> f64 {
    extent(low, high) / libm::pow(count.max(1) as f64, 1.0 / D as f64)
}

fn extent<const D: usize>(low: [f64; D], high: [f64; D]) -> f64 {
    (0..D).map(|k| high[k] - low[k]).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::contact::exact;
    use crate::probe::Silent;

    fn index(x: f64, low: f64, high: f64, reach: f64) -> i64 {
        i64::from(Cells::spanning([low, 0.0], [high, 0.0], reach, Margin::Safe).unwrap().index(
            x,
            0,
            &mut Silent,
        ))
    }

    #[test]
    fn pairs_exactly_one_reach_apart_are_at_most_one_cell_apart() {
        // Each of three sweeps of distances makes a textbook grid lose up to 10% of the pairs.
        let mut lost_by_the_book = 0;
        for (low, d) in [
            (0.0, 1.0),
            (-1.0, 1.0),
            (-1e6, 0.1),
            (-1e6, 1.0),
            (1e15, 0.5),
            (-3.7e-9, 1e-12),
            (0.3, 0.7),
        ] {
            for border in 1..4000 {
                let at = low + d * border as f64;
                for x in [at.next_down().next_down(), at.next_down(), at, at.next_up()] {
                    // Largest y with a true distance from x of at most d.
                    let mut y = (x + d).next_up();
                    while exact::compare(&[x, 0.0], &[y, 0.0], d / 2.0, d / 2.0).is_gt() {
                        y = y.next_down();
                    }
                    let (i, j) = (
                        index(x.max(low), low, low + d * 5000.0, d),
                        index(y.max(low), low, low + d * 5000.0, d),
                    );
                    assert!((j - i).abs() <= 1, "{x} {y} {low} {d}: {i} {j}");
                    let book = |x: f64| ((x - low) / d).floor();
                    lost_by_the_book += i64::from(book(y) - book(x) > 1.0);
                }
            }
        }
        assert!(lost_by_the_book > 0, "this test must hold cases that a textbook grid loses");
    }

    /// Tests pairs exactly at reach, the left particle near the right border of its cell, in cells
    /// so far from the origin that quotients have few bits left. A margin of 2^-22 instead of 2^-18
    /// loses about one in a thousand of these pairs.
    #[test]
    fn the_largest_addressable_domain_keeps_its_margin() {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        for _ in 0..20_000 {
            let reach = [0.3, 0.7, 1.0, 1.1][random.random_range(0..4)];
            let low = -6e8 * random.random::<f64>();
            let cells = Cells::spanning(
                [low, 0.0],
                [low + reach * (MOST_CELLS - 16.0), 0.0],
                reach,
                Margin::Safe,
            )
            .unwrap();
            let at = |x: f64| i64::from(cells.index(x, 0, &mut Silent));
            let k = random.random_range(1 << 30..(1i64 << 31) - 32);
            let mut x = low + k as f64 / cells.scale;
            while at(x) > k {
                x = x.next_down();
            }
            while at(x.next_up()) <= k {
                x = x.next_up();
            }
            let mut y = (x + reach).next_up();
            while exact::compare(&[x, 0.0], &[y, 0.0], reach / 2.0, reach / 2.0).is_gt() {
                y = y.next_down();
            }
            assert!(
                at(y) - at(x) <= 1,
                "{x} {y} from {low}, reach {reach}: cells {} and {}",
                at(x),
                at(y)
            );
        }
        assert!(matches!(
            Cells::<2>::spanning([0.0; 2], [4e9, 0.0], 1.0, Margin::Safe),
            Err(Refusal::Domain { axis: "x", .. })
        ));
        assert!(Cells::<2>::spanning([-f64::MAX; 2], [f64::MAX; 2], 1.0, Margin::Safe).is_err());
        assert!(
            Cells::<2>::spanning([-f64::MAX; 2], [f64::MAX; 2], f64::INFINITY, Margin::Safe)
                .is_err()
        );
    }
}
