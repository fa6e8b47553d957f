//! The first part: the contact test alone, asked as detectors ask it, for every couple of a batch.

use std::cmp::Ordering;

use contactbench_core::contact::depth::depth;
use contactbench_core::contact::exact::{self, Label};
use contactbench_core::contact::{Bodies, Test, WithBodies, with_bodies};
use contactbench_core::detect::Refusal;
use contactbench_core::probe::{Op, Silent, Tally};
use contactbench_core::scene::{Radii, Scene};
use nalgebra::Point;
use num_bigint::BigInt;

use super::counts::{Counts, What};
use super::couples::{Batch, Couple};
use crate::draw::Draw;

/// Couples in a batch.
pub const BATCH: u64 = 4096;
/// Every so many couples, labels are compared with rational arithmetic.
const SAMPLE: usize = 997;
/// Every so many couples, the sign of the depth is compared.
const DEPTHS: usize = 16;

/// Decides a batch of couples with the test under trial, and the same couples in f64.
pub fn run<const D: usize>(batch: &Batch<'_, D>, test: Test, draw: &mut Draw) -> Counts {
    let mut counts = Counts::default();
    let (mut centres, mut radii, mut truths) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..BATCH as usize {
        let couple = batch.couple(draw);
        judge(&couple, k, &mut counts);
        centres.extend([Point::from(couple.a), Point::from(couple.b)]);
        radii.extend([couple.ra, couple.rb]);
        truths.push(couple.truth);
    }
    let radii = if batch.uniform { Radii::Uniform(radii[0]) } else { Radii::Each(radii.into()) };
    let Ok(scene) = Scene::new(centres, radii) else {
        counts.add(What::Refused, 1);
        return counts;
    };
    let mut tally = Tally::default();
    match with_bodies(&scene, test, Ask { truths: &truths, tally: Some(&mut tally) }) {
        Ok((missed, spurious)) => {
            counts.add(What::Missed, missed);
            counts.add(What::Spurious, spurious);
        }
        Err(_) => counts.add(What::Refused, 1),
    }
    counts.add(What::Pairs, BATCH);
    counts.add(What::Exact, tally.get(Op::ExactTest));
    // f64 cannot square the extreme scales, and would only be blamed for its range there.
    if batch.exponent.abs() <= 200
        && let Ok((missed, spurious)) =
            with_bodies(&scene, Test::Rounded, Ask { truths: &truths, tally: None })
    {
        counts.add(What::Rounded, BATCH);
        counts.add(What::RoundedWrong, missed + spurious);
    }
    counts
}

/// Label, depth and, for some couples, the construction itself.
fn judge<const D: usize>(couple: &Couple<D>, k: usize, counts: &mut Counts) {
    let Couple { a, b, ra, rb, truth } = couple;
    let label = match truth {
        Ordering::Less => Label::Overlap,
        Ordering::Equal => Label::Tangent,
        Ordering::Greater => Label::Apart,
    };
    counts.add([What::Overlap, What::Tangent, What::Apart][(*truth as i8 + 1) as usize], 1);
    counts.add(What::Label, u64::from(exact::label(a, b, *ra, *rb) != label));
    if k.is_multiple_of(DEPTHS) {
        counts.add(
            What::Depth,
            u64::from(0.0f64.partial_cmp(&depth(a, b, *ra, *rb)) != Some(*truth)),
        );
    }
    if k.is_multiple_of(SAMPLE) {
        counts.add(What::Sampled, 1);
        counts.add(What::Construction, u64::from(rational(a, b, *ra, *rb) != *truth));
    }
}

/// The sign of |a - b|² - (ra + rb)² by a library that rounds nothing, in units of 2^-2148.
pub fn rational<const D: usize>(a: &[f64; D], b: &[f64; D], ra: f64, rb: f64) -> Ordering {
    let integer = |x: f64| {
        let (bits, field) = (x.to_bits(), x.to_bits() >> 52 & 0x7ff);
        let fraction = bits & ((1 << 52) - 1);
        let magnitude = if field == 0 {
            BigInt::from(fraction)
        } else {
            BigInt::from(fraction | 1 << 52) << (field - 1)
        };
        if x.is_sign_negative() { -magnitude } else { magnitude }
    };
    let square = |x: BigInt| &x * &x;
    let distance: BigInt = (0..D).map(|k| square(integer(a[k]) - integer(b[k]))).sum();
    distance.cmp(&square(integer(ra) + integer(rb)))
}

/// Asks for couples 0-1, 2-3, ..., and counts (missed, spurious).
struct Ask<'a> {
    truths: &'a [Ordering],
    tally: Option<&'a mut Tally>,
}

impl<const D: usize> WithBodies<f64, D> for Ask<'_> {
    type Output = Result<(u64, u64), Refusal>;

    fn call<B: Bodies<f64, D>>(self, bodies: B) -> Self::Output {
        let mut wrong = [0, 0];
        let mut compare = |k: usize, touch: bool| {
            let truth = self.truths[k] != Ordering::Greater;
            wrong[0] += u64::from(truth && !touch);
            wrong[1] += u64::from(touch && !truth);
        };
        match self.tally {
            Some(tally) => (0..self.truths.len())
                .for_each(|k| compare(k, bodies.touch(2 * k as u32, 2 * k as u32 + 1, tally))),
            None => (0..self.truths.len()).for_each(|k| {
                compare(k, bodies.touch(2 * k as u32, 2 * k as u32 + 1, &mut Silent))
            }),
        }
        Ok((wrong[0], wrong[1]))
    }
}
