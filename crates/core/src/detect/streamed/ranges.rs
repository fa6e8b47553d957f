//! The ranges of particles that can touch a particle.
//!
//! Half of the cells around a particle are enough, and they are few contiguous ranges, since the
//! cells of a row are side by side:
//!
//! ```text
//!   2D:  next row   1 1 1         3D:  next layer  2 2 2      this layer   . . .
//!        this row   . 0 0                          3 3 3                   . 0 0
//!                                                  4 4 4                   1 1 1
//! ```
//!
//! Range 0 begins after the particle itself. In the flat form the second axis has no
//! cells: ranges are as in 2D, and in 2D the first alone is left.

use super::plan::Plan;
use super::slab::Slab;
use super::unchecked::element;

/// Where the particles are that are to be tested against a particle: beginning and length of each
/// range, the first one or two in the slab of the particle, the others in the next.
pub(super) type Ranges = [(u32, u32); 5];

/// The dimensions of the grid of cells in which `F` finds ranges.
const fn axes<F: Find, const D: usize>() -> usize {
    if F::FLAT { D - 1 } else { D }
}

/// So many ranges there are.
pub(super) const fn ranges_used<F: Find, const D: usize>() -> usize {
    [0, 1, 2, 5][axes::<F, D>()]
}

/// Whether range `r` is in the next layer.
pub(super) const fn in_next<F: Find, const D: usize>(r: usize) -> bool {
    r + 1 >= axes::<F, D>() && axes::<F, D>() > 1
}

/// Finds the ranges of the particle at a place.
pub(super) trait Find: Copy {
    /// Coordinates along x begin again after this many steps.
    const TURN: Option<f32>;
    /// Has the second axis no cells?
    const FLAT: bool;
    /// The ranges.
    fn ranges<const D: usize>(&self, at: usize) -> Ranges;
}

/// By the cells of a grid.
#[derive(Clone, Copy)]
pub(super) struct ByCells<'a, const FLAT: bool> {
    cells: &'a [u32],
    begin: &'a [u32],
    next: &'a [u32],
    row: usize,
    /// From the number of a cell to that of the one in the next layer.
    to_next: isize,
}

impl<'a, const FLAT: bool> ByCells<'a, FLAT> {
    /// For particles of `slab` whose next layer is in `next`, `to_next` cells away.
    pub fn new<const D: usize>(
        plan: &Plan,
        slab: &'a Slab<D>,
        next: &'a Slab<D>,
        to_next: isize,
    ) -> ByCells<'a, FLAT> {
        ByCells {
            cells: &slab.cells,
            begin: &slab.begin,
            next: &next.begin,
            row: plan.row,
            to_next,
        }
    }
}

impl<const FLAT: bool> Find for ByCells<'_, FLAT> {
    const TURN: Option<f32> = None;
    const FLAT: bool = FLAT;

    #[inline(always)]
    fn ranges<const D: usize>(&self, at: usize) -> Ranges {
        // SAFETY: `at` is the place of a particle, and `cells` has an entry for each.
        let cell = unsafe { element(self.cells, at) } as usize;
        // Three cells side by side, around this one.
        let three = |begin: &[u32], cell: usize| {
            // SAFETY: `cell` is in a row beside a particle's, at the particle's x >= 1, and rows
            // beside have numbers: borders surround all cells with particles.
            let first = unsafe { element(begin, cell - 1) };
            // SAFETY: likewise; after the last border `begin` has an entry more.
            (first, unsafe { element(begin, cell + 2) } - first)
        };
        let next = cell.wrapping_add_signed(self.to_next);
        // SAFETY: a border follows the particle's cell, and `begin` has an entry for where it ends.
        let own_end = unsafe { element(self.begin, cell + 2) };
        let own = (at as u32 + 1, own_end - (at as u32 + 1));
        match axes::<Self, D>() {
            1 => return [own, (0, 0), (0, 0), (0, 0), (0, 0)],
            2 => return [own, three(self.next, next), (0, 0), (0, 0), (0, 0)],
            _ => {}
        }
        [
            own,
            three(self.begin, cell + self.row),
            three(self.next, next - self.row),
            three(self.next, next),
            three(self.next, next + self.row),
        ]
    }
}
