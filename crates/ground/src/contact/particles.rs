//! The view of a scene that detectors work on: positions for filters, and a contact test whose type
//! is fixed at compile time.

use nalgebra::Point;

use super::rule::{
    AnyRule, Asked, ExactEach, ExactUniform, Pair, RoundedEach, RoundedUniform, Rule,
};
use super::{Margin, Slack, Test};
use crate::limits::refusal::Refusal;
use crate::probe::{Op, Probe};
use crate::scene::{Radii, Real, Scene, Stored, array};
use crate::wide::fill;

/// Positions and radii for a detector's filters, and the contact test for its decisions.
pub trait Particles<T: Real, const D: usize>: Copy + Sync {
    /// Whether radii may differ; if false, code for radii that differ need not be compiled.
    const RADII_DIFFER: bool = true;
    /// Returns the number of particles.
    fn len(&self) -> usize;
    /// Returns whether the number of particles is 0.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Returns the centre of particle `i` in f64, without rounding.
    fn position(&self, i: u32) -> [f64; D];
    /// Requests the centre of particle `i` from memory, for a later call.
    fn prefetch(&self, _i: u32) {}
    /// Returns whether particles `i` and `j` touch. Each call counts as one contact test.
    fn touch<P: Probe>(&self, i: u32, j: u32, probe: &mut P) -> bool;
    /// Returns an upper bound for the true distance between the centres of any two particles that
    /// `touch` accepts.
    fn reach(&self) -> f64;
    /// Returns an upper bound for the true distance between two particles that `touch` accepts,
    /// with radii of at most `a` and `b`. For textbook margins it is a + b, whatever the test
    /// accepts.
    fn class_reach(&self, a: f64, b: f64) -> f64 {
        match self.margin() {
            Margin::Safe => self.slack().reach(a, b),
            Margin::Textbook => a + b,
        }
    }
    /// Returns the radius of particle `i` in f64, without rounding.
    fn radius(&self, i: u32) -> f64;
    /// Returns the radius that all particles share, in f64 without rounding, or `None` if radii are
    /// stored one by one.
    fn uniform(&self) -> Option<f64>;
    /// Returns how much the test's rounding can change the distance at which two particles touch.
    fn slack(&self) -> Slack;
    /// Returns the reach up to which particles touch only if they coincide or squares underflow.
    fn underflow(&self) -> f64 {
        T::UNDERFLOW
    }
    /// Returns the margin of filters: safe, or the textbook's, which may lose pairs to rounding.
    fn margin(&self) -> Margin {
        Margin::Safe
    }
    /// Returns the index of the first image of another particle, or `u32::MAX` if none is known.
    /// The contact test rejects pairs of two images.
    fn first_image(&self) -> u32 {
        u32::MAX
    }
    /// Returns the smallest and the largest coordinate along each axis, if already computed.
    fn corners(&self) -> Option<Corners<D>> {
        None
    }
}

/// The smallest and the largest coordinate along each axis: corners of a bounding box.
pub type Corners<const D: usize> = ([f64; D], [f64; D]);

/// The centres of a scene, in the order of the particles.
pub trait Centres<T: Real, const D: usize>: Copy + Sync {
    /// Returns the number of centres.
    fn count(&self) -> usize;
    /// Returns the centre of particle `i`.
    fn at(&self, i: usize) -> &[T; D];
}

impl<T: Real, const D: usize> Centres<T, D> for &[Point<T, D>] {
    fn count(&self) -> usize {
        self.len()
    }

    #[inline(always)]
    fn at(&self, i: usize) -> &[T; D] {
        array(&self[i])
    }
}

/// Centres in two slices, so that images can follow the particles of a scene without a copy.
#[derive(Clone, Copy)]
pub struct Pieces<'a, T: Real, const D: usize> {
    first: &'a [Point<T, D>],
    /// Centres that are numbered after the centres of `first`.
    rest: &'a [Point<T, D>],
}

