//! Compares the exact contact test with integers of unlimited length, for pairs through images
//! within one unit in the last place of tangency.

use std::cmp::Ordering;

use contactbench_core::contact::depth::depth_of_image;
use contactbench_core::contact::image::{Shift, compare};
use num_bigint::BigInt;

use super::*;

/// Returns a double as an integer in units of 2^-1074.
fn integer(x: f64) -> BigInt {
    let bits = x.to_bits();
    let (field, fraction) = (bits >> 52 & 0x7ff, bits & ((1 << 52) - 1));
    let magnitude = if field == 0 {
        BigInt::from(fraction)
    } else {
        BigInt::from(fraction | 1 << 52) << (field - 1)
    };
    if x.is_sign_negative() { -magnitude } else { magnitude }
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
        assert_eq!(compare(&c.a, &c.b, ra, rb, shift), truth, "{c:?}");
        // The same pair with the particles exchanged and the opposite image.
        let back = Shift { image: c.image.map(|s| -s), vectors: &c.vectors };
        assert_eq!(compare(&c.b, &c.a, rb, ra, back), truth, "{c:?}");
        let depth = depth_of_image(&c.a, &c.b, ra, rb, shift);
        assert_eq!(depth.partial_cmp(&0.0), Some(truth.reverse()), "{c:?}: {depth}");
        // The same pair without z, in 2D.
        let flat = |x: [f64; 3]| [x[0], x[1]];
        let vectors = c.vectors.map(flat);
        let shift = Shift { image: c.image, vectors: &vectors };
        let (a, b) = (flat(c.a), flat(c.b));
        assert_eq!(compare(&a, &b, ra, rb, shift), truth_of(&a, &b, ra, rb, shift), "{c:?}");
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
        assert_eq!(compare(&a, &b, ra, rb, shift), truth, "{a:?} {b:?} {ra} {rb} {shift:?}");
        seen[(truth as i8 + 1) as usize] += 1;
    }
    assert!(seen[0] > 200 && seen[2] > 200, "{seen:?}");
}
