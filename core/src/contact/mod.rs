//! The contact test: in which number format a scene is stored, and how |xi - xj| <= ri + rj is decided.
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
//! How far apart two accepted bodies can be at most, and what cells, boxes and keys must add to that, is derived in
//! [`crate::filter`].

pub mod depth;
pub mod exact;
mod rule;
mod scalar;

use nalgebra::Point;

use crate::detect::Refusal;
use crate::filter::{self, Margin};
use crate::probe::{Op, Probe};
use crate::scene::{Radii, Scene};
pub use rule::{AnyRule, ExactEach, ExactUniform, RoundedEach, RoundedUniform, Rule};
pub use scalar::{CellF32, Real, Work};

/// How contacts are decided, and in which precision the scene is stored: the axis of accuracy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default, serde::Serialize, serde::Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Arithmetic {
    /// Scene rounded to f32, |xi - xj|² <= (ri + rj)² evaluated in f32.
    F32,
    /// As f32, but coordinates are stored as a cell number and an offset from the cell's origin in f32.
    F32Cell,
    /// f64 with the filters as the book prints them, without a safety margin: may lose contacts.
    Textbook,
    /// |xi - xj|² <= (ri + rj)² evaluated in f64.
    F64,
    /// The exact sign for the given f64 numbers.
    #[default]
    Exact,
}

impl Arithmetic {
    /// All arithmetics, from the least to the most accurate.
    pub const ALL: [Arithmetic; 5] = [Arithmetic::F32, Arithmetic::F32Cell, Arithmetic::Textbook, Arithmetic::F64, Arithmetic::Exact];

    /// Those in which every detector must find exactly the pairs that the contact test accepts. Textbook filters promise no such thing.
    pub const SAFE: [Arithmetic; 4] = [Arithmetic::F32, Arithmetic::F32Cell, Arithmetic::F64, Arithmetic::Exact];

    /// The name used in records and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Arithmetic::F32 => "f32",
            Arithmetic::F32Cell => "f32-cell",
            Arithmetic::Textbook => "textbook",
            Arithmetic::F64 => "f64",
            Arithmetic::Exact => "exact",
        }
    }

    /// What it means, in a phrase.
    pub fn summary(self) -> &'static str {
        match self {
            Arithmetic::F32 => "scene stored in f32, contacts decided in f32",
            Arithmetic::F32Cell => "coordinates as cell number and f32 offset from the cell's origin, contacts decided in f32",
            Arithmetic::Textbook => "f64, with the book's filters as printed: may lose contacts to rounding",
            Arithmetic::F64 => "scene stored and contacts decided in f64",
            Arithmetic::Exact => "scene stored in f64, contacts decided exactly (the default)",
        }
    }

    /// All names, for messages.
    pub fn names() -> String {
        Arithmetic::ALL.map(Arithmetic::name).join(", ")
    }

    /// How a scene that is stored for this arithmetic is tested.
    pub fn test(self) -> Test {
        match self {
            Arithmetic::F32 | Arithmetic::F32Cell | Arithmetic::F64 => Test::Rounded,
            Arithmetic::Textbook => Test::Textbook,
            Arithmetic::Exact => Test::Exact,
        }
    }

    /// One of [`Arithmetic::SAFE`]?
    pub fn is_safe(self) -> bool {
        Arithmetic::SAFE.contains(&self)
    }
}

/// How a stored scene is tested for contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Test {
    /// Rounded in the scene's own precision.
    Rounded,
    /// Rounded, with filters that have no safety margin.
    Textbook,
    /// The exact sign for the stored numbers.
    Exact,
}

impl Test {
    /// The same contact test with filters that lose nothing: what all pairs tested are held to.
    pub fn safe(self) -> Test {
        if self == Test::Textbook { Test::Rounded } else { self }
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
    /// The radius of element `i`, in f64 without error.
    fn radius(&self, i: u32) -> f64;
    /// The radius of all elements, if it is the same for all, in f64 without error.
    fn uniform(&self) -> Option<f64>;
    /// How much the test's rounding can move the distance at which two elements touch.
    fn slack(&self) -> Slack;
    /// Whether filters may lose pairs to rounding.
    fn margin(&self) -> Margin {
        Margin::Safe
    }
}

/// Elements whose radii have the sum s are accepted if their true distance is at most s(1 - relative) - absolute, and refused if it is more than
/// s(1 + relative) + absolute. Derived in [`crate::filter`], 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slack {
    /// Relative to the sum of the radii.
    pub relative: f64,
    /// In units of length.
    pub absolute: f64,
}

impl Slack {
    /// That of the exact test.
    pub const NONE: Slack = Slack { relative: 0.0, absolute: 0.0 };
}

