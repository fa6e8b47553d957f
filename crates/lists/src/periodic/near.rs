//! Which images are near enough to touch, and how accurate their positions are.
//!
//! The symbols are those of [`super::images`] and, for (1), ga, c and off, of `frame.rs`.
//!
//! **Which images.** Let y be the computed positions of owners, fl(ga·y) their fractions
//! (`frame.rs`), from lowa to higha along vector a, and E a bound for |y - p| over all owners. If
//! the image of j by T is within R of owner i, then by (1) of that file Ta differs from ga·(pi -
//! pj) by at most |ga| R + 2c off(a). ga·pi differs from fl(ga·yi) by at most |ga| E + 4u m, where
//! m bounds the sum of |ga| |y| over coordinates; likewise for j. So
//!
//! ```text
//! lowa - fj - M <= Ta <= higha - fj + M,    M = |ga| (R + 2E) + 8u m + 2c off(a),
//! ```
//!
//! and the roundings of the two sums, (lowa - M) - fj and (higha + M) - fj, are at most 3u (4m +
//! M): the code uses 64u m for both terms in m, and M(1 + 2^-40). A positive T has some Ta of at
//! least 1, so fj is at most higha + M - 1 for this a. In upright boxes this is the last nonzero
//! Ta, to which other vectors add nothing. One pass over the scene finds its corners and fractions.
//! It lists the particles whose images must be examined, for which it guesses this bound. If the
//! guess was too low, there is a second pass.
//!
//! **Reach.** In exact arithmetic R = rj + rmax. A rounded arithmetic of unit v accepts pairs up to
//! its own reach ([`Slack::reach`]), and storing moves coordinates and radii by v, relatively. An
//! owner, at most Y from the origin, moves by less than 2vY, an image at distance d from it by less
//! than 2v(Y + d). So d <= reach + 4vY + 2vd + ..., and R = (reach + 16v Y)(1 + 16v) is enough,
//! with the sum of the largest coordinates for Y. Pairs beyond R are not accepted, so results do
//! not depend on which images are made.
//!
//! **Rounded positions.** Detectors use rounded positions in exact arithmetic: every particle and
//! image is within E of its true position, with E now for the largest T. Distances of rounded and
//! true positions differ by at most 2E. So pairs at most s - 2E apart touch, and pairs more than
//! s + 2E apart do not, where s is the sum of the radii: a [`Slack`] of 2E. The code uses 2E(1 +
//! 1/16), and a relative part of 8u for the roundings of code that uses the slack: at most four of
//! them, in s and in the bound itself (`half` in the copies of detectors has three,
//! [`Near`](contactbench_ground::filter::Near) four). Pairs between the two bounds are decided from
//! the given numbers. For points, whose reach would be too small for a grid, the slack is about the
//! distance between neighbours. If no image exists, the slack is none.

use super::frame::{MOST, ReducedBox, U, floor, off_by};
use super::survey::{GROW, Survey};
use contactbench_ground::contact::{Arithmetic, Corners, Slack};
use contactbench_ground::filter::cells::spacing;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::scene::{Real, Scene, Storage};
use contactbench_ground::wide::fill;

/// The lowest and the highest number of T along each vector.
type Ranges = [[i32; 2]; 3];

/// Returns the range of Ta between limits, if other vectors add `shift` to Ta.
#[inline(always)]
fn range([low, high]: [f64; 2], shift: f64) -> [i32; 2] {
    [-floor(shift - low), floor(high - shift)]
}

/// Counts the T in these ranges whose first nonzero number is positive; exact below 2^53.
fn half([x, y, z]: Ranges) -> f64 {
    // A length is at most 2^30, so that the product of two fits.
    let length = |[low, high]: [i32; 2]| i64::from((high - low + 1).max(0));
    let positive = |[low, high]: [i32; 2]| length([low.max(1), high]);
    let zero = |[low, high]: [i32; 2]| i64::from(low <= 0 && high >= 0);
    let behind = zero(x) * (positive(y) * length(z) + zero(y) * positive(z));
    (positive(x) * length(y)) as f64 * length(z) as f64 + behind as f64
}

/// Distance within which the contact test of an arithmetic may accept pairs.
#[derive(Clone, Copy, Debug)]
pub struct Reach {
    unit: f64,
    slack: Slack,
    largest_radius: f64,
}

