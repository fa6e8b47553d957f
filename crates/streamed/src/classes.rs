//! Size classes of particles; the particles of a class share a grid.
//!
//! Cells are as wide as the reach of the largest particle in them. So particles of very different
//! sizes are divided into classes by radius, and each class gets its own grid. Larger particles
//! then visit the grids of smaller ones (`levels/visits.rs`).
//!
//! Radii are grouped in bins: an octave (a factor of 2), or a half or a quarter of an octave if
//! there are many particles (`Bins`). Which bins share a grid is chosen to minimise a model of
//! the work (`Class::work`). Larger particles visit each finer class separately, so the work in a
//! class, visits included, depends only on where the class begins and ends. So the best partition
//! is found bin by bin. Most scenes whose sizes differ by a small factor form one class and are
//! swept like scenes of one size.

use super::grid::CELLS_PER_PARTICLE;
use contactbench_ground::contact::Particles;
use contactbench_ground::detect::company::CLASSES;
use contactbench_ground::scene::{Real, extremes};
use contactbench_ground::wide::fill;

/// Largest number of bins; the last one holds all smaller radii, at least those below 2^-31 of the
/// largest.
pub(super) const MOST: usize = CLASSES;
/// Scenes with fewer particles than this form one class.
const FEWEST: usize = 64;
/// Measured cost of finding a row of candidates, in contact tests.
const ROW: f64 = 30.0;
/// Fixed cost of one more class, in contact tests.
const CLASS: f64 = 2000.0;

/// A range of bins and the particles in it.
#[derive(Clone, Copy, Debug)]
pub struct Class<const D: usize> {
    pub particles: usize,
    least: f64,
    pub largest: f64,
    sum: f64,
    pub low: [f64; D],
    pub high: [f64; D],
}

impl<const D: usize> Class<D> {
    const EMPTY: Class<D> = Class {
        particles: 0,
        least: f64::INFINITY,
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
        self.least = self.least.min(radius);
        self.particles += 1;
    }

    /// Returns whether radii differ by more than a factor of 2.
    pub fn is_wide(&self) -> bool {
        self.largest > 2.0 * self.least
    }

    pub fn with(&self, other: &Class<D>) -> Class<D> {
        Class {
            particles: self.particles + other.particles,
            least: self.least.min(other.least),
            largest: self.largest.max(other.largest),
            sum: self.sum + other.sum,
            low: fill(|k| self.low[k].min(other.low[k])),
            high: fill(|k| self.high[k].max(other.high[k])),
        }
    }

    /// Estimates the work for this class in contact tests. Each particle is tested against those in
    /// half of the cells around it. Particles of the `larger` bins visit this class.
    fn work(&self, larger: &[Class<D>]) -> f64 {
        let n = self.particles as f64;
        let lengths: [f64; D] = fill(|k| self.high[k] - self.low[k] + 2.0 * self.largest);
        let share = lengths.iter().product::<f64>() / (CELLS_PER_PARTICLE * n);
        let edge = (2.0 * self.largest).max(root::<D>(share)).max(f64::MIN_POSITIVE);
        let per_cell = n / lengths.iter().map(|length| length / edge).product::<f64>();
        let visits = |bin: &Class<D>| {
            let radius = bin.sum / bin.particles as f64;
            // A visit tests slightly more than half of the cells in the cube around its reach.
            let width = 2.0 * (radius + self.largest) / edge + 1.0;
            let rows = if D == 2 { width } else { width * width };
            bin.particles as f64 * (ROW * 0.8 * rows + (0.6 * per_cell * rows * width).min(0.6 * n))
        };
        let beside = if D == 2 { 4.5 } else { 13.5 };
        let full = larger.iter().filter(|bin| bin.particles > 0);
        CLASS + n * beside * per_cell + full.map(visits).sum::<f64>()
    }
}

