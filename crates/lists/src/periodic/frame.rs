//! The box in one dimension: fractions along its vectors, and positions of images.
//!
//! Here u = 2^-53. A "dual" is the reciprocal vector as computed, whatever its error. It consists
//! of doubles like any other vector, and the proofs below use only measured properties of it.
//!
//! **Which images are near.** For periodic vectors Ha and duals ga let rab = |ga·Hb - [a = b]|,
//! where [a = b] is 1 if a = b, else 0. Let two points be p and p' with |p - p' - T·H| <= R. The
//! product of ga with this difference yields
//!
//! ```text
//! |Ta - ga·(p - p')| <= |ga| R + sum over b of |Tb| rab.       (1)
//! ```
//!
//! Let ca >= |ga·(p - p')| + |ga| R, and c be the largest ca. If each sum of rab over b is at most
//! 1/4, the largest |T| is at most c + |T|/4, hence below 2c. So Ta is within |ga| R + 2c·off(a) of
//! ga·(p - p'), where off(a) is the sum of rab: [`ReducedBox::coupling`]. Boxes with an off above
//! 1/4 are refused: their vectors are so long and so nearly coplanar that no filter in f64 can
//! separate their images.
//!
//! **Which vectors.** All this holds for any vectors of the lattice. If the given vectors make many
//! more images than the shortest ([`Lattice::reduced`]), as in a box tilted by many box lengths, H
//! are the shortest, which are integer combinations of the given ones. They are rounded, so
//! wherever a product with them appears above, the effect of their errors (`off_by`) is added to
//! rab. T and the integers that bring particles into the box refer to the vectors H. Names of
//! images and all decisions refer to the given vectors ([`ReducedBox::given`]). Given vectors that
//! are nearly as good are kept, so that particles in the box need not be moved.
//!
//! **Upright boxes.** Particles given with a tilted box often lie in the upright box instead.
//! Moving them into the tilted box would need a copy of the scene. Upright boxes in shifted rows
//! fill space too if each vector has a positive component along its own axis, none along later
//! axes, and along earlier axes at most those vectors' own. Let ga be the axis a over that edge,
//! and hba = ga·Hb, at most 1 in magnitude. Then (1) holds for Ta plus the sum of Tb hba over b >
//! a, in place of Ta, with rab without hba. So |Tz| is at most c + o, |Ty| at most 2(c + o) and
//! |Tx| at most 4(c + o), where o is the largest |T| times the largest off(a). As off(a) is below
//! 1/64, |T| is below 8c. Roundings of hba, its products and their sums are at most 5u |Tb hba|;
//! off(a) includes 16u |hba|.
//!
//! **Positions.** x + S·H is computed with the errors of all products (by a fused multiplication)
//! and of all sums (by two-sum) added up beside it. Each of these errors is exact except for
//! underflow in products, at most 3 · 2^-1075. Each of the six errors is at most u(1 + u)^3 times m
//! = |x| + the sum of |Sa Ha|. Adding them up makes an error of at most 6u · 6u(1 + 9u) m < 2^-100
//! m, and the last sum is rounded. So the position is within u|position| + 2^-100 m + 2^-1073 of
//! the true one; `off_by` uses twice as much. A position that is not shifted has no error.

use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::scene::Lattice;
use contactbench_ground::scene::lattice::{AS_GIVEN, Numbers, dot, norm, shifted};
use contactbench_ground::wide::fill;

/// Unit roundoff of f64, 2^-53.
pub const U: f64 = 1.0 / (1u64 << 53) as f64;
/// 2^-99: twice the relative error of adding up errors.
const SECOND: f64 = f64::from_bits((1023 - 99) << 52);
/// 2^-1070: more than the products of a position can lose by underflow.
const LEAST: f64 = f64::from_bits(1 << 4);
/// Limit for the magnitude of each number of an image, so that a sum of three fits an `i32`.
pub const MOST: f64 = (1u64 << 29) as f64;
/// The shortest vectors are used if the sum of the lengths of their duals is below this part of the
/// sum for the given vectors. The number of images grows with that sum.
const BETTER: f64 = 0.75;

/// A box with its duals and error bounds; the module documentation derives them.
#[derive(Clone, Debug)]
pub struct ReducedBox<const D: usize> {
    /// Whether the box is periodic along each of its vectors.
    pub periodic: [bool; 3],
    /// The given vectors; 0 for vectors along which the box is open.
    pub vectors: [[f64; D]; 3],
    /// The vectors in use (the module's H) as integer combinations of the given ones.
    numbers: Numbers,
    /// The vectors in use, rounded; 0 for vectors along which the box is open.
    pub own: [[f64; D]; 3],
    /// Duals of the vectors in use; 0 for vectors along which the box is open.
    duals: [[f64; D]; 3],
    origin: [f64; D],
    /// Upper bounds for the lengths of the duals.
    pub lengths: [f64; 3],
    /// Upper bounds for the sums of rab over b: off(a).
    off: [f64; 3],
    /// hba of an upright box, in row b; otherwise 0.
    pub shear: [[f64; 3]; 3],
    /// T is positive if its first nonzero number in this order of the vectors is positive.
    pub order: [usize; 3],
}

