//! Safe filters: how much a cell, a box, a key or a sweep must be widened so that no pair is lost
//! that the contact test accepts.
//!
//! A detector filters: it looks only at pairs that are near each other by some cheap measure. The
//! measure is computed in floating point, the contact test may be exact, and a filter that is right
//! in real numbers loses pairs to rounding (BOOK section 7: up to 10% of the couples that are
//! exactly a diameter apart). This page derives, once for all detectors, what is safe. The only
//! assumptions are IEEE 754 arithmetic in f64, rounding to nearest, and finite coordinates and
//! radii, as every [`crate::scene::Scene`] has them. u = 2^-53; fl(..) is what f64 computes;
//! positions are doubles without error, for every storage ([`crate::scene::Real::wide`]).
//!
//! **1. Reach.** If |xi - xj| is more than the reach along any one axis, the pair does not touch.
//! The reach, and the [`Slack`] of the test, are derived in [`crate::contact::slack`]; there, too,
//! the reach of two classes of sizes, with which small bodies need not be searched as far as the
//! largest reach ([`crate::contact::Bodies::class_reach`]).
//!
//! **2. Comparisons need no widening.** Rounding is monotone: a <= b implies fl(a) <= fl(b), and
//! fl(R) = R since R is a double. So for a pair with xj - xi <= R (true values):
//!
//! * *sweep*: fl(xj - xi) <= R. To stop at the first fl(xj - xi) > R is safe: [`beyond`].
//! * *boxes*: with Ri + Rj >= the pair's reach, xj - Rj <= xi + Ri, hence fl(xj - Rj) <= fl(xi +
//!   Ri): boxes from fl(x - R) to fl(x + R) that do not overlap belong to pairs that do not touch:
//!   [`interval`]. Minima and maxima of bounds are exact, so this holds for boxes around boxes. An
//!   overflowing bound is infinite and compares as it should.
//!
//! **3. Cells need a margin,** since floor is not a comparison: quotients that differ by at most 1
//! in real numbers may differ by more when computed, and the cells by 2. [`cells`] makes them wider
//! by 4 parts in a million, proves that this suffices below 2^31 cells per axis, and refuses more,
//! with the numbers: there cells cannot be told apart.
//!
//! **4. Keys.** A key made of cell numbers inherits 3, if it is injective: two numbers below 2^31
//! fit a u64, three do not (a detector that packs three must refuse 2^21 cells per axis, or take
//! 128 bits), and a hash must compare the cells themselves where it collides. No key is ever made
//! of an f32.
//!
//! **5. Squared distances** that prune (a point against a box): the computed square of a distance
//! in up to three dimensions is at most (1 + 6u) times the true one plus 2^-1073, so to prune where
//! it exceeds R²(1 + 16u) + 2^-960 is safe, by the argument of the exact test's own filter
//! ([`crate::contact`]). The other way round, the true square is at most (1 + 8u) times the
//! computed one plus 2^-1072: five factors of at least 1 - u, and three products that may
//! underflow.
//!
//! **6. Copies.** A detector that keeps copies of centres near to one another in memory may decide
//! from them what is far from being decided either way, and leave to `touch` the rest: [`Near`], by
//! 1 and 5. So its pairs are those that `touch` accepts, in every arithmetic.
//!
//! **7. Lists kept while bodies move** ([`crate::track`]). The contact test accepts no pair that is
//! farther apart than ri + rj + e, where e = 2·rmax·relative + absolute is from its [`Slack`], 0
//! for the exact one. A list with a skin s = 2h holds the pairs that touch, by the exact test, when
//! each radius is rounded up from ri + h + e/2. So a pair that is not listed was farther apart than
//! ri + rj + s + e when the list was built, and is farther apart than ri + rj + s + e - di - dj
//! when its centres have since gone di and dj, on whatever way. Hence: **while di + dj <= s for
//! every pair, the listed pairs that the test accepts are all that it accepts,** at once when the
//! list is built, too, be the skin 0. A rule is safe if it gives the list up before that fails:
//!
//! * *top two*: di + dj is at most the sum of the two largest ways;
//! * *half skin*: and that at most twice the largest;
//! * *summed*: a way is at most the sum of the ways in each frame, and that at most the sum of the
//!   largest in each.
//!
//! So each gives it up no earlier than the one below; bounds are cut so that this holds as
//! computed. s is a double since doubling is exact, and where it or the larger bodies overflow the
//! list is refused; the slack covers the roundings of e, as it does those of the reach. A computed
//! square of a way becomes a bound by 5, sums of bounds are rounded up, and an infinite one is more
//! than any skin. Where particles are is known without error in every storage (1), so nothing else
//! depends on the arithmetic. The inequality is one of the numbers as stored, whatever they mean:
//! positions by cells may change their origin between frames.
//!
//! **8. Lists kept in a periodic box,** whose vectors H may change from frame to frame
//! ([`crate::track`]; exact tests). A list has all triples (i, j, S) whose bodies, i and the image
//! of j by S·H, were at most ri + rj + s + E apart when it was built, where H was H0 and particles
//! were at y. In a frame, let z = x + W·H be where a particle is, for any whole numbers W: triples
//! of z are those of x with other S. Let F be linear with F H0v = Hv for each vector, and d the way
//! to z from F y, that is from where the particle would be had it moved with the box (which may be
//! carried along: only differences count). For every S
//!
//! ```text
//! zi - zj - S·H  =  F (yi - yj - S·H0)  +  (zi - F yi)  -  (zj - F yj)
//! ```
//!
//! and with c such that |F v| >= c |v|, a triple that is not listed is farther apart than c (ri +
//! rj + s + E) - di - dj, hence than ri + rj while di + dj <= s + E - t, t = (1 - c) (2 rmax + s +
//! E). So the rules of 7 hold for s - t, while no two ways together are computed too short by more
//! than E. F is 1 + the sum over the vectors of (Hv - H0v) gv, with gv the duals of H0, and c the
//! root of 1 + 2a with a <= 0 no more than the least eigenvalue of the symmetric part of F - 1; how
//! far the computed duals are from such is measured by their products with H0. In a box that keeps
//! its vectors F = 1 and t = 0. A shear by γ takes about γ / 2 of a diameter from the skin, however
//! large the box is. (LAMMPS takes the ways of its corners, `neighbor.cpp`, and counts those of
//! particles with what the box does.) The sum of the ways in each frame is one of z, not from F y:
//! *summed* holds since it is cut at the largest way from F y, and it also counts what the box
//! carries.

