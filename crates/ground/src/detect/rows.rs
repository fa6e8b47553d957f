//! Neighbouring rows of cells, and a hash of cells.

/// Steps along y and z from a row to the neighbouring rows that come after it. Exactly one of two
/// neighbouring rows comes after the other.
pub const ROWS: [[i32; 2]; 4] = [[1, 0], [-1, 1], [0, 1], [1, 1]];

/// Returns the steps to the rows after a row in `D` dimensions; in 2D there is one.
pub const fn rows_after<const D: usize>() -> &'static [[i32; 2]] {
    if D == 2 { ROWS.split_at(1).0 } else { &ROWS }
}

/// Hashes a cell; the highest bits are the most random. The hash mixes the sum of the coordinates,
/// each multiplied by a large odd number.
#[inline(always)]
pub fn mixed<const D: usize>(cell: [u32; D]) -> u64 {
    let factors = [0x9e37_79b9_7f4a_7c15u64, 0xc2b2_ae3d_27d4_eb4f, 0x1656_67b1_9e37_79f9];
    let mut sum = 0u64;
    for k in 0..D {
        sum = sum.wrapping_add(u64::from(cell[k]).wrapping_mul(factors[k]));
    }
    (sum ^ (sum >> 32)).wrapping_mul(0xd6e8_feb8_6659_fd93)
}
