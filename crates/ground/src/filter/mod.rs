//! Safe filters: how much a cell, a box, a key or a sweep must be widened to lose no pair that the
//! contact test accepts.
//!
//! A detector filters: it tests only pairs that are near each other by some cheap measure. The
//! measure is computed in floating point and the contact test may be exact, so a filter that is
//! correct for real numbers loses pairs to rounding: up to 10% of the pairs that are exactly a
//! diameter apart. This page derives once, for all detectors, what is safe. It assumes only IEEE
//! 754 arithmetic in f64, rounding to nearest, and finite coordinates and radii, as every
//! [`crate::scene::Scene`] has them. u = 2^-53; fl(..) is the result computed in f64. Positions are
//! doubles without error, for every storage ([`crate::scene::Real::wide`]).
//!
//! **1. Reach.** If |xi - xj| is more than the reach along any axis, the pair does not touch.
//! [`crate::contact::slack`] derives the reach and the [`Slack`] of the test, and also the reach of
//! two size classes, which limits the search around small particles
//! ([`crate::contact::Particles::class_reach`]).
//!
//! **2. Comparisons need no widening.** Rounding is monotone: a <= b implies fl(a) <= fl(b), and
//! fl(R) = R since R is a double. So for a pair with xj - xi <= R (true values):
//!
//! * *sweep*: fl(xj - xi) <= R. It is safe to stop at the first fl(xj - xi) > R: [`beyond`].
//! * *boxes*: with Ri + Rj >= the pair's reach, xj - Rj <= xi + Ri, hence fl(xj - Rj) <= fl(xi +
//!   Ri). So if two boxes from fl(x - R) to fl(x + R) do not overlap, the pair does not touch:
//!   [`interval`]. Minima and maxima of bounds are exact, so this holds for boxes around boxes. An
//!   overflowing bound is infinite and compares correctly.
//!
//! **3. Cells need a margin,** since floor is not a comparison: quotients that differ by at most 1
//! in real numbers may differ by more when computed, and the cell numbers by 2. [`cells`] widens
//! cells by 4 parts in a million, proves that this suffices below 2^31 cells per axis, and refuses
//! more cells.
//!
//! **4. Keys.** A key made of cell numbers is as safe as cells (3) if it is injective: two numbers
//! below 2^31 fit a u64, three do not. A detector that packs three must refuse 2^21 cells per axis
//! or use 128 bits. A detector that hashes must compare the cells themselves on a collision. Keys
//! are not made from an f32.
//!
//! **5. Squared distances** that prune (a point against a box): the computed square of a distance
//! in up to three dimensions is at most (1 + 6u) times the true one plus 2^-1073. So a pair can be
//! pruned safely if its computed square exceeds R²(1 + 16u) + 2^-960. The argument is that of the
//! exact test's own filter ([`crate::contact`]). In the other direction, the true square is at most
//! (1 + 8u) times the computed one plus 2^-1072: five factors of at least 1 - u, and three products
//! that may underflow.
//!
//! **6. Copies.** A detector that copies centres, so that neighbours are adjacent in memory, may
//! decide clear cases from the copies and leave the other pairs to `touch`: [`Near`], by 1 and 5.
//! So its pairs are those that `touch` accepts, in every arithmetic.
//!
//! **7. Lists kept while particles move** (`contactbench_lists::track`). The contact test accepts
//! no pair farther apart than ri + rj + e, where e = 2·rmax·relative + absolute follows from its
//! [`Slack`] and is 0 for the exact test. A list with a skin s = 2h holds the pairs that touch, by
//! the exact test, with each radius enlarged to ri + h + e/2, rounded up. So a pair that is not
//! listed was farther apart than ri + rj + s + e when the list was built. It is farther apart than
//! ri + rj + s + e - di - dj after its centres have moved by di and dj on any path. Hence: **while
//! di + dj <= s for every pair, the listed pairs that the test accepts are all that it accepts.**
//! This also holds right after the list is built, even for skin 0. A rule is safe if it discards
//! the list before the inequality fails:
//!
//! * *top two*: di + dj is at most the sum of the two largest displacements;
//! * *half skin*: that sum is at most twice the largest displacement;
//! * *summed*: a displacement is at most the sum of the displacements in each frame, and that is at
//!   most the sum of the largest in each frame.
//!
//! So each rule discards the list no earlier than the one below it; bounds are clamped so that this
//! holds for computed values, too. s is a double since doubling is exact. If s or the enlarged
//! particles overflow, the list is refused. The slack covers the roundings of e, as it does those
//! of the reach. A computed square of a displacement becomes a bound by 5, and sums of bounds are
//! rounded up; an infinite bound exceeds any skin. Positions are known without error in every
//! storage (1), so nothing else depends on the arithmetic. The inequality concerns numbers as
//! stored.
//!
//! **8. Lists kept in a periodic box** whose vectors H stay (`contactbench_lists::track`; exact
//! tests). A list has all triples (i, j, S) whose particles, i and the image of j by S·H, were at
//! most ri + rj + s + E apart when it was built; then particles were at y. In a frame, let z = x +
//! W·H be the position of a particle for any integers W: triples of z are those of x with another
//! S. Let d be the displacement of z from y. For every S
//!
//! ```text
//! zi - zj - S·H  =  (yi - yj - S·H)  +  (zi - yi)  -  (zj - yj)
//! ```
//!
//! so a triple that is not listed is farther apart than ri + rj + s + E - di - dj. This exceeds
//! ri + rj while di + dj <= s + E. So the rules of 7 hold, as long as no two displacements together
//! are computed too short by more than E. If a vector changes, the list is rebuilt. The sum of the
//! displacements in each frame concerns z of the same W; *summed* still holds for others, since it
//! is clamped at the largest displacement from y.

