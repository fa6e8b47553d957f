//! The scalars in which scenes are stored: `f32`, `f64`, and [`CellF32`], a cell number with an
//! `f32` offset.

use std::ops::{Add, Mul};

/// A scalar type in which scenes are stored.
pub trait Real:
    nalgebra::Scalar + Copy + PartialOrd + Default + Send + Sync + sealed::Sealed
{
    /// Type in which differences and sums of two numbers, and squares of these, are computed.
    type Work: Work;
    /// Name of the precision, for messages.
    const NAME: &'static str;
    /// Largest relative rounding error of one operation: half the distance from 1 to the next
    /// number of [`Real::Work`].
    const UNIT: f64;
    /// At least four times the square root of half the smallest subnormal of [`Real::Work`].
    const UNDERFLOW: f64;
    /// Returns the value in f64, without rounding.
    fn wide(self) -> f64;
    /// Rounds a length to this type.
    fn nearest(x: f64) -> Self;
    /// Rounds a coordinate to this type.
    fn place(x: f64) -> Self {
        Self::nearest(x)
    }
    /// Returns whether the value is neither NaN nor infinite.
    fn finite(self) -> bool;
    /// Returns self - other.
    fn minus(self, other: Self) -> Self::Work;
    /// Returns self + other.
    fn plus(self, other: Self) -> Self::Work;
}

/// A floating-point type in which contact tests compute.
pub trait Work:
    Copy + PartialOrd + Default + Add<Output = Self> + Mul<Output = Self> + Send + Sync
{
    /// Returns whether the value is neither NaN nor infinite.
    fn finite(self) -> bool;
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
    impl Sealed for super::CellF32 {}
}

macro_rules! floating_point {
    ($float:ident, $underflow:expr) => {
        impl Work for $float {
            fn finite(self) -> bool {
                self.is_finite()
            }
        }

        impl Real for $float {
            type Work = $float;
            const NAME: &'static str = stringify!($float);
            const UNIT: f64 = 1.0 / (1u64 << $float::MANTISSA_DIGITS) as f64;
            const UNDERFLOW: f64 = $underflow;
            #[inline(always)]
            fn wide(self) -> f64 {
                f64::from(self)
            }
            fn nearest(x: f64) -> $float {
                x as $float
            }
            fn finite(self) -> bool {
                self.is_finite()
            }
            #[inline(always)]
            fn minus(self, other: $float) -> $float {
                self - other
            }
            #[inline(always)]
            fn plus(self, other: $float) -> $float {
                self + other
            }
        }
    };
}

floating_point!(f32, f64::from_bits((1023 - 73) << 52)); // 4·√(2^-150) = 2^-73
floating_point!(f64, f64::from_bits((1023 - 535) << 52)); // 4·√(2^-1075) < 2^-535

/// A coordinate stored as the number of a cell of edge 1 and an `f32` offset from the cell's
/// origin. Codes do so to keep particles in single precision far from the origin or in a large
/// domain.
///
/// Offsets of coordinates are multiples of 2^-24 in [0, 1); cell numbers are below 2^28 in
/// magnitude. So a coordinate has at most 52 bits and converts to f64 exactly, and the difference
/// of two offsets is exact in `f32`. A length (radius) is an offset from cell 0 with full `f32`
/// precision.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct CellF32 {
    cell: i32,
    offset: f32,
}

impl CellF32 {
    /// Limit for the magnitude of cell numbers.
    pub const MOST_CELLS: f64 = (1u64 << 28) as f64;
    const STEPS: f64 = (1u64 << 24) as f64;

    /// Creates the coordinate that is `offset` (from 0 to 1) beyond the origin of `cell`, an
    /// integer. The result is not finite if the cell number is too large.
    pub fn at(cell: f64, offset: f64) -> CellF32 {
        // There are at most 2^24 steps, and f32 represents all integers up to 2^24.
        let steps = (offset * CellF32::STEPS).round();
        // An offset that rounds to 1 becomes the origin of the next cell, for unique results.
        let (cell, steps) = if steps == CellF32::STEPS { (cell + 1.0, 0.0) } else { (cell, steps) };
        if cell.is_nan() || cell.abs() >= CellF32::MOST_CELLS {
            return CellF32 { cell: 0, offset: f32::INFINITY };
        }
        CellF32 { cell: cell as i32, offset: (steps / CellF32::STEPS) as f32 }
    }
}

impl Real for CellF32 {
    type Work = f32;
    const NAME: &'static str = "f32 relative to the cell";
    const UNIT: f64 = <f32 as Real>::UNIT;
    const UNDERFLOW: f64 = <f32 as Real>::UNDERFLOW;

    #[inline(always)]
    fn wide(self) -> f64 {
        f64::from(self.cell) + f64::from(self.offset)
    }

    fn nearest(x: f64) -> CellF32 {
        CellF32 { cell: 0, offset: x as f32 }
    }

    /// Rounds a coordinate. The result is not finite if the cell number is too large.
    fn place(x: f64) -> CellF32 {
        CellF32::at(x.floor(), x - x.floor())
    }

    fn finite(self) -> bool {
        self.offset.is_finite()
    }

    #[inline(always)]
    fn minus(self, other: CellF32) -> f32 {
        (self.cell - other.cell) as f32 + (self.offset - other.offset)
    }

    #[inline(always)]
    fn plus(self, other: CellF32) -> f32 {
        (self.cell + other.cell) as f32 + (self.offset + other.offset)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coordinate_by_cells_is_within_half_a_step() {
        for x in [
            0.0,
            0.25,
            0.1,
            1.0f64.next_down(),
            -1e-300,
            -0.1,
            12345.678,
            -98765.4321,
            2.6e8,
            -2.6e8,
        ] {
            let placed = CellF32::place(x);
            assert!((placed.wide() - x).abs() <= 0.5 / CellF32::STEPS, "{x}: {placed:?}");
            assert_eq!(CellF32::place(placed.wide()).wide(), placed.wide());
        }
        assert!(
            !CellF32::place(3e8).finite()
                && !CellF32::place(-3e8).finite()
                && !CellF32::place(f64::NAN).finite()
        );
        assert_eq!(CellF32::place(5.5).minus(CellF32::place(3.25)), 2.25);
    }
}
