//! The contact test, and how far a filter must look so that it never loses a pair that the test accepts.
//!
//! **One predicate.** Two bodies touch when |xi - xj| <= ri + rj: the test is closed (BOOK: "touch or overlap"). Every detector
//! decides through [`Bodies::touch`], which counts itself. There are two ways to evaluate it:
//!
//! * *rounded*: |xi - xj|² <= (ri + rj)² as floating point gives it, in the scene's own precision;
//! * *exact*: the sign of |xi - xj|² - (ri + rj)² for the given binary numbers, whatever they are. A filter in f64 decides nearly
//!   all pairs, [`exact::compare`] the rest.
//!
//! **The exact test's filter.** Let u = 2^-53, d2 and s2 the computed |xi - xj|² and (ri + rj)², and d², s² the true ones. A
//! difference or sum of two doubles has relative error at most u (it never underflows), a product u plus an absolute 2^-1075.
//! So d2 = d²(1 + e) + t with |e| <= (1+u)^5 - 1 < 6u for up to three dimensions and |t| <= 4·2^-1075, and
//! s2 = s²(1 + e') + t' with |e'| < 4u. If d2 > s2(1 + 16u) + 2^-960 as computed (two more roundings), then d² > s²: apart. If
//! d2 <= s2(1 - 16u) - 2^-960, then d² < s²: overlap. If d2 overflows, d² >= 2^1024(1 - 7u); a threshold s2(1 + 16u) + 2^-960 that does
//! not overflow means s² < 2^1024(1 - 9u): apart, too. An overflowing s2 never decides. Everything between is left to exact
//! arithmetic. NaN cannot arise from finite input.
//!
//! **The reach.** [`Bodies::reach`] is an upper bound of the true distance of any pair that `touch` can accept:
//!
//! * exact: 2·rmax, without error (doubling is exact);
//! * rounded, in precision u with smallest normal squares underflowing by at most η = half the smallest subnormal: acceptance
//!   means d²(1-u)^5 - 4η <= s²(1+u)^3 + η, hence d <= s(1 + 5u) + 3√η. We take 2·rmax(1 + 8u) + 4√η. Where squares overflow,
//!   rounded arithmetic would accept everything: such scenes are refused ([`Refusal::Overflow`]).
//!
//! What a *cell* must add to the reach for its own rounding is derived in [`crate::cells`].

pub mod depth;
pub mod exact;

use std::cmp::Ordering;

use nalgebra::Point;

use crate::detect::Refusal;
use crate::probe::{Op, Probe};
use crate::scene::{Radii, Scene};

/// A scalar in which scenes are stored: `f32` or `f64`.
pub trait Real:
    nalgebra::Scalar
    + Copy
    + PartialOrd
    + std::ops::Add<Output = Self>
    + std::ops::Sub<Output = Self>
    + std::ops::Mul<Output = Self>
    + Default
    + Send
    + Sync
    + sealed::Sealed
{
    /// Half the distance from 1 to the next number: the relative rounding error of one operation.
    const UNIT: f64;
    /// At least four times the square root of half the smallest subnormal.
    const UNDERFLOW: f64;
    /// The value as a double, without error.
    fn wide(self) -> f64;
    /// The nearest value of this type.
    fn nearest(x: f64) -> Self;
    /// False for NaN and the infinities.
    fn finite(self) -> bool;
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

impl Real for f32 {
    const UNIT: f64 = 1.0 / (1u64 << 24) as f64;
    const UNDERFLOW: f64 = f64::from_bits((1023 - 73) << 52); // 4·√(2^-150) = 2^-73
    fn wide(self) -> f64 {
        f64::from(self)
    }
    fn nearest(x: f64) -> f32 {
        x as f32
    }
    fn finite(self) -> bool {
        self.is_finite()
    }
}

impl Real for f64 {
    const UNIT: f64 = 1.0 / (1u64 << 53) as f64;
    const UNDERFLOW: f64 = f64::from_bits((1023 - 535) << 52); // 4·√(2^-1075) < 2^-535
    #[inline(always)]
    fn wide(self) -> f64 {
        self
    }
    fn nearest(x: f64) -> f64 {
        x
    }
    fn finite(self) -> bool {
        self.is_finite()
    }
}

/// How contacts are decided, and in which precision the scene is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default, serde::Serialize, serde::Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Arithmetic {
    /// Scene rounded to f32, |xi - xj|² <= (ri + rj)² evaluated in f32.
    F32,
    /// |xi - xj|² <= (ri + rj)² evaluated in f64.
    F64,
    /// The exact sign for the given f64 numbers.
    #[default]
    Exact,
}

