//! The scalars in which scenes are stored: `f32` and `f64`.

use std::ops::{Add, Mul, Sub};

/// A scalar type in which scenes are stored and rounded contact tests compute.
pub trait Real:
    nalgebra::Scalar
    + Copy
    + PartialOrd
    + Default
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Send
    + Sync
    + sealed::Sealed
{
    /// Name of the precision, for messages.
    const NAME: &'static str;
    /// Largest relative rounding error of one operation: half the distance from 1 to the next
    /// number.
    const UNIT: f64;
    /// At least four times the square root of half the smallest subnormal.
    const UNDERFLOW: f64;
    /// Returns the value in f64, without rounding.
    fn wide(self) -> f64;
    /// Rounds a number to this type.
    fn nearest(x: f64) -> Self;
    /// Returns whether the value is neither NaN nor infinite.
    fn finite(self) -> bool;
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

macro_rules! floating_point {
    ($float:ident, $underflow:expr) => {
        impl Real for $float {
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
        }
    };
}

floating_point!(f32, f64::from_bits((1023 - 73) << 52)); // 4·√(2^-150) = 2^-73
floating_point!(f64, f64::from_bits((1023 - 535) << 52)); // 4·√(2^-1075) < 2^-535
