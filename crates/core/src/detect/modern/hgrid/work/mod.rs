//! A model of the work for a division into levels, and the levels for which it is least.
//!
//! The model is that of Krijgsman, Ogarko and Luding 2014 (doi:10.1007/s40571-014-0020-9; in
//! MercuryDPM `HGridOptimiser`): particles are uniform and independent in a box. Within its level a
//! particle is tested against half of the others in the 3^D cells around it. In a finer level with
//! cells of edge h, a particle of radius r visits (2r/h + 2)^D cells on average, and is tested
//! against their particles. The work is the number of tests plus K times that of lookups.
//!
//! Deviations: a lookup finds a strip of 8 cells, not one cell; a level is scanned completely if a
//! visit needs more lookups than half of its particles; cells of a sparse level are wider; and the
//! box is finite, which is modelled exactly along each axis and matters most if large particles are
//! few.
//!
//! The published optimum is for cells of any size and a given number of levels. This module covers
//! all partitions of the radii, in four steps per octave, and all numbers of levels. Larger
//! particles search each level separately, so the work in a level, visits included, depends only on
//! where the level begins and ends. So the best partition is found radius by radius.

use std::array::from_fn;

use super::STRIP;
use super::levels::MOST_LEVELS;
use crate::contact::Bodies;
use crate::filter::cells::spacing;
use crate::scene::Real;

/// K, the cost of a lookup in contact tests. A least-squares fit of relative errors to times and
/// counts of `hgrid` in results/reference-sizes (311 cells) gives 3.1 ns for a test, 39 ns for a
/// lookup and 88 ns for a particle. So K is 12.6 (11.9 in 2D, 15.3 in 3D). MercuryDPM, with lookups
/// of single cells and slower tests, uses 0.77.
pub const LOOK: f64 = 13.0;
/// Number of parts into which radii are divided: four per octave.
const RADII: usize = 128;

/// The particles of a level, or of a part of a level.
#[derive(Clone, Copy, Debug)]
pub struct Class<const D: usize> {
    pub low: [f64; D],
    pub high: [f64; D],
    pub largest: f64,
    pub bodies: usize,
    sum: f64,
}

/// Number of contact tests, and of lookups of strips in finer levels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work {
    pub tests: f64,
    pub looks: f64,
}

impl Work {
    pub fn all(self) -> f64 {
        self.tests + LOOK * self.looks
    }
}

impl<const D: usize> Class<D> {
    pub const NONE: Class<D> = Class {
        low: [f64::INFINITY; D],
        high: [f64::NEG_INFINITY; D],
        largest: 0.0,
        bodies: 0,
        sum: 0.0,
    };

    #[inline(always)]
    pub fn take(&mut self, position: [f64; D], radius: f64) {
        for (k, x) in position.into_iter().enumerate() {
            self.low[k] = self.low[k].min(x);
            self.high[k] = self.high[k].max(x);
        }
        self.largest = self.largest.max(radius);
        self.bodies += 1;
        self.sum += radius;
    }

    fn with(&self, other: &Class<D>) -> Class<D> {
        Class {
            low: from_fn(|k| self.low[k].min(other.low[k])),
            high: from_fn(|k| self.high[k].max(other.high[k])),
            largest: self.largest.max(other.largest),
            bodies: self.bodies + other.bodies,
            sum: self.sum + other.sum,
        }
    }

    fn edge(&self) -> f64 {
        let reach = 2.0 * self.largest;
        reach.max(spacing(self.low, self.high, self.bodies)).max(4.0 * f64::MIN_POSITIVE)
    }

    pub fn beside(&self) -> Work {
        let (n, edge) = (self.bodies as f64, self.edge());
        let near = (0..D).map(|k| Axis::new(self, k, edge).near()).product::<f64>();
        Work { tests: 0.5 * n * (n - 1.0) * near, looks: 0.0 }
    }

    /// Returns the work of searching this level for `bodies` particles of the coarser level
    /// `larger`, each with this radius.
    pub fn visits(&self, larger: &Class<D>, bodies: f64, radius: f64) -> Work {
        let (n, edge, reach) = (self.bodies as f64, self.edge(), radius + self.largest);
        let (mut within, mut tests, mut looks) = (1.0, n, 1.0);
        // The domain of random particles extends beyond their bounding box: by this fraction of the
        // box on each side, on average.
        let beyond = 1.0 / (larger.bodies as f64 - 1.0).max(1.0);
        for k in 0..D {
            let length = larger.high[k] - larger.low[k];
            let low = larger.low[k] - beyond * length - self.low[k];
            let length = length * (1.0 + 2.0 * beyond);
            let near = Near::new(Axis::new(self, k, edge), low, length, reach);
            let cells = near.steps(edge, 0.0);
            within *= near.within();
            tests *= near.covered(cells);
            looks *= if k == 0 { near.steps(edge * f64::from(STRIP), edge) } else { cells };
        }
        if looks > 0.5 * n * within {
            (tests, looks) = (n * within, 0.0);
        }
        Work { tests: bodies * tests, looks: bodies * looks }
    }
}

