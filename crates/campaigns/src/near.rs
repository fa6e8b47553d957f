//! Pairs as close to tangency as numbers allow, in integers. The label is the sign of an expression
//! in 128-bit integers that is computed here, without code of the library.

use std::cmp::Ordering;

use crate::draw::{Draw, Sphere, direction, power, square};

/// Lengths of a scene as integers. Coordinates are in units, radii in half fine units; in half fine
/// units the reach has 54 bits. One fine unit is at most one ulp of a radius.
#[derive(Clone, Copy)]
pub struct Lengths<'a, const D: usize> {
    pub sphere: &'a Sphere<D>,
    /// Reach in units of the length of `sphere`.
    pub multiple: i64,
    /// Whether particles have several radii instead of a common one.
    pub sizes: bool,
    /// The largest sum of two radii, in units.
    pub reach: i64,
    /// A fine unit is 2^-fine units.
    pub fine: i32,
}

/// A pair: the vector from the first particle to the second, the radii, and the sign of the gap.
pub struct Near<const D: usize> {
    pub vector: [i64; D],
    pub radii: [i64; 2],
    pub truth: Ordering,
}

impl<'a, const D: usize> Lengths<'a, D> {
    /// Chooses random lengths with a reach of 0.7 to 1 times `room`.
    pub fn new(sphere: &'a Sphere<D>, room: f64, sizes: bool, draw: &mut Draw) -> Self {
        let multiple = (room * (1.0 - 0.3 * draw.unit()) / sphere.length as f64) as i64 / 2 * 2;
        let multiple = multiple.max(2);
        let reach = multiple * sphere.length;
        Lengths { sphere, multiple, sizes, reach, fine: reach.leading_zeros() as i32 - 11 }
    }

    /// Returns the next pair. Its vector is along a Pythagorean direction, a random one, or an
    /// axis, and one component may be changed by one unit.
    pub fn near(&self, draw: &mut Draw) -> Near<D> {
        let Lengths { sphere, multiple, sizes, reach, fine } = *self;
        let small = sizes && draw.once_in(2);
        let part = if small { 1 + draw.below(multiple / 2) } else { multiple };
        let sum = part * sphere.length;
        let mut vector = [0; D];
        let family = draw.below(4);
        match family {
            0 => vector = sphere.any(draw).map(|x| x * part),
            1 => vector = direction(draw, sum),
            _ => vector[draw.axis::<D>()] = draw.sign() * sum,
        }
        vector[draw.axis::<D>()] += draw.within(1);
        let mut sum = sum << fine;
        if small && family == 1 {
            // The rounded distance is used, because units may be much coarser than radii.
            let distance = (square(&vector.map(|x| x << fine)) as f64).sqrt() as i64;
            sum = distance.min((reach << fine) / 2);
        }
        let (mut ra, mut rb) = (sum, sum);
        // The two radii may differ only if neither can exceed half the reach.
        if 2 * sum <= reach << fine {
            let shift = draw.below(sum + 1);
            (ra, rb) = (sum + shift, (sum - shift + draw.within(1)).abs());
        }
        let truth = gap(&vector, [ra, rb], fine);
        Near { vector, radii: [ra, rb], truth }
    }
}

/// Returns the sign of the length of a vector minus the sum of two radii. Components must be below
/// 2^61 in half fine units.
pub fn gap<const D: usize>(vector: &[i64; D], [ra, rb]: [i64; 2], fine: i32) -> Ordering {
    square(&vector.map(|x| x << (fine + 1))).cmp(&square(&[ra + rb]))
}

/// Two particles, and the sign of |a - b| - (ra + rb).
pub struct Pair<const D: usize> {
    pub a: [f64; D],
    pub b: [f64; D],
    pub ra: f64,
    pub rb: f64,
    pub truth: Ordering,
}

/// Builds a pair whose differences and sum of radii need 60 bits: a has 20 bits below the last bit
/// of b, and rb ends 20 bits below ra.
pub fn long_sum<const D: usize>(draw: &mut Draw) -> Pair<D> {
    let length = (1 << 39) + draw.below(1 << 39);
    let coarse: [i64; D] = direction(draw, length);
    let a: [i64; D] = std::array::from_fn(|_| draw.within(1 << 20));
    let n = square::<D>(&std::array::from_fn(|k| (coarse[k] << 20) - a[k])) as i128;
    // One Newton step from a root with 53 bits gives 60 bits, accurate to one unit.
    let guess = (n as f64).sqrt() as i128;
    let sum = (guess + (n - guess * guess) / (2 * guess)) as i64 + draw.within(2);
    let (ra, rb) = (sum >> 20, sum & ((1 << 20) - 1));
    let (unit, fine) = (power(-52), power(-72));
    let truth = (n as u128).cmp(&square(&[sum]));
    let (a, b) = (a.map(|x| x as f64 * fine), coarse.map(|x| x as f64 * unit));
    Pair { a, b, ra: ra as f64 * unit, rb: rb as f64 * fine, truth }
}

/// Builds a pair whose distance along one axis is the sum of radii, plus or minus at most one unit.
/// Its distance along the next axis is below half a unit, and may be 2^-900 of the other.
pub fn needle<const D: usize>(draw: &mut Draw) -> Pair<D> {
    let sum = (1i64 << 51) + draw.below(1 << 51);
    let distance = sum + draw.within(1);
    let off = if draw.once_in(4) { 0 } else { draw.below(1 << 51) };
    let depth = if draw.once_in(16) { draw.below(800) + 100 } else { draw.below(14) + 52 };
    // The distance off the axis adds less than 1/4 to the square. Without it, the squares are equal
    // or differ by at least 2·2^51.
    let truth = distance.cmp(&sum).then(off.cmp(&0));
    let (mut a, mut b) = ([0.0; D], [0.0; D]);
    let share = draw.below(sum + 1);
    let axis = draw.axis::<D>();
    let (from, to) = if draw.once_in(2) { (&mut a, &mut b) } else { (&mut b, &mut a) };
    to[axis] = distance as f64 * power(-52);
    from[(axis + 1) % D] = off as f64 * power(-52 - depth as i32);
    Pair { a, b, ra: share as f64 * power(-52), rb: (sum - share) as f64 * power(-52), truth }
}
