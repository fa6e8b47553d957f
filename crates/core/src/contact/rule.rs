//! The evaluations of the contact test: rounded or exact, for one radius or one per particle.

use std::cmp::Ordering;

use super::{Slack, exact};
use crate::probe::{Op, Probe};
use crate::scene::{Radii, Real};

/// Two particles: their numbers and their centres.
#[derive(Clone, Copy)]
pub struct Couple<'a, T, const D: usize> {
    /// The numbers.
    pub ids: [u32; 2],
    /// Centre of the first particle.
    pub a: &'a [T; D],
    /// Centre of the second particle.
    pub b: &'a [T; D],
}

impl<T, const D: usize> Couple<'_, T, D> {
    /// Returns the value of `of` for each of the two particles.
    #[inline(always)]
    fn each<R>(&self, of: impl Fn(usize) -> R) -> (R, R) {
        (of(self.ids[0] as usize), of(self.ids[1] as usize))
    }
}

/// Evaluates the contact test for one kind of radii and arithmetic.
pub trait Rule<T: Real>: Copy + Sync {
    /// Do these two touch?
    fn touch<const D: usize, P: Probe>(&self, of: Couple<'_, T, D>, probe: &mut P) -> bool;
}

#[inline(always)]
fn square_distance<T: Real, const D: usize>(a: &[T; D], b: &[T; D]) -> T::Work {
    let mut sum = T::Work::default();
    for k in 0..D {
        let d = a[k].minus(b[k]);
        sum = sum + d * d;
    }
    sum
}

/// Rounded arithmetic, one radius: the square of the diameter is computed once.
#[derive(Clone, Copy)]
pub struct RoundedUniform<T: Real> {
    /// (2r)².
    square: T::Work,
}

impl<T: Real> RoundedUniform<T> {
    /// The test for bodies of this radius.
    pub(super) fn new(radius: T) -> RoundedUniform<T> {
        let sum = radius.plus(radius);
        RoundedUniform { square: sum * sum }
    }
}

impl<T: Real> Rule<T> for RoundedUniform<T> {
    #[inline(always)]
    fn touch<const D: usize, P: Probe>(&self, of: Couple<'_, T, D>, _: &mut P) -> bool {
        square_distance(of.a, of.b) <= self.square
    }
}

/// Rounded arithmetic, one radius per particle.
#[derive(Clone, Copy)]
pub struct RoundedEach<'a, T> {
    pub(super) radii: &'a [T],
}

impl<T: Real> Rule<T> for RoundedEach<'_, T> {
    #[inline(always)]
    fn touch<const D: usize, P: Probe>(&self, of: Couple<'_, T, D>, _: &mut P) -> bool {
        let (r, s) = of.each(|k| self.radii[k]);
        let sum = r.plus(s);
        square_distance(of.a, of.b) <= sum * sum
    }
}

/// The relative half-width of the band in which the filter does not decide: 16u of f64.
const BAND: f64 = 16.0 / (1u64 << 53) as f64;
/// The absolute half-width of the band: 2^-960.
const FLOOR: f64 = f64::from_bits((1023 - 960) << 52);

/// (undecided above this, apart above this) for a computed square of the sum of radii.
#[inline(always)]
fn band(square: f64) -> (f64, f64) {
    let overlap = if square < f64::INFINITY { square * (1.0 - BAND) - FLOOR } else { -1.0 };
    (overlap, square * (1.0 + BAND) + FLOOR)
}

#[inline(always)]
fn decide<const D: usize, P: Probe>(
    a: &[f64; D],
    b: &[f64; D],
    radii: impl Fn() -> (f64, f64),
    band: (f64, f64),
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
    exact::compare(a, b, ra, rb) != Ordering::Greater
}

/// Exact arithmetic, one radius: the filter's band is computed once.
#[derive(Clone, Copy)]
pub struct ExactUniform {
    radius: f64,
    band: (f64, f64),
}

impl ExactUniform {
    /// The test for bodies of this radius.
    pub(super) fn new(radius: f64) -> ExactUniform {
        let diameter = 2.0 * radius;
        ExactUniform { radius, band: band(diameter * diameter) }
    }
}