fn root<const D: usize>(volume: f64) -> f64 {
    if D == 2 { volume.sqrt() } else { libm::cbrt(volume) }
}

#[derive(Clone, Debug)]
pub struct Classes<const D: usize> {
    bins: Bins,
    numbers: [u8; MOST],
    classes: [Class<D>; MOST],
    count: usize,
}

impl<const D: usize> Classes<D> {
    /// Returns the best classes, or `None` if radii are in one octave or particles are too few.
    pub fn of<T: Real>(particles: &impl Particles<T, D>) -> Option<Classes<D>> {
        let n = particles.len() as u32;
        if particles.uniform().is_some() || particles.len() < FEWEST {
            return None;
        }
        let (least, largest) = extremes(particles.len(), |id| particles.radius(id as u32))?;
        let bins = Bins::new(n as usize, least, largest)?;
        let mut all = [const { Class::EMPTY }; MOST];
        for id in 0..n {
            let radius = particles.radius(id);
            all[bins.of(radius)].take(particles.position(id), radius);
        }
        Some(Classes::best(bins, &all))
    }

    /// Returns the partition of the bins with the least estimated work.
    fn best(bins: Bins, all: &[Class<D>; MOST]) -> Classes<D> {
        let full = |bin: &usize| all[*bin].particles > 0;
        // For each bin: the least work up to it, and the first bin of the class that it ends.
        let mut least = [(0.0, 0); MOST + 1];
        for end in (0..MOST).filter(full) {
            let (mut class, mut best) = (Class::EMPTY, (f64::INFINITY, end));
            for begin in (0..=end).rev().filter(full) {
                class = class.with(&all[begin]);
                let before = (0..begin).rev().find(full).map_or(0.0, |end| least[end].0);
                let work = before + class.work(&all[..begin]);
                if work < best.0 {
                    best = (work, begin);
                }
            }
            least[end] = best;
        }
        let mut classes =
            Classes { bins, numbers: [0; MOST], classes: [Class::EMPTY; MOST], count: 0 };
        // Collect the classes from the last to the first, then reverse their order.
        let mut last = (0..MOST).rev().find(full);
        while let Some(end) = last {
            let begin = least[end].1;
            let class = (begin..=end).fold(Class::EMPTY, |class, k| class.with(&all[k]));
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
        usize::from(self.numbers[self.bins.of(radius)])
    }

    pub fn all(&self) -> &[Class<D>] {
        &self.classes[..self.count]
    }
}

/// Bins of radii. In each octave from the largest radius down they divide the quotient of largest
/// and radius into 2^`fine` equal parts.
#[derive(Clone, Copy, Debug)]
struct Bins {
    largest: f64,
    fine: u32,
}

impl Bins {
    /// Returns bins so fine that choosing classes costs little for `n` particles, or `None` if all
    /// radii are in one octave.
    fn new(n: usize, least: f64, largest: f64) -> Option<Bins> {
        let octaves = Bins { largest, fine: 0 };
        let few = |bins: &Bins| bins.number(least) < MOST && (bins.of(least) + 1).pow(3) <= n;
        let finer = [2, 1].map(|fine| Bins { fine, ..octaves });
        (least < largest && octaves.of(least) > 0)
            .then(|| finer.into_iter().find(few).unwrap_or(octaves))
    }

    /// Returns the leading bits of the quotient: its exponent and `fine` bits of its fraction.
    /// Rounding is monotone, so a smaller radius never has a lower number.
    #[inline(always)]
    fn number(&self, radius: f64) -> usize {
        let quotient = (self.largest / radius).to_bits();
        let leading = (quotient >> (52 - self.fine)) & ((0x800 << self.fine) - 1);
        // The quotient is at least 1, infinite for points, and NaN if all particles are points.
        (leading as usize).saturating_sub(1023 << self.fine)
    }

    #[inline(always)]
    fn of(&self, radius: f64) -> usize {
        self.number(radius).min(MOST - 1)
    }
}
