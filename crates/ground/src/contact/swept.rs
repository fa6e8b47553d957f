//! Contacts between two frames, decided exactly for particles that move at constant velocity.
//!
//! Let p and q be the differences of the centres at the beginning and at the end of a step, and R
//! the sum of the radii. At time t in [0, 1] the difference is p + t(q - p). Let a = |q - p|², b =
//! p·(q - p) and c = |p|² - R². The square of the distance less R² is a t² + 2b t + c. So the
//! particles touch within the step if and only if one of these holds:
//!
//! * c <= 0: they touch at the beginning.
//! * a + 2b + c <= 0: they touch at the end.
//! * a > 0, -a <= b <= 0 and b² >= ac: the minimum of the parabola lies within the step and is not
//!   above 0. (If a = 0, the difference is constant, and the ends decide.)
//!
//! A pair that satisfies only the last condition is a *tunnelled* contact. A program that tests at
//! the ends of steps misses it with any neighbour list; a smaller time step finds it.
//!
//! A filter decides in f64. Let S be the sum of R and of the magnitudes of all coordinates of p and
//! q. Then |a|, |b|, |c| <= 4 S², and each is computed with at most ten roundings of terms whose
//! sum has the same bound, so its error is below E = 64u S². The error of b² - ac is below
//! E (2|b| + a + |c|) + 2E², and two products and a difference add less than E (|b| + a). The error
//! vanishes with a and b, so the filter also decides particles that hardly move. Integers of
//! unlimited length decide all pairs nearer to a limit than the error, and numbers whose fourth
//! powers leave the range of f64.

use num_bigint::BigInt;

use super::exact::{compare, parts};
use crate::wide::fill;

/// Unit roundoff of f64, 2^-53.
const U: f64 = 1.0 / (1u64 << 53) as f64;

/// Returns whether two particles touch at any time of a step in which each centre moves at constant
/// velocity from its first point to its second. Tangent particles touch. The result is exact for
/// the given numbers.
///
/// All numbers must be finite and radii must not be negative.
pub fn touches_within<const D: usize>(
    a: [&[f64; D]; 2],
    b: [&[f64; D]; 2],
    ra: f64,
    rb: f64,
) -> bool {
    if a[0] == a[1] && b[0] == b[1] {
        return compare(a[0], b[0], ra, rb).is_le();
    }
    filtered(a, b, ra + rb).unwrap_or_else(|| exact(a, b, ra, rb))
}

/// Decides in f64, or returns `None` if a number is too close to a limit.
fn filtered<const D: usize>(a: [&[f64; D]; 2], b: [&[f64; D]; 2], reach: f64) -> Option<bool> {
    let difference = |end: usize| -> [f64; D] { fill(|k| a[end][k] - b[end][k]) };
    let (p, q) = (difference(0), difference(1));
    let size = p.iter().chain(&q).fold(reach, |sum, x| sum + x.abs());
    if !(1e-70..1e70).contains(&size) {
        return None;
    }
    let dot = |x: &[f64; D], y: &[f64; D]| -> f64 { x.iter().zip(y).map(|(x, y)| x * y).sum() };
    let step: [f64; D] = fill(|k| q[k] - p[k]);
    let (square, product) = (dot(&step, &step), dot(&p, &step));
    let (first, last) = (dot(&p, &p) - reach * reach, dot(&q, &q) - reach * reach);
    let error = 64.0 * U * size * size;
    if first < -error || last < -error {
        return Some(true);
    }
    if first <= error || last <= error {
        return None;
    }
    // The particles are apart at both ends, so the minimum within the step decides.
    if product > error || product < -square - error {
        return Some(false);
    }
    let lowest = product * product - square * first;
    let error_of_it = error * (3.0 * product.abs() + 2.0 * square + first) + 4.0 * error * error;
    if lowest < -error_of_it {
        return Some(false);
    }
    let within = product < -error && product > -square + error;
    (within && lowest > error_of_it).then_some(true)
}

#[cold]
fn exact<const D: usize>(a: [&[f64; D]; 2], b: [&[f64; D]; 2], ra: f64, rb: f64) -> bool {
    let all = a.iter().chain(&b).flat_map(|point| point.iter()).chain([&ra, &rb]);
    let lowest = all.map(|&x| parts(x).exponent).min().unwrap_or(0);
    // Returns x as an integer in units of the lowest bit of all numbers.
    let whole = |x: f64| {
        let parts = parts(x);
        let magnitude = BigInt::from(parts.mantissa) << (parts.exponent - lowest) as usize;
        if parts.negative { -magnitude } else { magnitude }
    };
    let reach = whole(ra) + whole(rb);
    let zero = BigInt::ZERO;
    let (mut square, mut product) = (zero.clone(), zero.clone());
    let (mut first, mut last) = (-(&reach * &reach), -(&reach * &reach));
    for k in 0..D {
        let p = whole(a[0][k]) - whole(b[0][k]);
        let q = whole(a[1][k]) - whole(b[1][k]);
        let step = &q - &p;
        square += &step * &step;
        product += &p * &step;
        first += &p * &p;
        last += &q * &q;
    }
    let within = square > zero && -&square <= product && product <= zero;
    first <= zero || last <= zero || within && &product * &product >= &square * &first
}

#[cfg(test)]
mod tests {
    use super::*;

    fn both<const D: usize>(a: [[f64; D]; 2], b: [[f64; D]; 2], ra: f64, rb: f64) -> bool {
        let (a, b) = ([&a[0], &a[1]], [&b[0], &b[1]]);
        let truth = exact(a, b, ra, rb);
        if let Some(filtered) = filtered(a, b, ra + rb) {
            assert_eq!(filtered, truth, "{a:?} {b:?} {ra} {rb}");
        }
        assert_eq!(touches_within(a, b, ra, rb), truth);
        assert_eq!(touches_within(b, a, rb, ra), truth, "the bodies change places");
        assert_eq!(touches_within([a[1], a[0]], [b[1], b[0]], ra, rb), truth, "time turns round");
        truth
    }

