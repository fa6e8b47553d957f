//! How deep two particles overlap relative to their size, accurate to 10^-15 however small the
//! overlap.
//!
//! The depth is (ra + rb - |a - b|) / ((ra + rb) / 2). Evaluated in this form it loses all digits
//! near tangency. Let s = ra + rb and d = |a - b|. The code computes 2(s² - d²) / (s(s + d))
//! instead. The only difference in this is of two squares, and those are exact integers (see
//! [`exact`]).
//!
//! **Error.** Let u = 2^-53. Each of the integers s², d² and |s² - d²| is cut to 63 or 64 bits and
//! then rounded to a double, with a relative error of at most u(1 + 2^-8). A square root halves the
//! error of its argument and adds u: at most 1.51u for s and for d. The sum s + d adds u. The
//! product with s adds 1.51u and u. The quotient adds the error of s² - d² and u. In total this is
//! at most 7.1u to first order, below 10^-15. Powers of two are kept apart, so that nothing
//! overflows or underflows before the last step. That step rounds a depth of magnitude below
//! 2^-1022 to a multiple of 2^-1074.

use super::image::Shift;
use super::{exact, image};

/// Returns the overlap of two particles divided by their mean radius: positive for an overlap,
/// negative for a gap, 0 only for exact tangency.
///
/// The relative error is below 10^-15 (for subnormal depths the absolute error is below 2^-1074),
/// and the sign always agrees with [`exact::compare`]. Two points (ra + rb = 0) have depth 0 if
/// they coincide, else minus infinity. A gap that overflows is minus infinity, too. All numbers
/// must be finite and radii must not be negative.
pub fn depth<const D: usize>(a: &[f64; D], b: &[f64; D], ra: f64, rb: f64) -> f64 {
    if let Some((distance, reach)) = exact::short(a, b, ra, rb) {
        // As distance < 2^128 and reach >= 2^121, the roots and their product are normal doubles.
        let (s, d) = ((reach as f64).sqrt(), (distance as f64).sqrt());
        let depth = 2.0 * reach.abs_diff(distance) as f64 / (s * (s + d));
        return if reach < distance { -depth } else { depth };
    }
    image::with_squares(a, b, ra, rb, Shift::NONE, relative)
}

/// Returns the [`depth`] for the first particle and an image of the second; see [`image::compare`].
pub fn depth_of_image<const D: usize>(
    a: &[f64; D],
    b: &[f64; D],
    ra: f64,
    rb: f64,
    shift: Shift<'_, D>,
) -> f64 {
    if shift.is_none() {
        return depth(a, b, ra, rb);
    }
    image::with_squares(a, b, ra, rb, shift, relative)
}

fn relative(distance: &[u64], reach: &[u64]) -> f64 {
    let order = exact::compare_words(reach, distance);
    let mut rest = [0; image::SQUARE_WORDS];
    let (large, small) = if order.is_lt() { (distance, reach) } else { (reach, distance) };
    exact::subtract(large, small, &mut rest);
    let ((rest, rest_power), (d, d_power), (s, s_power)) =
        (leading(&rest), leading(distance), leading(reach));
    let sign = if order.is_lt() { -1.0 } else { 1.0 };
    if rest == 0.0 {
        return 0.0;
    }
    if s == 0.0 {
        return f64::NEG_INFINITY;
    }
    let (d, s, power) = (d.sqrt(), s.sqrt(), (d_power - s_power) / 2);
    if power > 64 {
        // The particles are far apart: d/s > 2^32, nothing cancels; the result may be -infinity.
        return 2.0 * (1.0 - libm::scalbn(d / s, power));
    }
    let depth = libm::scalbn(2.0 * rest / (s * (s + libm::scalbn(d, power))), rest_power - s_power);
    // The particles are not tangent, so the depth must not underflow to zero.
    sign * depth.max(f64::from_bits(1))
}

/// Returns (m, p) such that m·2^p is the number, cut to 63 or 64 bits and then rounded; p is even
/// and m < 2^64.
fn leading(words: &[u64]) -> (f64, i32) {
    let Some(top) = words.iter().rposition(|&word| word != 0) else {
        return (0.0, 0);
    };
    let bits = 64 * top + 64 - words[top].leading_zeros() as usize;
    let shift = bits.saturating_sub(64).next_multiple_of(2);
    let (word, bit) = (shift / 64, shift % 64);
    let above = words.get(word + 1).copied().unwrap_or(0);
    let cut = ((u128::from(above) << 64 | u128::from(words[word])) >> bit) as u64;
    (cut as f64, shift as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depths_known_by_hand() {
        assert_eq!(depth(&[0.0, 0.0], &[3.0, 4.0], 2.0, 3.0), 0.0);
        assert_eq!(depth(&[0.0, 0.0], &[3.0, 4.0], 3.0, 3.0), 1.0 / 3.0);
        assert_eq!(depth(&[0.0, 0.0], &[6.0, 8.0], 3.0, 3.0), -4.0 / 3.0);
        assert_eq!(depth(&[1.0, 2.0, 3.0], &[1.0, 2.0, 3.0], 0.5, 0.25), 2.0);
        // A gap of 2^-52 in a distance of 1, and an overlap of 2^-53.
        assert_eq!(depth(&[0.0, 0.0], &[1.0f64.next_up(), 0.0], 0.5, 0.5), -2.0f64.powi(-51));
        assert_eq!(depth(&[0.0, 0.0], &[1.0f64.next_down(), 0.0], 0.5, 0.5), 2.0f64.powi(-52));
        // The gap is y² / 2 = 2^-201, far below the spacing of doubles at this distance.
        let gap = depth(&[0.0, 2.0f64.powi(-100)], &[1.0, 0.0], 0.5, 0.5);
        assert_eq!(gap, -(2.0f64.powi(-200)));
    }
}
