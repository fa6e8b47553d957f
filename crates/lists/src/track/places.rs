//! Stores particles such that neighbours in space are adjacent in memory.
//!
//! Positions are stored in f32, which halves the memory: a pass over a list of near pairs mostly
//! waits for memory. Lengths are in a unit u, the power of two with u <= diameter < 2u, from an
//! origin amid the particles. (Diameters below 2^-1000 or beyond 2^1000 get the unit of that bound,
//! so no diameter is more than 2^24 u.) Let x' be a stored coordinate, M the largest |x'| and v =
//! 2^-24.
//!
//! * x' is off by at most M(v + 4v²) + 2^-150, because of the difference in f64 and its rounding to
//!   f32. So a distance of two stored centres is off by at most √D · 2 · M · 1.01v < 2^-22 M, plus
//!   2^-148.
//! * The computed square of that distance is off by at most 6v relative, plus 2^-147 where squares
//!   underflow f32.
//!
//! So the result of the contact test for the distance d holds for the root of the computed square
//! with a larger [`Slack`]: by 2^-20 relative, by 2^-22 M + 2^-60 absolute in the unit u, and the
//! whole absolute part by a factor of 1 + 2^-20. The test decides pairs within this slack. Squares
//! that overflow are infinite; they belong to distances of at least 2^63 u, beyond any reach while
//! the absolute slack is below 2^60 u. If it is not, or if M is infinite, the test decides all
//! pairs. A particle far away therefore costs time: with M = 10^4 diameters the test decides all
//! pairs within 0.0024 diameters of touching.

use nalgebra::Point;

use contactbench_ground::contact::{Corners, Slack};
use contactbench_ground::filter::Near;
use contactbench_ground::scene::array;
use contactbench_ground::wide::Spot;
use contactbench_ground::wide::fill;

/// The unit and origin of stored positions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Unit<const D: usize> {
    origin: [f64; D],
    /// Units u per unit of length of the scene.
    scale: f64,
    /// Largest magnitude of a stored coordinate along each axis.
    most: [f32; D],
}

impl<const D: usize> Default for Unit<D> {
    fn default() -> Unit<D> {
        Unit { origin: [0.0; D], scale: 1.0, most: [0.0; D] }
    }
}

impl<const D: usize> Unit<D> {
    /// Creates the unit for particles of up to this diameter within these corners.
    pub fn new((low, high): Corners<D>, diameter: f64) -> Unit<D> {
        // Keeps the unit a normal double for any diameter.
        const FEWEST: u64 = 1023 - 1000;
        let exponent = (diameter.abs().to_bits() >> 52).clamp(FEWEST, 2 * 1023 - FEWEST);
        let origin = fill(|k| 0.5 * low[k] + 0.5 * high[k]);
        Unit { origin, scale: f64::from_bits((2 * 1023 - exponent) << 52), most: [0.0; D] }
    }

    /// Returns the same unit before any particle of a new frame is stored.
    pub fn begun(&self) -> Unit<D> {
        Unit { most: [0.0; D], ..*self }
    }

    #[inline(always)]
    pub fn put(&mut self, spot: &mut Spot, at: &Point<f64, D>) {
        for (k, &x) in array(at).iter().enumerate() {
            let x = ((x - self.origin[k]) * self.scale) as f32;
            self.most[k] = if x.abs() > self.most[k] { x.abs() } else { self.most[k] };
            spot.at[k] = x;
        }
    }

    /// Returns a function that computes the limits for computed squares from a sum of radii, under
    /// a contact test with this slack.
    pub fn near(&self, slack: Slack) -> impl Fn(f64) -> Near {
        const RELATIVE: f64 = 1.0 / (1u64 << 20) as f64;
        const ROUNDING: f64 = 1.0 / (1u64 << 22) as f64;
        const LARGEST: f64 = (1u64 << 60) as f64;
        let most = self.most.into_iter().fold(0.0, f32::max);
        let absolute = slack.absolute * self.scale + f64::from(most) * ROUNDING + 1.0 / LARGEST;
        let absolute = if absolute < LARGEST { absolute } else { f64::INFINITY };
        let (relative, absolute) = (slack.relative + RELATIVE, absolute * (1.0 + RELATIVE));
        let (scale, slack) = (self.scale, Slack { relative, absolute });
        move |sum| Near::new(sum * scale, slack)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contactbench_ground::contact::exact::{Label, label};

    /// Decides a pair from its stored copies and checks the decision. The other particles enlarge
    /// the box.
    fn verdict(points: [[f64; 2]; 2], radii: [f64; 2], others: &[[f64; 2]]) -> Option<bool> {
        let all = || points.iter().chain(others);
        let corner = |of: fn(f64, f64) -> f64| -> [f64; 2] {
            std::array::from_fn(|k| all().map(|p| p[k]).reduce(of).unwrap())
        };
        let mut unit =
            Unit::new((corner(f64::min), corner(f64::max)), 2.0 * radii[0].max(radii[1]));
        let mut spots = [Spot::default(); 8];
        for (spot, &at) in spots.iter_mut().zip(all()) {
            unit.put(spot, &Point::from(at));
        }
        let said = unit.near(Slack::NONE)(radii[0] + radii[1])
            .verdict(f64::from(spots[0].square(&spots[1])));
        let touch = label(&points[0], &points[1], radii[0], radii[1]) != Label::Apart;
        assert!(said.is_none_or(|said| said == touch), "{points:?} {radii:?} {others:?}: {said:?}");
        said
    }

    /// Every decision from copies is true: for pairs at all scales, with other particles near and
    /// far, and for sums of radii nearly or exactly equal to the distance.
    #[test]
    fn decisions_from_copies_are_true() {
        let mut state = 7u64;
        let mut draw = move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        let (mut decided, mut open) = (0, 0);
        for scale in [1.0, 3.7e-5, 1e-150, 1e-300, 5e-324, 2.5e200, 1e307] {
            for far in [0.0, 1.0, 1e3, 1e9, 1e18, 1e20, 1e25, 1e32, 1e38, 1e45] {
                for _ in 0..200 {
                    let mut point = || std::array::from_fn(|_| scale * draw());
                    let (points, [x, y]): ([[f64; 2]; 2], [f64; 2]) = ([point(), point()], point());
                    let off = |k: usize| points[0][k] - points[1][k];
                    let distance = off(0).hypot(off(1));
                    let near = [1e-16, 1e-8, 1e-7, 1e-6, 0.3][(draw().abs() * 5.0) as usize];
                    let sum = distance * (1.0 + draw() * near);
                    let other = [x * far, y * far].map(|x| x.clamp(-f64::MAX, f64::MAX));
                    match verdict(points, [0.75 * sum, 0.25 * sum], &[other]) {
                        Some(_) => decided += 1,
                        None => open += 1,
                    }
                }
            }
        }
        assert!(decided > 1000 && open > 3000, "{decided} {open}");
    }

    /// A distant particle makes the stored positions coarse, and its squared distance overflows.
    #[test]
    fn squares_that_overflow_decide_nothing() {
        let power = |k: i32| 2.0f64.powi(k);
        let far = -2.0 * (power(106) + 3.0 * power(82) - power(54));
        let points = [[power(53) - 1.0, 0.0], [power(53), 0.0]];
        assert_eq!(verdict(points, [0.5, 0.5], &[[far, 0.0]]), None);
        // Two particles far apart, with no other particle.
        assert_eq!(verdict([[0.0, 0.0], [power(70), 0.0]], [0.5, 0.5], &[]), Some(false));
    }
}