impl Reach {
    pub fn new<const D: usize>(given: &Scene<'_, f64, D>, arithmetic: Arithmetic) -> Reach {
        let largest_radius = given.largest_radius();
        let (unit, slack) = match arithmetic.storage() {
            Storage::F64 => (f64::UNIT, Slack::rounded::<f64>()),
            Storage::F32 => (f32::UNIT, Slack::rounded::<f32>()),
        };
        Reach { unit, slack, largest_radius }
    }

    /// Returns the reach R for a particle of this radius, if storing moves particles by `storing`.
    fn of(&self, radius: f64, storing: f64) -> f64 {
        (self.slack.reach(radius, self.largest_radius) + storing) * (1.0 + 16.0 * self.unit)
    }

    /// Guesses, for each vector, the fraction below which particles may have images, in a scene
    /// that begins at the corner of its box. The guess is rather too high, because each extra
    /// particle costs little.
    pub fn guess<const D: usize>(&self, frame: &ReducedBox<D>) -> [f64; 3] {
        let boxes = self.boxes(frame);
        fill(|a| {
            let below = frame.corner(a) + 1.125 * boxes[a];
            if frame.periodic[a] { below } else { f64::NEG_INFINITY }
        })
    }

    /// Returns the reach of the largest particle in distances of the faces of the box.
    pub fn boxes<const D: usize>(&self, frame: &ReducedBox<D>) -> [f64; 3] {
        frame.lengths.map(|length| length * self.of(self.largest_radius, 0.0))
    }
}

/// Determines which images are near enough to some owner to touch it.
pub struct Near<'a, const D: usize> {
    pub frame: &'a ReducedBox<D>,
    /// Corners and extreme fractions of owners.
    pub found: Survey<D>,
    /// The margin M without its part |ga| R.
    more: [f64; 3],
    reach: Reach,
    storing: f64,
    pub largest_reach: f64,
    /// Upper bound for the numbers of all T.
    pub most: f64,
    /// For each vector: only particles with a fraction of at most one of these may have images.
    pub below: [f64; 3],
    /// Bound E for the error of all positions of particles and images.
    off: f64,
}