impl<const D: usize> ReducedBox<D> {
    /// Creates a frame from the given vectors or from shorter vectors of the same lattice. Fails
    /// with [`Refusal::Skewed`] if images cannot be separated.
    pub fn new(lattice: &Lattice) -> Result<ReducedBox<D>, Refusal> {
        let given = ReducedBox::of(lattice, lattice, AS_GIVEN);
        let (reduced, numbers) = lattice.reduced();
        if numbers == AS_GIVEN {
            return given;
        }
        let reduced = ReducedBox::of(lattice, &reduced, numbers);
        let images = |frame: &ReducedBox<D>| frame.lengths.iter().sum::<f64>();
        match (given, reduced) {
            (Ok(given), Ok(reduced)) if images(&reduced) < BETTER * images(&given) => Ok(reduced),
            (Err(_), Ok(reduced)) => Ok(reduced),
            (given, _) => given,
        }
    }

    /// Creates a frame from vectors that are these integer combinations of the given ones.
    pub fn of(
        given: &Lattice,
        lattice: &Lattice,
        numbers: Numbers,
    ) -> Result<ReducedBox<D>, Refusal> {
        let periodic = given.periodic();
        let cut = |vector: [f64; 3]| fill(|k| vector[k]);
        let row = |a: usize, vector: [f64; 3]| if periodic[a] { cut(vector) } else { [0.0; D] };
        let vectors: [[f64; D]; 3] = std::array::from_fn(|a| row(a, given.vectors()[a]));
        let own: [[f64; D]; 3] = std::array::from_fn(|a| row(a, lattice.vectors()[a]));
        let duals: [[f64; D]; 3] = std::array::from_fn(|a| row(a, lattice.dual(a)));
        // Returns the rounding error of a vector along each axis.
        let error = |a: usize| -> [f64; D] {
            if numbers == AS_GIVEN {
                return [0.0; D];
            }
            fill(|k| {
                let terms = (0..3).map(|b| f64::from(numbers[a][b]).abs() * vectors[b][k].abs());
                off_by(own[a][k].abs(), terms.sum())
            })
        };
        let (mut lengths, mut off) = ([0.0; 3], [0.0; 3]);
        for a in (0..3).filter(|&a| periodic[a]) {
            // The computed size times this factor is at least the true root of the sum of squares.
            lengths[a] = norm(duals[a]) * (1.0 + 8.0 * U);
            for b in (0..3).filter(|&b| periodic[b]) {
                let expected = f64::from(u8::from(a == b));
                let rounded = 16.0 * U * (1.0 + times(&duals[a], &own[b]));
                let of_vector = 2.0 * times(&duals[a], &error(b));
                off[a] += (dot(duals[a], own[b]) - expected).abs() + rounded + of_vector;
            }
            // The condition is also true if a number is NaN.
            if !(off[a] <= 0.25 && lengths[a].is_finite()) {
                return Err(Refusal::Skewed { vector: a });
            }
        }
        let origin = cut(given.origin());
        let (shear, order) = ([[0.0; 3]; 3], [0, 1, 2]);
        Ok(ReducedBox {
            periodic,
            vectors,
            numbers,
            own,
            duals,
            origin,
            lengths,
            off,
            shear,
            order,
        })
    }

    /// Returns the frame of an upright box if the vectors in use are the given ones and allow it.
    /// An untilted box has no other frame.
    pub fn upright(&self) -> Option<ReducedBox<D>> {
        let (own, mut shear) = (&self.own, [[0.0; 3]; 3]);
        let allowed = |a: usize, b: usize| {
            if b < a { own[b][a] == 0.0 } else { own[b][a].abs() <= own[a][a] }
        };
        if !self.is_as_given() || !(0..D).all(|a| (0..D).all(|b| allowed(a, b))) {
            return None;
        }
        let mut frame = ReducedBox { off: [0.0; 3], ..self.clone() };
        for a in (0..D).filter(|&a| self.periodic[a]) {
            let dual = 1.0 / own[a][a];
            frame.duals[a] = fill(|k| if k == a { dual } else { 0.0 });
            frame.lengths[a] = dual * (1.0 + 8.0 * U);
            for b in a..D {
                shear[b][a] = dual * own[b][a];
                frame.off[a] += 16.0 * U * (1.0 + shear[b][a].abs());
            }
            frame.off[a] += (shear[a][a] - 1.0).abs();
            shear[a][a] = 0.0;
        }
        let usable = frame.lengths.iter().all(|length| length.is_finite());
        let tilted = shear != [[0.0; 3]; 3];
        (usable && tilted).then_some(ReducedBox { shear, order: [2, 1, 0], ..frame })
    }

    /// Returns whether this is the frame of an upright box in a tilted one.
    pub fn is_upright(&self) -> bool {
        self.order == [2, 1, 0]
    }

