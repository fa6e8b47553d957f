//! The ranges of particles that can touch a particle.
//!
//! Half of the cells around a particle are enough. They form few contiguous ranges, because the
//! cells of a row are adjacent:
//!
//! ```text
//!   2D:  next row   1 1 1         3D:  next layer  2 2 2      this layer   . . .
//!        this row   . 0 0                          3 3 3                   . 0 0
//!                                                  4 4 4                   1 1 1
//! ```
//!
//! Range 0 begins after the particle itself. A slab may divide the cells along x into parts
//! ([`super::plan`]). Touching particles are then at most as many of its cells apart as a cell of
//! the grid has parts: their coordinates differ by less than a cell of the grid
//! ([`super::grid`]). A
//! flat grid does not divide the second axis, so its ranges in 3D are those shown for 2D; in 2D it
//! has range 0 only.

use super::plan::Plan;
use super::slab::Slab;
use super::unchecked::element;

/// Begin and length of each range of candidates for a particle. The first one or two ranges are in
/// the particle's layer, the others in the next layer.
pub(super) type Ranges = [(u32, u32); 5];

/// Returns the bitwise or of the lengths. All lengths are below a power of two exactly if the
/// result is.
#[inline(always)]
pub(super) fn lengths(ranges: &Ranges) -> u32 {
    ranges.iter().fold(0, |all, &(_, len)| all | len)
}

/// Number of axes that are divided into cells.
const fn axes<F: Find, const D: usize>() -> usize {
    if F::FLAT { D - 1 } else { D }
}

/// Number of the five ranges that are used.
pub(super) const fn ranges_used<F: Find, const D: usize>() -> usize {
    [0, 1, 2, 5][axes::<F, D>()]
}

/// Returns whether range `r` is in the next layer.
pub(super) const fn in_next<F: Find, const D: usize>(r: usize) -> bool {
    r + 1 >= axes::<F, D>() && axes::<F, D>() > 1
}

pub(super) trait Find: Copy {
    /// Number of steps after which x wraps around, if it does.
    const TURN: Option<f32>;
    /// Whether the second axis is not divided into cells.
    const FLAT: bool;
    fn ranges<const D: usize>(&self, at: usize) -> Ranges;
}

#[derive(Clone, Copy)]
pub(super) struct ByCells<'a, const FLAT: bool> {
    cells: &'a [u32],
    begin: &'a [u32],
    next: &'a [u32],
    row: usize,
    /// Largest distance between touching particles along x, in cells.
    parts: usize,
    /// Offset from a cell to the cell in the next layer.
    to_next: isize,
}

impl<'a, const FLAT: bool> ByCells<'a, FLAT> {
    /// Creates a finder for `slab`; the next layer is in `next`, at an offset of `to_next` cells.
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
            parts: 1 << plan.parts,
            to_next,
        }
    }
}

impl<const FLAT: bool> Find for ByCells<'_, FLAT> {
    const TURN: Option<f32> = None;
    const FLAT: bool = FLAT;

    #[inline(always)]
    fn ranges<const D: usize>(&self, at: usize) -> Ranges {
        // SAFETY: `at` is the place of a particle, and `cells` has an entry for each particle.
        let cell = unsafe { element(self.cells, at) } as usize;
        // Returns begin and length of the range of cells in a row that are near `cell`.
        let near = |begin: &[u32], cell: usize| {
            // SAFETY: `cell` is the cell of a particle or a neighbour in another row, at the same x
            // >= `parts`. Its row exists, because borders surround all cells with particles.
            let first = unsafe { element(begin, cell - self.parts) };
            // SAFETY: as for `first`; `begin` has one more entry after the last border.
            (first, unsafe { element(begin, cell + self.parts + 1) } - first)
        };
        let next = cell.wrapping_add_signed(self.to_next);
        // SAFETY: borders follow the particle's cell, and `begin` has an entry for their end.
        let own_end = unsafe { element(self.begin, cell + self.parts + 1) };
        let own = (at as u32 + 1, own_end - (at as u32 + 1));
        match axes::<Self, D>() {
            1 => return [own, (0, 0), (0, 0), (0, 0), (0, 0)],
            2 => return [own, near(self.next, next), (0, 0), (0, 0), (0, 0)],
            _ => {}
        }
        [
            own,
            near(self.begin, cell + self.row),
            near(self.next, next - self.row),
            near(self.next, next),
            near(self.next, next + self.row),
        ]
    }
}
