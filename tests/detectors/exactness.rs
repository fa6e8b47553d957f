//! Tests the exact contact test against arbitrary-precision integers, on random and adversarial
//! near-tangent pairs.

use contactbench::contact::depth::depth;
use contactbench::contact::exact::{self, Label};
use contactbench::contact::{Bodies, Test, WithBodies, with_bodies};
use contactbench::detect::Refusal;
use contactbench::probe::Silent;
use contactbench::scene::{Radii, Scene};
use contactbench_campaigns::predicate::{integer, squares};
use num_bigint::BigInt;
use proptest::prelude::*;

/// Returns whether `depth` is 2(s² - d²) / (s² + sd) within a relative error of 10^-15, or within
/// 2^-1074 if subnormal; s is `reach`, d is `distance`.
fn depth_is_right(depth: f64, distance: &BigInt, reach: &BigInt) -> bool {
    if *reach == BigInt::ZERO || *distance == *reach {
        return depth == if distance == reach { 0.0 } else { f64::NEG_INFINITY };
    }
    // s² + sd as a fixed-point number with 200 fractional bits.
    let below: BigInt = (reach << 200) + ((reach * distance) << 400u32).sqrt();
    let above: BigInt = (reach - distance) << (1274 + 1);
    if depth.is_infinite() {
        return depth < 0.0 && -above >= &below * integer(f64::MAX);
    }
    let error: BigInt = (integer(depth) * &below - &above).magnitude().clone().into();
    let allowed = BigInt::from(above.magnitude().clone()) / 1_000_000_000_000_000u64;
    (depth > 0.0) == (reach > distance) && depth != 0.0 && error <= allowed.max(below)
}

struct Touch;
impl<const D: usize> WithBodies<f64, D> for Touch {
    type Output = Result<bool, Refusal>;
    fn call<B: Bodies<f64, D>>(self, bodies: B) -> Self::Output {
        Ok(bodies.touch(0, 1, &mut Silent))
    }
}

/// Runs the contact test with its filter, as detectors do.
fn touch<const D: usize>(a: [f64; D], b: [f64; D], radii: impl Into<Radii<'static, f64>>) -> bool {
    let scene = Scene::at([a, b], radii).unwrap();
    with_bodies(&scene, Test::Exact, Touch).unwrap()
}

fn check<const D: usize>(a: [f64; D], b: [f64; D], ra: f64, rb: f64) -> Result<(), TestCaseError> {
    let (distance, reach) = squares(&a, &b, ra, rb);
    let truth = distance.cmp(&reach);
    let label = [Label::Overlap, Label::Tangent, Label::Apart][(truth as i8 + 1) as usize];
    prop_assert_eq!(exact::label(&a, &b, ra, rb), label);
    let depth = depth(&a, &b, ra, rb);
    let what = format!("{a:?} {b:?} {ra} {rb}: {truth:?}, depth {depth}");
    prop_assert!(depth_is_right(depth, &distance, &reach), "{what}");
    prop_assert_eq!(exact::compare(&a, &b, ra, rb), truth, "{}", what);
    prop_assert_eq!(touch(a, b, vec![ra, rb]), truth.is_le(), "{}", what);
    prop_assert!(ra != rb || touch(a, b, ra) == truth.is_le(), "one radius: {what}");
    Ok(())
}

/// Returns the number that is `steps` representable numbers above `x`.
fn ulps(x: f64, steps: i64) -> f64 {
    (0..steps.unsigned_abs()).fold(x, |x, _| if steps > 0 { x.next_up() } else { x.next_down() })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_finite_numbers(bits in prop::array::uniform8(any::<u64>())) {
        let x = bits.map(f64::from_bits);
        prop_assume!(x.iter().all(|x| x.is_finite()));
        check([x[0], x[1], x[2]], [x[3], x[4], x[5]], x[6].abs(), x[7].abs())?;
        check([x[0], x[1]], [x[2], x[3]], x[4].abs(), x[4].abs())?;
    }

    /// Pythagorean pairs, scaled by powers of two, translated, and moved a few ulps off tangency.
    #[test]
    fn near_tangency(
        triple in prop::sample::select(vec![[3., 4., 0., 5.], [5., 12., 0., 13.], [1., 2., 2., 3.], [2., 3., 6., 7.], [1., 0., 0., 1.], [4., 4., 7., 9.]]),
        scale in -1000i32..960, offset in prop::sample::select(vec![0.0, 1.0, 1e3, 1e6, 1e9, 1e12, -0.1]),
        dx in -3i64..4, dr in -3i64..4, share in prop::sample::select(vec![0.5, 0.25, 0.3, 0.0, 1.0]),
    ) {
        let unit = if scale >= -1022 { f64::from_bits(((1023 + scale) as u64) << 52) } else { f64::MIN_POSITIVE };
        let base = [0.0, 1.0, 2.0].map(|k| offset * k * unit);
        let [x, y, z, d] = triple;
        let b = [ulps(base[0] + x * unit, dx), base[1] + y * unit, base[2] + z * unit];
        let (ra, rb) = (ulps(d * share * unit, if share > 0.0 { dr } else { 0 }).max(0.0), d * (1.0 - share) * unit);
        check(base, b, ra, rb)?;
        check([base[0], base[1]], [b[0], b[1]], ra, rb)?;
    }

    #[test]
    fn rounded_tangency(a in prop::array::uniform3(-10.0f64..10.0), direction in prop::array::uniform3(-1.0f64..1.0), r in 0.01f64..3.0, dx in -2i64..3) {
        let length = direction.iter().map(|d| d * d).sum::<f64>().sqrt();
        prop_assume!(length > 1e-3);
        let b: [f64; 3] = std::array::from_fn(|k| a[k] + direction[k] / length * 2.0 * r);
        check(a, [ulps(b[0], dx), b[1], b[2]], r, r)?;
        check(a, [ulps(b[0], dx), b[1], b[2]], r / 3.0, 5.0 * r / 3.0)?;
    }
}

#[test]
fn the_extremes() {
    let values = [
        0.0,
        -0.0,
        f64::from_bits(1),
        f64::MIN_POSITIVE,
        1e-160,
        1.0,
        1e160,
        f64::MAX,
        -f64::MAX,
        -1.0,
    ];
    for &x in &values {
        for &y in &values {
            for &z in &values {
                for &r in values.iter().filter(|r| r.is_sign_positive()) {
                    check([x, y], [z, 0.0], r, 0.0).unwrap();
                    check([x, y], [z, x], r, r).unwrap();
                    check([x, y, z], [z, x, 1.0], r, f64::MAX).unwrap();
                }
            }
        }
    }
    // Tangent at the largest distance, and one step off it; a gap below the smallest double.
    let (huge, tiny) = (f64::MAX, f64::from_bits(1));
    for y in [0.0, tiny] {
        check([huge, 0.0], [-huge, y], huge, huge).unwrap();
        check([0.0, 0.0], [tiny, y], tiny, 0.0).unwrap();
        check([1e300, y], [1e300, 0.0], tiny, 0.0).unwrap();
    }
    check([0.0, 1e-300], [1.0, 0.0], 0.5, 0.5).unwrap();
}
