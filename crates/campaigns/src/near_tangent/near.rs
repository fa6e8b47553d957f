//! Couples as near to tangency as numbers go, in whole numbers.

use std::cmp::Ordering;

use crate::draw::{Draw, Sphere, direction, square};

/// The lengths of a scene as whole numbers: coordinates in units, radii in half fine units, in
/// which the reach has 54 bits. One of them is one ulp of a radius, or less.
#[derive(Clone, Copy)]
pub struct Lengths<'a, const D: usize> {
    pub sphere: &'a Sphere<D>,
    /// Of the sphere's length.
    pub multiple: i64,
    /// Couples of several sizes; else one radius for all.
    pub sizes: bool,
    /// The largest sum of two radii.
    pub reach: i64,
    /// Fine units are 2^-this.
    pub fine: i32,
}

/// A couple as near to tangency as numbers go: the vector from the first to the second, the radii,
/// and the sign of the gap.
pub struct Near<const D: usize> {
    pub vector: [i64; D],
    pub radii: [i64; 2],
    pub truth: Ordering,
}

impl<'a, const D: usize> Lengths<'a, D> {
    /// A reach of somewhat less than `room`.
    pub fn new(sphere: &'a Sphere<D>, room: f64, sizes: bool, draw: &mut Draw) -> Self {
        let multiple = (room * (1.0 - 0.3 * draw.unit()) / sphere.length as f64) as i64 / 2 * 2;
        let multiple = multiple.max(2);
        let reach = multiple * sphere.length;
        Lengths { sphere, multiple, sizes, reach, fine: reach.leading_zeros() as i32 - 11 }
    }

    /// The next couple.
    pub fn near(&self, draw: &mut Draw) -> Near<D> {
        let Lengths { sphere, multiple, sizes, reach, fine } = *self;
        let part = if sizes && draw.once_in(2) { 1 + draw.below(multiple / 2) } else { multiple };
        let sum = part * sphere.length;
        let mut vector = [0; D];
        match draw.below(4) {
            0 => vector = sphere.any(draw).map(|x| x * part),
            1 => vector = direction(draw, sum),
            _ => vector[draw.below(D as i64) as usize] = if draw.once_in(2) { sum } else { -sum },
        }
        vector[draw.below(D as i64) as usize] += draw.within(1);
        let sum = sum << fine;
        let (mut ra, mut rb) = (sum, sum);
        // Neither radius may exceed half the reach.
        if 2 * sum <= reach << fine {
            let shift = draw.below(sum + 1);
            (ra, rb) = (sum + shift, (sum - shift + draw.within(1)).abs());
        }
        let truth = gap(&vector, [ra, rb], fine);
        Near { vector, radii: [ra, rb], truth }
    }
}

/// The sign of the length of a vector less the sum of two radii; components below 2^61 in half fine
/// units.
pub fn gap<const D: usize>(vector: &[i64; D], [ra, rb]: [i64; 2], fine: i32) -> Ordering {
    square(&vector.map(|x| x << (fine + 1))).cmp(&square(&[ra + rb]))
}
