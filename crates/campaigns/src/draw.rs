//! Random numbers, integer vectors of known length, and powers of two.

use contactbench_terms::mix::splitmix64;

/// A sequence of random numbers: SplitMix64 with a seed.
pub struct Draw(u64);

impl Draw {
    pub fn new(seed: u64, stream: u64) -> Draw {
        Draw(splitmix64(seed ^ splitmix64(stream)))
    }

    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        splitmix64(self.0)
    }

    /// Returns a random integer from 0 to n - 1.
    pub fn below(&mut self, n: i64) -> i64 {
        ((u128::from(self.bits()) * n as u128) >> 64) as i64
    }

    /// Returns a random integer from -n to n.
    pub fn within(&mut self, n: i64) -> i64 {
        self.below(2 * n + 1) - n
    }

    /// Returns -1 or 1 with a probability of 1/6 each, otherwise 0.
    pub fn bit(&mut self) -> i64 {
        if self.once_in(3) { 2 * self.below(2) - 1 } else { 0 }
    }

    /// Returns true with probability 1/n.
    pub fn once_in(&mut self, n: i64) -> bool {
        self.below(n) == 0
    }

    /// Returns 1 or -1.
    pub fn sign(&mut self) -> i64 {
        if self.once_in(2) { -1 } else { 1 }
    }

    /// Returns the number of a random axis.
    pub fn axis<const D: usize>(&mut self) -> usize {
        self.below(D as i64) as usize
    }

    pub fn one_of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len() as i64) as usize]
    }

    /// Returns the exponent of a unit: in turn -52, 0, and random ones up to 200 and to `most`.
    pub fn exponent(&mut self, turn: i64, most: i64) -> i32 {
        match turn {
            0 => -52,
            1 => 0,
            2 => self.within(200) as i32,
            _ => self.within(most) as i32,
        }
    }

    pub fn order(&mut self, n: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..n).collect();
        for k in (1..n).rev() {
            order.swap(k, self.below(k as i64 + 1) as usize);
        }
        order
    }

    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * power(-53)
    }
}

/// Returns 2^k for -1074 <= k <= 1023.
pub fn power(k: i32) -> f64 {
    libm::scalbn(1.0, k)
}

/// All integer vectors of one length: Pythagorean triples (2D) or quadruples (3D) with all signs
/// and orders.
pub struct Sphere<const D: usize> {
    pub length: i64,
    pub points: Vec<[i64; D]>,
}

impl<const D: usize> Sphere<D> {
    /// Builds the vectors of a length that has many: 1105 = 5·13·17 in 2D and 105 = 3·5·7 in 3D.
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

    pub fn any(&self, draw: &mut Draw) -> [i64; D] {
        draw.one_of(&self.points)
    }
}

/// Returns an integer vector of about this length in a random direction. The length is accurate to
/// one unit if it is below 2^53.
pub fn direction<const D: usize>(draw: &mut Draw, length: i64) -> [i64; D] {
    let mut vector = [0; D];
    let mut rest = length as f64;
    for component in &mut vector[..D - 1] {
        *component = (rest * (2.0 * draw.unit() - 1.0)) as i64;
        let x = *component as f64;
        rest = ((rest - x) * (rest + x)).sqrt();
    }
    vector[D - 1] = rest.round() as i64 * draw.sign();
    vector.rotate_left(draw.axis::<D>());
    vector
}

/// Returns the squared length of a vector with components below 2^62.
pub fn square<const D: usize>(vector: &[i64; D]) -> u128 {
    vector.iter().map(|x| u128::from(x.unsigned_abs()) * u128::from(x.unsigned_abs())).sum()
}
