//! The sign of |a - b|² - (ra + rb)² in exact arithmetic, for all finite binary numbers.
//!
//! A binary floating-point number is an integer times a power of two. The numbers of one test are brought to one common power
//! of two; then differences, sums and squares are integers and there is no rounding to argue about: no underflow, no
//! overflow, no special case for subnormals. Two widths do the work:
//!
//! * all significant bits of the inputs lie within 124 binary places (practically always): differences fit an `i128`, their
//!   squares and the sum of up to four of them fit 256 bits;
//! * anything else: fixed point with unit 2^-1074 in 33 words, squares in 66 words. Every finite double fits.
//!
//! Nothing here allocates.

use std::cmp::Ordering;

/// Compares |a - b|² with (ra + rb)² exactly: `Less` is overlap, `Equal` is tangency, `Greater` is apart.
///
/// All numbers must be finite; radii must not be negative.
#[cold]
pub fn compare<const D: usize>(a: &[f64; D], b: &[f64; D], ra: f64, rb: f64) -> Ordering {
    let (mut lowest, mut highest) = (i32::MAX, i32::MIN);
    for &x in a.iter().chain(b).chain([&ra, &rb]) {
        let Parts { mantissa, exponent, .. } = parts(x);
        if mantissa != 0 {
            lowest = lowest.min(exponent + mantissa.trailing_zeros() as i32);
            highest = highest.max(exponent + 64 - mantissa.leading_zeros() as i32);
        }
    }
    if lowest > highest {
        return Ordering::Equal; // every number is zero: two points at the same place
    }
    if highest - lowest <= 124 { narrow(a, b, ra, rb, lowest) } else { wide(a, b, ra, rb) }
}

/// A double as sign, integer mantissa and power of two: value = ±mantissa · 2^exponent, exponent >= -1074.
struct Parts {
    negative: bool,
    mantissa: u64,
    exponent: i32,
}

fn parts(x: f64) -> Parts {
    let bits = x.to_bits();
    let field = (bits >> 52 & 0x7ff) as i32;
    let fraction = bits & ((1 << 52) - 1);
    let (mantissa, exponent) = if field == 0 { (fraction, -1074) } else { (fraction | 1 << 52, field - 1075) };
    Parts { negative: x.is_sign_negative(), mantissa, exponent }
}

/// Magnitudes are below 2^124, so differences and the sum of radii are below 2^125, squares below 2^250, and their sum over at
/// most four dimensions below 2^252.
fn narrow<const D: usize>(a: &[f64; D], b: &[f64; D], ra: f64, rb: f64, lowest: i32) -> Ordering {
    let integer = |x: f64| -> i128 {
        let Parts { negative, mantissa, exponent } = parts(x);
        if mantissa == 0 {
            return 0; // its exponent says nothing
        }
        let shift = exponent - lowest;
        // Bits below `lowest` are zero in every mantissa, so the right shift is exact.
        let magnitude = if shift >= 0 { i128::from(mantissa) << shift } else { i128::from(mantissa >> -shift) };
        if negative { -magnitude } else { magnitude }
    };
    let mut distance = (0, 0);
    for k in 0..D {
        distance = add256(distance, square256((integer(a[k]) - integer(b[k])).unsigned_abs()));
    }
    let reach = (integer(ra) + integer(rb)).unsigned_abs();
    distance.cmp(&square256(reach))
}

/// (high, low) of x².
fn square256(x: u128) -> (u128, u128) {
    let (h, l) = (x >> 64, x & u128::from(u64::MAX));
    let middle = h * l; // below 2^126 for x below 2^127: its double does not overflow
    let (low, carry) = (l * l).overflowing_add(middle << 65);
    (h * h + (middle >> 63) + u128::from(carry), low)
}

fn add256(a: (u128, u128), b: (u128, u128)) -> (u128, u128) {
    let (low, carry) = a.1.overflowing_add(b.1);
    (a.0 + b.0 + u128::from(carry), low)
}

/// Words of a number in units of 2^-1074: magnitudes stay below 2^2099 after one addition.
const WORDS: usize = 33;
type Word = [u64; WORDS];
type Square = [u64; 2 * WORDS];

