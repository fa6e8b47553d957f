//! Short vectors of a lattice, as integer combinations of long ones.
//!
//! A box tilted by many box lengths has the same images as one with little tilt. The reduction
//! subtracts integer multiples of other vectors while that makes a vector shorter: first multiples
//! of one vector, as Gauss did, then the sum or difference of two vectors. The result is
//! Minkowski-reduced: in up to three dimensions no basis of the lattice is shorter, and its
//! shortest vector is the shortest of the lattice (Nguyen and Stehlé 2009,
//! doi:10.1145/1597036.1597050, section 3).
//!
//! **Exactness.** The integers are exact sums of such steps, so the short vectors span the same
//! lattice, whatever was rounded. Lengths are those of vectors recomputed from the integers and the
//! given vectors ([`shifted`]), so they have full precision. Because of rounding, a vector may
//! remain that could be shorter by a few ulps.

use super::{Lattice, dot, norm};
use crate::wide::fill;

/// Limit for the magnitudes of the integers that combine vectors.
const MOST: i64 = 1 << 29;
/// A vector is replaced only if the square of its length falls below this part of the old one, so
/// that rounding cannot cause a cycle.
const SHORTER: f64 = 1.0 - 1.0 / (1u64 << 30) as f64;

/// Integers that combine new vectors from the given ones, one row per new vector.
pub type Numbers = [[i32; 3]; 3];

/// Integers that leave all vectors unchanged.
pub const AS_GIVEN: Numbers = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

impl Lattice {
    /// Returns the same lattice with its shortest vectors, rounded, and the integers that combine
    /// these from the given vectors. Vectors along which the box is open are unchanged, and so are
    /// some whose integers would reach 2^29.
    pub fn reduced(&self) -> (Lattice, Numbers) {
        let mut basis = Basis { given: self, numbers: AS_GIVEN, vectors: self.vectors };
        // Each turn shortens a vector. The square of its length can be halved less than 4096 times.
        for _ in 0..10_000 {
            if !basis.shorten() {
                break;
            }
        }
        (Lattice { vectors: basis.vectors, ..*self }, basis.numbers)
    }

    /// Returns the length of the shortest nonzero vector of the lattice, with an error of a few
    /// ulps, or infinity if no vector is periodic. A particle touches an image of itself if and
    /// only if its diameter is at least this long.
    pub fn shortest(&self) -> f64 {
        let (reduced, _) = self.reduced();
        let lengths = (0..3).filter(|&a| self.periodic[a]).map(|a| norm(reduced.vectors[a]));
        lengths.fold(f64::INFINITY, f64::min)
    }
}

struct Basis<'a> {
    given: &'a Lattice,
    numbers: Numbers,
    /// The short vectors, rounded.
    vectors: [[f64; 3]; 3],
}

impl Basis<'_> {
    fn shorten(&mut self) -> bool {
        let periodic = self.given.periodic;
        for a in (0..3).filter(|&a| periodic[a]) {
            for b in (0..3).filter(|&b| b != a && periodic[b]) {
                let (a_b, b_b) = self.products(a, b);
                let times = (a_b / b_b).round();
                // If the quotient is NaN, the condition is false.
                if times.abs() < MOST as f64 && times != 0.0 {
                    let mut by = [0; 3];
                    by[b] = -(times as i64);
                    if self.add(a, by) {
                        return true;
                    }
                }
            }
        }
        if periodic != [true; 3] {
            return false;
        }
        let signs = [[1, 1], [1, -1], [-1, 1], [-1, -1]];
        (0..3).any(|a| {
            signs.iter().any(|&[b, c]| {
                let mut by = [0; 3];
                (by[(a + 1) % 3], by[(a + 2) % 3]) = (b, c);
                self.add(a, by)
            })
        })
    }

    fn products(&self, a: usize, b: usize) -> (f64, f64) {
        (dot(self.vectors[a], self.vectors[b]), dot(self.vectors[b], self.vectors[b]))
    }

    /// Adds multiples of other vectors to vector `a` if that shortens it; returns whether it did.
    fn add(&mut self, a: usize, by: [i64; 3]) -> bool {
        let row = self.numbers.map(|row| row.map(i64::from));
        // A sum is at most 2^29 plus three times 2^29 · 2^29, so it does not overflow.
        let sum: [i64; 3] =
            std::array::from_fn(|k| row[a][k] + (0..3).map(|b| by[b] * row[b][k]).sum::<i64>());
        if sum.iter().any(|number| number.abs() >= MOST) {
            return false;
        }
        let sum = sum.map(|number| number as i32);
        let vector = shifted(&[0.0; 3], sum, &self.given.vectors);
        let shorter = dot(vector, vector) < SHORTER * dot(self.vectors[a], self.vectors[a]);
        if shorter {
            (self.numbers[a], self.vectors[a]) = (sum, vector);
        }
        shorter
    }
}