struct Axis {
    length: f64,
    edge: f64,
    /// Number of cells along the axis without the last one, which may extend beyond the box.
    full: f64,
}

impl Axis {
    fn new<const D: usize>(class: &Class<D>, k: usize, edge: f64) -> Axis {
        let length = class.high[k] - class.low[k];
        Axis { length, edge, full: (length / edge).floor() }
    }

    /// Returns the fraction of all pairs that are in the same cell or in neighbouring cells.
    fn near(&self) -> f64 {
        if self.full == 0.0 {
            return 1.0;
        }
        let cell = self.edge / self.length;
        let last = 1.0 - self.full * cell;
        (3.0 * self.full - 2.0) * cell * cell + 2.0 * cell * last + last * last
    }
}

/// Points spread evenly over a segment of an axis. [`Near::steps`] averages how many cells of the
/// axis are within their reach. Cells count from the beginning of the axis.
struct Near {
    axis: Axis,
    reach: f64,
    length: f64,
    /// Begin of the part of the segment from which at least one cell is within reach.
    from: f64,
    to: f64,
}

impl Near {
    /// Creates points on a segment of this length that begins at `low`; a segment shorter than a
    /// cell is extended to one cell.
    fn new(axis: Axis, low: f64, length: f64, reach: f64) -> Near {
        let more = (axis.edge - length).max(0.0);
        let (low, length) = (low - 0.5 * more, length + more);
        let from = low.max(-reach);
        let to = (low + length).min(axis.length + reach).max(from);
        Near { axis, reach, length, from, to }
    }

    fn within(&self) -> f64 {
        (self.to - self.from) / self.length
    }

    /// Returns the mean number of steps of this width within reach, the first shorter by `offset`.
    fn steps(&self, width: f64, offset: f64) -> f64 {
        let (end, reach) = (self.axis.length, self.reach);
        // Integral of the step number from 0 to x.
        let sum = |x: f64| {
            let x = x + offset;
            let k = (x / width).floor();
            k * (x - 0.5 * (k + 1.0) * width)
        };
        let (from, to) = (self.from + reach, self.to + reach);
        let last = ((end + offset) / width).floor();
        let high = sum(to.min(end)) - sum(from.min(end)) + (to - from.max(end)).max(0.0) * last;
        let low = sum((self.to - reach).max(0.0)) - sum((self.from - reach).max(0.0));
        (self.to - self.from + high - low) / self.length
    }

    /// Returns the fraction of the axis that this many cells within reach cover.
    fn covered(&self, cells: f64) -> f64 {
        let Axis { length, edge, full } = self.axis;
        if full == 0.0 {
            return self.within();
        }
        let beyond = (full + 1.0) * edge - length;
        let at_end = (self.to - self.from.max(full * edge - self.reach)).max(0.0) / self.length;
        (cells * edge - beyond * at_end) / length
    }
}

/// Returns the largest radius of each level, largest level first, and the number of levels, for
/// which the work is least. `largest` is the largest radius of the scene and must be positive.
pub fn optimal<T: Real, const D: usize>(
    bodies: &impl Bodies<T, D>,
    largest: f64,
) -> ([f64; MOST_LEVELS], usize) {
    let mut parts = [Class::NONE; RADII];
    for id in 0..bodies.len() as u32 {
        let radius = bodies.radius(id);
        parts[part(largest, radius)].take(bodies.position(id), radius);
    }
    let mut count = 0;
    for k in 0..RADII {
        if parts[k].bodies > 0 {
            parts[count] = parts[k];
            count += 1;
        }
    }
    let parts = &parts[..count];
    // For each part: the least work up to it, and the first part of the level that it ends.
    let mut least = [(0.0, 0); RADII];
    for end in 0..count {
        let (mut level, mut best) = (Class::NONE, (f64::INFINITY, end));
        for begin in (0..=end).rev() {
            level = level.with(&parts[begin]);
            let before = if begin == 0 { 0.0 } else { least[begin - 1].0 };
            let mut all = before + level.beside().all();
            for larger in &parts[..begin] {
                let n = larger.bodies as f64;
                all += level.visits(larger, n, larger.sum / n).all();
            }
            if all < best.0 {
                best = (all, begin);
            }
        }
        least[end] = best;
    }
    let (mut borders, mut levels) = ([0.0; MOST_LEVELS], 0);
    let mut end = count;
    while end > 0 {
        end = least[end - 1].1;
        // If there are too many levels, drop the lowest border so far, to merge the smallest.
        if levels == MOST_LEVELS {
            borders.copy_within(1.., 0);
            levels -= 1;
        }
        borders[levels] = parts[end].largest;
        levels += 1;
    }
    borders[..levels].reverse();
    (borders, levels)
}

/// Returns the number of the part that holds a radius: the exponent of largest / radius and two
/// more bits. Rounding is monotone, so a smaller radius never has a lower number.
#[inline(always)]
fn part(largest: f64, radius: f64) -> usize {
    let bits = (largest / radius).to_bits() >> 50 & 0x1fff;
    // The quotient is at least 1, and infinite for points.
    (bits as usize).saturating_sub(4 * 1023).min(RADII - 1)
}

#[cfg(test)]
mod tests;
