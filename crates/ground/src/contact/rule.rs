//! Types of contact tests: rounded or exact, for one radius or one per particle.

use std::cmp::Ordering;

use super::{Slack, Test, exact};
use crate::probe::{Op, Probe};
use crate::scene::{Radii, Real};

/// Two particles, given by their numbers and centres.
#[derive(Clone, Copy)]
pub struct Pair<'a, T, const D: usize> {
    /// Numbers of the particles, from 0.
    pub ids: [u32; 2],
    /// Centre of the first particle.
    pub a: &'a [T; D],
    /// Centre of the second particle.
    pub b: &'a [T; D],
}

impl<T, const D: usize> Pair<'_, T, D> {
    #[inline(always)]
    fn each<R>(&self, of: impl Fn(usize) -> R) -> (R, R) {
        (of(self.ids[0] as usize), of(self.ids[1] as usize))
    }
}

/// The contact test for one kind of radii and one arithmetic.
pub trait Rule<T: Real>: Copy + Sync {
    /// Whether radii may differ.
    const RADII_DIFFER: bool = true;
    /// Returns whether the two particles touch.
    fn touch<const D: usize, P: Probe>(&self, of: Pair<'_, T, D>, probe: &mut P) -> bool;
    /// Returns the number of the first image, or `u32::MAX` if none is known. Two images never
    /// touch.
    fn first_image(&self) -> u32 {
        u32::MAX
    }
}

#[inline(always)]
fn square_distance<T: Real, const D: usize>(a: &[T; D], b: &[T; D]) -> T {
    let mut sum = T::default();
    for k in 0..D {
        let d = a[k] - b[k];
        sum = sum + d * d;
    }
    sum
}

/// The rounded test for particles of one radius; the square of the diameter is computed once.
#[derive(Clone, Copy)]
pub struct RoundedUniform<T: Real> {
    /// Square of the diameter.
    square: T,
}

impl<T: Real> RoundedUniform<T> {
    pub(super) fn new(radius: T) -> RoundedUniform<T> {
        let sum = radius + radius;
        RoundedUniform { square: sum * sum }
    }
}

impl<T: Real> Rule<T> for RoundedUniform<T> {
    const RADII_DIFFER: bool = false;

    #[inline(always)]
    fn touch<const D: usize, P: Probe>(&self, of: Pair<'_, T, D>, _: &mut P) -> bool {
        square_distance(of.a, of.b) <= self.square
    }
}

/// The rounded test for particles with individual radii.
#[derive(Clone, Copy)]
pub struct RoundedEach<'a, T> {
    pub(super) radii: &'a [T],
}

impl<T: Real> Rule<T> for RoundedEach<'_, T> {
    #[inline(always)]
    fn touch<const D: usize, P: Probe>(&self, of: Pair<'_, T, D>, _: &mut P) -> bool {
        let (r, s) = of.each(|k| self.radii[k]);
        let sum = r + s;
        square_distance(of.a, of.b) <= sum * sum
    }
}

/// Relative half-width of the band of squares in which the filter does not decide: 16u, u = 2^-53.
const BAND: f64 = 16.0 / (1u64 << 53) as f64;
/// Absolute half-width of the band of squares in which the filter does not decide: 2^-960.
const FLOOR: f64 = f64::from_bits((1023 - 960) << 52);

/// Returns two limits for squared distances from the computed square of a sum of radii: particles
/// overlap up to the first limit and are apart above the second.
#[inline(always)]
fn band(square: f64) -> (f64, f64) {
    let overlap = if square < f64::INFINITY { square * (1.0 - BAND) - FLOOR } else { -1.0 };
    (overlap, square * (1.0 + BAND) + FLOOR)
}

/// Returns whether particles touch by an exact test, from the order of |a - b|² and (ra + rb)².
pub fn touches(test: Test, order: Ordering) -> bool {
    order == Ordering::Less || order == Ordering::Equal && test != Test::Open
}

#[inline(always)]
fn decide<const D: usize, P: Probe>(
    a: &[f64; D],
    b: &[f64; D],
    radii: impl Fn() -> (f64, f64),
    band: (f64, f64),
    test: Test,
    probe: &mut P,
) -> bool {
    let square = square_distance(a, b);
    if square > band.1 {
        return false;
    }
    if square <= band.0 {
        return true;
    }
    probe.count(Op::ExactTest);
    let (ra, rb) = radii();
    touches(test, exact::compare(a, b, ra, rb))
}

/// The exact test for particles of one radius; the limits of the filter are computed once.
#[derive(Clone, Copy)]
pub struct ExactUniform {
    radius: f64,
    band: (f64, f64),
    test: Test,
}

impl ExactUniform {
    pub(super) fn new(radius: f64, test: Test) -> ExactUniform {
        let diameter = 2.0 * radius;
        ExactUniform { radius, band: band(diameter * diameter), test }
    }
}

impl Rule<f64> for ExactUniform {
    const RADII_DIFFER: bool = false;

    #[inline(always)]
    fn touch<const D: usize, P: Probe>(&self, of: Pair<'_, f64, D>, probe: &mut P) -> bool {
        decide(of.a, of.b, || (self.radius, self.radius), self.band, self.test, probe)
    }
}

