//! One bundle of layers, sorted by cell into arrays that stay in cache.

use super::lists::{Lists, Size, at_least};
use super::pair_sink::PairSink;
use super::plan::Plan;
use crate::probe::Op;
use crate::wide::LANES;

/// The particles of a slab, in the order of their cells.
pub(super) struct Slab<const D: usize> {
    /// Coordinates in steps: along x from the grid's origin, along the others from the origin of
    /// the cell.
    pub lanes: [Vec<f32>; D],
    /// Radii in steps, where each particle has its own.
    pub radii: Vec<f32>,
    pub ids: Vec<u32>,
    /// The cell of each.
    pub cells: Vec<u32>,
    /// For each cell the place of its first particle.
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
    /// Heap needed for so many particles and cells.
    pub fn bytes(particles: usize, cells: usize, each: bool) -> u64 {
        (4 * (D + 2 + usize::from(each)) * (particles + LANES) + 4 * (cells + 2)) as u64
    }

    /// Room for so many particles and cells. A vector may be loaded from any place up to the last
    /// particle.
    pub fn prepare(&mut self, particles: usize, cells: usize, each: bool) {
        self.lanes.iter_mut().for_each(|lane| at_least(lane, particles + LANES, 0.0));
        at_least(&mut self.ids, particles + LANES, 0);
        at_least(&mut self.cells, particles + LANES, 0);
        if each {
            at_least(&mut self.radii, particles + LANES, 0.0);
        }
        at_least(&mut self.begin, cells + 2, 0);
    }

    /// Makes the slab hold a list, sorted by cell: counts, then places.
    pub fn fill<R: Size>(
        &mut self,
        lists: &[Lists<D, R>],
        list: Option<usize>,
        plan: &Plan,
        sink: &mut dyn PairSink,
    ) {
        let begin = &mut self.begin[..plan.cells() + 2];
        begin.fill(0);
        let blocks = || {
            list.into_iter().flat_map(|list| lists.iter().flat_map(move |lists| lists.blocks(list)))
        };
        for block in blocks() {
            for record in block {
                begin[plan.cell(record.at) + 2] += 1;
            }
        }
        let mut sum = 0;
        for begin in begin.iter_mut() {
            sum += *begin;
            *begin = sum;
        }
        self.len = sum as usize;
        sink.count(Op::Move, u64::from(sum));
        let fraction = (1 << plan.bits) - 1;
        for block in blocks() {
            for record in block {
                let cell = plan.cell(record.at);
                let at = begin[cell + 1] as usize;
                begin[cell + 1] += 1;
                self.lanes[0][at] = record.at[0] as f32;
                for k in 1..D {
                    self.lanes[k][at] = (record.at[k] & fraction) as f32;
                }
                if R::EACH {
                    self.radii[at] = record.radius.get();
                }
                self.ids[at] = record.id;
                self.cells[at] = cell as u32;
            }
        }
    }
}
