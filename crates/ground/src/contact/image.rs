//! The sign of |a - b - S·H|² - (ra + rb)² in exact arithmetic: the contact test between a particle
//! and an image of another.
//!
//! The shift S is three 32-bit integers, and H is three vectors of doubles. The difference along an
//! axis is a sum of five terms, each a double or an integer times a double. As in [`exact`], all
//! terms become integers in one unit and nothing is rounded. The shifted centre, which may not fit
//! a double, is never computed. Two widths are used:
//!
//! * *narrow*: let all significant bits of the doubles lie within m binary places, and |S| < 2^s. A
//!   difference is below 2·2^m + 3·2^(m+s) <= 2^(m+s+2) for s >= 1, and below 2^(m+1) without a
//!   shift. If m + s <= 124, it fits an `i128`, as does each term. Its square is below 2^252, and
//!   the sum of up to four squares below 2^254.
//! * *wide*: fixed point in units of 2^-1074. Positive and negative terms are added separately, so
//!   every sum is at most (2 + 3·2^31)·2^1024 < 2^1057. This is 2^2131 units and fits 34 words. The
//!   sum of up to four squares is below 2^4264 and fits 68.

use std::cmp::Ordering;

use super::exact::{
    self, add256, compare_words, fixed, integer, parts, square, square256, subtract, sum, words,
};

/// A shift by integer multiples of vectors. It takes a particle at b to its image at b + S·H.
#[derive(Clone, Copy, Debug)]
pub struct Shift<'a, const D: usize> {
    /// Shift S: the multiple of each vector.
    pub image: [i32; 3],
    /// Vectors H, one per row. All numbers must be finite.
    pub vectors: &'a [[f64; D]; 3],
}

impl<const D: usize> Shift<'_, D> {
    /// Shift 0, which stands for the particle itself.
    pub const NONE: Shift<'static, D> = Shift { image: [0; 3], vectors: &[[0.0; D]; 3] };

    /// Returns whether the shift is 0, which stands for the particle itself.
    pub fn is_none(&self) -> bool {
        self.image == [0; 3]
    }

    fn terms(&self) -> impl Iterator<Item = (i32, &[f64; D])> {
        self.image.into_iter().zip(self.vectors).filter(|(count, _)| *count != 0)
    }
}

/// Compares |a - b - S·H|² with (ra + rb)² exactly: `Less` means overlap, `Equal` tangent,
/// `Greater` apart.
///
/// All numbers must be finite and radii must not be negative.
#[cold]
pub fn compare<const D: usize>(
    a: &[f64; D],
    b: &[f64; D],
    ra: f64,
    rb: f64,
    shift: Shift<'_, D>,
) -> Ordering {
    if shift.is_none() {
        return exact::compare(a, b, ra, rb);
    }
    with_squares(a, b, ra, rb, shift, compare_words)
}

/// Calls `then` with |a - b - S·H|² and (ra + rb)² as integers in one unit. Both have the same
/// number of words, the lowest first.
pub(super) fn with_squares<O, const D: usize>(
    a: &[f64; D],
    b: &[f64; D],
    ra: f64,
    rb: f64,
    shift: Shift<'_, D>,
    then: impl FnOnce(&[u64], &[u64]) -> O,
) -> O {
    let (mut lowest, mut highest) = (i32::MAX, i32::MIN);
    let vectors = shift.terms().flat_map(|(_, vector)| vector);
    for &x in a.iter().chain(b).chain([&ra, &rb]).chain(vectors) {
        let (mantissa, exponent) = (parts(x).mantissa, parts(x).exponent);
        if mantissa != 0 {
            lowest = lowest.min(exponent + mantissa.trailing_zeros() as i32);
            highest = highest.max(exponent + 64 - mantissa.leading_zeros() as i32);
        }
    }
    if lowest > highest {
        return then(&[0], &[0]); // every number is zero
    }
    let most = shift.image.iter().fold(0, |most, count| most | count.unsigned_abs());
    let bits = 32 - most.leading_zeros() as i32;
    if highest - lowest + bits <= 124 && D <= 4 {
        let (distance, reach) = narrow(a, b, ra, rb, shift, lowest);
        then(&words(distance), &words(reach))
    } else {
        let (distance, reach) = wide(a, b, ra, rb, shift);
        then(&distance, &reach)
    }
}

/// Returns |a - b - S·H|² and (ra + rb)² in units of 2^(2·lowest), each as high and low 128 bits.
fn narrow<const D: usize>(
    a: &[f64; D],
    b: &[f64; D],
    ra: f64,
    rb: f64,
    shift: Shift<'_, D>,
    lowest: i32,
) -> ((u128, u128), (u128, u128)) {
    let integer = |x: f64| integer(x, lowest);
    let mut distance = (0, 0);
    for k in 0..D {
        let shifted: i128 =
            shift.terms().map(|(count, vector)| i128::from(count) * integer(vector[k])).sum();
        let difference = integer(a[k]) - integer(b[k]) - shifted;
        distance = add256(distance, square256(difference.unsigned_abs()));
    }
    (distance, square256((integer(ra) + integer(rb)).unsigned_abs()))
}

/// Number of words for a sum of terms, in units of 2^-1074.
const WORDS: usize = 34;
/// Number of words for the square of a sum of terms.
pub(super) const SQUARE_WORDS: usize = 2 * WORDS;
type Word = [u64; WORDS];
type Square = [u64; SQUARE_WORDS];