pub mod bounds;
pub mod cells;
mod sieve;

pub use bounds::{axes_by_length, bounds, bounds_by};
pub use cells::Cells;
pub use sieve::Sieve;

use crate::contact::Slack;

/// Limits that decide contacts from computed squares of distances, if clear enough: section 6.
#[derive(Clone, Copy, Debug)]
pub struct Near {
    /// Pairs touch if the computed square of their distance is at most this.
    pub inner: f64,
    /// Pairs do not touch if the computed square of their distance exceeds this.
    pub outer: f64,
}

impl Near {
    /// Computes the limits for a sum of two radii, itself computed in f64.
    #[inline(always)]
    pub fn new(sum: f64, slack: Slack) -> Near {
        // The band of 16u covers the rounding of the sum, too: squares of sums and distances
        // together take less than 6u + 4u.
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

    /// Returns the decision for a computed square of a distance, Σ fl(fl(xi - xj)²), or `None` if
    /// the square is between the limits.
    #[inline(always)]
    pub fn verdict(&self, square: f64) -> Option<bool> {
        if square > self.outer {
            return Some(false);
        }
        (square <= self.inner).then_some(true)
    }
}

/// Returns whether `low` <= `high` are too far apart for a pair with this reach (section 2).
#[inline(always)]
pub fn beyond(low: f64, high: f64, reach: f64) -> bool {
    high - low > reach
}

/// Returns the bounds of a particle at `x` along one axis, where `half` is half of a pair's reach.
/// Pairs whose intervals do not overlap do not touch (section 2).
#[inline(always)]
pub fn interval(x: f64, half: f64) -> [f64; 2] {
    [x - half, x + half]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{Arithmetic, Particles, WithParticles, exact, with_stored};
    use crate::limits::refusal::Refusal;
    use crate::probe::Silent;
    use crate::scene::{AnyScene, Real};

    struct Agree(usize);
    impl<T: Real, const D: usize> WithParticles<T, D> for &mut Agree {
        type Output = Result<(), Refusal>;
        fn call<B: Particles<T, D>>(self, particles: B) -> Self::Output {
            for j in 1..particles.len() as u32 {
                let (a, b) = (particles.position(0), particles.position(j));
                let square = (0..D).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum();
                if let Some(verdict) =
                    Near::new(particles.radius(0) + particles.radius(j), particles.slack())
                        .verdict(square)
                {
                    assert_eq!(verdict, particles.touch(0, j, &mut Silent), "{a:?} {b:?}");
                    self.0 += 1;
                }
            }
            Ok(())
        }
    }

    /// The contact test confirms every decision from a copy: around tangency, and at scales where
    /// squares vanish or overflow.
    #[test]
    fn decisions_from_copies_agree_with_the_test() {
        for arithmetic in Arithmetic::ALL {
            let mut decided = Agree(0);
            for scale in [1.0, 1e-3, 3e-19, 1e-22, 1e-38, 1e18] {
                for (r, ulp) in [(0.37, 1e-16), (0.7, 1e-15), (0.2, 1e-8), (0.45, 4e-7)] {
                    let x = |k: i32| {
                        [(0.6 * (r + 0.5) + ulp * f64::from(k)) * scale, 0.8 * (r + 0.5) * scale]
                    };
                    let centres = [[0.0, 0.0]].into_iter().chain((-40..40).map(x));
                    let radii = [vec![r * scale], vec![0.5 * scale; 80]].concat();
                    let scene = AnyScene::at(centres, radii).unwrap();
                    let Ok(scene) = scene.stored(arithmetic) else { continue };
                    let AnyScene::Plane(scene) = scene else { panic!("made in the plane") };
                    let _ = with_stored(&scene, arithmetic.test(), &mut decided);
                }
            }
            assert!(decided.0 > 100, "{arithmetic:?}: {}", decided.0);
        }
    }

    /// Tests pairs exactly at reach and one unit in the last place around it, at offsets where
    /// every sum is rounded.
    #[test]
    fn comparisons_lose_no_touching_pair() {
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
