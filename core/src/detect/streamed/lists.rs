//! The particles of each bundle of layers, on a list of blocks.
//!
//! One pass over the scene, in the order in which it is stored, puts a compact record of each
//! particle on the list of its bundle. A list is a chain of blocks of records: no histogram is
//! needed beforehand, and memory is written and read in pieces that the hardware fetches ahead.

use std::ops::Range;

use super::grid::Grid;
use super::plan::Plan;
use crate::contact::Bodies;
use crate::scene::Real;

/// The radius of a particle in a record: nothing where all are the same.
pub(super) trait Size: Copy + Default + Send + Sync + 'static {
    /// One radius per particle?
    const EACH: bool;
    /// Of a number of steps.
    fn new(steps: f32) -> Self;
    /// In steps.
    fn get(self) -> f32;
}

impl Size for () {
    const EACH: bool = false;
    fn new(_: f32) {}
    fn get(self) -> f32 {
        0.0
    }
}

impl Size for f32 {
    const EACH: bool = true;
    #[inline(always)]
    fn new(steps: f32) -> f32 {
        steps
    }
    #[inline(always)]
    fn get(self) -> f32 {
        self
    }
}

/// A particle: the lowest 32 bits of its coordinates in steps, its radius, its number.
#[derive(Clone, Copy)]
pub(super) struct Record<const D: usize, R> {
    pub at: [u32; D],
    pub radius: R,
    pub id: u32,
}

/// No block.
const NONE: u32 = u32::MAX;

/// The lists that one worker has filled.
pub(super) struct Lists<const D: usize, R> {
    records: Vec<Record<D, R>>,
    /// The block before each block in its list.
    before: Vec<u32>,
    /// For each list the place of its next record. There is always room for it: a full block is
    /// followed by a new one at once.
    next: Vec<u32>,
    /// Records in a block are two to the power of this.
    block: u32,
}

impl<const D: usize, R> Default for Lists<D, R> {
    fn default() -> Self {
        Lists { records: Vec::new(), before: Vec::new(), next: Vec::new(), block: 0 }
    }
}

/// Log2 of the records in a block, for `n` records in so many lists; and the number of blocks
/// needed.
fn block_size(n: usize, lists: usize) -> (u32, usize) {
    // Eight blocks per list in the mean waste a sixteenth.
    let block = (n / lists.max(1) / 8).next_power_of_two().clamp(16, 1024).trailing_zeros();
    (block, (n >> block) + lists)
}

impl<const D: usize, R: Size> Lists<D, R> {
    /// Heap needed for `n` records in so many lists.
    pub fn bytes(n: usize, lists: usize) -> u64 {
        let (block, count) = block_size(n, lists);
        ((count << block) * size_of::<Record<D, R>>() + 4 * count + 4 * lists) as u64
    }

    /// Puts the particles of a range on the list of their slab.
    pub fn fill<T: Real>(
        &mut self,
        bodies: &impl Bodies<T, D>,
        particles: Range<usize>,
        grid: &Grid<D>,
        plan: &Plan,
    ) {
        let mut filling = self.begin(particles.len(), grid, plan);
        for id in particles.start as u32..particles.end as u32 {
            let radius = if R::EACH { bodies.radius(id) } else { 0.0 };
            filling.push(bodies.position(id), radius, id);
        }
        filling.end();
    }

    /// Empty lists for at most `n` particles.
    pub fn begin(&mut self, n: usize, grid: &Grid<D>, plan: &Plan) -> Filling<'_, D, R> {
        let lists = plan.slabs;
        let (block, count) = block_size(n, lists);
        self.block = block;
        at_least(
            &mut self.records,
            count << block,
            Record { at: [0; D], radius: R::default(), id: 0 },
        );
        at_least(&mut self.before, count, NONE);
        at_least(&mut self.next, lists, 0);
        for (list, next) in self.next[..lists].iter_mut().enumerate() {
            *next = (list as u32) << block;
            self.before[list] = NONE;
        }
        Filling {
            records: &mut self.records,
            before: &mut self.before,
            next: &mut self.next,
            block,
            free: lists as u32,
            shift: grid.bits + plan.layers,
            most: [0; D],
            grid: *grid,
        }
    }

    /// The blocks of a list, the last first.
    pub fn blocks(&self, list: usize) -> impl Iterator<Item = &[Record<D, R>]> {
        let next = self.next[list];
        let (mut block, mut end) = (next >> self.block, next);
        std::iter::from_fn(move || {
            if block == NONE {
                return None;
            }
            let begin = block << self.block;
            let records = &self.records[begin as usize..end as usize];
            block = self.before[block as usize];
            // Not used after the last block; no block is as high as that.
            end = block.wrapping_add(1) << self.block;
            Some(records)
        })
    }

    /// Particles on a list.
    pub fn len(&self, list: usize) -> usize {
        self.blocks(list).map(<[_]>::len).sum()
    }
}

/// Lists that are being filled.
pub(super) struct Filling<'a, const D: usize, R> {
    records: &'a mut [Record<D, R>],
    before: &'a mut [u32],
    next: &'a mut [u32],
    block: u32,
    /// The first block that is on no list.
    free: u32,
    /// From a coordinate in steps to the number of its slab.
    shift: u32,
    /// The largest coordinates.
    most: [u64; D],
    grid: Grid<D>,
}

impl<const D: usize, R: Size> Filling<'_, D, R> {
    /// Puts a particle on the list of its slab.
    #[inline(always)]
    pub fn push(&mut self, position: [f64; D], radius: f64, id: u32) {
        let steps = self.grid.steps(position);
        let radius = if R::EACH { R::new(self.grid.length(radius) as f32) } else { R::default() };
        self.most = std::array::from_fn(|k| self.most[k].max(steps[k]));
        let next = &mut self.next[(steps[D - 1] >> self.shift) as usize];
        self.records[*next as usize] =
            Record { at: std::array::from_fn(|k| steps[k] as u32), radius, id };
        let full = (1 << self.block) - 1;
        if *next & full == full {
            self.before[self.free as usize] = *next >> self.block;
            *next = self.free << self.block;
            self.free += 1;
        } else {
            *next += 1;
        }
    }

    /// To be called after the last particle.
    pub fn end(self) {
        // The kernel relies on it without a check, and `Bodies` may be anybody's: one whose
        // positions changed since the grid was made stops here.
        assert!(
            (0..D).all(|k| self.most[k] >> self.grid.bits < self.grid.count[k]),
            "positions changed during a detection"
        );
    }
}

/// Makes an array at least `count` long. What it held is lost if it must grow, and not held twice.
pub(super) fn at_least<A: Copy>(array: &mut Vec<A>, count: usize, value: A) {
    if count > array.len() {
        if count > array.capacity() {
            *array = Vec::new();
            array.reserve_exact(count);
        }
        array.resize(count, value);
    }
}
