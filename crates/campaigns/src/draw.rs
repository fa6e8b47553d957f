//! Random numbers, integer vectors of known length, and integers as doubles.

use contactbench_core::sink::splitmix64;

/// A sequence of random numbers: SplitMix64 from a seed.
pub struct Draw(u64);

impl Draw {
    /// One sequence for each seed and stream.
    pub fn new(seed: u64, stream: u64) -> Draw {
        Draw(splitmix64(seed ^ splitmix64(stream)))
    }

    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        splitmix64(self.0)
    }

    /// 0 to n - 1.
    pub fn below(&mut self, n: i64) -> i64 {
        ((u128::from(self.bits()) * n as u128) >> 64) as i64
    }

    /// -n to n.
    pub fn within(&mut self, n: i64) -> i64 {
        self.below(2 * n + 1) - n
    }

    /// 0, and half as often 1 or -1.
    pub fn bit(&mut self) -> i64 {
        if self.once_in(3) { 2 * self.below(2) - 1 } else { 0 }
    }

    /// True once in n times.
    pub fn once_in(&mut self, n: i64) -> bool {
        self.below(n) == 0
    }

    /// The numbers below n in any order.
    pub fn order(&mut self, n: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..n).collect();
        for k in (1..n).rev() {
            order.swap(k, self.below(k as i64 + 1) as usize);
        }
        order
    }

    /// 0 up to 1.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * power(-53)
    }
}

/// 2^k for -1074 <= k <= 1023.
pub fn power(k: i32) -> f64 {
    libm::scalbn(1.0, k)
}

/// All integer vectors of one length, over the signs and the order of their components: what
/// Pythagorean triples and quadruples give.
pub struct Sphere<const D: usize> {
    pub length: i64,
    pub points: Vec<[i64; D]>,
}

impl<const D: usize> Sphere<D> {
    /// 1105 = 5·13·17 in the plane and 105 = 3·5·7 in space: short lengths with many vectors.
    pub fn made() -> Sphere<D> {
        let length = if D == 2 { 1105i64 } else { 105 };
        let width = 2 * length + 1;
        let mut points = Vec::new();
        // The last component follows from the others.
        for k in 0..width.pow(D as u32 - 1) {
            let mut point: [i64; D] =
                std::array::from_fn(|axis| k / width.pow(axis as u32) % width - length);
            let rest = length * length - point[..D - 1].iter().map(|x| x * x).sum::<i64>();
            let most = rest.max(0).isqrt();
            if most * most == rest {
                for x in if most == 0 { vec![0] } else { vec![-most, most] } {
                    point[D - 1] = x;
                    points.push(point);
                }
            }
        }
        Sphere { length, points }
    }

    /// One of them.
    pub fn any(&self, draw: &mut Draw) -> [i64; D] {
        self.points[draw.below(self.points.len() as i64) as usize]
    }
}

/// An integer vector of about this length in a random direction: within one unit, if `length` is
/// below 2^53.
pub fn direction<const D: usize>(draw: &mut Draw, length: i64) -> [i64; D] {
    let mut vector = [0; D];
    let mut rest = length as f64;
    for component in &mut vector[..D - 1] {
        *component = (rest * (2.0 * draw.unit() - 1.0)) as i64;
        let x = *component as f64;
        rest = ((rest - x) * (rest + x)).sqrt();
    }
    vector[D - 1] = rest.round() as i64 * if draw.once_in(2) { -1 } else { 1 };
    vector.rotate_left(draw.below(D as i64) as usize);
    vector
}

/// The square of the length of a vector with components below 2^62.
pub fn square<const D: usize>(vector: &[i64; D]) -> u128 {
    vector.iter().map(|x| u128::from(x.unsigned_abs()) * u128::from(x.unsigned_abs())).sum()
}
