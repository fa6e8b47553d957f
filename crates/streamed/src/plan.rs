//! Number of layers in a bundle, and numbering of the cells in its slab.

use super::grid::Grid;

/// Numbering of the cells in a slab: the cells of a row are adjacent, then the rows of a layer,
/// then the layers. A slab may divide the cells of the grid along x, see [`PARTS`].
///
/// ```text
///   3D, a layer of 3 x 2 cells:    b b b b      b: borders, always empty;
///                                  b o o o      a row ends where the border of the next begins
///                                  b o o o
///                                  b b b b b
/// ```
#[derive(Clone, Copy, Debug)]
pub(super) struct Plan {
    /// Number of fraction bits of a coordinate.
    pub bits: u32,
    /// Base-2 logarithm of the number of a slab's cells along x in a cell of the grid.
    pub parts: u32,
    /// Offset from a cell to the cell in the next row; 0 if a layer is one row.
    pub row: usize,
    /// Offset from a cell to the cell in the next layer.
    pub layer: usize,
    /// Base-2 logarithm of the number of layers in a slab.
    pub layers: u32,
    pub slabs: usize,
    /// Whether cells along the second axis are merged ([`Grid::flat`]).
    pub flat: bool,
}

/// Number of particles per slab for which the slab's arrays fit in the caches.
const PARTICLES: usize = 4096;
/// Mean numbers of particles per cell from which cells have this many parts along x (base-2
/// logarithm), as measured. Among spheres with one to five per cell, shorter ranges need fewer
/// vectors; discs have fewer ranges and lose by it. In fuller cells, the particles of a part are
/// too few to share copies of candidates, until the tests saved outweigh this.
const PARTS: [(f64, u32); 4] = [(1.0, 1), (5.0, 0), (12.0, 1), (32.0, 2)];

impl Plan {
    /// Returns the number of cells of a slab, borders included.
    pub fn cells(&self) -> usize {
        (self.layer << self.layers) + (1 << self.parts)
    }

    pub fn new<const D: usize>(grid: &Grid<D>, n: usize) -> Plan {
        let count = grid.count.map(|count| count as usize);
        let one_row = D == 2 || grid.flat;
        let cells = grid.count.iter().map(|&count| count as f64).product::<f64>();
        let full = |&&(least, _): &&(f64, u32)| n as f64 >= least * cells;
        let parts =
            PARTS.iter().skip(usize::from(D == 2)).rfind(full).map_or(0, |&(_, parts)| parts);
        let row = (count[0] + 1) << parts;
        let layer = if one_row { row } else { row * (count[1] + 2) };
        let all = if D == 2 && grid.flat { 1 } else { count[D - 1] };
        let layers = (all * PARTICLES / n.max(1)).clamp(1, all.next_power_of_two()).ilog2();
        // The 32 bits of a coordinate must determine the layer within its bundle.
        let layers = layers.min(32 - grid.bits);
        let row = if one_row { 0 } else { row };
        let slabs = all.div_ceil(1 << layers);
        Plan { bits: grid.bits, parts, row, layer, layers, slabs, flat: grid.flat }
    }

    /// Returns the cell number of a particle, from the lowest 32 bits of its coordinates.
    #[inline(always)]
    pub fn cell<const D: usize>(&self, at: [u32; D]) -> u32 {
        // The type is u32, like the coordinates, so that vectors of both have the same length.
        let (per_row, per_layer) = (self.row as u32, self.layer as u32);
        let x = (at[0] >> (self.bits - self.parts)) + (1 << self.parts);
        let layer = (at[D - 1] >> self.bits) & ((1 << self.layers) - 1);
        let row = if D == 2 { 0 } else { ((at[1] >> self.bits) + 1).wrapping_mul(per_row) };
        layer.wrapping_mul(per_layer).wrapping_add(row).wrapping_add(x)
    }
}
