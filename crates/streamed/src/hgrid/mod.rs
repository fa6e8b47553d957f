//! `hgrid`: a grid for every size class, with large particles searched in the grids of smaller ones
//! (hierarchical grid: Ogarko and Luding 2012, doi:10.1016/j.cpc.2011.12.019; Krijgsman, Ogarko and
//! Luding 2014, doi:10.1007/s40571-014-0020-9; hashed levels as in Ericson 2005, "Real-Time
//! Collision Detection", section 7.2).
//!
//! ```text
//!   coarse |       A       |               A is tested against its neighbours on this level,
//!   middle |   b   |       |               and against all particles in the cells of finer
//!   fine   | c | c |   | c |               levels that are within reach of A; b likewise;
//!                                          c is tested against its neighbours only
//! ```
//!
//! 1. Radii are divided into levels at the largest radius divided by powers of a ratio. A radius at
//!    a border belongs to the smaller level. The grid of a level covers the box of its particles.
//!    Its cells are as wide as the reach of its largest radius
//!    ([`contactbench_ground::contact::Particles::class_reach`]). In a sparse level cells are as
//!    wide as the spacing of particles, unless a sample shows that particles crowd.
//! 2. Rows of cells along x are cut into strips of 8. Strips with particles are found by a hash
//!    (open addressing, one table per level) and sorted by row and position. A strip stores where
//!    the particles of each of its cells begin. Every particle is copied to its place. So adjacent
//!    cells of a row are adjacent in memory, and empty cells take no space.
//! 3. Within a level every particle is tested against the rest of its cell, the cell to the right,
//!    and three cells in each of half of the neighbouring rows.
//! 4. Every particle is tested against those of each finer level in the cells within the reach of
//!    its own radius and the level's largest one. If that covers more strips than half of the
//!    level's particles, it is tested against all of them. So each pair of two levels is found
//!    once, from the larger particle.
//!
//! * Cost: proportional to N particles for each level in which they are searched, whatever the
//!   ratio of sizes and the domain; quadratic if a crowd is narrower than 2^-30 of the domain.
//! * Memory: `4(C + N) + 44S + 24N` bytes in 2D, `+ 48S + 32N` in 3D, for S strips with particles
//!   (at most N). C sums, over levels, the smallest power of two of at least twice the level's
//!   particles.
//! * Refuses scenes over the memory limit, and domains of 2^31 or more cells of the largest reach
//!   along an axis if particles crowd in wider cells.
//! * Deviations from the sources: there are at most 32 levels, from the largest radius
//!   downwards, and only those with particles exist. Cells are as wide as the largest radius in a
//!   level requires, not as its border does, and wider if most would be empty. Strips instead of
//!   cells are hashed, so that one lookup finds up to 8 cells. Cells are wider by 4 parts in a
//!   million ([`contactbench_ground::filter::cells`]).

mod levels;
mod search;

use levels::{Level, Levels};

use contactbench_ground::contact::Particles;
use contactbench_ground::detect::any::{AnyDetector, Both};
use contactbench_ground::detect::copies::{Each, Judge, One, Record, room};
use contactbench_ground::detect::{Declare, Detector, Options, within};
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::Sink;
use contactbench_ground::probe::{Op, Probe};
use contactbench_ground::scene::Real;

/// Number of cells in a strip.
const STRIP: u32 = 8;
/// Marks a slot without a strip; not a valid particle number.
const FREE: u32 = u32::MAX;

/// Returns a detector with this ratio of the borders of levels; `None` puts all sizes in one level.
pub fn hgrid(ratio: Option<f64>, options: Options) -> Box<dyn AnyDetector> {
    let plane = HGrid::<2>::with_ratio(ratio, options);
    Both::join(plane, HGrid::<3>::with_ratio(ratio, options), options)
}

/// The hierarchical grid, in `D` dimensions.
pub struct HGrid<const D: usize> {
    options: Options,
    /// Ratio of the borders of levels; `None` puts all sizes in one level.
    ratio: Option<f64>,
    levels: Levels<D>,
    /// Hash tables of all levels: in each slot the first particle of a strip, later the strip's
    /// number.
    slots: Vec<u32>,
    /// For each particle: the slot of its strip within its level, later the strip's number.
    places: Vec<u32>,
    strips: Vec<Strip<D>>,
    records: Vec<Record<D>>,
}

impl<const D: usize> HGrid<D> {
    /// Creates a detector with the ratio of the borders of levels; `None` puts all sizes in
    /// one level.
    pub fn with_ratio(ratio: Option<f64>, options: Options) -> HGrid<D> {
        HGrid {
            options,
            ratio,
            levels: Levels::NONE,
            slots: Vec::new(),
            places: Vec::new(),
            strips: Vec::new(),
            records: Vec::new(),
        }
    }
}

impl<const D: usize> Declare for HGrid<D> {
    const DECIDES_FROM_COPIES: bool = true;

    fn with(options: Options) -> HGrid<D> {
        HGrid::with_ratio(Some(2.0), options)
    }

    fn formula_bytes(&self) -> u64 {
        bytes::<D>(self.slots.len() as u64, self.places.len() as u64, self.strips.len() as u64)
    }
}

fn bytes<const D: usize>(slots: u64, particles: u64, strips: u64) -> u64 {
    4 * (slots + particles) + size_of::<Strip<D>>() as u64 * strips + Record::<D>::BYTES * particles
}