impl Arithmetic {
    /// All arithmetics, cheapest first.
    pub const ALL: [Arithmetic; 3] = [Arithmetic::F32, Arithmetic::F64, Arithmetic::Exact];

    /// The name used in records and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Arithmetic::F32 => "f32",
            Arithmetic::F64 => "f64",
            Arithmetic::Exact => "exact",
        }
    }
}

/// What a detector sees of a scene: positions for its filters, the contact test for its decisions.
pub trait Bodies<T: Real, const D: usize>: Copy + Sync {
    /// The number of elements.
    fn len(&self) -> usize;
    /// True if there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// The centre of element `i`, in f64 without error.
    fn position(&self, i: u32) -> [f64; D];
    /// Do elements `i` and `j` touch? Counts one contact test.
    fn touch<P: Probe>(&self, i: u32, j: u32, probe: &mut P) -> bool;
    /// An upper bound for the true distance between the centres of any two elements that `touch` accepts.
    fn reach(&self) -> f64;
}

/// A scene with its contact test resolved to a type: what [`Bodies`] is implemented for.
#[derive(Clone, Copy)]
pub struct Subject<'a, T: Real, R, const D: usize> {
    centres: &'a [Point<T, D>],
    rule: R,
    reach: f64,
}

/// Evaluates the contact test for one kind of radii and arithmetic.
pub trait Rule<T: Real>: Copy + Sync {
    /// Do bodies `i` at `a` and `j` at `b` touch?
    fn touch<const D: usize, P: Probe>(&self, i: u32, j: u32, a: &[T; D], b: &[T; D], probe: &mut P) -> bool;
}

impl<T: Real, R: Rule<T>, const D: usize> Bodies<T, D> for Subject<'_, T, R, D> {
    fn len(&self) -> usize {
        self.centres.len()
    }

    #[inline(always)]
    fn position(&self, i: u32) -> [f64; D] {
        array(&self.centres[i as usize]).map(Real::wide)
    }

    #[inline(always)]
    fn touch<P: Probe>(&self, i: u32, j: u32, probe: &mut P) -> bool {
        probe.count(Op::ContactTest);
        self.rule.touch(i, j, array(&self.centres[i as usize]), array(&self.centres[j as usize]), probe)
    }

    fn reach(&self) -> f64 {
        self.reach
    }
}

/// The coordinates of a point as a plain array.
#[inline(always)]
pub fn array<T: nalgebra::Scalar, const D: usize>(p: &Point<T, D>) -> &[T; D] {
    &p.coords.data.0[0]
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

/// Rounded arithmetic, one radius: the square of the diameter is computed once.
#[derive(Clone, Copy)]
pub struct RoundedUniform<T> {
    square: T,
}

impl<T: Real> Rule<T> for RoundedUniform<T> {
    #[inline(always)]
    fn touch<const D: usize, P: Probe>(&self, _: u32, _: u32, a: &[T; D], b: &[T; D], _: &mut P) -> bool {
        square_distance(a, b) <= self.square
    }
}

/// Rounded arithmetic, one radius per element.
#[derive(Clone, Copy)]
pub struct RoundedEach<'a, T> {
    radii: &'a [T],
}

