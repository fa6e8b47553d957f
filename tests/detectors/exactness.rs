//! Tests the exact contact test against arbitrary-precision integers, on random and adversarial
//! near-tangent pairs, also through images.

use std::cmp::Ordering;

use contactbench::scene::{Radii, Scene};
use contactbench_campaigns::predicate::{integer, squares};
use contactbench_ground::contact::depth::{depth, depth_of_image};
use contactbench_ground::contact::exact::{self, Label};
use contactbench_ground::contact::image::{self, Shift};
use contactbench_ground::contact::{Particles, Test, WithParticles, with_particles};
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::probe::Silent;
use num_bigint::BigInt;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

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
impl<const D: usize> WithParticles<f64, D> for Touch {
    type Output = Result<bool, Refusal>;
    fn call<B: Particles<f64, D>>(self, particles: B) -> Self::Output {
        Ok(particles.touch(0, 1, &mut Silent))
    }
}

/// Runs the contact test with its filter, as detectors do.
fn touch<const D: usize>(a: [f64; D], b: [f64; D], radii: impl Into<Radii<'static, f64>>) -> bool {
    let scene = Scene::at([a, b], radii).unwrap();
    with_particles(&scene, Test::Exact, Touch).unwrap()
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

fn truth_of<const D: usize>(
    a: &[f64; D],
    b: &[f64; D],
    ra: f64,
    rb: f64,
    shift: Shift<'_, D>,
) -> Ordering {
    let mut distance = BigInt::ZERO;
    for k in 0..D {
        let mut d = integer(a[k]) - integer(b[k]);
        for v in 0..3 {
            d -= BigInt::from(shift.image[v]) * integer(shift.vectors[v][k]);
        }
        distance += &d * &d;
    }
    let sum = integer(ra) + integer(rb);
    distance.cmp(&(&sum * &sum))
}

/// Two particles, the box, and the image of the second particle.
#[derive(Clone, Copy, Debug)]
struct Pair {
    a: [f64; 3],
    b: [f64; 3],
    radii: [f64; 2],
    image: [i32; 3],
    vectors: [[f64; 3]; 3],
}

/// Integer vectors and their lengths, which are integers, too.
const WHOLE: [([i64; 3], i64); 5] =
    [([1, 2, 2], 3), ([2, 3, 6], 7), ([3, 4, 0], 5), ([0, 0, 1], 1), ([-4, 4, 7], 9)];

/// Returns two particles that are tangent through an image, but for one number that may be off by
/// one rounding step. The other numbers are integers times a power of two and add up exactly.
fn pair(random: &mut ChaCha8Rng) -> Pair {
    let unit = [1.0, 2f64.powi(-20), 2f64.powi(-900), 2f64.powi(900)][random.random_range(0..4)];
    let bits = [3, 10, 20][random.random_range(0..3)];
    let range = 1i64 << bits;
    let most = [1, 3, 1 << 20, i32::MAX - 1][random.random_range(0..4)];
    let image: [i32; 3] = std::array::from_fn(|_| random.random_range(-most..=most));
    let whole = |random: &mut ChaCha8Rng| random.random_range(-range..=range);
    let vectors: [[i64; 3]; 3] = std::array::from_fn(|_| std::array::from_fn(|_| whole(random)));
    let (direction, length) = WHOLE[random.random_range(0..WHOLE.len())];
    let scale = random.random_range(1..=range);
    let b: [i64; 3] = std::array::from_fn(|_| whole(random));
    let a: [i64; 3] = std::array::from_fn(|k| {
        let shift: i64 = (0..3).map(|v| i64::from(image[v]) * vectors[v][k]).sum();
        b[k] + shift + scale * direction[k]
    });
    let first = random.random_range(0..=length * scale);
    let double = |x: i64| x as f64 * unit;
    let mut pair = Pair {
        a: a.map(double),
        b: b.map(double),
        radii: [double(first), double(length * scale - first)],
        image,
        vectors: vectors.map(|vector| vector.map(double)),
    };
    let up = random.random_bool(0.5);
    let step = |x: &mut f64| *x = if up { x.next_up() } else { x.next_down() };
    let k = random.random_range(0..3);
    match random.random_range(0..5) {
        0 => {}
        1 => step(&mut pair.a[k]),
        2 => step(&mut pair.b[k]),
        3 => step(&mut pair.vectors[random.random_range(0..3)][k]),
        _ => {
            let radius = &mut pair.radii[k % 2];
            *radius = if up { radius.next_up() } else { radius.next_down().max(0.0) };
        }
    }
    pair
}

#[test]
fn pairs_one_step_from_tangency_through_an_image() {
    let random = &mut ChaCha8Rng::seed_from_u64(11);
    let mut seen = [0; 3];
    for _ in 0..20_000 {
        let c = pair(random);
        let shift = Shift { image: c.image, vectors: &c.vectors };
        let truth = truth_of(&c.a, &c.b, c.radii[0], c.radii[1], shift);
        let [ra, rb] = c.radii;
        assert_eq!(image::compare(&c.a, &c.b, ra, rb, shift), truth, "{c:?}");
        // The same pair with the particles exchanged and the opposite image.
        let back = Shift { image: c.image.map(|s| -s), vectors: &c.vectors };
        assert_eq!(image::compare(&c.b, &c.a, rb, ra, back), truth, "{c:?}");
        let depth = depth_of_image(&c.a, &c.b, ra, rb, shift);
        assert_eq!(depth.partial_cmp(&0.0), Some(truth.reverse()), "{c:?}: {depth}");
        // The same pair without z, in 2D.
        let flat = |x: [f64; 3]| [x[0], x[1]];
        let vectors = c.vectors.map(flat);
        let shift = Shift { image: c.image, vectors: &vectors };
        let (a, b) = (flat(c.a), flat(c.b));
        assert_eq!(image::compare(&a, &b, ra, rb, shift), truth_of(&a, &b, ra, rb, shift), "{c:?}");
        seen[(truth as i8 + 1) as usize] += 1;
    }
    assert!(seen.iter().all(|&count| count > 3000), "{seen:?}");
}

/// Tests pairs of arbitrary doubles, including subnormal and huge ones.
#[test]
fn pairs_of_arbitrary_doubles() {
    let random = &mut ChaCha8Rng::seed_from_u64(12);
    let mut seen = [0; 3];
    for turn in 0..4000 {
        let mut any = || loop {
            let x = f64::from_bits(random.random());
            if x.is_finite() {
                // In every second turn all numbers have the same order of magnitude.
                break if turn % 2 == 0 { x } else { x.signum() * (1.0 + x.abs().fract()) };
            }
        };
        let vectors: [[f64; 3]; 3] = std::array::from_fn(|_| std::array::from_fn(|_| any()));
        let (a, b) = (std::array::from_fn(|_| any()), std::array::from_fn(|_| any()));
        let (ra, rb) = (any().abs(), any().abs());
        let image = if turn % 3 == 0 { [0, 1, -1] } else { random.random() };
        let shift = Shift { image, vectors: &vectors };
        let truth = truth_of(&a, &b, ra, rb, shift);
        assert_eq!(image::compare(&a, &b, ra, rb, shift), truth, "{a:?} {b:?} {ra} {rb} {shift:?}");
        seen[(truth as i8 + 1) as usize] += 1;
    }
    assert!(seen[0] > 200 && seen[2] > 200, "{seen:?}");
}
