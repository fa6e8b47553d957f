//! How deep two bodies overlap, relative to their size, to full precision however small it is.
//!
//! The depth is (ra + rb - |a - b|) over the mean radius (ra + rb) / 2. Evaluated as it stands it
//! loses every digit near tangency. With s = ra + rb and d = |a - b| we take 2(s² - d²) / (s(s +
//! d)): the only difference is that of the squares, and those are exact integers (see [`exact`]).
//!
//! **Error.** Let u = 2^-53. The integers s², d² and |s² - d²| become doubles with relative error
//! at most u(1 + 2^-8) each (cut to 63 or 64 bits, then rounded). A root halves that of its
//! argument and adds u: at most 1.51u for s and for d. The sum s + d adds u, the product with s
//! adds 1.51u and u, the quotient adds that of s² - d² and u: in total at most 7.1u to first order,
//! below 10^-15. Powers of two are kept apart, so nothing overflows or underflows before the last
//! step, where a depth of magnitude below 2^-1022 is rounded to a multiple of 2^-1074.

use super::image::Shift;
use super::{exact, image};

/// The overlap of two bodies relative to their mean radius: positive for overlap, negative for a
/// gap, 0 for exact tangency and only then.
///
/// The relative error is below 10^-15 (absolute 2^-1074 for subnormal depths), and the sign is
/// always that of [`exact::compare`]. For two points (ra + rb = 0): 0 where they coincide, else
/// minus infinity, as for gaps that overflow. All numbers must be finite; radii must not be
/// negative.
pub fn depth<const D: usize>(a: &[f64; D], b: &[f64; D], ra: f64, rb: f64) -> f64 {
    if let Some((distance, reach)) = exact::short(a, b, ra, rb) {
        // Below 2^128, the reach at least 2^121: far from both ends of the range.
        let (s, d) = ((reach as f64).sqrt(), (distance as f64).sqrt());
        let depth = 2.0 * reach.abs_diff(distance) as f64 / (s * (s + d));
        return if reach < distance { -depth } else { depth };
    }
    image::with_squares(a, b, ra, rb, Shift::NONE, relative)
}

/// The same of the first body and an image of the second: see [`image::compare`].
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

/// The depth for given squares of distance and sum of radii, in the same unit.
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
        // Far apart, nothing cancels: d/s is above 2^32. May overflow to minus infinity.
        return 2.0 * (1.0 - libm::scalbn(d / s, power));
    }
    let depth = libm::scalbn(2.0 * rest / (s * (s + libm::scalbn(d, power))), rest_power - s_power);
    // Not tangent, so not zero, even where the depth underflows.
    sign * depth.max(f64::from_bits(1))
}

/// (m, p) with m·2^p the number, p even and m below 2^64; cut to at least 63 bits, then rounded.
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
        // y² / 2 = 2^-201 too far apart, far below one ulp of the distance.
        let gap = depth(&[0.0, 2.0f64.powi(-100)], &[1.0, 0.0], 0.5, 0.5);
        assert_eq!(gap, -(2.0f64.powi(-200)));
    }

    #[test]
    fn points_and_the_ends_of_the_range() {
        let (tiny, huge) = (f64::from_bits(1), f64::MAX);
        assert_eq!(depth(&[1.0, 2.0], &[1.0, 2.0], 0.0, 0.0), 0.0);
        assert_eq!(depth(&[1.0, 2.0], &[1.0, 2.0f64.next_up()], 0.0, 0.0), f64::NEG_INFINITY);
        assert_eq!(depth(&[huge, 0.0], &[-huge, 0.0], huge, huge), 0.0);
        assert_eq!(depth(&[huge, 0.0], &[huge, 0.0], huge, huge), 2.0);
        assert_eq!(depth(&[0.0, 0.0], &[tiny, 0.0], tiny, tiny), 1.0);
        assert_eq!(depth(&[0.0, 0.0], &[huge, 0.0], tiny, 0.0), f64::NEG_INFINITY);
        assert_eq!(depth(&[0.0, 0.0], &[1e300, 0.0], 1e-5, 0.0), -2e305);
        // (1e-300)² / 2 is below the smallest double, but not zero.
        assert_eq!(depth(&[0.0, 1e-300], &[1.0, 0.0], 0.5, 0.5), -tiny);
        assert_eq!(depth(&[0.0, 0.0], &[1.0, 0.0], 1.0, 1e-300), 2e-300);
    }
}