impl<T: Real> Rule<T> for RoundedEach<'_, T> {
    #[inline(always)]
    fn touch<const D: usize, P: Probe>(&self, i: u32, j: u32, a: &[T; D], b: &[T; D], _: &mut P) -> bool {
        let sum = self.radii[i as usize] + self.radii[j as usize];
        square_distance(a, b) <= sum * sum
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
fn decide<T: Real, const D: usize, P: Probe>(
    a: &[T; D],
    b: &[T; D],
    radii: impl Fn() -> (f64, f64),
    band: (f64, f64),
    probe: &mut P,
) -> bool {
    let (a, b) = (a.map(Real::wide), b.map(Real::wide));
    let square = square_distance(&a, &b);
    if square > band.1 {
        return false;
    }
    if square <= band.0 {
        return true;
    }
    probe.count(Op::ExactTest);
    let (ra, rb) = radii();
    exact::compare(&a, &b, ra, rb) != Ordering::Greater
}

/// Exact arithmetic, one radius: the filter's band is computed once.
#[derive(Clone, Copy)]
pub struct ExactUniform {
    radius: f64,
    band: (f64, f64),
}

impl<T: Real> Rule<T> for ExactUniform {
    #[inline(always)]
    fn touch<const D: usize, P: Probe>(&self, _: u32, _: u32, a: &[T; D], b: &[T; D], probe: &mut P) -> bool {
        decide(a, b, || (self.radius, self.radius), self.band, probe)
    }
}

/// Exact arithmetic, one radius per element.
#[derive(Clone, Copy)]
pub struct ExactEach<'a, T> {
    radii: &'a [T],
}

impl<T: Real> Rule<T> for ExactEach<'_, T> {
    #[inline(always)]
    fn touch<const D: usize, P: Probe>(&self, i: u32, j: u32, a: &[T; D], b: &[T; D], probe: &mut P) -> bool {
        let (ra, rb) = (self.radii[i as usize].wide(), self.radii[j as usize].wide());
        let sum = ra + rb;
        decide(a, b, || (ra, rb), band(sum * sum), probe)
    }
}

/// Something to be done with a scene once its contact test has a type.
pub trait WithBodies<T: Real, const D: usize> {
    /// What comes of it.
    type Output;
    /// Does it.
    fn call<B: Bodies<T, D>>(self, bodies: B) -> Self::Output;
}

