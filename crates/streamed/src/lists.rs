//! Lists of particles, one for each bundle of layers of cells. A list is a chain of blocks.
//!
//! One pass over the scene, in stored order, appends a compact record of each particle to the list
//! of its bundle. No histogram is needed beforehand, and memory is accessed in pieces that the
//! hardware prefetches.

use std::ops::Range;

use super::grid::Grid;
use super::plan::Plan;
use contactbench_ground::contact::Particles;
use contactbench_ground::limits::pages::Array;
use contactbench_ground::limits::refusal::at_least;
use contactbench_ground::radix::prefetch_to_write;
use contactbench_ground::scene::Real;
use contactbench_ground::wide::fill;
use contactbench_ground::wide::{Kernel, Level, Wide};

/// Type of the radius in a record; it is empty if all radii are equal.
pub(super) trait Size: Copy + Default + Send + Sync + 'static {
    const EACH: bool;
    fn room<const D: usize>(room: &mut Room<D>) -> &mut Vec<Record<D, Self>>;
    fn new(steps: f32) -> Self;
    fn get(self) -> f32;
}

impl Size for () {
    const EACH: bool = false;
    fn room<const D: usize>(room: &mut Room<D>) -> &mut Vec<Record<D, ()>> {
        &mut room.uniform
    }
    fn new(_: f32) {}
    fn get(self) -> f32 {
        0.0
    }
}

impl Size for f32 {
    const EACH: bool = true;
    fn room<const D: usize>(room: &mut Room<D>) -> &mut Vec<Record<D, f32>> {
        &mut room.each
    }
    #[inline(always)]
    fn new(steps: f32) -> f32 {
        steps
    }
    #[inline(always)]
    fn get(self) -> f32 {
        self
    }
}

/// Record of a particle: the lowest 32 bits of its coordinates in steps, its radius and its number.
#[derive(Clone, Copy)]
pub(super) struct Record<const D: usize, R> {
    pub at: [u32; D],
    pub radius: R,
    pub id: u32,
}

impl<const D: usize, R: Size> Record<D, R> {
    pub fn prepare(room: &mut Room<D>, count: usize) {
        at_least(R::room(room), count, Record { at: [0; D], radius: R::default(), id: 0 });
    }
}

/// Space for the records of a bundle while they are sorted.
pub(super) struct Room<const D: usize> {
    uniform: Vec<Record<D, ()>>,
    each: Vec<Record<D, f32>>,
}

impl<const D: usize> Default for Room<D> {
    fn default() -> Room<D> {
        Room { uniform: Vec::new(), each: Vec::new() }
    }
}

/// Marks the first block of a list, which has no block before it.
const NONE: u32 = u32::MAX;

pub(super) struct Lists<const D: usize, R> {
    records: Array<Record<D, R>>,
    /// For each block, the block before it in the same list.
    before: Vec<u32>,
    /// For each list, the place of its next record. The place always exists: when a block is full,
    /// the list gets a new one at once.
    next: Vec<u32>,
    /// Base-2 logarithm of the number of records per block.
    block: u32,
}

impl<const D: usize, R> Default for Lists<D, R> {
    fn default() -> Self {
        Lists { records: Array::EMPTY, before: Vec::new(), next: Vec::new(), block: 0 }
    }
}

struct Blocks {
    /// Base-2 logarithm of the number of records per block.
    block: u32,
    blocks: usize,
    records: usize,
}

impl Blocks {
    fn new(n: usize, lists: usize) -> Blocks {
        if lists == 1 {
            // A single list has one block that is never full.
            return Blocks { block: u32::BITS - 1, blocks: 1, records: n + 1 };
        }
        // Eight blocks per list on average waste a sixteenth of the space.
        let block = (n / lists.max(1) / 8).next_power_of_two().clamp(16, 1024).trailing_zeros();
        let blocks = (n >> block) + lists;
        Blocks { block, blocks, records: blocks << block }
    }
}

impl<const D: usize, R: Size> Lists<D, R> {
    pub fn bytes(n: usize, lists: usize) -> u64 {
        let Blocks { blocks, records, .. } = Blocks::new(n, lists);
        Array::<Record<D, R>>::bytes(records) + (4 * blocks + 4 * lists) as u64
    }

    pub fn fill<T: Real>(
        &mut self,
        particles: &impl Particles<T, D>,
        range: Range<usize>,
        grid: &Grid<D>,
        plan: &Plan,
        level: Level,
    ) {
        let mut filling = self.begin(range.len(), plan);
        level.run(Fill {
            position: |id| particles.position(id),
            radius: |id| particles.radius(id),
            ids: range.start as u32..range.end as u32,
            grid,
            slabs: plan.slabs,
            lists: self,
            filling: &mut filling,
        });
        filling.end(grid);
    }

