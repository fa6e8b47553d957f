//! The sign of |a - b|² - (ra + rb)² in exact arithmetic, for all finite binary numbers.
//!
//! A binary floating-point number is an integer times a power of two. All numbers of one test are
//! scaled by one common power of two. Their differences, sums and squares are then integers, and
//! nothing is rounded: underflow and overflow cannot occur, and subnormals need no special case.
//! The *short* form takes the differences `a[k] - b[k]` and the sum ra + rb in units of 2^-62 of
//! the sum, rounded to a power of two. If all of them are integers below 2^62, their squares fit in
//! 128 bits; this holds for nearly every pair near tangency. Other pairs are decided like a contact
//! with an image of shift 0: see [`super::image`]. Nothing here allocates.
//!
//! **The short form.** Knuth's two-sum computes h = fl(x ± y) and the error l, with x ± y = h + l
//! exactly, for any order of magnitudes, unless a sum overflows (Dekker 1971,
//! doi:10.1007/BF01397083; Shewchuk 1997, doi:10.1007/PL00009321, theorem 7). The error of a sum is
//! a multiple of the smallest subnormal, so it never underflows. Let s be the h of ra + rb,
//! required to lie in [2^-900, 2^60), and c the power of two that scales s into [2^61, 2^62). Then
//! c lies in [2^2, 2^962) and is a double. As c > 1, the product c·x of a double x is exact or
//! overflows to infinity.
//!
//! A value v = c·x must pass two checks. First, |v| < 2^62, so that `v as i64` truncates and never
//! saturates. Second, the integer converted back equals v, so that nothing was truncated. NaN and
//! infinities fail. If the h and l of a sum pass, the sum in units of 1/c is the sum of their
//! integers, at most 2^62 + 2^62 in magnitude, which does not overflow `i64`. An l is at most half
//! an ulp of its h, so below 2^62 · 2^-53. The integers are therefore below 2^62 + 2^9, their
//! squares below 2^124 + 2^73, and the sum of up to 15 squares below 2^128. Every step is exact, so
//! the comparison is exact.

use std::cmp::Ordering;

use super::image::{Shift, with_squares};

/// Whether two particles are apart, tangent or overlapping.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Label {
    /// |a - b| > ra + rb: no contact.
    Apart,
    /// |a - b| = ra + rb: contact, at one point.
    Tangent,
    /// |a - b| < ra + rb: contact.
    Overlap,
}

impl Label {
    /// All labels, from the largest gap to the deepest overlap.
    pub const ALL: [Label; 3] = [Label::Apart, Label::Tangent, Label::Overlap];

    /// Returns the name used in records and tables.
    pub fn name(self) -> &'static str {
        match self {
            Label::Apart => "apart",
            Label::Tangent => "tangent",
            Label::Overlap => "overlap",
        }
    }

    /// Returns whether particles with this label touch. Tangent particles touch.
    pub fn touches(self) -> bool {
        self != Label::Apart
    }
}

/// Returns whether particles of radii `ra` and `rb` at `a` and `b` are apart, tangent or
/// overlapping, exactly for the given numbers.
///
/// All numbers must be finite and radii must not be negative.
pub fn label<const D: usize>(a: &[f64; D], b: &[f64; D], ra: f64, rb: f64) -> Label {
    match compare(a, b, ra, rb) {
        Ordering::Less => Label::Overlap,
        Ordering::Equal => Label::Tangent,
        Ordering::Greater => Label::Apart,
    }
}

/// Compares |a - b|² with (ra + rb)² exactly: `Less` means overlap, `Equal` tangent, `Greater`
/// apart.
///
/// All numbers must be finite and radii must not be negative.
#[cold]
pub fn compare<const D: usize>(a: &[f64; D], b: &[f64; D], ra: f64, rb: f64) -> Ordering {
    match short(a, b, ra, rb) {
        Some((distance, reach)) => distance.cmp(&reach),
        None => long(a, b, ra, rb),
    }
}