    /// A disc flies past a resting one, on a line one unit in the last place nearer or farther than
    /// the line of tangency.
    #[test]
    fn a_graze_is_a_contact_and_a_miss_by_the_last_bit_is_none() {
        let mut grazes = 0;
        for scale in [1.0, 3.0, 1e-3, 1e-100, 1e100, 2f64.powi(-500), 2f64.powi(400)] {
            let flight = |height: f64| {
                both(
                    [[-2.0 * scale, height], [2.0 * scale, height]],
                    [[0.0, 0.0], [0.0, 0.0]],
                    0.5 * scale,
                    0.5 * scale,
                )
            };
            assert!(flight(scale) && flight(scale.next_down()) && flight(0.0), "{scale}");
            assert!(!flight(scale.next_up()), "{scale}");
            grazes += 1;
        }
        assert_eq!(grazes, 7);
        // The moving disc stops just before contact, or starts beyond the other disc.
        let rest = [[0.0, 0.0], [0.0, 0.0]];
        assert!(!both([[-3.0, 0.0], [-1.0f64.next_up() - 1e-15, 0.0]], rest, 0.5, 0.5));
        assert!(both([[-3.0, 0.0], [-1.0, 0.0]], rest, 0.5, 0.5));
        assert!(!both([[1.5, 0.0], [9.0, 0.0]], rest, 0.5, 0.5));
        assert!(!both([[1.5, 0.0], [1.5, 0.0]], rest, 0.5, 0.5), "both at rest");
        assert!(both([[1.0, 0.0], [1.0, 0.0]], rest, 0.5, 0.5));
        assert!(!both([[0.0, 2.0], [1e9, 2.0]], [[0.0, 0.0], [1e9, 0.0]], 0.5, 0.5));
        assert!(both([[f64::MAX, 0.0], [-f64::MAX, 0.0]], rest, 1e-300, 0.0));
        assert!(both([[5e-324, 0.0], [-5e-324, 0.0]], rest, 0.0, 0.0));
        assert!(!both([[5e-324, 5e-324], [-5e-324, 5e-324]], rest, 0.0, 0.0));
    }

    /// Tests steps that end a few units in the last place from tangency, in 2D and 3D.
    #[test]
    fn ends_near_tangency_are_decided_alike_in_every_direction() {
        let mut state = 7;
        let mut symmetric = || {
            state = contactbench_terms::mix::splitmix64(state);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        let (mut touching, mut all) = (0, 0);
        for round in 0..4_000 {
            let (ra, rb) = (0.5 + 0.3 * symmetric(), 0.4);
            let direction = [(); 3].map(|()| symmetric());
            let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
            let step = [(); 3].map(|()| 0.01 * symmetric() * f64::from(round % 3));
            let mut near = |x: f64| match (3.5 * symmetric()).round() as i32 {
                steps @ 1.. => (0..steps).fold(x, |x, _| x.next_up()),
                steps => (steps..0).fold(x, |x, _| x.next_down()),
            };
            let end = direction.map(|x| near(0.3 + x / length * (ra + rb)));
            let start: [f64; 3] = std::array::from_fn(|k| end[k] + step[k]);
            let rest = [[0.3; 3]; 2];
            touching += i32::from(both([start, end], rest, ra, rb));
            let flat = |point: [f64; 3]| [point[0], point[1]];
            let planar = [flat(start), flat(end)];
            touching += i32::from(both(planar, [[0.3; 2]; 2], ra, rb));
            all += 2;
        }
        assert!(touching > all / 3 && touching < all * 9 / 10, "{touching} of {all}");
    }

    /// Compares all flights between integer points with the nearest point in integer arithmetic.
    #[test]
    fn all_flights_on_a_lattice_agree_with_the_nearest_point_of_a_segment() {
        let (mut touching, mut tunnelled) = (0, 0);
        for code in 0..6i64.pow(4) {
            let x = |k: u32| code / 6i64.pow(k) % 6 - 2;
            let (p, q) = ([x(0), x(1)], [x(2), x(3)]);
            let step = [q[0] - p[0], q[1] - p[1]];
            let (square, product) = (
                step[0] * step[0] + step[1] * step[1],
                -(p[0] * step[0] + p[1] * step[1]).clamp(-1000, 1000),
            );
            for reach in 0..4 {
                let at = |point: [i64; 2]| point[0] * point[0] + point[1] * point[1];
                // The nearest point is at t = product / square, clamped to the segment. Its
                // distance from the line is cross / |step|.
                let cross = p[0] * step[1] - p[1] * step[0];
                let truth = match square {
                    0 => at(p) <= reach * reach,
                    _ if product <= 0 => at(p) <= reach * reach,
                    _ if product >= square => at(q) <= reach * reach,
                    _ => cross * cross <= reach * reach * square,
                };
                let point = |x: [i64; 2]| x.map(|x| x as f64 + 0.25);
                let found = both(
                    [point(p), point(q)],
                    [[0.25, 0.25], [0.25, 0.25]],
                    0.25 * reach as f64,
                    0.75 * reach as f64,
                );
                assert_eq!(found, truth, "{p:?} {q:?} {reach}");
                touching += i32::from(truth);
                tunnelled += i32::from(truth && at(p) > reach * reach && at(q) > reach * reach);
            }
        }
        assert!(touching > 1_500 && tunnelled > 100, "{touching} {tunnelled}");
    }
}