impl Rule<f64> for ExactUniform {
    #[inline(always)]
    fn touch<const D: usize, P: Probe>(&self, of: Couple<'_, f64, D>, probe: &mut P) -> bool {
        decide(of.a, of.b, || (self.radius, self.radius), self.band, probe)
    }
}

/// Exact arithmetic, one radius per particle.
#[derive(Clone, Copy)]
pub struct ExactEach<'a> {
    pub(super) radii: &'a [f64],
}

impl Rule<f64> for ExactEach<'_> {
    #[inline(always)]
    fn touch<const D: usize, P: Probe>(&self, of: Couple<'_, f64, D>, probe: &mut P) -> bool {
        decide_each(of.a, of.b, of.each(|k| self.radii[k]), probe)
    }
}

#[inline(always)]
fn decide_each<const D: usize, P: Probe>(
    a: &[f64; D],
    b: &[f64; D],
    (ra, rb): (f64, f64),
    probe: &mut P,
) -> bool {
    let sum = ra + rb;
    decide(a, b, || (ra, rb), band(sum * sum), probe)
}

/// Positions are only near the true ones: what they leave open somebody else decides.
#[derive(Clone, Copy)]
pub struct Asked<'a> {
    /// Bodies whose radii have the sum s touch if their positions are at most s(1 - relative) -
    /// absolute apart, and do not if they are more than s(1 + relative) + absolute apart. A
    /// relative part of at least 8u, 1% of the absolute one, or no slack at all, covers the
    /// roundings of those who compute with it (see [`super::slack`]).
    pub slack: Slack,
    /// Bodies from this number on are not asked about each other: nobody uses what is said of two
    /// of them.
    pub owners: u32,
    /// Do these two touch? Asked for pairs that positions do not decide; it must not contradict the
    /// slack.
    pub decide: Decide<'a>,
}

/// Decides whether two bodies touch, by their numbers.
pub type Decide<'a> = &'a (dyn Fn(u32, u32) -> bool + Sync);

impl Asked<'_> {
    /// Decides from positions where the slack allows it: the argument of
    /// [`Near`](crate::filter::Near).
    fn touch<const D: usize, P: Probe>(
        &self,
        of: Couple<'_, f64, D>,
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

/// Any of them, chosen anew for every test: the same answers, slower, and detectors are compiled
/// once instead of once for each. For the exact test of other storages, coordinates and radii
/// become doubles, which is without error.
#[derive(Clone, Copy)]
pub enum AnyRule<'a, T: Real> {
    /// Rounded, one radius.
    RoundedUniform(RoundedUniform<T>),
    /// Rounded, one radius per particle.
    RoundedEach(RoundedEach<'a, T>),
    /// Exact, one radius.
    ExactUniform(ExactUniform),
    /// Exact, one radius per particle.
    ExactEach(&'a [T]),
    /// Positions near the true ones, one radius or one per particle.
    Asked(Asked<'a>, &'a Radii<'a, T>),
}

impl<T: Real> Rule<T> for AnyRule<'_, T> {
    #[inline(always)]
    fn touch<const D: usize, P: Probe>(&self, of: Couple<'_, T, D>, probe: &mut P) -> bool {
        let wide = |p: &[T; D]| p.map(Real::wide);
        let exact = || (wide(of.a), wide(of.b));
        match self {
            AnyRule::RoundedUniform(rule) => rule.touch(of, probe),
            AnyRule::RoundedEach(rule) => rule.touch(of, probe),
            AnyRule::ExactUniform(rule) => {
                let (a, b) = exact();
                rule.touch(Couple { ids: of.ids, a: &a, b: &b }, probe)
            }
            AnyRule::ExactEach(radii) => {
                let (a, b) = exact();
                decide_each(&a, &b, of.each(|k| radii[k].wide()), probe)
            }
            AnyRule::Asked(asked, radii) => {
                let ((a, b), (r, s)) = (exact(), of.each(|k| radii.get(k).wide()));
                asked.touch(Couple { ids: of.ids, a: &a, b: &b }, r + s, probe)
            }
        }
    }
}