/// Returns |a - b|² and (ra + rb)² as integers in one unit, or `None` if the short form cannot hold
/// them.
#[inline(always)]
pub(super) fn short<const D: usize>(
    a: &[f64; D],
    b: &[f64; D],
    ra: f64,
    rb: f64,
) -> Option<(u128, u128)> {
    const MOST: f64 = (1u64 << 62) as f64;
    let (s, s_rest) = two_sum(ra, rb);
    let field = s.to_bits() >> 52;
    if !(1023 - 900..1023 + 60).contains(&field) || D > 15 {
        return None;
    }
    let c = f64::from_bits((2 * 1023 + 61 - field) << 52);
    let mut exact = true;
    let mut integer = |x: f64| {
        let x = x * c;
        let whole = x as i64;
        exact &= x.abs() < MOST && whole as f64 == x;
        whole
    };
    let (mut sum, mut differences, mut rests) = (integer(s), [0; D], [0.0; D]);
    let mut one_double = s_rest == 0.0;
    for k in 0..D {
        let (d, rest) = two_sum(a[k], -b[k]);
        (differences[k], rests[k]) = (integer(d), rest);
        one_double &= rest == 0.0;
    }
    if !one_double {
        sum = sum.wrapping_add(integer(s_rest));
        for k in 0..D {
            differences[k] = differences[k].wrapping_add(integer(rests[k]));
        }
    }
    let square = |x: i64| u128::from(x.unsigned_abs()) * u128::from(x.unsigned_abs());
    let distance = differences.into_iter().fold(0u128, |sum, d| sum.wrapping_add(square(d)));
    exact.then(|| (distance, square(sum)))
}

/// Returns s = fl(x + y) and its error x + y - s. The error is exact unless a sum overflows.
#[inline(always)]
fn two_sum(x: f64, y: f64) -> (f64, f64) {
    let sum = x + y;
    let part = sum - x;
    (sum, (x - (sum - part)) + (y - part))
}

#[cold]
fn long<const D: usize>(a: &[f64; D], b: &[f64; D], ra: f64, rb: f64) -> Ordering {
    with_squares(a, b, ra, rb, Shift::NONE, compare_words)
}

/// Splits a number of 256 bits into four words, the lowest first.
pub(super) fn words((high, low): (u128, u128)) -> [u64; 4] {
    [low as u64, (low >> 64) as u64, high as u64, (high >> 64) as u64]
}

/// A double split as ±mantissa · 2^exponent, with exponent >= -1074.
pub(super) struct Parts {
    pub negative: bool,
    pub mantissa: u64,
    pub exponent: i32,
}

pub(super) fn parts(x: f64) -> Parts {
    let bits = x.to_bits();
    let field = (bits >> 52 & 0x7ff) as i32;
    let fraction = bits & ((1 << 52) - 1);
    let (mantissa, exponent) =
        if field == 0 { (fraction, -1074) } else { (fraction | 1 << 52, field - 1075) };
    Parts { negative: x.is_sign_negative(), mantissa, exponent }
}

/// Returns x in units of 2^lowest. It must be a multiple of that unit and below 2^127 units.
#[inline(always)]
pub(super) fn integer(x: f64, lowest: i32) -> i128 {
    let Parts { negative, mantissa, exponent } = parts(x);
    if mantissa == 0 {
        return 0; // its exponent says nothing
    }
    let shift = exponent - lowest;
    // The bits below `lowest` are zero in every mantissa, so the right shift loses nothing.
    let magnitude =
        if shift >= 0 { i128::from(mantissa) << shift } else { i128::from(mantissa >> -shift) };
    if negative { -magnitude } else { magnitude }
}

/// Returns x² as its high and its low 128 bits.
pub(super) fn square256(x: u128) -> (u128, u128) {
    let (h, l) = (x >> 64, x & u128::from(u64::MAX));
    let middle = h * l; // below 2^126 for x below 2^127: its double does not overflow
    let (low, carry) = (l * l).overflowing_add(middle << 65);
    (h * h + (middle >> 63) + u128::from(carry), low)
}

pub(super) fn add256(a: (u128, u128), b: (u128, u128)) -> (u128, u128) {
    let (low, carry) = a.1.overflowing_add(b.1);
    (a.0 + b.0 + u128::from(carry), low)
}

/// Returns |x| as an integer in units of 2^-1074, in W >= 33 words.
pub(super) fn fixed<const W: usize>(x: f64) -> [u64; W] {
    let Parts { mantissa, exponent, .. } = parts(x);
    let shift = (exponent + 1074) as usize;
    let shifted = u128::from(mantissa) << (shift % 64);
    let mut words = [0; W];
    words[shift / 64] = shifted as u64;
    // The largest double ends in word 32. If the array ends there, `shifted >> 64` is zero.
    if let Some(word) = words.get_mut(shift / 64 + 1) {
        *word = (shifted >> 64) as u64;
    }
    words
}

/// Compares two integers that have the same number of words.
pub(super) fn compare_words(a: &[u64], b: &[u64]) -> Ordering {
    a.iter().rev().cmp(b.iter().rev())
}

