//! The box as numbers of one dimension: fractions along its vectors, places of images.
//!
//! u = 2^-53. "Dual" is the computed vector, whatever its error: it is a double like any other, and
//! what follows asks of it only what is measured here.
//!
//! **Which images are near.** For periodic vectors Ha and duals ga let rab = |ga·Hb - [a = b]|. Let
//! two points be p and p' with |p - p' - T·H| <= R. The product of ga with this difference gives
//!
//! ```text
//! |Ta - ga·(p - p')| <= |ga| R + sum over b of |Tb| rab.       (1)
//! ```
//!
//! With ca >= |ga·(p - p')| + |ga| R, c the largest of them, and all sums of rab over b at most
//! 1/4, the largest |T| is at most c + |T|/4, hence below 2c. So Ta is within |ga| R + 2c·off(a) of
//! ga·(p - p'), where off(a) is the sum: [`Frame::coupling`]. Boxes whose off is above 1/4 are
//! refused: their vectors are so long and so nearly in one plane that no filter in f64 can tell
//! their images apart.
//!
//! **Which vectors.** All this is true of any vectors of the lattice. Where the given ones make
//! many more images than the shortest ([`Lattice::reduced`]), as in a box whose tilt is many box
//! lengths, H are the shortest, whole numbers times the given ones. They are rounded: where a
//! product with them stands above, what their errors (`off_by`) make of it is added to rab. T,
//! and the numbers that bring particles into the box, are of these vectors; what a body is called,
//! and everything that is decided, of the given ones ([`Frame::given`]). Vectors that are nearly as
//! good are left as they are, so that particles in the box are in the frame, and need not be moved.
//!
//! **Places.** x + S·H is computed with the errors of all products (by a fused multiplication) and
//! of all sums (by two-sum) added up beside it. Both are exact, but for underflow in products, at
//! most 3 · 2^-1075. The six errors are at most u(1 + u)^3 times m = |x| + the sum of |Sa Ha|,
//! each; adding them up makes an error of at most 6u · 6u(1 + 9u) m < 2^-100 m; and the last sum is
//! rounded. So the place is within u|place| + 2^-100 m + 2^-1073 of the true one: `off_by` takes
//! twice as much. A place that is not shifted is exact.

use crate::refusal::Refusal;
use crate::scene::Lattice;
use crate::scene::lattice::{AS_GIVEN, Numbers, shifted};

/// 2^-53.
pub const U: f64 = 1.0 / (1u64 << 53) as f64;
/// 2^-99.
const SECOND: f64 = f64::from_bits((1023 - 99) << 52);
/// 2^-1070.
const LEAST: f64 = f64::from_bits(1 << 4);
/// Numbers of images stay below this in magnitude, so that a sum of three fits an `i32`.
pub(super) const MOST: f64 = (1u64 << 29) as f64;
/// Other vectors are taken if the sum of their duals is below this part of that of the given ones:
/// images are as many as that sum is large.
const BETTER: f64 = 0.75;

/// See the page.
#[derive(Clone, Debug)]
pub struct Frame<const D: usize> {
    /// Whether the box repeats along each vector.
    pub periodic: [bool; 3],
    /// As given; zeros where the box is open.
    pub vectors: [[f64; D]; 3],
    /// The frame's own vectors in those.
    numbers: Numbers,
    /// The frame's own vectors, rounded; zeros where the box is open.
    pub own: [[f64; D]; 3],
    /// Of the frame's own vectors; zeros where the box is open.
    duals: [[f64; D]; 3],
    origin: [f64; D],
    /// Upper bounds for the lengths of the duals.
    pub lengths: [f64; 3],
    /// Upper bounds for the sums of rab over b.
    off: [f64; 3],
}

impl<const D: usize> Frame<D> {
    /// By the vectors as given, or shorter ones.
    ///
    /// # Errors
    /// [`Refusal::Skewed`].
    pub fn new(lattice: &Lattice) -> Result<Frame<D>, Refusal> {
        let given = Frame::of(lattice, lattice, AS_GIVEN);
        let (reduced, numbers) = lattice.reduced();
        if numbers == AS_GIVEN {
            return given;
        }
        let reduced = Frame::of(lattice, &reduced, numbers);
        let images = |frame: &Frame<D>| frame.lengths.iter().sum::<f64>();
        match (given, reduced) {
            (Ok(given), Ok(reduced)) if images(&reduced) < BETTER * images(&given) => Ok(reduced),
            (Err(_), Ok(reduced)) => Ok(reduced),
            (given, _) => given,
        }
    }

    /// By vectors that are so many times the given ones.
    pub(super) fn of(
        given: &Lattice,
        lattice: &Lattice,
        numbers: Numbers,
    ) -> Result<Frame<D>, Refusal> {
        let periodic = given.periodic();
        let cut = |vector: [f64; 3]| std::array::from_fn(|k| vector[k]);
        let row = |a: usize, vector: [f64; 3]| if periodic[a] { cut(vector) } else { [0.0; D] };
        let vectors: [[f64; D]; 3] = std::array::from_fn(|a| row(a, given.vectors()[a]));
        let own: [[f64; D]; 3] = std::array::from_fn(|a| row(a, lattice.vectors()[a]));
        let duals: [[f64; D]; 3] = std::array::from_fn(|a| row(a, lattice.dual(a)));
        // By how much a vector of the frame is off along each axis.
        let error = |a: usize| -> [f64; D] {
            if numbers == AS_GIVEN {
                return [0.0; D];
            }
            std::array::from_fn(|k| {
                let terms = (0..3).map(|b| f64::from(numbers[a][b]).abs() * vectors[b][k].abs());
                off_by(own[a][k].abs(), terms.sum())
            })
        };
        let (mut lengths, mut off) = ([0.0; 3], [0.0; 3]);
        for a in (0..3).filter(|&a| periodic[a]) {
            // Above the root of the sum of squares.
            lengths[a] = size(&duals[a]) * (1.0 + 8.0 * U);
            for b in (0..3).filter(|&b| periodic[b]) {
                let expected = f64::from(u8::from(a == b));
                let rounded = 16.0 * U * (1.0 + times(&duals[a], &own[b]));
                let of_vector = 2.0 * times(&duals[a], &error(b));
                off[a] += (dot(&duals[a], &own[b]) - expected).abs() + rounded + of_vector;
            }
            // Also where it is no number.
            if !(off[a] <= 0.25 && lengths[a].is_finite()) {
                return Err(Refusal::Skewed { vector: a });
            }
        }
        let origin = cut(given.origin());
        Ok(Frame { periodic, vectors, numbers, own, duals, origin, lengths, off })
    }

