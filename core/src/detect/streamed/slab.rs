//! One bundle of layers, sorted by cell into arrays that stay in cache.

use super::grid::Grid;
use super::kernel::Take;
use super::lists::{Lists, Record, Size, at_least};
use crate::probe::Op;
use crate::wide::LANES;

/// How cells are numbered in a slab: cells of a row side by side, rows of a layer one after the other, layers likewise.
///
/// ```text
///   3D, a layer of 3 x 2 cells:    b b b b      b: borders, always empty; a row ends where the border of the next begins
///                                  b o o o
///                                  b o o o
///                                  b b b b b
/// ```
#[derive(Clone, Copy, Debug)]
pub(super) struct Plan {
    /// Bits of the fraction of a coordinate.
    pub bits: u32,
    /// From a cell to the one in the next row.
    pub row: usize,
    /// From a cell to the one in the next layer.
    pub layer: usize,
    /// Log2 of the layers in a slab.
    pub layers: u32,
    /// Slabs.
    pub slabs: usize,
}

/// Elements of a slab, in the mean and at the most, for which the arrays fit the caches.
const ELEMENTS: usize = 4096;

impl Plan {
    /// Cells of a slab, borders included.
    pub fn cells(&self) -> usize {
        (self.layer << self.layers) + 1
    }

    /// For the cells of a grid and `n` elements.
    pub fn new<const D: usize>(grid: &Grid<D>, n: usize) -> Plan {
        let count = grid.count.map(|count| count as usize);
        let row = count[0] + 1;
        let layer = if D == 2 { row } else { row * (count[1] + 2) };
        let all = count[D - 1];
        let layers = (all * ELEMENTS / n.max(1)).clamp(1, all.next_power_of_two()).ilog2();
        // The layer in its bundle must be known from the 32 bits of a coordinate.
        let layers = layers.min(32 - grid.bits);
        Plan { bits: grid.bits, row, layer, layers, slabs: all.div_ceil(1 << layers) }
    }

    #[inline(always)]
    fn cell<const D: usize, R>(&self, record: &Record<D, R>) -> usize {
        let x = (record.at[0] >> self.bits) as usize + 1;
        let layer = (record.at[D - 1] >> self.bits) as usize & ((1 << self.layers) - 1);
        let row = if D == 2 { 0 } else { ((record.at[1] >> self.bits) as usize + 1) * self.row };
        layer * self.layer + row + x
    }
}

/// The elements of a slab, in the order of their cells.
pub(super) struct Slab<const D: usize> {
    /// Coordinates in steps: along x from the grid's origin, along the others from the origin of the cell.
    pub lanes: [Vec<f32>; D],
    /// Radii in steps, where each element has its own.
    pub radii: Vec<f32>,
    pub ids: Vec<u32>,
    /// The cell of each.
    pub cells: Vec<u32>,
    /// For each cell the place of its first element.
    pub begin: Vec<u32>,
    pub len: usize,
}

impl<const D: usize> Default for Slab<D> {
    fn default() -> Self {
        let lanes = std::array::from_fn(|_| Vec::new());
        Slab { lanes, radii: Vec::new(), ids: Vec::new(), cells: Vec::new(), begin: Vec::new(), len: 0 }
    }
}

impl<const D: usize> Slab<D> {
    /// Heap needed for so many elements and cells.
    pub fn bytes(elements: usize, cells: usize, each: bool) -> u64 {
        (4 * (D + 2 + usize::from(each)) * (elements + LANES) + 4 * (cells + 2)) as u64
    }

    /// Room for so many elements and cells. A vector may be loaded from any place up to the last element.
    pub fn prepare(&mut self, elements: usize, cells: usize, each: bool) {
        self.lanes.iter_mut().for_each(|lane| at_least(lane, elements + LANES, 0.0));
        at_least(&mut self.ids, elements + LANES, 0);
        at_least(&mut self.cells, elements + LANES, 0);
        if each {
            at_least(&mut self.radii, elements + LANES, 0.0);
        }
        at_least(&mut self.begin, cells + 2, 0);
    }

    /// Makes the slab hold a list, sorted by cell: counts, then places.
    pub fn fill<R: Size>(&mut self, lists: &[Lists<D, R>], list: Option<usize>, plan: &Plan, take: &mut dyn Take) {
        let begin = &mut self.begin[..plan.cells() + 2];
        begin.fill(0);
        let blocks = || list.into_iter().flat_map(|list| lists.iter().flat_map(move |lists| lists.of(list)));
        for block in blocks() {
            for record in block {
                begin[plan.cell(record) + 2] += 1;
            }
        }
        let mut sum = 0;
        for begin in begin.iter_mut() {
            sum += *begin;
            *begin = sum;
        }
        self.len = sum as usize;
        take.count(Op::Move, u64::from(sum));
        let fraction = (1 << plan.bits) - 1;
        for block in blocks() {
            for record in block {
                let cell = plan.cell(record);
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