fn wide<const D: usize>(a: &[f64; D], b: &[f64; D], ra: f64, rb: f64) -> Ordering {
    let mut distance: Square = [0; 2 * WORDS];
    for k in 0..D {
        let (x, y) = (fixed(a[k]), fixed(b[k]));
        let difference = if a[k].is_sign_negative() != b[k].is_sign_negative() {
            sum(&x, &y)
        } else if compare_words(&x, &y) == Ordering::Less {
            subtract(&y, &x)
        } else {
            subtract(&x, &y)
        };
        distance = sum(&distance, &square(&difference));
    }
    compare_words(&distance, &square(&sum(&fixed(ra), &fixed(rb))))
}

/// |x| in units of 2^-1074.
fn fixed(x: f64) -> Word {
    let Parts { mantissa, exponent, .. } = parts(x);
    let shift = (exponent + 1074) as usize;
    let shifted = u128::from(mantissa) << (shift % 64);
    let mut words = [0; WORDS];
    words[shift / 64] = shifted as u64;
    // The largest double ends at bit 2098, in word 32: when there is no word above, nothing is left to put there.
    if let Some(word) = words.get_mut(shift / 64 + 1) {
        *word = (shifted >> 64) as u64;
    }
    words
}

fn compare_words(a: &[u64], b: &[u64]) -> Ordering {
    a.iter().rev().cmp(b.iter().rev())
}

fn sum<const W: usize>(a: &[u64; W], b: &[u64; W]) -> [u64; W] {
    let (mut out, mut carry) = ([0; W], 0u128);
    for k in 0..W {
        carry += u128::from(a[k]) + u128::from(b[k]);
        out[k] = carry as u64;
        carry >>= 64;
    }
    out
}

/// a - b for a >= b.
fn subtract(a: &Word, b: &Word) -> Word {
    let (mut out, mut borrow) = ([0; WORDS], false);
    for k in 0..WORDS {
        let (difference, first) = a[k].overflowing_sub(b[k]);
        let (difference, second) = difference.overflowing_sub(u64::from(borrow));
        out[k] = difference;
        borrow = first | second;
    }
    out
}

fn square(a: &Word) -> Square {
    let mut out = [0; 2 * WORDS];
    for i in (0..WORDS).filter(|&i| a[i] != 0) {
        let mut carry = 0u128;
        for j in 0..WORDS {
            // At most (2^64-1)² + 2(2^64-1) = 2^128 - 1: no overflow.
            carry += u128::from(a[i]) * u128::from(a[j]) + u128::from(out[i + j]);
            out[i + j] = carry as u64;
            carry >>= 64;
        }
        out[i + WORDS] = carry as u64;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_two_widths_agree_where_both_apply() {
        let values = [0.0, 1.0, -1.0, 0.1, 3.0, 4.0, 5.0, 1e9, -1e-9, 2.5f64.next_up(), 2.5];
        for &x in &values {
            for &y in &values {
                for &r in values.iter().filter(|r| **r >= 0.0) {
                    let (a, b) = ([x, 3.0], [y, -1.0]);
                    assert_eq!(compare(&a, &b, r, 2.5), wide(&a, &b, r, 2.5), "{a:?} {b:?} {r}");
                }
            }
        }
    }

    #[test]
    fn squares_that_overflow_or_vanish_are_decided() {
        let huge = f64::MAX;
        assert_eq!(compare(&[huge, 0.0], &[-huge, 0.0], huge, huge), Ordering::Equal);
        assert_eq!(compare(&[huge, 0.0], &[-huge, f64::from_bits(1)], huge, huge), Ordering::Greater);
        let tiny = f64::from_bits(1);
        assert_eq!(compare(&[0.0, 0.0], &[tiny, 0.0], tiny, 0.0), Ordering::Equal);
        assert_eq!(compare(&[0.0, 0.0], &[tiny, tiny], tiny, 0.0), Ordering::Greater);
        assert_eq!(compare(&[0.0, 0.0], &[tiny, tiny], tiny, tiny), Ordering::Less);
        assert_eq!(compare(&[-0.0, 0.0], &[0.0, 0.0], 0.0, 0.0), Ordering::Equal);
        assert_eq!(compare(&[1e300, tiny], &[1e300, 0.0], tiny, 0.0), Ordering::Equal);
    }
}