    /// Numbers of the frame's own vectors as numbers of the given ones; beyond 2^29, which of the
    /// given vectors, and its number.
    #[inline]
    pub fn given(&self, image: [i32; 3]) -> Result<[i32; 3], (usize, i64)> {
        if image == [0; 3] || self.numbers == AS_GIVEN {
            return Ok(image);
        }
        let mut given = [0; 3];
        for (b, number) in given.iter_mut().enumerate() {
            // At most 3 · 2^31 · 2^29.
            let sum: i64 =
                (0..3).map(|a| i64::from(image[a]) * i64::from(self.numbers[a][b])).sum();
            if sum.unsigned_abs() >= 1 << 29 {
                return Err((b, sum));
            }
            *number = sum as i32;
        }
        Ok(given)
    }

    /// Are its vectors those that were given?
    pub fn is_as_given(&self) -> bool {
        self.numbers == AS_GIVEN
    }

    /// Images by up to so many of the frame's own vectors have so many of the given ones.
    pub fn most_given(&self, most: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|b| (0..3).map(|a| most[a] * f64::from(self.numbers[a][b]).abs()).sum())
    }

    /// Is every vector along the axis of its number, and not against it? Then a fraction is one
    /// product, and grows with its coordinate.
    pub fn is_along_axes(&self) -> bool {
        let along = |a: usize| (0..D).all(|k| k == a || self.duals[a][k] == 0.0);
        (0..3).all(|a| along(a) && (self.scale(a) > 0.0 || !self.periodic[a]))
    }

    /// The part of the dual along its own axis.
    pub fn scale(&self, a: usize) -> f64 {
        if a < D { self.duals[a][a] } else { 0.0 }
    }

    /// ga·origin as computed.
    pub fn corner(&self, a: usize) -> f64 {
        self.fraction(a, &self.origin)
    }

    /// ga·x as computed: within 4u times [`Frame::most`] of what is true; 0 where the box is open.
    pub fn fraction(&self, a: usize, x: &[f64; D]) -> f64 {
        dot(&self.duals[a], x)
    }

    /// The sum of |ga| |x| by coordinates, or somewhat less.
    pub fn most(&self, a: usize, x: &[f64; D]) -> f64 {
        times(&self.duals[a], x)
    }

    /// The numbers of the given vectors that bring particle `index` at `x` about into the box.
    pub fn wrap(&self, index: u32, x: &[f64; D]) -> Result<[i32; 3], Refusal> {
        let from_corner = std::array::from_fn(|k| x[k] - self.origin[k]);
        let mut image = [0; 3];
        for a in (0..3).filter(|&a| self.periodic[a]) {
            let fraction = self.fraction(a, &from_corner);
            if (0.0..1.0).contains(&fraction) {
                continue;
            }
            let boxes = fraction.floor();
            // Also where a difference overflows and it is no number.
            if boxes.is_nan() || boxes.abs() >= MOST {
                return Err(Refusal::Away { particle: index, vector: a, boxes });
            }
            image[a] = -(boxes as i32);
        }
        self.given(image).map_err(|(vector, number)| Refusal::Away {
            particle: index,
            vector,
            boxes: -(number as f64),
        })
    }

    /// Where the image of a particle at `x` by so many of the given vectors is, rounded; not finite
    /// where that overflows.
    pub fn place(&self, x: &[f64; D], image: [i32; 3]) -> [f64; D] {
        shifted(x, image, &self.vectors)
    }

    /// For points whose fractions along vector `a` differ by at most `spread`\[a\], and that are to
    /// be within `reach`: by how much more than |ga| R the numbers of images may differ from
    /// fractions, and a bound for them; (1) on this page.
    pub fn coupling(&self, spread: [f64; 3], reach: f64) -> ([f64; 3], f64) {
        let most = (0..3)
            .filter(|&a| self.periodic[a])
            .map(|a| spread[a] + self.lengths[a] * reach)
            .fold(0.0, f64::max);
        (self.off.map(|off| 2.0 * most * off), 2.0 * most)
    }
}

/// A bound for the distance along one axis between a place and what is true: for places of at most
/// `place` in magnitude, from terms whose magnitudes have at most this sum.
pub(super) fn off_by(place: f64, terms: f64) -> f64 {
    2.0 * U * place + SECOND * terms + LEAST
}

fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (0..D).map(|k| a[k] * b[k]).sum()
}

/// As [`dot`], of magnitudes.
fn times<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (0..D).map(|k| (a[k] * b[k]).abs()).sum()
}

fn size<const D: usize>(a: &[f64; D]) -> f64 {
    dot(a, a).sqrt()
}