    /// Makes the lists empty, with space for `n` particles.
    pub fn begin(&mut self, n: usize, plan: &Plan) -> Filling<D> {
        let lists = plan.slabs;
        let Blocks { block, blocks, records } = Blocks::new(n, lists);
        self.block = block;
        self.records.at_least(records);
        at_least(&mut self.before, blocks, NONE);
        // Lists of an earlier call have no places in a new array.
        self.next.truncate(lists);
        at_least(&mut self.next, lists, 0);
        for (list, next) in self.next[..lists].iter_mut().enumerate() {
            *next = (list as u32) << block;
            self.before[list] = NONE;
        }
        Filling { block, layers: plan.layers, free: lists as u32, most: [0; D] }
    }

    #[inline(always)]
    pub fn push(
        &mut self,
        filling: &mut Filling<D>,
        grid: &Grid<D>,
        position: [f64; D],
        radius: f64,
        id: u32,
    ) {
        let steps = grid.steps(position);
        let radius = if R::EACH { R::new(grid.length(radius) as f32) } else { R::default() };
        filling.most = fill(|k| filling.most[k].max(steps[k]));
        let list = (steps[D - 1] >> (grid.bits + filling.layers)) as usize;
        debug_assert!(!grid.flat, "a flat grid of discs has one list");
        self.put(filling, list, Record { at: fill(|k| steps[k] as u32), radius, id });
    }

    #[inline(always)]
    fn put(&mut self, filling: &mut Filling<D>, list: usize, record: Record<D, R>) {
        let next = &mut self.next[list];
        self.records[*next as usize].write(record);
        let full = (1 << filling.block) - 1;
        if *next & full == full {
            self.before[filling.free as usize] = *next >> filling.block;
            *next = filling.free << filling.block;
            filling.free += 1;
            prefetch_to_write(&self.records, *next as usize);
        } else {
            prefetch_to_write(&self.records, *next as usize + 4);
            *next += 1;
        }
    }

    /// Returns the blocks of a list, last block first.
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
            // Unused if `block` is NONE, which is larger than any block number.
            end = block.wrapping_add(1) << self.block;
            // SAFETY: a record is written to each place before `next` moves beyond it.
            Some(unsafe { records.assume_init_ref() })
        })
    }

    pub fn len(&self, list: usize) -> usize {
        self.blocks(list).map(<[_]>::len).sum()
    }
}

/// Number of particles that are converted to steps together.
const TOGETHER: usize = 64;

struct Fill<'a, P, Q, R, const D: usize> {
    position: P,
    radius: Q,
    ids: Range<u32>,
    grid: &'a Grid<D>,
    slabs: usize,
    lists: &'a mut Lists<D, R>,
    filling: &'a mut Filling<D>,
}

impl<P, Q, R: Size, const D: usize> Kernel for Fill<'_, P, Q, R, D>
where
    P: Fn(u32) -> [f64; D],
    Q: Fn(u32) -> f64,
{
    type Output = ();

    #[inline(always)]
    fn run<W: Wide>(self, _: W) {
        let Fill { position, radius, ids, grid, slabs, lists, filling } = self;
        let shift = grid.bits + filling.layers;
        let mut filled = *filling;
        let (mut at, mut steps) = ([[0.0; TOGETHER]; D], [[0; TOGETHER]; D]);
        for first in ids.clone().step_by(TOGETHER) {
            let many = TOGETHER.min((ids.end - first) as usize);
            for k in 0..many {
                let position = position(first + k as u32);
                for (axis, at) in at.iter_mut().enumerate() {
                    at[k] = position[axis];
                }
            }
            for (axis, steps) in steps.iter_mut().enumerate() {
                let from = &at[grid.axis(axis)];
                for (steps, &x) in steps.iter_mut().zip(from) {
                    *steps = grid.along(axis, x);
                }
                for &steps in &steps[..many] {
                    filled.most[axis] = filled.most[axis].max(steps);
                }
            }
            let record = |k: usize| {
                let id = first + k as u32;
                let radius =
                    if R::EACH { R::new(grid.length(radius(id)) as f32) } else { R::default() };
                Record { at: fill(|axis| steps[axis][k] as u32), radius, id }
            };
            if let [next] = &mut lists.next[..slabs] {
                let places = lists.records[*next as usize..][..many].iter_mut();
                (0..many).zip(places).for_each(|(k, place)| {
                    place.write(record(k));
                });
                *next += many as u32;
            } else {
                for (k, &along_last) in steps[D - 1][..many].iter().enumerate() {
                    lists.put(&mut filled, (along_last >> shift) as usize, record(k));
                }
            }
        }
        *filling = filled;
    }
}

/// State of the lists while they are filled; it is separate so that it fits in registers.
#[derive(Clone, Copy)]
pub(super) struct Filling<const D: usize> {
    block: u32,
    layers: u32,
    free: u32,
    most: [u64; D],
}

impl<const D: usize> Filling<D> {
    /// Checks that all coordinates were inside the grid; must be called after the last particle.
    pub fn end(self, grid: &Grid<D>) {
        // The kernel relies on coordinates inside the grid without further checks. They may be
        // outside if positions in `Particles` have changed since the grid was made.
        assert!(
            (0..D).all(|k| self.most[k] >> grid.bits < grid.count[k]),
            "positions changed during a detection"
        );
    }
}