/// The exact test for particles with individual radii.
#[derive(Clone, Copy)]
pub struct ExactEach<'a> {
    pub(super) radii: &'a [f64],
    pub(super) test: Test,
}

impl Rule<f64> for ExactEach<'_> {
    #[inline(always)]
    fn touch<const D: usize, P: Probe>(&self, of: Pair<'_, f64, D>, probe: &mut P) -> bool {
        decide_each(of.a, of.b, of.each(|k| self.radii[k]), self.test, probe)
    }
}

#[inline(always)]
fn decide_each<const D: usize, P: Probe>(
    a: &[f64; D],
    b: &[f64; D],
    (ra, rb): (f64, f64),
    test: Test,
    probe: &mut P,
) -> bool {
    let sum = ra + rb;
    decide(a, b, || (ra, rb), band(sum * sum), test, probe)
}

/// A test of approximate positions. A callback decides the pairs that the positions leave open.
#[derive(Clone, Copy)]
pub struct Asked<'a> {
    /// How much the errors of the positions can mislead: particles with sum of radii s touch if
    /// their positions are at most s(1 - relative) - absolute apart, and do not touch beyond s(1 +
    /// relative) + absolute. A relative part of at least 8u, 1% of the absolute part, or no slack
    /// at all, covers the roundings of code that computes with the slack (see [`super::slack`]).
    pub slack: Slack,
    /// Number of particles; images have this number or a higher one. Two images count as apart
    /// without a test, because callers drop such pairs.
    pub owners: u32,
    /// Returns whether two particles or images touch. It is called for pairs that the positions
    /// leave open, and must not contradict the slack.
    pub decide: Decide<'a>,
}

/// A callback that decides, from the numbers of two particles or images, whether they touch.
pub type Decide<'a> = &'a (dyn Fn(u32, u32) -> bool + Sync);

impl Asked<'_> {
    /// Decides from the positions if the slack allows it, as derived at
    /// [`Near`](crate::filter::Near), else by the callback.
    fn touch<const D: usize, P: Probe>(
        &self,
        of: Pair<'_, f64, D>,
        sum: f64,
        probe: &mut P,
    ) -> bool {
        let [i, j] = of.ids;
        if i >= self.owners && j >= self.owners {
            return false;
        }
        let (low, high) = (
            sum * (1.0 - self.slack.relative) - self.slack.absolute,
            sum * (1.0 + self.slack.relative) + self.slack.absolute,
        );
        let square = square_distance(of.a, of.b);
        if square > band(high * high).1 {
            return false;
        }
        if low > 0.0 && square <= band(low * low).0 {
            return true;
        }
        probe.count(Op::ExactTest);
        (self.decide)(i, j)
    }
}

/// Any contact test, chosen anew for each pair. Results are equal, but slower; detectors are
/// compiled once instead of once per test. For the exact test, other storages are widened to f64
/// without rounding.
#[derive(Clone, Copy)]
pub enum AnyRule<'a, T: Real> {
    /// Rounded test for particles of one radius.
    RoundedUniform(RoundedUniform<T>),
    /// Rounded test for particles with individual radii.
    RoundedEach(RoundedEach<'a, T>),
    /// Exact test for particles of one radius.
    ExactUniform(ExactUniform),
    /// Exact test for particles with individual radii.
    ExactEach(&'a [T], Test),
    /// Test of approximate positions with a callback, for one radius or one per particle.
    Asked(Asked<'a>, &'a Radii<'a, T>),
}

impl<'a, T: Real> AnyRule<'a, T> {
    pub(super) fn new(radii: &'a Radii<'_, T>, test: Test) -> AnyRule<'a, T> {
        match radii {
            Radii::Uniform(r) if test.is_exact() => {
                AnyRule::ExactUniform(ExactUniform::new(r.wide(), test))
            }
            Radii::Each(radii) if test.is_exact() => AnyRule::ExactEach(radii, test),
            Radii::Uniform(r) => AnyRule::RoundedUniform(RoundedUniform::new(*r)),
            Radii::Each(radii) => AnyRule::RoundedEach(RoundedEach { radii }),
        }
    }
}

impl<T: Real> Rule<T> for AnyRule<'_, T> {
    #[inline]
    fn touch<const D: usize, P: Probe>(&self, of: Pair<'_, T, D>, probe: &mut P) -> bool {
        let wide = |p: &[T; D]| p.map(Real::wide);
        let exact = || (wide(of.a), wide(of.b));
        match self {
            AnyRule::RoundedUniform(rule) => rule.touch(of, probe),
            AnyRule::RoundedEach(rule) => rule.touch(of, probe),
            AnyRule::ExactUniform(rule) => {
                let (a, b) = exact();
                rule.touch(Pair { ids: of.ids, a: &a, b: &b }, probe)
            }
            AnyRule::ExactEach(radii, test) => {
                let (a, b) = exact();
                decide_each(&a, &b, of.each(|k| radii[k].wide()), *test, probe)
            }
            AnyRule::Asked(asked, radii) => {
                let ((a, b), (r, s)) = (exact(), of.each(|k| radii.get(k).wide()));
                asked.touch(Pair { ids: of.ids, a: &a, b: &b }, r + s, probe)
            }
        }
    }

    fn first_image(&self) -> u32 {
        if let AnyRule::Asked(asked, _) = self { asked.owners } else { u32::MAX }
    }
}
