//! One bundle of layers, sorted by cell into arrays that stay in cache.

use super::PairSink;
use super::lists::{Lists, Record, Size};
use super::plan::Plan;
use contactbench_ground::limits::refusal::at_least;
use contactbench_ground::probe::Op;
use contactbench_ground::wide::{Kernel, LANES, Level, Wide};

pub(super) struct Slab<const D: usize> {
    /// Coordinates in steps. They count from the grid's origin along x and along the second axis of
    /// a flat grid, from the origin of the cell along other axes.
    pub lanes: [Vec<f32>; D],
    /// Radii in steps, if particles have individual radii.
    pub radii: Vec<f32>,
    pub ids: Vec<u32>,
    pub cells: Vec<u32>,
    /// Place of the first particle of each cell.
    pub begin: Vec<u32>,
    pub len: usize,
}

impl<const D: usize> Default for Slab<D> {
    fn default() -> Self {
        let lanes = std::array::from_fn(|_| Vec::new());
        Slab {
            lanes,
            radii: Vec::new(),
            ids: Vec::new(),
            cells: Vec::new(),
            begin: Vec::new(),
            len: 0,
        }
    }
}

impl<const D: usize> Slab<D> {
    pub fn bytes(particles: usize, cells: usize, each: bool) -> u64 {
        (4 * (D + 2 + usize::from(each)) * (particles + LANES) + 4 * (cells + 2)) as u64
    }

    /// Returns the coordinates along an axis, or the radii if `axis` is D.
    #[inline(always)]
    pub fn lane(&self, axis: usize) -> &[f32] {
        if axis < D { &self.lanes[axis] } else { &self.radii }
    }

    /// Makes space for this many particles and cells; a vector can be loaded from any particle's
    /// place.
    pub fn prepare(&mut self, particles: usize, cells: usize, each: bool) {
        self.lanes.iter_mut().for_each(|lane| at_least(lane, particles + LANES, 0.0));
        at_least(&mut self.ids, particles + LANES, 0);
        at_least(&mut self.cells, particles + LANES, 0);
        if each {
            at_least(&mut self.radii, particles + LANES, 0.0);
        }
        at_least(&mut self.begin, cells + 2, 0);
    }

    pub fn fill<R: Size>(
        &mut self,
        lists: &[Lists<D, R>],
        list: Option<usize>,
        plan: &Plan,
        level: Level,
        room: &mut [Record<D, R>],
        sink: &mut dyn PairSink,
    ) {
        level.run(Fill { slab: self, lists, list, plan, room });
        sink.count(Op::Move, self.len as u64);
    }
}

/// Sorts a list into a slab by counting. Whole records are moved first: each move writes to one
/// place in memory instead of one per array.
struct Fill<'a, R, const D: usize> {
    slab: &'a mut Slab<D>,
    lists: &'a [Lists<D, R>],
    list: Option<usize>,
    plan: &'a Plan,
    room: &'a mut [Record<D, R>],
}

impl<R: Size, const D: usize> Kernel for Fill<'_, R, D> {
    type Output = ();

    #[inline(always)]
    fn run<W: Wide>(self, _: W) {
        let Fill { slab, lists, list, plan, room } = self;
        let Slab { lanes, radii, ids, cells, begin, len } = slab;
        let blocks = || {
            list.into_iter().flat_map(|list| lists.iter().flat_map(move |lists| lists.blocks(list)))
        };
        // If `list` is `None`, only the first layer is read.
        let cells_used = if list.is_some() { plan.cells() } else { plan.layer + (1 << plan.parts) };
        let begin = &mut begin[..cells_used + 2];
        begin.fill(0);
        *len = 0;
        for block in blocks() {
            // Cells in the order of the list; they are sorted below.
            let cells = &mut cells[*len..][..block.len()];
            for (cell, record) in cells.iter_mut().zip(block) {
                *cell = plan.cell(record.at);
            }
            for &cell in &*cells {
                begin[cell as usize + 2] += 1;
            }
            *len += block.len();
        }
        if *len == 0 {
            return;
        }
        let mut sum = 0;
        for begin in begin.iter_mut() {
            sum += *begin;
            *begin = sum;
        }
        let mut first = 0;
        for block in blocks() {
            for (record, &cell) in block.iter().zip(&cells[first..]) {
                let place = &mut begin[cell as usize + 1];
                room[*place as usize] = *record;
                *place += 1;
            }
            first += block.len();
        }
        // Arrays are filled one at a time, so that the compiler vectorises each loop.
        let sorted = &room[..*len];
        let fraction = (1 << plan.bits) - 1;
        for (k, lane) in lanes.iter_mut().enumerate() {
            let kept = if k == 0 || (k == 1 && plan.flat) { u32::MAX } else { fraction };
            for (x, record) in lane.iter_mut().zip(sorted) {
                *x = (record.at[k] & kept) as f32;
            }
        }
        if R::EACH {
            for (radius, record) in radii.iter_mut().zip(sorted) {
                *radius = record.radius.get();
            }
        }
        for (id, record) in ids.iter_mut().zip(sorted) {
            *id = record.id;
        }
        for (cell, record) in cells.iter_mut().zip(sorted) {
            *cell = plan.cell(record.at);
        }
    }
}