/// Resolves radii and arithmetic to a type, once per detection, and hands the result to `then`.
///
/// `exact` asks for the exact test; otherwise the test is rounded in `T`.
pub fn with_bodies<T: Real, const D: usize, W, O>(scene: &Scene<'_, T, D>, exact: bool, then: W) -> Result<O, Refusal>
where
    W: WithBodies<T, D, Output = Result<O, Refusal>>,
{
    let centres = scene.centres();
    let diameter = 2.0 * scene.largest_radius().wide();
    if exact {
        return match scene.radii() {
            Radii::Uniform(r) => {
                then.call(Subject { centres, rule: ExactUniform { radius: r.wide(), band: band(diameter * diameter) }, reach: diameter })
            }
            Radii::Each(radii) => then.call(Subject { centres, rule: ExactEach { radii }, reach: diameter }),
        };
    }
    refuse_overflow(scene, diameter)?;
    let reach = diameter * (1.0 + 8.0 * T::UNIT) + T::UNDERFLOW;
    match scene.radii() {
        Radii::Uniform(r) => then.call(Subject { centres, rule: RoundedUniform { square: (*r + *r) * (*r + *r) }, reach }),
        Radii::Each(radii) => then.call(Subject { centres, rule: RoundedEach { radii }, reach }),
    }
}

/// Rounded arithmetic must be able to hold the square of the largest diameter.
fn refuse_overflow<T: Real, const D: usize>(scene: &Scene<'_, T, D>, diameter: f64) -> Result<(), Refusal> {
    let r = scene.largest_radius();
    if ((r + r) * (r + r)).finite() {
        return Ok(());
    }
    Err(Refusal::Overflow { diameter, precision: std::any::type_name::<T>() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::Tally;

    struct Touch(Tally);
    impl<const D: usize> WithBodies<f64, D> for &mut Touch {
        type Output = Result<bool, Refusal>;
        fn call<B: Bodies<f64, D>>(self, bodies: B) -> Self::Output {
            Ok(bodies.touch(0, 1, &mut self.0))
        }
    }

    fn touch<const D: usize>(centres: [[f64; D]; 2], radii: [f64; 2], exact: bool) -> (bool, u64) {
        let centres: Vec<_> = centres.into_iter().map(Point::from).collect();
        let mut answer = None;
        for uniform in [true, false] {
            if uniform && radii[0] != radii[1] {
                continue;
            }
            let radii = if uniform { Radii::Uniform(radii[0]) } else { Radii::Each(radii.to_vec().into()) };
            let scene = Scene::new(centres.clone(), radii).unwrap();
            let mut probe = Touch(Tally::default());
            let this = (with_bodies(&scene, exact, &mut probe).unwrap(), probe.0.get(Op::ExactTest));
            assert_eq!(*answer.get_or_insert(this), this);
        }
        answer.unwrap()
    }

    #[test]
    fn tangency_is_contact_and_one_ulp_apart_is_not() {
        for (x, y) in [(3.0, 4.0), (5.0, 12.0), (0.0, 7.0)] {
            let d = f64::hypot(x, y);
            assert_eq!(touch([[0.0, 0.0], [x, y]], [d / 2.0, d / 2.0], true), (true, 1));
            assert!(touch([[0.0, 0.0], [x, y]], [d / 4.0, d * 0.75], true).0);
            assert!(!touch([[0.0, 0.0], [x, y.next_up()]], [d / 2.0, d / 2.0], true).0);
            assert!(touch([[0.0, 0.0], [x, y.next_down()]], [d / 2.0, d / 2.0], true).0);
        }
        assert!(touch([[0.0, 0.0, 0.0], [2.0, 3.0, 6.0]], [3.5, 3.5], true).0);
        assert_eq!(touch([[0.0, 0.0], [3.0, 0.0]], [1.0, 1.0], true), (false, 0));
        assert_eq!(touch([[0.0, 0.0], [1.0, 0.0]], [1.0, 1.0], true), (true, 0));
    }

    #[test]
    fn the_exact_test_holds_where_squares_overflow_or_underflow() {
        assert!(touch([[0.0, 0.0], [1e-200, 0.0]], [1e-200, 1e-200], true).0);
        assert!(!touch([[0.0, 0.0], [3e-200, 0.0]], [1e-200, 1e-200], true).0);
        assert!(touch([[-1e200, 0.0], [1e200, 0.0]], [1e200, 1e200], true).0);
        assert!(!touch([[-1e200, 0.0], [1.1e200, 0.0]], [1e200, 1e200], true).0);
        assert!(touch([[f64::MAX, 0.0], [-f64::MAX, 0.0]], [f64::MAX, f64::MAX], true).0);
    }

    struct Reach;
    impl<const D: usize> WithBodies<f32, D> for Reach {
        type Output = Result<(bool, f64), Refusal>;
        fn call<B: Bodies<f32, D>>(self, bodies: B) -> Self::Output {
            Ok((bodies.touch(0, 1, &mut crate::probe::Silent), bodies.reach()))
        }
    }

    /// Rounded arithmetic accepts couples that are apart; the reach covers them. The couples are those one step from not being accepted.
    #[test]
    fn the_reach_covers_what_rounding_accepts() {
        let mut beyond = 0;
        let radii = (1..2000).map(|k| k as f32 * 0.00137).chain([1e-18, 3e-20, 1e-22, 1e-30, 0.0, f32::from_bits(1)]);
        for r in radii {
            let accepted = |x: f32| {
                let scene = Scene::new(vec![Point::from([0.0, 0.0]), Point::from([x, x])], Radii::Uniform(r)).unwrap();
                with_bodies(&scene, false, Reach).unwrap()
            };
            // Bisection on the bits of x: couples at (0, 0) and (x, x).
            let (mut low, mut high) = (0.0f32.to_bits(), (4.0 * r + 1e-3).to_bits());
            while high - low > 1 {
                let middle = low + (high - low) / 2;
                if accepted(f32::from_bits(middle)).0 { low = middle } else { high = middle }
            }
            let x = f64::from(f32::from_bits(low));
            let reach = accepted(x as f32).1;
            let apart = |d: f64| exact::compare(&[0.0, 0.0], &[x, x], d / 2.0, d / 2.0) == Ordering::Greater;
            beyond += i32::from(apart(2.0 * f64::from(r)));
            assert!(!apart(reach), "r = {r:e}: accepted at ({x:e}, {x:e}), reach {reach:e}");
        }
        assert!(beyond > 100, "this test must hold couples that only rounding accepts");
    }

    #[test]
    fn rounded_arithmetic_refuses_what_it_cannot_square() {
        let scene = Scene::<f64, 2>::new(vec![Point::from([0.0, 0.0])], Radii::Uniform(1e200)).unwrap();
        let refusal = with_bodies(&scene, false, &mut Touch(Tally::default()));
        assert!(matches!(refusal, Err(Refusal::Overflow { .. })));
    }
}
