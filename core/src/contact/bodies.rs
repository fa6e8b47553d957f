//! What a detector sees of a scene, and the contact test as a type.

use nalgebra::Point;

use super::rule::{
    AnyRule, Asked, Decide, ExactEach, ExactUniform, RoundedEach, RoundedUniform, Rule,
};
use super::{Margin, Slack, Test};
use crate::probe::{Op, Probe};
use crate::refusal::Refusal;
use crate::scene::{AnyScene, CellF32, Radii, Real, Scene, Stored, Work, array};

/// What a detector sees of a scene: positions for its filters, the contact test for its decisions.
pub trait Bodies<T: Real, const D: usize>: Copy + Sync {
    /// The number of particles.
    fn len(&self) -> usize;
    /// True if there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// The centre of particle `i`, in f64 without error.
    fn position(&self, i: u32) -> [f64; D];
    /// Do particles `i` and `j` touch? Counts one contact test.
    fn touch<P: Probe>(&self, i: u32, j: u32, probe: &mut P) -> bool;
    /// An upper bound for the true distance between the centres of any two particles that `touch`
    /// accepts.
    fn reach(&self) -> f64;
    /// The same of two whose radii are at most `a` and `b`: the reach of two classes of sizes. For
    /// the textbook's filters it is their sum, whatever the test accepts.
    fn class_reach(&self, a: f64, b: f64) -> f64 {
        match self.margin() {
            Margin::Safe => self.slack().reach(a, b),
            Margin::Textbook => a + b,
        }
    }
    /// The radius of particle `i`, in f64 without error.
    fn radius(&self, i: u32) -> f64;
    /// The radius of all particles, if it is the same for all, in f64 without error.
    fn uniform(&self) -> Option<f64>;
    /// How much the test's rounding can move the distance at which two particles touch.
    fn slack(&self) -> Slack;
    /// Whether filters may lose pairs to rounding.
    fn margin(&self) -> Margin {
        Margin::Safe
    }
}

/// A scene with its contact test resolved to a type.
#[derive(Clone, Copy)]
pub struct SceneBodies<'a, T: Real, R, const D: usize> {
    centres: &'a [Point<T, D>],
    rule: R,
    radii: &'a Radii<'a, T>,
    reach: f64,
    slack: Slack,
    margin: Margin,
}

