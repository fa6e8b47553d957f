//! The contact test alone, called as detectors call it, for every pair of a batch.

use std::cmp::Ordering;

use contactbench_ground::contact::depth::depth;
use contactbench_ground::contact::exact::{self, Label};
use contactbench_ground::contact::{Particles, Test, WithParticles, with_particles};
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::probe::{Op, Tally};
use contactbench_ground::scene::{Radii, Scene};
use num_bigint::BigInt;

use crate::draw::{Draw, Sphere, power};
use crate::near::{Lengths, Near, Pair, long_sum, needle};
use crate::{Counts, Plan, Totals, What, in_batches};

/// Offsets in diameters: coordinates have one to five times this magnitude; 0 means around the
/// origin.
pub const OFFSETS: [f64; 5] = [0.0, 1e3, 1e6, 1e9, 1e12];
/// Least magnitude of coordinates with an offset, in units; one unit is one ulp.
pub const FAR: i64 = 1 << 52;
const BATCH: u64 = 4096;
/// Interval, in pairs, at which the label is compared with rational arithmetic.
const SAMPLE: u64 = 997;
/// Interval, in pairs, at which the sign of the depth is checked.
const DEPTHS: u64 = 16;
/// Needles are made rarely, because one in sixteen needs the widest integers.
const NEEDLES: usize = 9;

const FAMILIES: [&str; 3] = ["grid", "long sum", "needle"];

pub fn run(plan: Plan) -> Totals {
    let (plane, space) = (Sphere::<2>::made(), Sphere::<3>::made());
    let mut rows = Vec::new();
    for dim in [2, 3] {
        rows.extend(OFFSETS.map(|offset| (0, dim, offset)));
        rows.extend([(1, dim, 0.0), (2, dim, 0.0)]);
    }
    // Scenes alternate between one radius and several.
    in_batches(plan, 2 * rows.len(), |piece| {
        let ((family, dim, offset), index) = (rows[piece % rows.len()], piece / rows.len());
        let mut table = Totals::default();
        if family < 2 || index.is_multiple_of(NEEDLES) {
            let draw = &mut Draw::new(plan.seed, piece as u64);
            let counts = match dim {
                2 => batch(&plane, family, offset, index, draw),
                _ => batch(&space, family, offset, index, draw),
            };
            table.add(FAMILIES[family], &format!("{dim}D {offset:e}"), counts);
        }
        table
    })
}

/// Decides a batch of pairs exactly, and again in f64.
fn batch<const D: usize>(
    sphere: &Sphere<D>,
    family: usize,
    offset: f64,
    index: usize,
    draw: &mut Draw,
) -> Counts {
    let uniform = family == 0 && index % 2 == 1;
    let turn = if family == 0 { index as i64 / 2 % 4 } else { 0 };
    // Scales reach from 2^-1010 to 2^970.
    let exponent = draw.exponent(turn, 990) - if turn == 3 { 20 } else { 0 };
    // Around the origin, no bit of a radius is below one unit.
    let room = if offset == 0.0 { (1i64 << 53) as f64 } else { FAR as f64 / offset };
    let lengths = Lengths::new(sphere, room, !uniform, draw);
    let mut counts = Counts::default();
    let (mut centres, mut radii, mut truths) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..BATCH {
        let pair = match family {
            0 => on_the_grid(&lengths, offset > 0.0, exponent, draw),
            1 => long_sum(draw),
            _ => needle(draw),
        };
        judge(&pair, k, &mut counts);
        centres.extend([pair.a, pair.b]);
        radii.extend([pair.ra, pair.rb]);
        truths.push(pair.truth);
    }
    let radii = if uniform { Radii::Uniform(radii[0]) } else { Radii::Each(radii.into()) };
    let Ok(scene) = Scene::at(centres, radii) else {
        counts.add(What::Refused, 1);
        return counts;
    };
    let mut tally = Tally::default();
    match with_particles(&scene, Test::Exact, Ask { truths: &truths, tally: &mut tally }) {
        Ok([missed, spurious]) => {
            counts.add(What::Missed, missed);
            counts.add(What::Spurious, spurious);
        }
        Err(_) => counts.add(What::Refused, 1),
    }
    counts.add(What::Pairs, BATCH);
    counts.add(What::Exact, tally.get(Op::ExactTest));
    // Pairs of extreme scale are not decided in f64, which cannot hold their squares.
    let ask = Ask { truths: &truths, tally: &mut tally };
    if exponent.abs() <= 200
        && let Ok([missed, spurious]) = with_particles(&scene, Test::Rounded, ask)
    {
        counts.add(What::Rounded, BATCH);
        counts.add(What::RoundedWrong, missed + spurious);
    }
    counts
}

