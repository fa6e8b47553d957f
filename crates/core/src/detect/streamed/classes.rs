//! Size classes of particles; the particles of a class share a grid.
//!
//! Cells are as wide as the reach of the largest particle in them. So particles of very different
//! sizes are divided into classes by radius, and each class gets its own grid. Larger particles
//! then visit the grids of smaller ones ([`super::visits`]).
//!
//! Radii are grouped by octave. The octave of a radius is how often the largest radius of the scene
//! must be halved until it is at most this radius. Which octaves share a grid is chosen to minimise
//! a model of the work ([`Class::work`], [`Class::visits`]). Larger particles visit each finer
//! class separately, so the work in a class, visits included, depends only on where the class
//! begins and ends. So the best partition is found octave by octave. Most scenes whose sizes differ
//! by a small factor form one class and are swept like scenes of one size.

use super::grid::CELLS_PER_PARTICLE;
use crate::contact::Bodies;
use crate::detect::modern::crowd::CLASSES;
use crate::scene::{Real, extremes};
use crate::wide::fill;

/// Number of octaves; the last one holds all radii below 2^-31 of the largest.
pub(super) const MOST: usize = CLASSES;
/// Scenes with fewer particles than this form one class.
const FEWEST: usize = 64;
/// Measured cost of finding a row of candidates, in contact tests.
const ROW: f64 = 30.0;
/// Fixed cost of one more class, in contact tests.
const CLASS: f64 = 2000.0;

/// A range of octaves and the particles in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Class<const D: usize> {
    pub bodies: usize,
    pub octaves: usize,
    pub largest: f64,
    sum: f64,
    pub low: [f64; D],
    pub high: [f64; D],
}

impl<const D: usize> Class<D> {
    const EMPTY: Class<D> = Class {
        bodies: 0,
        octaves: 0,
        largest: 0.0,
        sum: 0.0,
        low: [f64::INFINITY; D],
        high: [f64::NEG_INFINITY; D],
    };

    #[inline(always)]
    fn take(&mut self, position: [f64; D], radius: f64) {
        for (k, x) in position.into_iter().enumerate() {
            // f64::min would check for NaN, which a scene cannot contain.
            self.low[k] = if x < self.low[k] { x } else { self.low[k] };
            self.high[k] = if x > self.high[k] { x } else { self.high[k] };
        }
        self.largest = if radius > self.largest { radius } else { self.largest };
        self.sum += radius;
        self.bodies += 1;
        self.octaves = 1;
    }

    pub fn with(&self, other: &Class<D>) -> Class<D> {
        Class {
            bodies: self.bodies + other.bodies,
            octaves: self.octaves + other.octaves,
            largest: self.largest.max(other.largest),
            sum: self.sum + other.sum,
            low: fill(|k| self.low[k].min(other.low[k])),
            high: fill(|k| self.high[k].max(other.high[k])),
        }
    }

    /// Returns the approximate number of cells of the class, and their edge.
    fn cells(&self) -> (f64, f64) {
        let lengths: [f64; D] = fill(|k| self.high[k] - self.low[k] + 2.0 * self.largest);
        let share = lengths.iter().product::<f64>() / (CELLS_PER_PARTICLE * self.bodies as f64);
        let edge = (2.0 * self.largest).max(root::<D>(share)).max(f64::MIN_POSITIVE);
        (lengths.iter().map(|length| length / edge).product(), edge)
    }

    /// Estimates the contact tests within the class: each particle is tested against those in half
    /// of the cells around it.
    fn work(&self) -> f64 {
        let (cells, _) = self.cells();
        let beside = if D == 2 { 4.5 } else { 13.5 };
        let n = self.bodies as f64;
        n * n * beside / cells
    }

