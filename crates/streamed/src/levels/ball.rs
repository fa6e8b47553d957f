//! The cells of a bundle within reach of a visitor, as patches of adjacent rows.

use super::visits::Host;
use crate::grid::Grid;
use crate::plan::Plan;

/// Rows in which a reach exceeds this many cells are shortened to chords, two rows at a time.
const CLIP: f64 = 4.0;
/// 2^52: adding it to a smaller number leaves the nearest integer in the lowest bits.
const WHOLE: f64 = (1u64 << 52) as f64;

/// A larger particle in steps of the visited grid.
pub struct Visitor<const D: usize> {
    pub at: [f64; D],
    /// Largest distance at which a particle of the visited class can touch the visitor.
    pub reach: f64,
    pub radius: f32,
    /// Bound on the errors of distances, like [`Bounds::grow`](crate::bounds::Bounds).
    pub grow: f32,
    pub id: u32,
}

/// Adjacent rows of a layer within reach of a visitor, with the same cells along x.
#[derive(Clone, Copy)]
pub struct Patch<const D: usize> {
    /// First cell of the first row, number of cells in a row, and number of rows.
    pub first: u32,
    pub cells: u32,
    pub rows: u32,
    /// The visitor's coordinates in steps, relative to the first row, apart from x.
    pub at: [f32; D],
    /// The visitor's radius plus `grow`.
    pub radius: f32,
    pub grow: f32,
    pub id: u32,
}

impl<const D: usize> Patch<D> {
    pub const EMPTY: Patch<D> =
        Patch { first: 0, cells: 0, rows: 0, at: [0.0; D], radius: 0.0, grow: 0.0, id: 0 };
}

/// Returns the larger number, or `b` if `a` is NaN. `f64::max` has to check both.
#[inline(always)]
pub fn max(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// Returns the smaller number, or `b` if `a` is NaN.
#[inline(always)]
fn min(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// Returns the first and the last cell within a distance of `x` on an axis of this many steps.
#[inline(always)]
fn cells(steps: f64, bits: u32, x: f64, distance: f64) -> (usize, usize) {
    let top = steps - 1.0;
    // The exponent of the sum is in bits 52 and above, so beyond the 32 bits that are kept.
    let cell = |x: f64| ((x + WHOLE).to_bits() >> bits) as u32 as usize;
    // For NaN the lower limit is the first cell, the upper limit the last.
    (cell(min(max(x - distance, 0.0), top)), cell(max(min(x + distance, top), 0.0)))
}

impl<const D: usize> Host<'_, D> {
    /// Calls `add` for each patch of a bundle's cells within reach of a visitor.
    #[inline(always)]
    pub fn ball(
        &self,
        bundle: usize,
        steps: &[f64; D],
        visitor: &Visitor<D>,
        mut add: impl FnMut(Patch<D>),
    ) {
        let Host { grid, plan, .. } = *self;
        let Visitor { at, reach, .. } = *visitor;
        if (0..D).any(|k| at[k] + reach < 0.0 || at[k] - reach > steps[k]) {
            return;
        }
        let one = (1u64 << grid.bits) as f64;
        let ball = Ball { grid, plan, steps, visitor, one, wide: reach > CLIP * one };
        let square = reach * reach * (1.0 + 1.0 / (1u64 << 48) as f64);
        let (first, last) = ball.cells(D - 1, reach);
        let begin = bundle << plan.layers;
        let (first, last) = (first.max(begin), last.min(begin + (1 << plan.layers) - 1));
        if D == 2 {
            // Each layer is a single row.
            let offset = (first - begin) * plan.layer + (1 << plan.parts);
            let layer = Layer { left: square, root: reach, z: 0.0, offset, stride: plan.layer };
            ball.rows(layer, (first, last), &mut add);
            return;
        }
        for layer in first..=last {
            let (of_layer, z) = ball.gap_to(D - 1, layer);
            let left = square - of_layer;
            if left < 0.0 {
                continue;
            }
            let root = left.sqrt();
            let among = ball.cells(1, root);
            let row = (among.0 + 1) * plan.row + (1 << plan.parts);
            let offset = (layer - begin) * plan.layer + row;
            ball.rows(Layer { left, root, z, offset, stride: plan.row }, among, &mut add);
        }
    }
}

/// The cells of a bundle within reach of a visitor.
struct Ball<'a, const D: usize> {
    grid: &'a Grid<D>,
    plan: &'a Plan,
    /// Number of steps along each axis.
    steps: &'a [f64; D],
    visitor: &'a Visitor<D>,
    /// Edge of a cell in steps.
    one: f64,
    /// Whether rows are shortened to chords.
    wide: bool,
}

struct Layer {
    /// Squared reach minus squared gap to the layer.
    left: f64,
    /// Square root of `left`.
    root: f64,
    /// Offset of the visitor from the layer's origin.
    z: f32,
    /// Index of the first cell of the first row.
    offset: usize,
    /// Number of cells from one row to the next.
    stride: usize,
}

impl<const D: usize> Ball<'_, D> {
    #[inline(always)]
    fn cells(&self, axis: usize, distance: f64) -> (usize, usize) {
        let parts = if axis == 0 { self.plan.parts } else { 0 };
        cells(self.steps[axis], self.grid.bits - parts, self.visitor.at[axis], distance)
    }

    /// Returns the squared distance of the visitor from a cell along an axis, and its offset from
    /// the cell's origin.
    #[inline(always)]
    fn gap_to(&self, axis: usize, cell: usize) -> (f64, f32) {
        let origin = self.visitor.at[axis] - cell as f64 * self.one;
        let gap = max(max(-origin, origin - self.one), 0.0);
        (gap * gap, origin as f32)
    }

    /// Adds the patches of rows in a layer.
    #[inline(always)]
    fn rows(
        &self,
        Layer { left, root, z, mut offset, stride }: Layer,
        (mut row, last): (usize, usize),
        add: &mut impl FnMut(Patch<D>),
    ) {
        let Visitor { at, radius, grow, id, .. } = *self.visitor;
        while row <= last {
            let next = last.min(row + 1);
            let ((of_row, y), (of_next, _)) = (self.gap_to(1, row), self.gap_to(1, next));
            let (rows, chord) = if self.wide {
                (next + 1 - row, max(left - min(of_row, of_next), 0.0).sqrt())
            } else {
                (last + 1 - row, root)
            };
            let (from, to) = self.cells(0, chord);
            let mut patch = Patch {
                first: (offset + from) as u32,
                cells: (to + 1 - from) as u32,
                rows: rows as u32,
                at: [at[0] as f32; D],
                radius: radius + grow,
                grow,
                id,
            };
            patch.at[D - 1] = z;
            patch.at[1] = y;
            add(patch);
            row += rows;
            offset += rows * stride;
        }
    }
}
