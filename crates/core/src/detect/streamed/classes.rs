//! Classes of sizes: which bodies go through the scene together.
//!
//! Cells are as wide as the reach of the largest body in them. So bodies of very different sizes
//! are parted by their radii, each class gets the grid that suits it, and where the grid of one
//! class holds the smaller bodies, larger ones visit it ([`super::visits`]).
//!
//! Radii are told apart by octaves: how many times the largest radius of the scene is halved,
//! before it is less. Which octaves share a grid is chosen so that a model of the work is least
//! ([`Class::work`], [`Class::visits`]). Since larger bodies visit finer classes one by one, the
//! work in a class and of its visitors depends on where the class begins and ends alone, and the
//! best partition is found octave by octave. Most scenes whose sizes differ by a small factor are
//! one class, and once that is known are swept as if there were none.

use super::grid::CELLS_PER_PARTICLE;
use crate::contact::Bodies;
use crate::detect::modern::crowd::CLASSES;
use crate::scene::{Real, extremes};

/// Octaves that are told apart: what is smaller than 2^-31 of the largest body is in the last.
pub(super) const MOST: usize = CLASSES;
/// Scenes with fewer bodies are one class.
const FEWEST: usize = 64;
/// What it takes to find a row of candidates, in contact tests: measured.
const ROW: f64 = 30.0;
/// What a class takes beside its bodies, in contact tests.
const CLASS: f64 = 2000.0;

/// Bodies of similar sizes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Class<const D: usize> {
    pub bodies: usize,
    /// Octaves of radii that it has.
    pub octaves: usize,
    /// The largest radius.
    pub largest: f64,
    /// The sum of all radii.
    sum: f64,
    /// The box around the centres.
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
            // Not f64::min, which asks for NaN first; there is none in a scene.
            self.low[k] = if x < self.low[k] { x } else { self.low[k] };
            self.high[k] = if x > self.high[k] { x } else { self.high[k] };
        }
        self.largest = if radius > self.largest { radius } else { self.largest };
        self.sum += radius;
        self.bodies += 1;
        self.octaves = 1;
    }

    /// Both together.
    pub fn with(&self, other: &Class<D>) -> Class<D> {
        Class {
            bodies: self.bodies + other.bodies,
            octaves: self.octaves + other.octaves,
            largest: self.largest.max(other.largest),
            sum: self.sum + other.sum,
            low: std::array::from_fn(|k| self.low[k].min(other.low[k])),
            high: std::array::from_fn(|k| self.high[k].max(other.high[k])),
        }
    }

    /// Volume of its domain, and edge of its cells, about; in units of the edge.
    fn cells(&self) -> (f64, f64) {
        let lengths: [f64; D] =
            std::array::from_fn(|k| self.high[k] - self.low[k] + 2.0 * self.largest);
        let share = lengths.iter().product::<f64>() / (CELLS_PER_PARTICLE * self.bodies as f64);
        let edge = (2.0 * self.largest).max(root::<D>(share)).max(f64::MIN_POSITIVE);
        (lengths.iter().map(|length| length / edge).product(), edge)
    }

    /// Contact tests among its bodies, about: those in half of the cells around each.
    fn work(&self) -> f64 {
        let (cells, _) = self.cells();
        let beside = if D == 2 { 4.5 } else { 13.5 };
        let n = self.bodies as f64;
        n * n * beside / cells
    }

    /// What it takes to look for its bodies around those of a larger octave, in contact tests,
    /// about.
    fn visits(&self, octave: &Class<D>) -> f64 {
        let (cells, edge) = self.cells();
        let radius = octave.sum / octave.bodies as f64;
        // A ball is a bit more than half of the cube around it.
        let width = 2.0 * (radius + self.largest) / edge + 1.0;
        let (rows, tests) =
            if D == 2 { (width, width * width) } else { (width * width, width * width * width) };
        let tests = (self.bodies as f64 * tests / cells).min(self.bodies as f64);
        octave.bodies as f64 * (ROW * 0.8 * rows + 0.6 * tests)
    }
}

/// The root of a volume.
fn root<const D: usize>(volume: f64) -> f64 {
    if D == 2 { volume.sqrt() } else { libm::cbrt(volume) }
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
    /// Those of a scene, if there is more than one octave of radii.
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

    /// The partition of the octaves that takes least.
    fn best(largest: f64, octaves: &[Class<D>; MOST]) -> Classes<D> {
        let full = |octave: &usize| octaves[*octave].bodies > 0;
        // For each octave the least work of all up to it, and where the class begins in which it is
        // the last.
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
        // From the last class back to the first, which is then turned round.
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