/// Returns a pair at a random position, with coordinates below 2^53 units.
fn on_the_grid<const D: usize>(
    lengths: &Lengths<'_, D>,
    far: bool,
    exponent: i32,
    draw: &mut Draw,
) -> Pair<D> {
    let Near { vector, radii, truth } = lengths.near(draw);
    let centred = draw.once_in(2);
    let a: [i64; D] = vector.map(|x| match (far, centred) {
        (true, _) => draw.sign() * (FAR + x.abs() + draw.below(FAR - 2 * x.abs())),
        (false, true) => -x / 2 + draw.within(1 << 50),
        (false, false) => 0,
    });
    let (unit, half) = (power(exponent), power(exponent - lengths.fine - 1));
    let b: [i64; D] = std::array::from_fn(|k| a[k] + vector[k]);
    let [a, b] = [a, b].map(|at| at.map(|x| x as f64 * unit));
    let [ra, rb] = radii.map(|r| r as f64 * half);
    Pair { a, b, ra, rb, truth }
}

/// Checks the label, sometimes the depth, and sometimes the construction itself.
fn judge<const D: usize>(pair: &Pair<D>, k: u64, counts: &mut Counts) {
    let Pair { a, b, ra, rb, truth } = pair;
    let (what, label) = match truth {
        Ordering::Less => (What::Overlap, Label::Overlap),
        Ordering::Equal => (What::Tangent, Label::Tangent),
        Ordering::Greater => (What::Apart, Label::Apart),
    };
    counts.add(what, 1);
    counts.add(What::Label, u64::from(exact::label(a, b, *ra, *rb) != label));
    if k.is_multiple_of(DEPTHS) {
        let sign = 0.0f64.partial_cmp(&depth(a, b, *ra, *rb));
        counts.add(What::Depth, u64::from(sign != Some(*truth)));
    }
    if k.is_multiple_of(SAMPLE) {
        counts.add(What::Sampled, 1);
        counts.add(What::Construction, u64::from(rational(a, b, *ra, *rb) != *truth));
    }
}

/// Returns the sign of |a - b|² - (ra + rb)², computed with exact integers.
fn rational<const D: usize>(a: &[f64; D], b: &[f64; D], ra: f64, rb: f64) -> Ordering {
    let (distance, reach) = squares(a, b, ra, rb);
    distance.cmp(&reach)
}

/// Returns |a - b|² and (ra + rb)² in units of 2^-2148, computed by a library of exact integers.
pub fn squares<const D: usize>(a: &[f64; D], b: &[f64; D], ra: f64, rb: f64) -> (BigInt, BigInt) {
    let square = |x: BigInt| &x * &x;
    ((0..D).map(|k| square(integer(a[k]) - integer(b[k]))).sum(), square(integer(ra) + integer(rb)))
}

pub fn integer(x: f64) -> BigInt {
    let bits = x.to_bits();
    let field = bits >> 52 & 0x7ff;
    let fraction = bits & ((1 << 52) - 1);
    let magnitude = if field == 0 {
        BigInt::from(fraction)
    } else {
        BigInt::from(fraction | 1 << 52) << (field - 1)
    };
    if x.is_sign_negative() { -magnitude } else { magnitude }
}

/// Tests the pairs 0-1, 2-3, ..., and counts missed and spurious ones.
struct Ask<'a> {
    truths: &'a [Ordering],
    tally: &'a mut Tally,
}

impl<const D: usize> WithParticles<f64, D> for Ask<'_> {
    type Output = Result<[u64; 2], Refusal>;

    fn call<B: Particles<f64, D>>(self, particles: B) -> Self::Output {
        let mut wrong = [0; 2];
        for (truth, i) in self.truths.iter().zip((0..).step_by(2)) {
            let touch = particles.touch(i, i + 1, self.tally);
            wrong[0] += u64::from(truth.is_le() && !touch);
            wrong[1] += u64::from(touch && !truth.is_le());
        }
        Ok(wrong)
    }
}