impl<'a, const D: usize> Near<'a, D> {
    /// Creates the bounds for owners that were moved by at most `wraps` vectors from coordinates of
    /// at most `x_most` in magnitude. Fails with [`Refusal::Range`] if positions of images
    /// overflow, and [`Refusal::Skewed`] if images cannot be numbered in the given vectors.
    pub fn new(
        frame: &'a ReducedBox<D>,
        found: Survey<D>,
        x_most: [f64; D],
        wraps: [u32; 3],
        reach: Reach,
    ) -> Result<Near<'a, D>, Refusal> {
        let (low, high, y_most) = (found.low, found.high, found.most());
        // Returns the error bound E for images shifted by up to this number along each vector.
        let off = |shift: f64| -> f64 {
            let given = frame.most_given([shift; 3]);
            let along = |k: usize| {
                let shifted: f64 = (0..3).map(|a| shift * frame.own[a][k].abs()).sum();
                let terms = |a: usize| (f64::from(wraps[a]) + given[a]) * frame.vectors[a][k].abs();
                off_by(y_most[k] + shifted, x_most[k] + (0..3).map(terms).sum::<f64>())
            };
            (0..D).map(along).sum()
        };
        let storing = 16.0 * reach.unit * y_most.iter().sum::<f64>();
        let largest_reach = reach.of(reach.largest_radius, storing);
        let owners_off = off(0.0);
        let mut more: [f64; 3] =
            fill(|a| 2.0 * frame.lengths[a] * owners_off + 64.0 * U * frame.most(a, &y_most));
        let spread = fill(|a| high[a] - low[a] + more[a]);
        let (coupling, most) = frame.coupling(spread, largest_reach);
        (0..3).for_each(|a| more[a] += coupling[a]);
        let off = off(most.min(MOST));
        // The condition is also true if a number is NaN.
        if !(off < f64::INFINITY && most.is_finite()) {
            return Err(Refusal::Range);
        }
        let given = frame.most_given([most.min(MOST); 3]);
        if let Some(vector) = (0..3).find(|&a| most < MOST && given[a] >= MOST) {
            return Err(Refusal::Skewed { vector });
        }
        let below = fill(|a| {
            if !frame.periodic[a] {
                return f64::NEG_INFINITY;
            }
            let margin = (frame.lengths[a] * largest_reach + more[a]) * GROW;
            let rounded = (GROW - 1.0) * (low[a].abs() + high[a].abs() + margin + 1.0);
            high[a] + margin - 1.0 + rounded
        });
        Ok(Near { frame, found, more, reach, storing, largest_reach, most, below, off })
    }

    /// Estimates how many images this many particles have, for an error message.
    pub fn about(&self, particles: usize) -> f64 {
        let along = |a: usize| {
            let boxes = self.found.high[a] - self.found.low[a];
            1.0 + boxes + 2.0 * (self.frame.lengths[a] * self.largest_reach + self.more[a])
        };
        0.5 * particles as f64 * (0..3).map(along).product::<f64>()
    }

    /// Returns the limits of T plus the fraction of an owner of this radius, for each vector.
    pub fn sums(&self, radius: f64) -> [[f64; 2]; 3] {
        let reach = self.reach.of(radius, self.storing);
        fill(|a| {
            if !self.frame.periodic[a] {
                return [0.0; 2];
            }
            let margin = (self.frame.lengths[a] * reach + self.more[a]) * GROW;
            [self.found.low[a] - margin, self.found.high[a] + margin]
        })
    }

    /// Returns the limits of T for an owner at this position, before rounding to integers.
    #[inline(always)]
    fn limits(&self, place: &[f64; D], sums: &[[f64; 2]; 3]) -> [[f64; 2]; 3] {
        fill(|a| {
            let fraction = self.frame.fraction(a, place);
            sums[a].map(|sum| sum - fraction)
        })
    }

    /// Returns whether images must be counted before they are made, because a particle may have
    /// hundreds. In an upright box it has few.
    pub fn are_many(&self) -> bool {
        !self.frame.is_upright() && self.reaches_far()
    }

    /// Returns whether the reach of the largest particle exceeds two boxes along a vector.
    pub fn reaches_far(&self) -> bool {
        let reach = |a: usize| self.frame.lengths[a] * self.largest_reach + self.more[a];
        (0..3).any(|a| reach(a) > 2.0)
    }

    /// Returns a lower bound for the number of images of an owner at this position. Shear moves the
    /// ranges of later vectors, but does not change their lengths.
    pub fn fewest(&self, place: &[f64; D], sums: &[[f64; 2]; 3]) -> f64 {
        let limits = self.limits(place, sums);
        let mut axes = self.frame.order.into_iter().filter(|&a| self.frame.periodic[a]);
        let Some(first) = axes.next() else { return 0.0 };
        let length = |a: usize| (limits[a][1] - limits[a][0]).floor().max(0.0);
        axes.fold(limits[first][1].floor().max(0.0), |images, a| images * length(a))
    }

    /// Returns the number of images of an owner at this position, if the box is not upright.
    pub fn count(&self, place: &[f64; D], sums: &[[f64; 2]; 3]) -> f64 {
        half(self.limits(place, sums).map(|limits| range(limits, 0.0)))
    }

    /// Calls `call` with each positive T for an owner at this position.
    #[inline(always)]
    pub fn for_images(
        &self,
        place: &[f64; D],
        sums: &[[f64; 2]; 3],
        mut call: impl FnMut([i32; 3]),
    ) {
        let (limits, shear) = (self.limits(place, sums), &self.frame.shear);
        let [p, q, r] = self.frame.order;
        let [low, high] = range(limits[p], 0.0);
        for a in low.max(0)..=high {
            let by_a = |v: usize| f64::from(a) * shear[p][v];
            let [low, high] = range(limits[q], by_a(q));
            for b in (if a > 0 { low } else { low.max(0) })..=high {
                let [low, high] = range(limits[r], by_a(r) + f64::from(b) * shear[q][r]);
                for c in (if a > 0 || b > 0 { low } else { low.max(1) })..=high {
                    let mut image = [0; 3];
                    (image[p], image[q], image[r]) = (a, b, c);
                    call(image);
                }
            }
        }
    }

    /// Returns the slack of the exact test for all particles and images, whose positions lie
    /// between these corners.
    pub fn slack(&self, corners: Option<Corners<D>>, particles: usize) -> Slack {
        let mut absolute = 2.125 * self.off;
        if let (Some((low, high)), true) =
            (corners, 2.0 * self.reach.largest_radius <= f64::UNDERFLOW)
        {
            absolute = absolute.max(spacing(low, high, particles));
        }
        Slack { relative: 8.0 * U, absolute }
    }
}