pub mod bounds;
pub mod cells;

pub use bounds::{bounds, bounds_by};
pub use cells::Cells;

use crate::contact::Slack;

/// What the computed square of a distance says of a contact: 6.
#[derive(Clone, Copy, Debug)]
pub struct Near {
    /// Up to here the test accepts.
    pub inner: f64,
    /// Beyond, the test refuses.
    pub outer: f64,
}

impl Near {
    /// For particles whose radii have this sum (as computed in f64).
    #[inline(always)]
    pub fn new(sum: f64, slack: Slack) -> Near {
        // The sum's own rounding is in the 16u: squares of sums and distances together have less
        // than 6u + 4u.
        const BAND: f64 = 16.0 / (1u64 << 53) as f64;
        const FLOOR: f64 = f64::from_bits((1023 - 960) << 52);
        let (low, high) = (
            sum * (1.0 - slack.relative) - slack.absolute,
            sum * (1.0 + slack.relative) + slack.absolute,
        );
        let square = low * low;
        let inner =
            if low > 0.0 && square < f64::INFINITY { square * (1.0 - BAND) - FLOOR } else { -1.0 };
        Near { inner, outer: high * high * (1.0 + BAND) + FLOOR }
    }

    /// `Some` if a computed square of a distance, Σ fl(fl(xi - xj)²), decides.
    #[inline(always)]
    pub fn verdict(&self, square: f64) -> Option<bool> {
        if square > self.outer {
            return Some(false);
        }
        (square <= self.inner).then_some(true)
    }
}

/// True if coordinates `low` <= `high` are so far apart that no pair with this reach touches: 2.
#[inline(always)]
pub fn beyond(low: f64, high: f64, reach: f64) -> bool {
    high - low > reach
}