impl<T: Real, const D: usize> Centres<T, D> for Pieces<'_, T, D> {
    fn count(&self) -> usize {
        self.first.len() + self.rest.len()
    }

    #[inline(always)]
    fn at(&self, i: usize) -> &[T; D] {
        match self.first.get(i) {
            Some(centre) => array(centre),
            None => array(&self.rest[i - self.first.len()]),
        }
    }
}

/// A scene with a contact test whose type is fixed at compile time, for static dispatch.
#[derive(Clone, Copy)]
pub struct SceneParticles<'a, T: Real, R, C, const D: usize> {
    centres: C,
    rule: R,
    radii: &'a Radii<'a, T>,
    reach: f64,
    slack: Slack,
    margin: Margin,
    corners: Option<Corners<D>>,
}

/// A scene whose contact test is chosen at run time, for each pair.
pub type AnyParticles<'a, T, const D: usize> =
    SceneParticles<'a, T, AnyRule<'a, T>, Pieces<'a, T, D>, D>;

impl<T: Real, R: Rule<T>, C: Centres<T, D>, const D: usize> Particles<T, D>
    for SceneParticles<'_, T, R, C, D>
{
    const RADII_DIFFER: bool = R::RADII_DIFFER;

    fn len(&self) -> usize {
        self.centres.count()
    }

    #[inline(always)]
    fn position(&self, i: u32) -> [f64; D] {
        let centre = self.centres.at(i as usize);
        fill(|k| centre[k].wide())
    }

    #[inline(always)]
    fn prefetch(&self, i: u32) {
        crate::radix::prefetch_to_write(self.centres.at(i as usize), 0);
    }

    #[inline(always)]
    fn touch<P: Probe>(&self, i: u32, j: u32, probe: &mut P) -> bool {
        probe.count(Op::ContactTest);
        let (a, b) = (self.centres.at(i as usize), self.centres.at(j as usize));
        self.rule.touch(Pair { ids: [i, j], a, b }, probe)
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

    fn first_image(&self) -> u32 {
        self.rule.first_image()
    }

    fn corners(&self) -> Option<Corners<D>> {
        self.corners
    }
}

/// Code that works on a scene and is compiled separately for each type of contact test.
pub trait WithParticles<T: Real, const D: usize> {
    /// Type of the code's result.
    type Output;
    /// Runs the code on `particles`.
    fn call<B: Particles<T, D>>(self, particles: B) -> Self::Output;
}

/// Calls `then` with the type of contact test that fits the radii and `test`. The type is chosen
/// once per detection. A rounded test is rounded in f64.
///
/// # Errors
/// Returns [`Refusal::Overflow`] if the test is rounded and the square of the largest diameter
/// overflows, and any error that `then` returns.
pub fn with_particles<const D: usize, W, O>(
    scene: &Scene<'_, f64, D>,
    test: Test,
    then: W,
) -> Result<O, Refusal>
where
    W: WithParticles<f64, D, Output = Result<O, Refusal>>,
{
    if !test.is_exact() {
        return rounded(scene, test, then);
    }
    let (envelope, centres) = (Envelope::exact(scene.largest_radius()), scene.centres());
    match scene.radii() {
        radii @ Radii::Uniform(r) => {
            then.call(envelope.with(centres, radii, ExactUniform::new(*r, test)))
        }
        all @ Radii::Each(radii) => {
            then.call(envelope.with(centres, all, ExactEach { radii, test }))
        }
    }
}

/// Calls `then` as [`with_particles`] does, for a scene in any storage. A rounded test is rounded
/// in that storage. For the exact test the scene is widened to f64, so that this test is compiled
/// for f64 only. Fails as [`with_particles`].
pub fn with_stored<const D: usize, W, O>(
    scene: &Stored<'_, D>,
    test: Test,
    then: W,
) -> Result<O, Refusal>
where
    W: WithParticles<f32, D, Output = Result<O, Refusal>>
        + WithParticles<f64, D, Output = Result<O, Refusal>>,
{
    match scene {
        Stored::F32(scene) if !test.is_exact() => rounded(scene, test, then),
        scene => with_particles(&scene.widened(), test, then),
    }
}

fn rounded<T: Real, const D: usize, W, O>(
    scene: &Scene<'_, T, D>,
    test: Test,
    then: W,
) -> Result<O, Refusal>
where
    W: WithParticles<T, D, Output = Result<O, Refusal>>,
{
    let (envelope, centres) = (Envelope::of(scene.largest_radius(), test)?, scene.centres());
    match scene.radii() {
        radii @ Radii::Uniform(r) => {
            then.call(envelope.with(centres, radii, RoundedUniform::new(*r)))
        }
        all @ Radii::Each(radii) => then.call(envelope.with(centres, all, RoundedEach { radii })),
    }
}

/// Returns the scene with a contact test that is chosen anew for each pair. It serves code that is
/// not timed and detectors that seldom call the test. Every storage works, even with the exact
/// test. Fails with [`Refusal::Overflow`] as [`with_particles`].
pub fn any_particles<'a, T: Real, const D: usize>(
    scene: &'a Scene<'_, T, D>,
    test: Test,
) -> Result<AnyParticles<'a, T, D>, Refusal> {
    let envelope = Envelope::of(scene.largest_radius(), test)?;
    let centres = Pieces { first: scene.centres(), rest: &[] };
    Ok(envelope.with(centres, scene.radii(), AnyRule::new(scene.radii(), test)))
}