/// Returns x + S·H, rounded; not finite if it overflows. `periodic/frame.rs` bounds the error.
#[inline]
pub fn shifted<const D: usize>(x: &[f64; D], image: [i32; 3], vectors: &[[f64; D]; 3]) -> [f64; D] {
    fill(|k| {
        let (mut sum, mut rest) = (x[k], 0.0);
        for (count, vector) in image.into_iter().zip(vectors) {
            let h = vector[k];
            if count == 0 || h == 0.0 {
                continue;
            }
            let count = f64::from(count);
            let product = count * h;
            let (next, error) = two_sum(sum, product);
            rest += error;
            if count.abs() != 1.0 {
                rest += count.mul_add(h, -product);
            }
            sum = next;
        }
        sum + rest
    })
}

fn two_sum(x: f64, y: f64) -> (f64, f64) {
    let sum = x + y;
    let part = sum - x;
    (sum, (x - (sum - part)) + (y - part))
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    fn lattice(vectors: [[f64; 3]; 3], periodic: [bool; 3]) -> Lattice {
        Lattice::new(vectors, periodic, [0.0; 3]).unwrap()
    }

    fn determinant([a, b, c]: Numbers) -> i128 {
        let [a, b, c] = [a, b, c].map(|row| row.map(i128::from));
        let minor = |k: usize, l: usize| b[k] * c[l] - b[l] * c[k];
        a[0] * minor(1, 2) - a[1] * minor(0, 2) + a[2] * minor(0, 1)
    }

    #[test]
    fn known_lattices_have_their_shortest_vectors() {
        let cube = [[2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 4.0]];
        assert_eq!(lattice(cube, [true; 3]).shortest(), 2.0);
        assert_eq!(lattice(cube, [true; 3]).reduced(), (lattice(cube, [true; 3]), AS_GIVEN));
        assert_eq!(lattice(cube, [false, false, true]).shortest(), 4.0);
        assert_eq!(lattice(cube, [false; 3]).shortest(), f64::INFINITY);
        // Short vectors of the face-centred and of the body-centred cubic lattice.
        let fcc = [[0.0, 1.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 0.0]];
        assert_eq!(lattice(fcc, [true; 3]).shortest(), 2.0f64.sqrt());
        let bcc = [[1.0, 1.0, 1.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
        assert_eq!(lattice(bcc, [true; 3]).shortest(), 3.0f64.sqrt());
        // The sum of all three vectors is shorter than at least one of them.
        let star = [[2.0, 0.0, 0.0], [-1.0, 2.0, 0.0], [-0.9, -0.9, 2.0]];
        assert!((lattice(star, [true; 3]).shortest() - 2.0).abs() < 1e-15);
        let star = [[1.0, -0.5, -0.5], [-0.5, 1.0, -0.45], [-0.45, -0.5, 1.0]];
        assert!(lattice(star, [true; 3]).shortest() < 0.09);
        let tilted = [[1.0, 0.0, 0.0], [1e6 + 0.25, 1.0, 0.0], [-3e5, 7e5 + 0.5, 1.0]];
        assert_eq!(lattice(tilted, [true; 3]).shortest(), 1.0);
        assert_eq!(lattice(tilted, [true, false, true]).reduced().1[1], [0, 1, 0]);
    }

    /// Small combinations of the reduced vectors are not shorter. The integers have determinant 1
    /// or -1, so the lattice is unchanged.
    #[test]
    fn no_vector_of_a_lattice_is_shorter() {
        let random = &mut ChaCha8Rng::seed_from_u64(21);
        let mut changed = 0;
        for turn in 0..3000 {
            let mut vectors: [[f64; 3]; 3] =
                std::array::from_fn(|_| std::array::from_fn(|_| random.random::<f64>() - 0.5));
            if turn % 2 == 0 {
                (vectors[0][1], vectors[0][2], vectors[1][2]) = (0.0, 0.0, 0.0);
                vectors[1][0] *= 300.0;
                vectors[2][1] *= 300.0;
            }
            let periodic = std::array::from_fn(|a| turn >> a & 7 != 0);
            let Ok(lattice) = Lattice::new(vectors, periodic, [0.0; 3]) else { continue };
            if !lattice.repeats() {
                continue;
            }
            let (reduced, numbers) = lattice.reduced();
            assert_eq!(determinant(numbers).abs(), 1, "{lattice:?}");
            assert_eq!(reduced.reduced().1, AS_GIVEN, "{lattice:?}");
            changed += usize::from(numbers != AS_GIVEN);
            let mut least = f64::INFINITY;
            let range = |a: usize| if periodic[a] { -3..=3 } else { 0..=0 };
            for x in range(0) {
                for y in range(1) {
                    for z in range(2) {
                        let vector = shifted(&[0.0; 3], [x, y, z], &reduced.vectors);
                        let length = norm(vector);
                        least = if [x, y, z] == [0; 3] { least } else { least.min(length) };
                    }
                }
            }
            assert!((lattice.shortest() - least).abs() <= 1e-9 * least, "{lattice:?}");
        }
        assert!(changed > 1500, "{changed}");
    }
}