fn wide<const D: usize>(
    a: &[f64; D],
    b: &[f64; D],
    ra: f64,
    rb: f64,
    shift: Shift<'_, D>,
) -> (Square, Square) {
    let mut distance: Square = [0; SQUARE_WORDS];
    for k in 0..D {
        // Sum of the positive terms, and sum of the magnitudes of the negative terms.
        let mut sums: [Word; 2] = [[0; WORDS]; 2];
        let mut add = |count: i64, x: f64| {
            let negative = (count < 0) != x.is_sign_negative();
            add_times(&mut sums[usize::from(negative)], count.unsigned_abs(), x);
        };
        add(1, a[k]);
        add(-1, b[k]);
        shift.terms().for_each(|(count, vector)| add(-i64::from(count), vector[k]));
        let [positive, negative] = sums;
        let mut difference: Word = [0; WORDS];
        if compare_words(&positive, &negative) == Ordering::Less {
            subtract(&negative, &positive, &mut difference);
        } else {
            subtract(&positive, &negative, &mut difference);
        }
        distance = sum(&distance, &square(&difference));
    }
    (distance, square(&sum(&fixed::<WORDS>(ra), &fixed(rb))))
}

/// Adds `count` times |x| to `sum`; `count` is at most 2^31.
fn add_times(sum: &mut Word, count: u64, x: f64) {
    let mut carry = 0u128;
    for (to, word) in sum.iter_mut().zip(fixed::<WORDS>(x)) {
        // The sum is below 2^95 + 2^65, so it does not overflow.
        carry += u128::from(word) * u128::from(count) + u128::from(*to);
        *to = carry as u64;
        carry >>= 64;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_widths_agree_where_they_apply() {
        let values = [0.0, 1.0, -1.0, 0.1, 3.0, -4.0, 1e9, -1e-9, 2.5f64.next_up(), 2.5];
        let images = [[0; 3], [1, 0, 0], [-1, 2, 0], [0, 0, 1], [i32::MIN, i32::MAX, -7]];
        let mut narrow = 0;
        for (k, &x) in values.iter().enumerate() {
            for &y in &values {
                for image in images {
                    let vectors = [[x, y], [values[(k + 3) % 10], 1.0], [0.0, y]];
                    let (a, b, shift) = ([y, 3.0], [x, -1.0], Shift { image, vectors: &vectors });
                    let (distance, reach) = wide(&a, &b, 0.5, 2.5, shift);
                    let truth = compare_words(&distance, &reach);
                    assert_eq!(compare(&a, &b, 0.5, 2.5, shift), truth, "{a:?} {b:?} {shift:?}");
                    with_squares(&a, &b, 0.5, 2.5, shift, |d, _| {
                        narrow += usize::from(d.len() < SQUARE_WORDS);
                    });
                }
            }
        }
        assert!(narrow > 300, "{narrow}");
    }

    /// Tests numbers from far inside the range of the narrow form to beyond it, tangent and not.
    #[test]
    fn the_narrow_form_declines_numbers_too_large_for_it() {
        let mut narrow = 0;
        for places in 50..130 {
            let x = f64::from_bits((1023 + places) << 52);
            let vectors = [[x, 1.0], [-x, x], [x, -x]];
            for image in [[i32::MAX; 3], [i32::MIN, i32::MAX, i32::MIN], [1, 0, 0], [0, -40, 3]] {
                let (a, b, shift) = ([-x, 0.0], [x, 1.0], Shift { image, vectors: &vectors });
                for r in [0.0, x, 2.0 * x, 3.0 * x] {
                    let (distance, reach) = wide(&a, &b, r, 1.0, shift);
                    let truth = compare_words(&distance, &reach);
                    assert_eq!(compare(&a, &b, r, 1.0, shift), truth, "{places} {r:e} {shift:?}");
                    with_squares(&a, &b, r, 1.0, shift, |d, _| {
                        narrow += usize::from(d.len() < SQUARE_WORDS);
                    });
                }
            }
        }
        assert!((600..1000).contains(&narrow), "{narrow}");
    }

    #[test]
    fn the_largest_and_the_smallest_numbers_are_decided() {
        let (huge, tiny) = (f64::MAX, f64::from_bits(1));
        let vectors = [[huge, 0.0], [-huge, 0.0], [huge, tiny]];
        let compare = |a: [f64; 2], b, ra, rb, image| {
            compare(&a, &b, ra, rb, Shift { image, vectors: &vectors })
        };
        // The shifts cancel in all but one vector, or completely.
        assert!(compare([0.0; 2], [0.0; 2], huge, 0.0, [i32::MAX, i32::MAX - 1, 0]).is_eq());
        assert!(compare([0.0; 2], [0.0; 2], huge, 0.0, [i32::MAX, i32::MAX - 2, 0]).is_gt());
        assert!(compare([tiny, 0.0], [0.0; 2], tiny, 0.0, [i32::MIN, i32::MIN, 0]).is_eq());
        assert!(compare([tiny, 0.0], [0.0; 2], 0.0, 0.0, [i32::MIN, i32::MIN, 0]).is_gt());
        assert!(compare([0.0; 2], [0.0; 2], tiny, 0.0, [0, 1, 1]).is_eq());
        assert!(compare([0.0, tiny], [0.0; 2], 0.0, 0.0, [0, 1, 1]).is_eq());
        assert!(compare([huge, 0.0], [-huge, 0.0], huge, huge, [i32::MIN; 3]).is_gt());
        assert!(compare([huge, 0.0], [-huge, 0.0], huge, huge, [0, 0, 1]).is_lt());
        // Shift and distance cancel up to 1e-300, which no single double can represent.
        let one = [[1.0, 0.0], [0.0, 1.0], [0.0; 2]];
        let shift = Shift { image: [i32::MAX, 0, 0], vectors: &one };
        let a = [2147483648.0, 1e-300];
        assert!(super::compare(&a, &[1.0, 0.0], 0.0, 1e-300, shift).is_eq());
        assert!(super::compare(&a, &[1.0, 0.0], 0.0, 1e-301, shift).is_gt());
    }
}