/// Particles of a periodic scene, followed by images of some of them.
#[derive(Clone, Copy)]
pub struct Imaged<'a, const D: usize> {
    /// Positions of the particles, as filters use them.
    pub owners: &'a [Point<f64, D>],
    /// Positions of the images, numbered after the particles.
    pub images: &'a [Point<f64, D>],
    /// Radii of the particles and then of the images.
    pub radii: &'a Radii<'a, f64>,
    /// The largest radius of all particles.
    pub largest_radius: f64,
    /// Corners of the box around all particles and images, if they are known.
    pub corners: Option<Corners<D>>,
    /// How contacts are decided.
    pub decided: Decided<'a>,
}

/// How contacts of a periodic scene are decided.
#[derive(Clone, Copy)]
pub enum Decided<'a> {
    /// A test of the stored positions decides.
    Test(Test),
    /// A callback decides exactly from true positions, which stored positions only approximate.
    Asked(Asked<'a>),
}

impl<'a, const D: usize> Imaged<'a, D> {
    /// Returns a view of particles and images for detectors. Fails with [`Refusal::Overflow`] as
    /// [`with_particles`].
    pub fn particles(&self) -> Result<AnyParticles<'a, f64, D>, Refusal> {
        let (radii, largest) = (self.radii, self.largest_radius);
        let (envelope, rule) = match self.decided {
            Decided::Test(test) => (Envelope::of(largest, test)?, AnyRule::new(radii, test)),
            Decided::Asked(asked) => {
                let slack = asked.slack;
                let reach = slack.reach(largest, largest);
                let envelope = Envelope { reach, slack, margin: Margin::Safe };
                (envelope, AnyRule::Asked(asked, radii))
            }
        };
        let centres = Pieces { first: self.owners, rest: self.images };
        Ok(SceneParticles { corners: self.corners, ..envelope.with(centres, radii, rule) })
    }
}

struct Envelope {
    reach: f64,
    slack: Slack,
    margin: Margin,
}

impl Envelope {
    /// Creates the bounds of a test. Fails if the square of the diameter overflows `T` and the test
    /// is rounded.
    fn of<T: Real>(r: T, test: Test) -> Result<Envelope, Refusal> {
        let Some(margin) = test.margin() else { return Ok(Envelope::exact(r)) };
        let (sum, diameter) = (r + r, 2.0 * r.wide());
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

    fn exact<T: Real>(r: T) -> Envelope {
        Envelope { reach: 2.0 * r.wide(), slack: Slack::NONE, margin: Margin::Safe }
    }

    fn with<'a, T: Real, R, C: Centres<T, D>, const D: usize>(
        self,
        centres: C,
        radii: &'a Radii<'a, T>,
        rule: R,
    ) -> SceneParticles<'a, T, R, C, D> {
        let Envelope { reach, slack, margin } = self;
        SceneParticles { centres, radii, rule, reach, slack, margin, corners: None }
    }
}