    /// Estimates the cost in contact tests if the larger particles of `octave` visit this class.
    fn visits(&self, octave: &Class<D>) -> f64 {
        let (cells, edge) = self.cells();
        let radius = octave.sum / octave.bodies as f64;
        // A visit covers slightly more than half of the cube around its ball.
        let width = 2.0 * (radius + self.largest) / edge + 1.0;
        let (rows, tests) =
            if D == 2 { (width, width * width) } else { (width * width, width * width * width) };
        let tests = (self.bodies as f64 * tests / cells).min(self.bodies as f64);
        octave.bodies as f64 * (ROW * 0.8 * rows + 0.6 * tests)
    }
}

fn root<const D: usize>(volume: f64) -> f64 {
    if D == 2 { volume.sqrt() } else { libm::cbrt(volume) }
}

#[derive(Clone, Debug)]
pub(super) struct Classes<const D: usize> {
    largest: f64,
    numbers: [u8; MOST],
    classes: [Class<D>; MOST],
    count: usize,
}

impl<const D: usize> Classes<D> {
    /// Returns the best classes, or `None` if radii are in one octave or particles are too few.
    pub fn of<T: Real>(bodies: &impl Bodies<T, D>) -> Option<Classes<D>> {
        let n = bodies.len() as u32;
        if bodies.uniform().is_some() || bodies.len() < FEWEST {
            return None;
        }
        let (least, largest) = extremes(bodies.len(), |id| bodies.radius(id as u32))?;
        if least == largest || octave(largest, least) == 0 {
            return None;
        }
        let mut octaves = [const { Class::EMPTY }; MOST];
        for id in 0..n {
            let radius = bodies.radius(id);
            octaves[octave(largest, radius)].take(bodies.position(id), radius);
        }
        Some(Classes::best(largest, &octaves))
    }

    /// Returns the partition of the octaves with the least estimated work.
    fn best(largest: f64, octaves: &[Class<D>; MOST]) -> Classes<D> {
        let full = |octave: &usize| octaves[*octave].bodies > 0;
        // For each octave: the least work up to it, and the first octave of the class that it ends.
        let mut least = [(0.0, 0); MOST + 1];
        for end in (0..MOST).filter(full) {
            let (mut class, mut best) = (Class::EMPTY, (f64::INFINITY, end));
            for begin in (0..=end).rev().filter(full) {
                class = class.with(&octaves[begin]);
                let visits = (0..begin).filter(full).map(|octave| class.visits(&octaves[octave]));
                let before = (0..begin).rev().find(full).map_or(0.0, |end| least[end].0);
                let all = before + CLASS + class.work() + visits.sum::<f64>();
                if all < best.0 {
                    best = (all, begin);
                }
            }
            least[end] = best;
        }
        let mut classes =
            Classes { largest, numbers: [0; MOST], classes: [Class::EMPTY; MOST], count: 0 };
        // Collect the classes from the last to the first, then reverse their order.
        let mut last = (0..MOST).rev().find(full);
        while let Some(end) = last {
            let begin = least[end].1;
            let class = (begin..=end).fold(Class::EMPTY, |class, k| class.with(&octaves[k]));
            classes.classes[classes.count] = class;
            classes.numbers[begin..=end].fill(classes.count as u8);
            classes.count += 1;
            last = (0..begin).rev().find(full);
        }
        classes.classes[..classes.count].reverse();
        let last = classes.count.saturating_sub(1) as u8;
        classes.numbers.iter_mut().for_each(|number| *number = last.saturating_sub(*number));
        classes
    }

    #[inline(always)]
    pub fn number(&self, radius: f64) -> usize {
        usize::from(self.numbers[octave(self.largest, radius)])
    }

    pub fn all(&self) -> &[Class<D>] {
        &self.classes[..self.count]
    }
}

/// Returns how often the largest radius is halved until it is at most `radius`: the exponent of the
/// quotient. Rounding is monotone, so a smaller radius never has a lower octave.
#[inline(always)]
fn octave(largest: f64, radius: f64) -> usize {
    let exponent = (largest / radius).to_bits() >> 52 & 0x7ff;
    // The quotient is at least 1, infinite for points, and NaN if all particles are points.
    (exponent as usize).saturating_sub(1023).min(MOST - 1)
}
