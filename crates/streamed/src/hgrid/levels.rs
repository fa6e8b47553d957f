//! Size classes: which radii belong together, and the grid of each class.

use std::ops::Range;

use super::STRIP;
use contactbench_ground::contact::{Margin, Particles};
use contactbench_ground::detect::company::{CLASSES, CROWD, company};
use contactbench_ground::detect::rows::mixed;
use contactbench_ground::filter::Cells;
use contactbench_ground::filter::cells::spacing;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::probe::{Probe, Silent};
use contactbench_ground::scene::Real;
use contactbench_ground::wide::fill;
use contactbench_terms::mix::splitmix64;

/// Largest number of levels; the last one holds all radii below the last border.
const MOST_LEVELS: usize = CLASSES;

/// Size classes, largest first.
#[derive(Clone)]
pub(super) struct Levels<const D: usize> {
    /// Upper limit of the radii in each class.
    borders: [f64; MOST_LEVELS],
    levels: [Level<D>; MOST_LEVELS],
    count: usize,
}

/// The particles of a level.
#[derive(Clone)]
pub(super) struct Class<const D: usize> {
    pub low: [f64; D],
    pub high: [f64; D],
    pub largest: f64,
    pub particles: usize,
}

impl<const D: usize> Class<D> {
    const NONE: Class<D> =
        Class { low: [f64::INFINITY; D], high: [f64::NEG_INFINITY; D], largest: 0.0, particles: 0 };

    #[inline(always)]
    fn take(&mut self, position: [f64; D], radius: f64) {
        for (k, x) in position.into_iter().enumerate() {
            self.low[k] = self.low[k].min(x);
            self.high[k] = self.high[k].max(x);
        }
        self.largest = self.largest.max(radius);
        self.particles += 1;
    }
}

#[derive(Clone)]
pub(super) struct Level<const D: usize> {
    pub class: Class<D>,
    pub cells: Option<Cells<D>>,
    /// Range of the level's slots; its length is a power of two.
    pub slots: Range<usize>,
    pub strips: Range<usize>,
    pub records: Range<usize>,
}

impl<const D: usize> Level<D> {
    const NONE: Level<D> =
        Level { class: Class::NONE, cells: None, slots: 0..0, strips: 0..0, records: 0..0 };

    /// Returns the grid of the class: about one particle per cell if `filled` is set, else cells as
    /// wide as the reach.
    fn grid<T: Real>(
        &self,
        particles: &impl Particles<T, D>,
        filled: bool,
    ) -> Result<Cells<D>, Refusal> {
        let Class { low, high, largest, particles: count, .. } = self.class;
        let points = particles.class_reach(largest, largest) <= particles.underflow();
        // The book's cells are always as wide as the reach.
        let filled = filled && particles.margin() == Margin::Safe;
        let least = if filled || points { spacing(low, high, count) } else { 0.0 };
        Cells::of_class(particles, (low, high), largest, least)
    }

    fn is_sparse<T: Real>(&self, particles: &impl Particles<T, D>) -> bool {
        let Class { low, high, largest, particles: count, .. } = self.class;
        spacing(low, high, count) > particles.class_reach(largest, largest)
    }

    #[inline(always)]
    pub fn strip(cells: &Cells<D>, position: [f64; D], probe: &mut impl Probe) -> [u32; D] {
        let mut cell: [u32; D] = fill(|k| cells.index(position[k], k, probe));
        cell[0] -= cell[0] % STRIP;
        cell
    }

    /// Returns the slot, counted within the level, where to begin the search for a strip.
    #[inline(always)]
    pub fn slot(&self, first: [u32; D]) -> usize {
        (mixed(first) >> 32) as usize & (self.slots.len() - 1)
    }
}

impl<const D: usize> Levels<D> {
    pub const NONE: Levels<D> = Levels {
        borders: [0.0; MOST_LEVELS],
        levels: [const { Level::NONE }; MOST_LEVELS],
        count: 0,
    };

    pub fn new<T: Real>(
        particles: &impl Particles<T, D>,
        ratio: Option<f64>,
    ) -> Result<Levels<D>, Refusal> {
        let n = particles.len() as u32;
        let mut levels = Levels::NONE;
        let (mut least, mut largest) = (f64::INFINITY, 0.0_f64);
        match particles.uniform() {
            Some(radius) => (least, largest) = (radius, radius),
            None => (0..n).for_each(|id| {
                least = least.min(particles.radius(id));
                largest = largest.max(particles.radius(id));
            }),
        }
        levels.part(ratio, least, largest);
        for id in 0..n {
            let radius = particles.radius(id);
            let class = levels.class(radius);
            levels.levels[class].class.take(particles.position(id), radius);
        }
        let mut slots = 0;
        for level in &mut levels.levels[..levels.count] {
            if level.class.particles > 0 {
                level.cells = Some(level.grid(particles, true)?);
                // One slot always stays free, since there are fewer than 2^32 particles.
                let wanted =
                    (2 * level.class.particles as u64).next_power_of_two().min(1 << 32) as usize;
                level.slots = slots..slots + wanted;
                slots += wanted;
            }
        }
        if levels.all().iter().any(|level| level.class.particles > 0 && level.is_sparse(particles))
        {
            let crowded = levels.crowded(particles);
            let levels = levels.levels.iter_mut().zip(crowded);
            for (level, _) in levels.filter(|(_, crowded)| *crowded) {
                level.cells = Some(level.grid(particles, false)?);
            }
        }
        Ok(levels)
    }

    fn part(&mut self, ratio: Option<f64>, least: f64, largest: f64) {
        self.borders[0] = largest;
        self.count = 1;
        // Particles of one size, and points, form one level.
        if least >= largest {
            return;
        }
        let Some(ratio) = ratio else { return };
        let mut border = largest / ratio;
        while least <= border && self.count < MOST_LEVELS {
            self.borders[self.count] = border;
            self.count += 1;
            border /= ratio;
        }
    }

    /// Returns for each level whether it has many particles per cell, estimated from a sample. A
    /// level with few pairs is not reported: it costs little.
    fn crowded<T: Real>(&self, particles: &impl Particles<T, D>) -> [bool; MOST_LEVELS] {
        let place = |id| {
            let class = self.class(particles.radius(id));
            let (_, cells) = self.at(class);
            let position = particles.position(id);
            let key =
                |key, k| splitmix64(key ^ u64::from(cells.index(position[k], k, &mut Silent)));
            (class, (0..D).fold(0, key))
        };
        company(particles.len(), place, |class| self.levels[class].class.particles)
            .map(|company| company > CROWD)
    }

    #[inline(always)]
    pub fn class(&self, radius: f64) -> usize {
        if self.count == 1 {
            return 0;
        }
        self.borders[1..self.count].partition_point(|&border| radius <= border)
    }

    pub fn all_mut(&mut self) -> &mut [Level<D>] {
        &mut self.levels[..self.count]
    }

    pub fn all(&self) -> &[Level<D>] {
        &self.levels[..self.count]
    }

    #[inline(always)]
    pub fn at(&self, class: usize) -> (&Level<D>, &Cells<D>) {
        let level = &self.levels[class];
        let Some(cells) = &level.cells else { unreachable!("a level with particles has cells") };
        (level, cells)
    }

    #[inline(always)]
    pub fn of(&self, radius: f64) -> (&Level<D>, &Cells<D>) {
        self.at(self.class(radius))
    }
}
