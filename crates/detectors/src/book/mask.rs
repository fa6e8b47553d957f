//! The contact masks of the book: offsets of the cells that are checked with a central cell, so
//! that each pair of neighbouring cells is checked once.

use contactbench_ground::wide::fill;

/// Contact mask in 2D (page 93): the cell to the left and the three cells below.
pub const PLANE: [[i32; 2]; 4] = [[-1, 0], [-1, -1], [0, -1], [1, -1]];

/// Contact mask in 3D (page 121): the nine cells of the layer below, the three cells behind, the
/// cell to the left.
pub const SPACE: [[i32; 3]; 13] = [
    [-1, -1, -1],
    [0, -1, -1],
    [1, -1, -1],
    [-1, 0, -1],
    [0, 0, -1],
    [1, 0, -1],
    [-1, 1, -1],
    [0, 1, -1],
    [1, 1, -1],
    [-1, -1, 0],
    [0, -1, 0],
    [1, -1, 0],
    [-1, 0, 0],
];

/// Returns the cell at `offset` from `central`; empty border cells ensure that it exists.
#[inline(always)]
pub fn neighbour<const D: usize>(central: [u32; D], offset: [i32; D]) -> [u32; D] {
    fill(|k| central[k].wrapping_add_signed(offset[k]))
}

/// Implements `Detector` in one dimension, by the type's method `run` and the mask of that name.
macro_rules! detects_by_mask {
    ($detector:ty, $dim:literal, $mask:ident) => {
        impl<T: Real> Detector<T, $dim> for $detector {
            fn detect<B: Particles<T, $dim>, P: Probe, S: Sink>(
                &mut self,
                particles: B,
                probe: &mut P,
                sink: &mut S,
            ) -> Result<(), Refusal> {
                self.run(&particles, mask::$mask, probe, sink)
            }
        }
    };
}
pub(super) use detects_by_mask;

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    fn with_mirror<const D: usize>(mask: &[[i32; D]]) -> HashSet<[i32; D]> {
        mask.iter().flat_map(|offset| [*offset, offset.map(|d| -d)]).collect()
    }

    #[test]
    fn a_mask_and_its_mirror_are_all_neighbours_once() {
        assert_eq!(with_mirror(&PLANE).len(), 8);
        assert_eq!(with_mirror(&SPACE).len(), 26);
        assert!(!with_mirror(&PLANE).contains(&[0; 2]) && !with_mirror(&SPACE).contains(&[0; 3]));
    }
}