    /// Converts a shift by the vectors in use to a shift by the given ones. If a number reaches
    /// 2^29, the error holds the index of the given vector and the number.
    #[inline]
    pub fn given(&self, image: [i32; 3]) -> Result<[i32; 3], (usize, i64)> {
        if image == [0; 3] || self.numbers == AS_GIVEN {
            return Ok(image);
        }
        let mut given = [0; 3];
        for (b, number) in given.iter_mut().enumerate() {
            // The sum is at most 3 · 2^31 · 2^29, so it does not overflow.
            let sum: i64 =
                (0..3).map(|a| i64::from(image[a]) * i64::from(self.numbers[a][b])).sum();
            if sum.unsigned_abs() >= 1 << 29 {
                return Err((b, sum));
            }
            *number = sum as i32;
        }
        Ok(given)
    }

    /// Returns whether the vectors in use are the given ones.
    pub fn is_as_given(&self) -> bool {
        self.numbers == AS_GIVEN
    }

    /// Returns bounds for shifts by the given vectors from bounds for shifts by the vectors in use.
    pub fn most_given(&self, most: [f64; 3]) -> [f64; 3] {
        fill(|b| (0..3).map(|a| most[a] * f64::from(self.numbers[a][b]).abs()).sum())
    }

    /// Returns whether each vector points in the positive direction of the axis with its index. A
    /// fraction is then a single product that grows with its coordinate.
    pub fn is_along_axes(&self) -> bool {
        let along = |a: usize| (0..D).all(|k| k == a || self.duals[a][k] == 0.0);
        (0..3).all(|a| along(a) && (self.scale(a) > 0.0 || !self.periodic[a]))
    }

    /// Returns component `a` of dual `a`.
    pub fn scale(&self, a: usize) -> f64 {
        if a < D { self.duals[a][a] } else { 0.0 }
    }

    /// Returns the computed fraction ga·origin of the box's corner.
    pub fn corner(&self, a: usize) -> f64 {
        self.fraction(a, &self.origin)
    }

    /// Returns the computed fraction ga·x, within 4u times [`ReducedBox::most`] of the true value;
    /// 0 if the box is open along vector `a`.
    pub fn fraction(&self, a: usize, x: &[f64; D]) -> f64 {
        dot(self.duals[a], *x)
    }

    /// Returns the sum over coordinates of |ga| |x|, up to rounding.
    pub fn most(&self, a: usize, x: &[f64; D]) -> f64 {
        times(&self.duals[a], x)
    }

    /// Returns how often each given vector must be added to bring particle `index` from `x` into
    /// the box, up to rounding.
    #[inline]
    pub fn wrap(&self, index: u32, x: &[f64; D]) -> Result<[i32; 3], Refusal> {
        let from_corner = fill(|k| x[k] - self.origin[k]);
        let mut image = [0; 3];
        for a in (0..3).filter(|&a| self.periodic[a]) {
            let fraction = self.fraction(a, &from_corner);
            // The condition is also true if a difference overflows to NaN.
            if !(1.0 - MOST..MOST).contains(&fraction) {
                return Err(Refusal::Away { particle: index, vector: a, boxes: fraction.floor() });
            }
            image[a] = -floor(fraction);
        }
        self.given(image).map_err(|(vector, number)| Refusal::Away {
            particle: index,
            vector,
            boxes: -(number as f64),
        })
    }

    /// Returns the rounded position of an image of a particle at `x`; not finite if it overflows.
    #[inline]
    pub fn place(&self, x: &[f64; D], image: [i32; 3]) -> [f64; D] {
        shifted(x, image, &self.vectors)
    }

    /// Bounds image numbers by inequality (1) of the module, for points whose fractions along
    /// vector `a` differ by at most `spread`\[a\] and that lie within `reach`. Returns by how much
    /// more than |ga| R image numbers may differ from fractions, and a bound for all image numbers.
    pub fn coupling(&self, spread: [f64; 3], reach: f64) -> ([f64; 3], f64) {
        let most = (0..3)
            .filter(|&a| self.periodic[a])
            .map(|a| spread[a] + self.lengths[a] * reach)
            .fold(0.0, f64::max);
        let most = if self.is_upright() { 8.0 * most } else { 2.0 * most };
        (self.off.map(|off| most * off), most)
    }
}

/// Rounds down without a call to the library, for numbers in the range of an i32. The sum with 3 ·
/// 2^51 has the nearest integer in its lower bits.
#[inline(always)]
pub fn floor(x: f64) -> i32 {
    let nearest = (x + 6_755_399_441_055_744.0).to_bits() as i32;
    nearest - i32::from(f64::from(nearest) > x)
}

/// Returns a bound for the error of a position along one axis, for positions of at most `place` in
/// magnitude that are sums of terms of at most `terms` in total magnitude.
pub fn off_by(place: f64, terms: f64) -> f64 {
    2.0 * U * place + SECOND * terms + LEAST
}

/// Returns the product of two vectors as [`dot`] does, but of the magnitudes of their components.
fn times<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (0..D).map(|k| (a[k] * b[k]).abs()).sum()
}
