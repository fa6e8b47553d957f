//! The work of levels, as a model says, and the levels where it is least.
//!
//! The model is that of Krijgsman, Ogarko and Luding 2014 (doi:10.1007/s40571-014-0020-9; in
//! MercuryDPM `HGridOptimiser`): bodies lie anywhere in a box, independently. A body is tested
//! against half of the others in the 3^D cells around it. Where one of radius r is searched for in
//! a finer level of cells of edge h, it looks at (2r/h + 2)^D of them on average, and is tested
//! against what they hold. Work is tests + K looks.
//!
//! Deviations: a look is at a strip of 8 cells, not at a cell; a level where that would be more
//! strips than half of its bodies is gone through whole; cells of a sparse level are wider; and the
//! box ends, which is exact here along each axis, and where large bodies are few is most of it.
//!
//! The published optimum is that of cells of any size, for a number of levels that is given. Ours
//! is over all partitions of the radii, parted into four per octave, and over all numbers of
//! levels: larger bodies look for those of a level one by one, so the work in a level and of its
//! visitors depends on where it begins and ends alone, and the best is found radius by radius.

use std::array::from_fn;

use super::STRIP;
use super::levels::MOST_LEVELS;
use crate::contact::Bodies;
use crate::filter::cells::spacing;
use crate::scene::Real;

/// K, what a look takes in contact tests: measured, by least squares of relative errors over the
/// times and counts of `hgrid` in results/reference-sizes (311 cells; a test takes 3.1 ns, a look
/// 39 ns, a body 88 ns, so 12.6; 11.9 in 2D, 15.3 in 3D). In MercuryDPM's notes, where it looks at
/// single cells and tests are slower, 0.77 is best.
pub const LOOK: f64 = 13.0;
/// Radii that are told apart: four to an octave.
const RADII: usize = 128;

/// Bodies of a level, or of a part of one.
#[derive(Clone, Copy, Debug)]
pub struct Class<const D: usize> {
    /// The box around their centres.
    pub low: [f64; D],
    pub high: [f64; D],
    pub largest: f64,
    pub bodies: usize,
    /// The sum of all radii.
    sum: f64,
}

/// Contact tests, and looks at strips of another level.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work {
    pub tests: f64,
    pub looks: f64,
}

impl Work {
    /// In contact tests.
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

    /// The edge of its cells, if bodies do not crowd.
    fn edge(&self) -> f64 {
        let reach = 2.0 * self.largest;
        reach.max(spacing(self.low, self.high, self.bodies)).max(4.0 * f64::MIN_POSITIVE)
    }

    /// Among its bodies.
    pub fn beside(&self) -> Work {
        let (n, edge) = (self.bodies as f64, self.edge());
        let near = (0..D).map(|k| Axis::new(self, k, edge).near()).product::<f64>();
        Work { tests: 0.5 * n * (n - 1.0) * near, looks: 0.0 }
    }

    /// Of so many bodies of `larger`, of this radius, which are searched for in this class.
    pub fn visits(&self, larger: &Class<D>, bodies: f64, radius: f64) -> Work {
        let (n, edge, reach) = (self.bodies as f64, self.edge(), radius + self.largest);
        let (mut within, mut tests, mut looks) = (1.0, n, 1.0);
        // So much longer than between the outermost is the box that they lie in, on average.
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

/// A row of cells from end to end of a box.
struct Axis {
    length: f64,
    edge: f64,
    /// Cells but for the last, which may reach over the end.
    full: f64,
}

impl Axis {
    fn new<const D: usize>(class: &Class<D>, k: usize, edge: f64) -> Axis {
        let length = class.high[k] - class.low[k];
        Axis { length, edge, full: (length / edge).floor() }
    }

    /// The part of all couples that are in one cell, or in neighbours.
    fn near(&self) -> f64 {
        if self.full == 0.0 {
            return 1.0;
        }
        let cell = self.edge / self.length;
        let last = 1.0 - self.full * cell;
        (3.0 * self.full - 2.0) * cell * cell + 2.0 * cell * last + last * last
    }
}

/// Points anywhere in a stretch of an axis, and what of its cells is within reach of them, on
/// average over all points of the stretch. Cells count from the beginning of the axis.
struct Near {
    axis: Axis,
    reach: f64,
    /// The stretch.
    length: f64,
    /// The part of it from which anything is within reach.
    from: f64,
    to: f64,
}

impl Near {
    /// For a stretch of this length that begins at `low`. One that is shorter than a cell is taken
    /// to be as long.
    fn new(axis: Axis, low: f64, length: f64, reach: f64) -> Near {
        let more = (axis.edge - length).max(0.0);
        let (low, length) = (low - 0.5 * more, length + more);
        let from = low.max(-reach);
        let to = (low + length).min(axis.length + reach).max(from);
        Near { axis, reach, length, from, to }
    }

    /// The part of the points that have anything within reach.
    fn within(&self) -> f64 {
        (self.to - self.from) / self.length
    }

    /// How many steps of so wide, the first one shorter by `offset`.
    fn steps(&self, width: f64, offset: f64) -> f64 {
        let (end, reach) = (self.axis.length, self.reach);
        // The integral from 0 of the number of the step.
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

    /// The part of the axis that is in cells within reach, which are so many.
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

/// The largest radius of each level, the largest level first, where the work is least; and how many
/// levels these are. `largest` is that of all bodies, and over 0.
pub fn optimal<T: Real, const D: usize>(
    bodies: &impl Bodies<T, D>,
    largest: f64,
) -> ([f64; MOST_LEVELS], usize) {
    let mut parts = [Class::NONE; RADII];
    for id in 0..bodies.len() as u32 {
        let radius = bodies.radius(id);
        parts[part(largest, radius)].take(bodies.position(id), radius);
    }
    // Those with bodies.
    let mut count = 0;
    for k in 0..RADII {
        if parts[k].bodies > 0 {
            parts[count] = parts[k];
            count += 1;
        }
    }
    let parts = &parts[..count];
    // For each part the least work of all up to it, and where the level begins in which it is the
    // last.
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
        // Of too many, the smallest share a level: those beyond are the largest so far.
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

/// Which part a radius belongs to: their quotient's exponent and two more bits. Rounding is
/// monotone, so smaller radii have no lower part.
#[inline(always)]
fn part(largest: f64, radius: f64) -> usize {
    let bits = (largest / radius).to_bits() >> 50 & 0x1fff;
    // The quotient is at least 1; it is infinite for points.
    (bits as usize).saturating_sub(4 * 1023).min(RADII - 1)
}

#[cfg(test)]
mod tests;