pub(super) fn sum<const W: usize>(a: &[u64; W], b: &[u64; W]) -> [u64; W] {
    let (mut out, mut carry) = ([0; W], 0u128);
    for k in 0..W {
        carry += u128::from(a[k]) + u128::from(b[k]);
        out[k] = carry as u64;
        carry >>= 64;
    }
    out
}

/// Writes a - b to `out`. Requires a >= b and equal numbers of words.
pub(super) fn subtract(a: &[u64], b: &[u64], out: &mut [u64]) {
    let mut borrow = false;
    for ((a, b), out) in a.iter().zip(b).zip(out) {
        let (difference, first) = a.overflowing_sub(*b);
        let (difference, second) = difference.overflowing_sub(u64::from(borrow));
        *out = difference;
        borrow = first | second;
    }
}

/// Returns a², in twice the number of words of a.
pub(super) fn square<const W: usize, const S: usize>(a: &[u64; W]) -> [u64; S] {
    const { assert!(S == 2 * W) };
    let mut out = [0; S];
    for i in (0..W).filter(|&i| a[i] != 0) {
        let mut carry = 0u128;
        for j in 0..W {
            // The sum is at most (2^64-1)² + 2(2^64-1) = 2^128 - 1, so it does not overflow.
            carry += u128::from(a[i]) * u128::from(a[j]) + u128::from(out[i + j]);
            out[i + j] = carry as u64;
            carry >>= 64;
        }
        out[i + W] = carry as u64;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_short_form_agrees_where_it_applies() {
        let mut in_short = 0;
        let values = [0.0, 1.0, -1.0, 0.1, 3.0, 4.0, 5.0, 1e9, -1e-9, 2.5f64.next_up(), 2.5];
        for &x in &values {
            for &y in &values {
                for &r in values.iter().filter(|r| **r >= 0.0) {
                    let (a, b) = ([x, 3.0], [y, -1.0]);
                    let truth = long(&a, &b, r, 2.5);
                    assert_eq!(compare(&a, &b, r, 2.5), truth, "{a:?} {b:?} {r}");
                    in_short += usize::from(short(&a, &b, r, 2.5).is_some());
                }
            }
        }
        assert!(in_short > 450, "{in_short}");
    }

    /// Tests each condition of the short form at its limit: numbers within the limit give the true
    /// result, numbers beyond it `None`.
    #[test]
    fn the_short_form_declines_numbers_too_large_for_it() {
        let power = |k: i32| f64::from_bits(((1023 + k) as u64) << 52);
        for (r, inside) in [(-902, false), (-901, true), (0, true), (58, true), (59, false)] {
            let r = power(r); // the sum is 2r
            assert_eq!(short(&[0.0, 0.0], &[2.0 * r, 0.0], r, r).is_some(), inside, "{r:e}");
            assert_eq!(compare(&[0.0, 0.0], &[2.0 * r, 0.0], r, r), Ordering::Equal);
        }
        // The sum of the radii is 2, so the unit is 2^-60.
        assert!(short(&[0.0, power(-60)], &[2.0, 0.0], 1.0, 1.0).is_some());
        assert!(short(&[0.0, power(-61)], &[2.0, 0.0], 1.0, 1.0).is_none());
        assert!(short(&[4.0f64.next_down(), 0.0], &[0.0, 0.0], 1.0, 1.0).is_some());
        assert!(short(&[4.0, 0.0], &[0.0, 0.0], 1.0, 1.0).is_none());
        assert!(short(&[f64::MAX, 0.0], &[-f64::MAX, 0.0], 1.0, 1.0).is_none());
        // The difference and the sum each have an error that needs a second double.
        assert!(short(&[power(-60), 0.0], &[2.0, 0.0], 1.0, 1.0).is_some());
        assert_eq!(compare(&[power(-60), 0.0], &[2.0, 0.0], 1.0, 1.0), Ordering::Less);
        assert_eq!(compare(&[-power(-60), 0.0], &[2.0, 0.0], 1.0, 1.0), Ordering::Greater);
        assert_eq!(compare(&[-power(-60), 0.0], &[2.0, 0.0], 2.0, power(-60)), Ordering::Equal);
        assert!(short(&[0.0, 0.0], &[2.0, 0.0], 2.0, power(-61)).is_none());
        assert_eq!(short(&[0.0, 0.0], &[0.0, 0.0], 0.0, 0.0), None);
        assert_eq!(label(&[0.0, 0.0], &[0.0, 0.0], 0.0, 0.0), Label::Tangent);
        assert_eq!(Label::ALL.map(Label::name), ["apart", "tangent", "overlap"]);
        assert_eq!(Label::ALL.map(Label::touches), [false, true, true]);
    }
}