/// A scene with its contact test resolved to a type: what [`Bodies`] is implemented for.
#[derive(Clone, Copy)]
pub struct Subject<'a, T: Real, R, const D: usize> {
    centres: &'a [Point<T, D>],
    rule: R,
    radii: &'a Radii<'a, T>,
    reach: f64,
    slack: Slack,
    margin: Margin,
}

impl<T: Real, R: Rule<T>, const D: usize> Bodies<T, D> for Subject<'_, T, R, D> {
    fn len(&self) -> usize {
        self.centres.len()
    }

    #[inline(always)]
    fn position(&self, i: u32) -> [f64; D] {
        let centre = array(&self.centres[i as usize]);
        std::array::from_fn(|k| centre[k].wide())
    }

    #[inline(always)]
    fn touch<P: Probe>(&self, i: u32, j: u32, probe: &mut P) -> bool {
        probe.count(Op::ContactTest);
        self.rule.touch(i, j, array(&self.centres[i as usize]), array(&self.centres[j as usize]), probe)
    }

    fn reach(&self) -> f64 {
        self.reach
    }

    #[inline(always)]
    fn radius(&self, i: u32) -> f64 {
        self.radii.of(i as usize).wide()
    }

    fn uniform(&self) -> Option<f64> {
        match self.radii {
            Radii::Uniform(r) => Some(r.wide()),
            Radii::Each(_) => None,
        }
    }

    fn slack(&self) -> Slack {
        self.slack
    }

    fn margin(&self) -> Margin {
        self.margin
    }
}

/// The coordinates of a point as a plain array.
#[inline(always)]
pub fn array<T: nalgebra::Scalar, const D: usize>(p: &Point<T, D>) -> &[T; D] {
    &p.coords.data.0[0]
}

/// Something to be done with a scene once its contact test has a type.
pub trait WithBodies<T: Real, const D: usize> {
    /// What comes of it.
    type Output;
    /// Does it.
    fn call<B: Bodies<T, D>>(self, bodies: B) -> Self::Output;
}

/// Resolves radii and contact test to a type, once per detection, and hands the result to `then`.
///
/// The exact test takes scenes in f64 only; others are refused: [`Scene::convert`] makes them f64 without error.
pub fn with_bodies<T: Real, const D: usize, W, O>(scene: &Scene<'_, T, D>, test: Test, then: W) -> Result<O, Refusal>
where
    W: WithBodies<T, D, Output = Result<O, Refusal>>,
{
    if test == Test::Exact {
        return T::exactly(scene, then);
    }
    let frame = Frame::rounded(scene, test)?;
    match scene.radii() {
        Radii::Uniform(r) => then.call(frame.with(scene, RoundedUniform::new(*r))),
        Radii::Each(radii) => then.call(frame.with(scene, RoundedEach { radii })),
    }
}

/// As [`with_bodies`], with a contact test that is looked up for each pair: for what is not timed. Exact tests take every storage.
pub fn any_bodies<'a, T: Real, const D: usize>(
    scene: &'a Scene<'_, T, D>,
    test: Test,
) -> Result<Subject<'a, T, AnyRule<'a, T>, D>, Refusal> {
    let (frame, rule) = match (test, scene.radii()) {
        (Test::Exact, Radii::Uniform(r)) => (Frame::exact(scene), AnyRule::ExactUniform(ExactUniform::new(r.wide()))),
        (Test::Exact, Radii::Each(radii)) => (Frame::exact(scene), AnyRule::ExactEach(radii)),
        (_, Radii::Uniform(r)) => (Frame::rounded(scene, test)?, AnyRule::RoundedUniform(RoundedUniform::new(*r))),
        (_, Radii::Each(radii)) => (Frame::rounded(scene, test)?, AnyRule::RoundedEach(RoundedEach { radii })),
    };
    Ok(frame.with(scene, rule))
}