impl<T: Real, R: Rule<T>, const D: usize> Bodies<T, D> for SceneBodies<'_, T, R, D> {
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
        self.rule.touch(
            i,
            j,
            array(&self.centres[i as usize]),
            array(&self.centres[j as usize]),
            probe,
        )
    }

    fn reach(&self) -> f64 {
        self.reach
    }

    #[inline(always)]
    fn radius(&self, i: u32) -> f64 {
        self.radii.get(i as usize).wide()
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

/// Work on a scene that is compiled for each type of contact test.
pub trait WithBodies<T: Real, const D: usize> {
    /// The result of the work.
    type Output;
    /// Works on `bodies`.
    fn call<B: Bodies<T, D>>(self, bodies: B) -> Self::Output;
}

/// Resolves radii and contact test to a type, once per detection, and hands the result to `then`;
/// a rounded test is rounded in f64.
///
/// # Errors
/// [`Refusal::Overflow`] if the test is rounded and cannot hold the square of the largest diameter,
/// and what `then` refuses.
pub fn with_bodies<const D: usize, W, O>(
    scene: &Scene<'_, f64, D>,
    test: Test,
    then: W,
) -> Result<O, Refusal>
where
    W: WithBodies<f64, D, Output = Result<O, Refusal>>,
{
    match test.margin() {
        Some(margin) => rounded(scene, margin, then),
        None => exact(scene, then),
    }
}

/// As [`with_bodies`], for a scene in any storage: a rounded test is rounded in that storage, for
/// the exact test the scene is widened to f64, so that it is compiled for f64 only.
///
/// # Errors
/// See [`with_bodies`].
pub fn with_stored<const D: usize, W, O>(
    scene: &Stored<'_, D>,
    test: Test,
    then: W,
) -> Result<O, Refusal>
where
    W: WithBodies<f32, D, Output = Result<O, Refusal>>
        + WithBodies<f64, D, Output = Result<O, Refusal>>
        + WithBodies<CellF32, D, Output = Result<O, Refusal>>,
{
    let Some(margin) = test.margin() else { return exact(&scene.widened(), then) };
    match scene {
        Stored::F32(scene) => rounded(scene, margin, then),
        Stored::F64(scene) => rounded(scene, margin, then),
        Stored::Cell(scene) => rounded(scene, margin, then),
    }
}

fn rounded<T: Real, const D: usize, W, O>(
    scene: &Scene<'_, T, D>,
    margin: Margin,
    then: W,
) -> Result<O, Refusal>
where
    W: WithBodies<T, D, Output = Result<O, Refusal>>,
{
    let envelope = Envelope::rounded(scene, margin)?;
    match scene.radii() {
        Radii::Uniform(r) => then.call(envelope.with(scene, RoundedUniform::new(*r))),
        Radii::Each(radii) => then.call(envelope.with(scene, RoundedEach { radii })),
    }
}

fn exact<const D: usize, W, O>(scene: &Scene<'_, f64, D>, then: W) -> O
where
    W: WithBodies<f64, D, Output = O>,
{
    let envelope = Envelope::exact(scene);
    match scene.radii() {
        Radii::Uniform(r) => then.call(envelope.with(scene, ExactUniform::new(*r))),
        Radii::Each(radii) => then.call(envelope.with(scene, ExactEach { radii })),
    }
}

/// As [`with_bodies`], with a contact test that is looked up for each pair: for what is not timed.
/// Takes every storage, also for the exact test.
///
/// # Errors
/// [`Refusal::Overflow`], see [`with_bodies`].
pub fn any_bodies<'a, T: Real, const D: usize>(
    scene: &'a Scene<'_, T, D>,
    test: Test,
) -> Result<SceneBodies<'a, T, AnyRule<'a, T>, D>, Refusal> {
    let envelope = match test.margin() {
        Some(margin) => Envelope::rounded(scene, margin)?,
        None => Envelope::exact(scene),
    };
    let rule = match (test, scene.radii()) {
        (Test::Exact, Radii::Uniform(r)) => AnyRule::ExactUniform(ExactUniform::new(r.wide())),
        (Test::Exact, Radii::Each(radii)) => AnyRule::ExactEach(radii),
        (_, Radii::Uniform(r)) => AnyRule::RoundedUniform(RoundedUniform::new(*r)),
        (_, Radii::Each(radii)) => AnyRule::RoundedEach(RoundedEach { radii }),
    };
    Ok(envelope.with(scene, rule))
}

/// A scene in f64 whose positions are only near the true ones, and somebody who knows those.
#[derive(Clone, Copy)]
pub struct Approximate<'a> {
    /// Positions as filters see them, and radii as they are.
    pub scene: &'a AnyScene<'a>,
    /// Bodies whose radii have the sum s touch if their positions are at most s(1 - relative) -
    /// absolute apart, and do not if they are more than s(1 + relative) + absolute apart. A
    /// relative part of at least 8u, 1% of the absolute one, or no slack at all, covers the
    /// roundings of those who compute with it (see [`super::slack`]).
    pub slack: Slack,
    /// Bodies from this number on are not asked about each other: nobody uses what is said of two
    /// of them.
    pub owners: u32,
    /// Do these two touch? It must not contradict the slack.
    pub decide: Decide<'a>,
}

/// What detectors see of an [`Approximate`] scene; the exact test of such a scene.
pub fn approximate_bodies<'a, const D: usize>(
    scene: &'a Scene<'_, f64, D>,
    asked: Asked<'a>,
) -> SceneBodies<'a, f64, AnyRule<'a, f64>, D> {
    let r = scene.largest_radius();
    let slack = asked.slack;
    let envelope = Envelope { reach: slack.reach(r, r), slack, margin: Margin::Safe };
    envelope.with(scene, AnyRule::Asked(asked, scene.radii()))
}

impl<'a> Approximate<'a> {
    /// Their contact test.
    pub fn asked(&self) -> Asked<'a> {
        Asked { slack: self.slack, owners: self.owners, decide: self.decide }
    }
}

/// What a contact test means for filters.
struct Envelope {
    reach: f64,
    slack: Slack,
    margin: Margin,
}

impl Envelope {
    /// Rounded arithmetic must be able to hold the square of the largest diameter.
    fn rounded<T: Real, const D: usize>(
        scene: &Scene<'_, T, D>,
        margin: Margin,
    ) -> Result<Envelope, Refusal> {
        let r = scene.largest_radius();
        let (sum, diameter) = (r.plus(r), 2.0 * r.wide());
        if !(sum * sum).finite() {
            return Err(Refusal::Overflow { diameter, precision: T::NAME });
        }
        let slack = Slack::rounded::<T>();
        let reach = match margin {
            Margin::Textbook => diameter,
            Margin::Safe => slack.reach(r.wide(), r.wide()),
        };
        Ok(Envelope { reach, slack, margin })
    }

    fn exact<T: Real, const D: usize>(scene: &Scene<'_, T, D>) -> Envelope {
        let reach = 2.0 * scene.largest_radius().wide();
        Envelope { reach, slack: Slack::NONE, margin: Margin::Safe }
    }

    fn with<'a, T: Real, R, const D: usize>(
        self,
        scene: &'a Scene<'_, T, D>,
        rule: R,
    ) -> SceneBodies<'a, T, R, D> {
        let Envelope { reach, slack, margin } = self;
        SceneBodies { centres: scene.centres(), radii: scene.radii(), rule, reach, slack, margin }
    }
}
