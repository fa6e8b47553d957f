//! Classes of sizes: which bodies go through the scene together.
//!
//! Cells are as wide as the reach of the largest body in them. So bodies of very different sizes
//! are parted by their radii, each class gets the grid that suits it, and where the grid of one
//! class holds the smaller bodies, larger ones visit it ([`super::visits`]).
//!
//! Radii are told apart by octaves: how many times the largest radius of the scene is halved, before
//! it is less. Neighbouring octaves stay together where a model of the work says that parting them
//! does not pay ([`Class::work`]); most scenes whose sizes differ by a small factor are one class,
//! and are swept as if there were none.

use super::grid::CELLS_PER_PARTICLE;
use crate::contact::Bodies;
use crate::scene::Real;

/// Octaves that are told apart: what is smaller than 2^-31 of the largest body is in the last.
pub(super) const MOST: usize = 32;
/// Scenes with fewer bodies are one class.
const FEWEST: usize = 64;
/// What it takes to find a row of candidates, in contact tests.
const ROW: f64 = 12.0;
/// What a class takes beside its bodies, in contact tests.
const CLASS: f64 = 2000.0;
/// Bodies of similar sizes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Class<const D: usize> {
    pub bodies: usize,
    /// The largest radius.
    pub largest: f64,
    /// The box around the centres.
    pub low: [f64; D],
    pub high: [f64; D],
}

impl<const D: usize> Class<D> {
    const EMPTY: Class<D> =
        Class { bodies: 0, largest: 0.0, low: [f64::INFINITY; D], high: [f64::NEG_INFINITY; D] };

    #[inline(always)]
    fn take(&mut self, position: [f64; D], radius: f64) {
        for (k, x) in position.into_iter().enumerate() {
            // Not f64::min, which asks for NaN first; there is none in a scene.
            self.low[k] = if x < self.low[k] { x } else { self.low[k] };
            self.high[k] = if x > self.high[k] { x } else { self.high[k] };
        }
        self.largest = if radius > self.largest { radius } else { self.largest };
        self.bodies += 1;
    }

    fn with(&self, other: &Class<D>) -> Class<D> {
        Class {
            bodies: self.bodies + other.bodies,
            largest: self.largest.max(other.largest),
            low: std::array::from_fn(|k| self.low[k].min(other.low[k])),
            high: std::array::from_fn(|k| self.high[k].max(other.high[k])),
        }
    }

    /// The volume of its domain, and the edge of its cells, about.
    fn domain(&self) -> (f64, f64) {
        let volume: f64 = (0..D).map(|k| self.high[k] - self.low[k] + 2.0 * self.largest).product();
        let share = volume / (CELLS_PER_PARTICLE * self.bodies as f64);
        (volume, (2.0 * self.largest).max(libm::pow(share, 1.0 / D as f64)))
    }

    /// Contact tests among its bodies, about: those in half of the cells around each.
    fn work(&self) -> f64 {
        let (volume, edge) = self.domain();
        let cells = if D == 2 { 4.5 } else { 13.5 };
        let n = self.bodies as f64;
        n * n * cells * libm::pow(edge, D as f64) / volume
    }

    /// What it takes to look for the bodies of a finer class around those of this one, in contact
    /// tests, about.
    fn visits(&self, finer: &Class<D>) -> f64 {
        let (volume, edge) = finer.domain();
        let width = 2.0 * (self.largest + finer.largest);
        let rows = libm::pow(width / edge + 1.0, (D - 1) as f64);
        let tests = finer.bodies as f64 * libm::pow(width + edge, D as f64) / volume;
        self.bodies as f64 * (ROW * rows + tests.min(finer.bodies as f64))
    }
}

/// The classes of a scene, the largest bodies first.
#[derive(Clone, Debug)]
pub(super) struct Classes<const D: usize> {
    largest: f64,
    /// The class of each octave.
    numbers: [u8; MOST],
    classes: [Class<D>; MOST],
    count: usize,
}

impl<const D: usize> Classes<D> {
    /// Those of a scene, if there are several.
    pub fn of<T: Real>(bodies: &impl Bodies<T, D>) -> Option<Classes<D>> {
        let n = bodies.len() as u32;
        if bodies.uniform().is_some() || bodies.len() < FEWEST {
            return None;
        }
        let (mut least, mut largest) = (f64::INFINITY, 0.0);
        for id in 0..n {
            let radius = bodies.radius(id);
            least = if radius < least { radius } else { least };
            largest = if radius > largest { radius } else { largest };
        }
        if octave(largest, least) == 0 {
            return None;
        }
        let mut classes = Classes {
            largest,
            numbers: [0; MOST],
            classes: [const { Class::EMPTY }; MOST],
            count: MOST,
        };
        for id in 0..n {
            let radius = bodies.radius(id);
            classes.classes[octave(largest, radius)].take(bodies.position(id), radius);
        }
        classes.join();
        (classes.count > 1).then_some(classes)
    }

    /// Joins octaves where that saves work.
    fn join(&mut self) {
        let octaves = self.classes;
        self.count = 0;
        for (octave, finer) in octaves.iter().enumerate() {
            if finer.bodies > 0 {
                let last = self.count.checked_sub(1).map(|last| &mut self.classes[last]);
                let joined = last.as_ref().map(|coarser| coarser.with(finer));
                match (last, joined) {
                    (Some(coarser), Some(joined))
                        if joined.work()
                            <= coarser.work() + finer.work() + coarser.visits(finer) + CLASS =>
                    {
                        *coarser = joined;
                    }
                    _ => {
                        self.classes[self.count] = *finer;
                        self.count += 1;
                    }
                }
            }
            self.numbers[octave] = self.count.saturating_sub(1) as u8;
        }
    }

    /// The number of the class of a radius.
    #[inline(always)]
    pub fn number(&self, radius: f64) -> usize {
        usize::from(self.numbers[octave(self.largest, radius)])
    }

    /// All of them.
    pub fn all(&self) -> &[Class<D>] {
        &self.classes[..self.count]
    }
}

/// How many times the largest radius is halved, before it is less than this one or equal: the
/// exponent of their quotient. Rounding is monotone, so smaller radii have no lower octave.
#[inline(always)]
fn octave(largest: f64, radius: f64) -> usize {
    let exponent = (largest / radius).to_bits() >> 52 & 0x7ff;
    // The quotient is at least 1; it is infinite for points, and no number if all are points.
    (exponent as usize).saturating_sub(1023).min(MOST - 1)
}