/// The exact test, for doubles: every storage becomes doubles without error, so that it need not be compiled for the others.
fn exactly<const D: usize, W, O>(scene: &Scene<'_, f64, D>, then: W) -> Result<O, Refusal>
where
    W: WithBodies<f64, D, Output = Result<O, Refusal>>,
{
    let frame = Frame::exact(scene);
    match scene.radii() {
        Radii::Uniform(r) => then.call(frame.with(scene, ExactUniform::new(*r))),
        Radii::Each(radii) => then.call(frame.with(scene, ExactEach { radii })),
    }
}

/// What a test means for filters.
struct Frame {
    reach: f64,
    slack: Slack,
    margin: Margin,
}

impl Frame {
    fn rounded<T: Real, const D: usize>(scene: &Scene<'_, T, D>, test: Test) -> Result<Frame, Refusal> {
        let diameter = 2.0 * scene.largest_radius().wide();
        refuse_overflow(scene, diameter)?;
        let (margin, reach) = match test {
            Test::Textbook => (Margin::Textbook, diameter),
            _ => (Margin::Safe, filter::rounded_reach::<T>(diameter)),
        };
        Ok(Frame { reach, slack: filter::rounded_slack::<T>(), margin })
    }

    fn exact<T: Real, const D: usize>(scene: &Scene<'_, T, D>) -> Frame {
        Frame { reach: 2.0 * scene.largest_radius().wide(), slack: Slack::NONE, margin: Margin::Safe }
    }

    fn with<'a, T: Real, R, const D: usize>(self, scene: &'a Scene<'_, T, D>, rule: R) -> Subject<'a, T, R, D> {
        Subject { centres: scene.centres(), radii: scene.radii(), rule, reach: self.reach, slack: self.slack, margin: self.margin }
    }
}

/// Rounded arithmetic must be able to hold the square of the largest diameter.
fn refuse_overflow<T: Real, const D: usize>(scene: &Scene<'_, T, D>, diameter: f64) -> Result<(), Refusal> {
    let r = scene.largest_radius();
    let sum = r.plus(r);
    if (sum * sum).finite() {
        return Ok(());
    }
    Err(Refusal::Overflow { diameter, precision: T::NAME })
}

#[cfg(test)]
mod tests {
    use std::cmp::Ordering;

    use super::*;
    use crate::probe::Tally;

    struct Touch(Tally);
    impl<const D: usize> WithBodies<f64, D> for &mut Touch {
        type Output = Result<bool, Refusal>;
        fn call<B: Bodies<f64, D>>(self, bodies: B) -> Self::Output {
            Ok(bodies.touch(0, 1, &mut self.0))
        }
    }

    fn touch<const D: usize>(centres: [[f64; D]; 2], radii: [f64; 2], test: Test) -> (bool, u64) {
        let centres: Vec<_> = centres.into_iter().map(Point::from).collect();
        let mut answer = None;
        for uniform in [true, false] {
            if uniform && radii[0] != radii[1] {
                continue;
            }
            let radii = if uniform { Radii::Uniform(radii[0]) } else { Radii::Each(radii.to_vec().into()) };
            let scene = Scene::new(centres.clone(), radii).unwrap();
            let mut probe = Touch(Tally::default());
            let this = (with_bodies(&scene, test, &mut probe).unwrap(), probe.0.get(Op::ExactTest));
            assert_eq!(*answer.get_or_insert(this), this);
            let mut tally = Tally::default();
            let any = any_bodies(&scene, test).unwrap().touch(0, 1, &mut tally);
            assert_eq!((any, tally.get(Op::ExactTest)), this);
        }
        answer.unwrap()
    }

    #[test]
    fn tangency_is_contact_and_one_ulp_apart_is_not() {
        for (x, y) in [(3.0, 4.0), (5.0, 12.0), (0.0, 7.0)] {
            let d = f64::hypot(x, y);
            assert_eq!(touch([[0.0, 0.0], [x, y]], [d / 2.0, d / 2.0], Test::Exact), (true, 1));
            assert!(touch([[0.0, 0.0], [x, y]], [d / 4.0, d * 0.75], Test::Exact).0);
            assert!(!touch([[0.0, 0.0], [x, y.next_up()]], [d / 2.0, d / 2.0], Test::Exact).0);
            assert!(touch([[0.0, 0.0], [x, y.next_down()]], [d / 2.0, d / 2.0], Test::Exact).0);
        }
        assert!(touch([[0.0, 0.0, 0.0], [2.0, 3.0, 6.0]], [3.5, 3.5], Test::Exact).0);
        assert_eq!(touch([[0.0, 0.0], [3.0, 0.0]], [1.0, 1.0], Test::Exact), (false, 0));
        assert_eq!(touch([[0.0, 0.0], [1.0, 0.0]], [1.0, 1.0], Test::Exact), (true, 0));
    }

    #[test]
    fn the_exact_test_holds_where_squares_overflow_or_underflow() {
        assert!(touch([[0.0, 0.0], [1e-200, 0.0]], [1e-200, 1e-200], Test::Exact).0);
        assert!(!touch([[0.0, 0.0], [3e-200, 0.0]], [1e-200, 1e-200], Test::Exact).0);
        assert!(touch([[-1e200, 0.0], [1e200, 0.0]], [1e200, 1e200], Test::Exact).0);
        assert!(!touch([[-1e200, 0.0], [1.1e200, 0.0]], [1e200, 1e200], Test::Exact).0);
        assert!(touch([[f64::MAX, 0.0], [-f64::MAX, 0.0]], [f64::MAX, f64::MAX], Test::Exact).0);
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
                with_bodies(&scene, Test::Rounded, Reach).unwrap()
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
        let refusal = with_bodies(&scene, Test::Rounded, &mut Touch(Tally::default()));
        assert!(matches!(refusal, Err(Refusal::Overflow { .. })));
    }
}
