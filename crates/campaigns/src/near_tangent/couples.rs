//! Families of near-tangent couples. Each is built from integers, and its label is the sign of an
//! expression in 128-bit integers that is written here: no code of the library takes part.

use std::cmp::Ordering;

use crate::draw::{Draw, Sphere, direction, power, square};

/// How couples come about.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Family {
    /// Pythagorean triples and quadruples, exactly tangent, then moved by one ulp in a coordinate,
    /// in a radius, in both, or not at all.
    Pythagoras,
    /// Random directions on the grid; the sum of radii is the distance rounded, give or take one
    /// ulp.
    Direction,
    /// As `Direction`, with differences and sums of radii that need 60 bits.
    LongSum,
    /// Along an axis, and off it by something as small as 2^-900 of the distance.
    Needle,
}

impl Family {
    pub fn name(self) -> &'static str {
        match self {
            Family::Pythagoras => "pythagoras",
            Family::Direction => "direction",
            Family::LongSum => "long sum",
            Family::Needle => "needle",
        }
    }
}

/// Two bodies and the sign of |a - b| - (ra + rb).
pub struct Couple<const D: usize> {
    pub a: [f64; D],
    pub b: [f64; D],
    pub ra: f64,
    pub rb: f64,
    pub truth: Ordering,
}

/// What the couples of one batch have in common.
pub struct Batch<'a, const D: usize> {
    family: Family,
    sphere: &'a Sphere<D>,
    /// Coordinates are integers times 2^this.
    pub exponent: i32,
    /// Offset in diameters; 0: about the origin.
    offset: f64,
    /// The multiple of the sphere's length that makes the diameter of the batch; even.
    multiple: i64,
    /// One radius for all.
    pub uniform: bool,
}

/// Coordinates at an offset have this magnitude or more, in units: one unit is one ulp.
const FAR: i64 = 1 << 52;

impl<'a, const D: usize> Batch<'a, D> {
    /// Batch number `index` of a family; `offset` in diameters.
    pub fn new(
        family: Family,
        sphere: &'a Sphere<D>,
        offset: f64,
        index: u64,
        draw: &mut Draw,
    ) -> Batch<'a, D> {
        // About the origin the radius has all its 53 bits above the unit; the sphere's length times
        // an even number.
        let most = if offset == 0.0 { (1i64 << 53) as f64 } else { FAR as f64 / offset };
        let multiple = (most * (0.6 + 0.35 * draw.unit()) / sphere.length as f64) as i64 / 2 * 2;
        let exponent = match index % 4 {
            0 => -52,
            1 => 0,
            2 => draw.within(200) as i32,
            _ => (draw.within(990) - 20) as i32,
        };
        let exponent =
            if matches!(family, Family::LongSum | Family::Needle) { -52 } else { exponent };
        let uniform =
            index / 4 % 2 == 1 && matches!(family, Family::Pythagoras | Family::Direction);
        Batch { family, sphere, exponent, offset, multiple: multiple.max(2), uniform }
    }

    /// The next couple.
    pub fn couple(&self, draw: &mut Draw) -> Couple<D> {
        match self.family {
            Family::Pythagoras | Family::Direction => self.on_the_grid(draw),
            Family::LongSum => long_sum(draw),
            Family::Needle => needle(draw),
        }
    }

    fn on_the_grid(&self, draw: &mut Draw) -> Couple<D> {
        let diameter = self.multiple * self.sphere.length;
        // Radii lie in finer units, where the diameter has 53 bits: one of them is one ulp of the
        // radius.
        let fine = diameter.leading_zeros() as i32 - 11;
        let mut sum = diameter << fine;
        let mut vector: [i64; D] = if self.family == Family::Pythagoras {
            self.sphere.any(draw).map(|x| x * self.multiple)
        } else {
            direction(draw, diameter)
        };
        if self.family == Family::Pythagoras || self.uniform {
            vector[draw.below(D as i64) as usize] += draw.within(1);
        } else {
            // Even, and below 2^53 with what is added to one radius: then both are doubles.
            sum = (((square(&vector.map(|x| x << fine)) as f64).sqrt() as i64 + 1) & !1)
                .min((1 << 53) - 4);
        }
        // In half fine units, so that half the sum is an integer.
        let (mut ra, mut rb) = (sum, sum);
        if !self.uniform {
            if draw.once_in(2) {
                let shift = 2 * draw.below(sum / 2 + 1);
                (ra, rb) = (sum + shift, sum - shift);
            }
            // The smaller, because the larger may have no bit left.
            rb = (rb + draw.within(2)).abs();
        }
        let (a, b) = self.place(&vector, draw);
        let (unit, half) = (power(self.exponent), power(self.exponent - fine - 1));
        // Components are below 2^55 + 2 in half fine units, the sums of radii below 2^55.
        let truth = square(&vector.map(|x| x << (fine + 1))).cmp(&square(&[ra + rb]));
        Couple {
            a: a.map(|x| x as f64 * unit),
            b: b.map(|x| x as f64 * unit),
            ra: ra as f64 * half,
            rb: rb as f64 * half,
            truth,
        }
    }

    /// Two points that differ by the vector, with coordinates below 2^53.
    fn place(&self, vector: &[i64; D], draw: &mut Draw) -> ([i64; D], [i64; D]) {
        let (centred, far) = (draw.once_in(2), self.offset > 0.0);
        let mut a = [0; D];
        for k in 0..D {
            a[k] = if far {
                let room = vector[k].abs();
                let x = FAR + room + draw.below(FAR - 2 * room);
                if draw.once_in(2) { -x } else { x }
            } else if centred {
                -vector[k] / 2 + draw.within(1 << 50)
            } else {
                0
            };
        }
        (a, std::array::from_fn(|k| a[k] + vector[k]))
    }
}