impl<T: Real, const D: usize> Detector<T, D> for HGrid<D> {
    fn detect<B: Particles<T, D>, P: Probe, S: Sink>(
        &mut self,
        particles: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        self.levels = Levels::new(&particles, self.ratio)?;
        self.fits(particles.len(), 0)?;
        self.find_strips(&particles, probe);
        let strips = self.levels.all().iter().map(|level| level.strips.len()).sum();
        self.fits(particles.len(), strips)?;
        self.sort_strips(&particles, strips, probe);
        self.sort_particles(&particles, probe);
        let (slack, touch) =
            (particles.slack(), |i, j, probe: &mut P| particles.touch(i, j, probe));
        match particles.uniform() {
            Some(radius) => self.search(Judge::new(&touch, One::new(radius, slack)), probe, sink),
            None => self.search(Judge::new(&touch, Each::new(slack)), probe, sink),
        }
        Ok(())
    }
}

/// A strip of adjacent cells along x, at least one of them with particles.
#[derive(Clone, Copy)]
struct Strip<const D: usize> {
    /// First cell of the strip, as its index on each axis.
    first: [u32; D],
    /// Index of the first record of each cell, then the end of the last cell's records.
    starts: [u32; STRIP as usize + 1],
}

impl<const D: usize> Strip<D> {
    const NONE: Strip<D> = Strip { first: [0; D], starts: [0; STRIP as usize + 1] };
}

/// Sorts strips by their first cells. As a separate function it is compiled only once.
fn sort_by_cell<const D: usize>(strips: &mut [Strip<D>], probe: &mut impl Probe) {
    strips.sort_unstable_by(|a, b| {
        probe.count(Op::KeyCompare);
        a.first.iter().rev().cmp(b.first.iter().rev())
    });
}

impl<const D: usize> HGrid<D> {
    fn fits(&self, particles: usize, strips: usize) -> Result<(), Refusal> {
        let slots: usize = self.levels.all().iter().map(|level| level.slots.len()).sum();
        let needed = bytes::<D>(slots as u64, particles as u64, strips as u64);
        within(&self.options, "hgrid", needed, || format!("{particles} particles"))
    }

    fn find_strips<T: Real>(&mut self, particles: &impl Particles<T, D>, probe: &mut impl Probe) {
        let n = particles.len();
        let slots = self.levels.all().iter().map(|level| level.slots.len()).sum();
        self.slots.clear();
        room(&mut self.slots, slots, FREE);
        room(&mut self.places, n, 0);
        for id in 0..n as u32 {
            let class = self.levels.class(particles.radius(id));
            let (level, cells) = self.levels.at(class);
            let first = Level::strip(cells, particles.position(id), probe);
            let slots = &mut self.slots[level.slots.clone()];
            let mut slot = level.slot(first);
            let is_new = loop {
                let other = slots[slot];
                if other == FREE {
                    slots[slot] = id;
                    break true;
                }
                probe.count(Op::KeyCompare);
                if Level::strip(cells, particles.position(other), probe) == first {
                    break false;
                }
                slot = (slot + 1) & (slots.len() - 1);
            };
            self.places[id as usize] = slot as u32;
            // Strips are only counted here; `sort_strips` sets the begin of the range.
            self.levels.all_mut()[class].strips.end += usize::from(is_new);
        }
    }

    fn sort_strips<T: Real>(
        &mut self,
        particles: &impl Particles<T, D>,
        count: usize,
        probe: &mut impl Probe,
    ) {
        self.strips.clear();
        room(&mut self.strips, count, Strip::NONE);
        let mut end = 0;
        for level in self.levels.all_mut() {
            let Some(cells) = &level.cells else { continue };
            level.strips = end..end + level.strips.len();
            end = level.strips.end;
            let (strips, slots) =
                (&mut self.strips[level.strips.clone()], &mut self.slots[level.slots.clone()]);
            let taken = slots.iter().zip(0..).filter(|(id, _)| **id != FREE);
            for (strip, (&id, slot)) in strips.iter_mut().zip(taken) {
                strip.first = Level::strip(cells, particles.position(id), probe);
                // Holds the strip's slot until strips are sorted; starts of records come later.
                strip.starts[0] = slot;
            }
            sort_by_cell(strips, probe);
            for (strip, number) in strips.iter_mut().zip(level.strips.start as u32..) {
                slots[strip.starts[0] as usize] = number;
                strip.starts[0] = 0;
            }
        }
    }

    fn sort_particles<T: Real>(
        &mut self,
        particles: &impl Particles<T, D>,
        probe: &mut impl Probe,
    ) {
        let n = particles.len() as u32;
        room(&mut self.records, particles.len(), Record::NONE);
        for id in 0..n {
            let (level, cells) = self.levels.of(particles.radius(id));
            let place = &mut self.places[id as usize];
            *place = self.slots[level.slots.clone()][*place as usize];
            let at = cells.index(particles.position(id)[0], 0, probe) % STRIP;
            self.strips[*place as usize].starts[at as usize] += 1;
        }
        let mut end = 0;
        for level in self.levels.all_mut() {
            let first = end;
            for strip in &mut self.strips[level.strips.clone()] {
                let [starts @ .., last] = &mut strip.starts;
                for start in starts {
                    end += *start;
                    *start = end;
                }
                *last = end;
            }
            level.records = first as usize..end as usize;
        }
        // Each cell is filled from its end backwards, so that its particles stay in order.
        for id in (0..n).rev() {
            let (_, cells) = self.levels.of(particles.radius(id));
            let record = Record::new(particles, id);
            let at = cells.index(record.position[0], 0, probe) % STRIP;
            let start = &mut self.strips[self.places[id as usize] as usize].starts[at as usize];
            *start -= 1;
            probe.count(Op::Move);
            self.records[*start as usize] = record;
        }
    }
}