/// The bounds of a body at `x` with half a pair's reach `half`, along one axis: pairs whose
/// intervals do not overlap do not touch: 2.
#[inline(always)]
pub fn interval(x: f64, half: f64) -> [f64; 2] {
    [x - half, x + half]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{Arithmetic, Bodies, WithBodies, exact, with_stored};
    use crate::probe::Silent;
    use crate::refusal::Refusal;
    use crate::scene::{AnyScene, Radii, Real, Scene};

    struct Agree(usize);
    impl<T: Real, const D: usize> WithBodies<T, D> for &mut Agree {
        type Output = Result<(), Refusal>;
        fn call<B: Bodies<T, D>>(self, bodies: B) -> Self::Output {
            for j in 1..bodies.len() as u32 {
                let (a, b) = (bodies.position(0), bodies.position(j));
                let square = (0..D).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum();
                if let Some(verdict) =
                    Near::new(bodies.radius(0) + bodies.radius(j), bodies.slack()).verdict(square)
                {
                    assert_eq!(verdict, bodies.touch(0, j, &mut Silent), "{a:?} {b:?}");
                    self.0 += 1;
                }
            }
            Ok(())
        }
    }

    /// Around tangency, at scales where squares vanish and overflow: what a copy decides, the test
    /// decides alike.
    #[test]
    fn what_near_decides_the_test_decides_alike() {
        for arithmetic in Arithmetic::ALL {
            let mut decided = Agree(0);
            for scale in [1.0, 1e-3, 3e-19, 1e-22, 1e-38, 1e18] {
                for (r, ulp) in [(0.37, 1e-16), (0.7, 1e-15), (0.2, 1e-8), (0.45, 4e-7)] {
                    let x = |k: i32| {
                        [(0.6 * (r + 0.5) + ulp * f64::from(k)) * scale, 0.8 * (r + 0.5) * scale]
                    };
                    let centres: Vec<_> = [[0.0, 0.0]]
                        .into_iter()
                        .chain((-40..40).map(x))
                        .map(nalgebra::Point::from)
                        .collect();
                    let radii = std::iter::once(r * scale)
                        .chain((0..80).map(|_| 0.5 * scale))
                        .collect::<Vec<_>>();
                    let scene =
                        AnyScene::from(Scene::new(centres, Radii::Each(radii.into())).unwrap());
                    let Ok(scene) = scene.stored(arithmetic) else { continue };
                    let AnyScene::Plane(scene) = scene else { panic!("made in the plane") };
                    let _ = with_stored(&scene, arithmetic.test(), &mut decided);
                }
            }
            assert!(decided.0 > 100, "{arithmetic:?}: {}", decided.0);
        }
    }

    /// Couples exactly at reach, and one unit in the last place around it, at offsets where every
    /// sum is rounded.
    #[test]
    fn comparisons_lose_no_touching_couple() {
        let (mut touching, mut at_reach) = (0, 0);
        for offset in [0.0, -0.7, 1e3, -1e6 / 3.0, 1e15, 3e-9] {
            for k in 1..3000 {
                let (ri, rj) = (0.37 * f64::from(k), 0.1 + f64::from(k % 7) / 3.0);
                let xi = offset + 0.1 * f64::from(k);
                let mut xj = (xi + (ri + rj)).next_up().next_up();
                for _ in 0..5 {
                    if exact::compare(&[xi, 0.0], &[xj, 0.0], ri, rj).is_le() {
                        let (a, b) = (interval(xi, ri), interval(xj, rj));
                        assert!(b[0] <= a[1] && a[0] <= b[1], "boxes of {xi} {xj} {ri} {rj}");
                        // The reach of a scene with these two bodies.
                        let reach = 2.0 * ri.max(rj);
                        assert!(!beyond(xi, xj, reach), "{xi} {xj} {reach}");
                        touching += 1;
                        at_reach += i32::from(b[0] == a[1]);
                    }
                    xj = xj.next_down();
                }
            }
        }
        assert!(touching > 20_000 && at_reach > 1_000, "{touching} {at_reach}");
    }
}