/// a has 20 bits below the last of b, and rb ends 20 bits below ra.
fn long_sum<const D: usize>(draw: &mut Draw) -> Couple<D> {
    let length = (1 << 39) + draw.below(1 << 39);
    let coarse: [i64; D] = direction(draw, length);
    let a: [i64; D] = std::array::from_fn(|_| draw.within(1 << 20));
    let n = square::<D>(&std::array::from_fn(|k| (coarse[k] << 20) - a[k])) as i128;
    // One step of Newton's method from a root of 53 bits: right to one unit of 60 bits.
    let guess = (n as f64).sqrt() as i128;
    let sum = (guess + (n - guess * guess) / (2 * guess)) as i64 + draw.within(2);
    let (ra, rb) = (sum >> 20, sum & ((1 << 20) - 1));
    let (unit, fine) = (power(-52), power(-72));
    let truth = (n as u128).cmp(&square(&[sum]));
    let (a, b) = (a.map(|x| x as f64 * fine), coarse.map(|x| x as f64 * unit));
    Couple { a, b, ra: ra as f64 * unit, rb: rb as f64 * fine, truth }
}

/// Along one axis the distance is the sum of radii, give or take one; along the next it is below
/// half a unit.
fn needle<const D: usize>(draw: &mut Draw) -> Couple<D> {
    let sum = (1i64 << 51) + draw.below(1 << 51);
    let distance = sum + draw.within(1);
    let off = if draw.once_in(4) { 0 } else { draw.below(1 << 51) };
    let depth = if draw.once_in(16) { draw.below(800) + 100 } else { draw.below(14) + 52 };
    // What is off the axis adds less than 1/4 to the square, which without it differs by 2·2^51 or
    // not at all.
    let truth = distance.cmp(&sum).then(off.cmp(&0));
    let (mut a, mut b) = ([0.0; D], [0.0; D]);
    let share = draw.below(sum + 1);
    let axis = draw.below(D as i64) as usize;
    let (from, to) = if draw.once_in(2) { (&mut a, &mut b) } else { (&mut b, &mut a) };
    to[axis] = distance as f64 * power(-52);
    from[(axis + 1) % D] = off as f64 * power(-52 - depth as i32);
    Couple { a, b, ra: share as f64 * power(-52), rb: (sum - share) as f64 * power(-52), truth }
}
