//! One object-safe face for all detectors: dynamic once per detection, static inside.

use super::table::Params;
use super::{Declare, Detector, Options, Refusal};
use crate::contact::{Bodies, Imaged, Test, WithBodies, any_bodies, with_bodies, with_stored};
use crate::pair_list::{Allowance, PairList};
use crate::probe::{Probe, Silent, Tally};
use crate::scene::{AnyScene, CellF32, Real, Scene, Stored};
use crate::sink::Sink;
use crate::with_stored;

/// A detector of any algorithm, for scenes of both dimensions and precisions.
///
/// The precision is the scene's: [`AnyScene::stored`] gives the one that an
/// [`Arithmetic`](crate::contact::Arithmetic) asks for. For the exact test a scene in another
/// storage is widened to f64 first, which is exact.
pub trait AnyDetector: Send {
    /// The complete list of pairs, appended to `pairs`: what is timed. The list may grow to the
    /// memory limit of the detector's options.
    ///
    /// # Errors
    /// What the detector refuses, and [`Refusal::Pairs`]; `pairs` is then as it was.
    fn list(
        &mut self,
        scene: &AnyScene<'_>,
        test: Test,
        pairs: &mut Vec<[u32; 2]>,
    ) -> Result<(), Refusal>;

    /// Hands every contact to `sink`, on one thread.
    ///
    /// # Errors
    /// As [`AnyDetector::list`].
    fn visit(
        &mut self,
        scene: &AnyScene<'_>,
        test: Test,
        sink: &mut dyn Sink,
    ) -> Result<(), Refusal>;

    /// Hands every contact to `sink` and counts every operation. The code is that of
    /// [`AnyDetector::list`], compiled once for all kinds of radii and tests.
    ///
    /// # Errors
    /// As [`AnyDetector::list`].
    fn count(
        &mut self,
        scene: &AnyScene<'_>,
        test: Test,
        tally: &mut Tally,
        sink: &mut dyn Sink,
    ) -> Result<(), Refusal>;

    /// As [`AnyDetector::list`], for particles and images of them. Pairs go to `sink`, from this
    /// thread.
    ///
    /// # Errors
    /// What the detector refuses.
    fn list_images(
        &mut self,
        bodies: &Searched<'_>,
        sink: &mut (dyn Sink + Send),
    ) -> Result<(), Refusal>;

    /// As [`AnyDetector::count`], for particles and images of them.
    ///
    /// # Errors
    /// What the detector refuses.
    fn count_images(
        &mut self,
        bodies: &Searched<'_>,
        tally: &mut Tally,
        sink: &mut dyn Sink,
    ) -> Result<(), Refusal>;

    /// The bytes that the memory formula gives for the scene of the last call; 0 for detectors
    /// that declare none.
    fn formula_bytes(&self) -> u64;
}

/// What is searched of a periodic scene ([`crate::periodic`]).
pub enum Searched<'a> {
    /// Discs and their images, in f64.
    Plane(Imaged<'a, 2>),
    /// Spheres and their images, in f64.
    Space(Imaged<'a, 3>),
    /// Both in another storage, and how contacts are decided there.
    Stored(AnyScene<'a>, Test),
}

impl<'a> From<Imaged<'a, 2>> for Searched<'a> {
    fn from(bodies: Imaged<'a, 2>) -> Self {
        Searched::Plane(bodies)
    }
}

impl<'a> From<Imaged<'a, 3>> for Searched<'a> {
    fn from(bodies: Imaged<'a, 3>) -> Self {
        Searched::Space(bodies)
    }
}

/// The two forms of one algorithm: for the plane and for space.
pub struct Both<A, B> {
    plane: A,
    space: B,
    last_was_space: bool,
    /// For the list of pairs, in bytes.
    memory_limit: u64,
}

impl<A, B> Both<A, B>
where
    A: DetectorOfAll<2> + Declare + 'static,
    B: DetectorOfAll<3> + Declare + 'static,
{
    /// A detector with empty buffers that has no parameters.
    pub fn boxed(_: &Params, options: Options) -> Box<dyn AnyDetector> {
        Both::join(A::with(options), B::with(options), options)
    }

    /// The two as one, made with these options.
    pub fn join(plane: A, space: B, options: Options) -> Box<dyn AnyDetector> {
        let memory_limit = options.memory_limit;
        Box::new(Both { plane, space, last_was_space: false, memory_limit })
    }
}

impl<A, B> AnyDetector for Both<A, B>
where
    A: DetectorOfAll<2> + Declare + 'static,
    B: DetectorOfAll<3> + Declare + 'static,
{
    fn list(
        &mut self,
        scene: &AnyScene<'_>,
        test: Test,
        pairs: &mut Vec<[u32; 2]>,
    ) -> Result<(), Refusal> {
        self.last_was_space = scene.dim() == 3;
        let allowance = Allowance::new(self.memory_limit);
        let mut found = PairList::behind(std::mem::take(pairs), &allowance);
        let result = match scene {
            AnyScene::Plane(scene) => list(&mut self.plane, scene, test, &mut Silent, &mut found),
            AnyScene::Space(scene) => list(&mut self.space, scene, test, &mut Silent, &mut found),
        };
        let listed = found.end(scene.len(), pairs);
        result.and(listed)
    }

    /// Counts all the same, so that a third form of every detector need not be compiled.
    fn visit(
        &mut self,
        scene: &AnyScene<'_>,
        test: Test,
        sink: &mut dyn Sink,
    ) -> Result<(), Refusal> {
        self.count(scene, test, &mut Tally::default(), sink)
    }

    fn count(
        &mut self,
        scene: &AnyScene<'_>,
        test: Test,
        tally: &mut Tally,
        mut sink: &mut dyn Sink,
    ) -> Result<(), Refusal> {
        self.last_was_space = scene.dim() == 3;
        match scene {
            AnyScene::Plane(scene) => run_any(&mut self.plane, scene, test, tally, &mut sink),
            AnyScene::Space(scene) => run_any(&mut self.space, scene, test, tally, &mut sink),
        }
    }

    fn list_images(
        &mut self,
        bodies: &Searched<'_>,
        sink: &mut (dyn Sink + Send),
    ) -> Result<(), Refusal> {
        // All goes on to the sink.
        let allowance = Allowance::new(0);
        let mut found = PairList::door(sink, &allowance);
        match bodies {
            Searched::Plane(bodies) => {
                self.last_was_space = false;
                self.plane.detect(bodies.bodies()?, &mut Silent, &mut found)
            }
            Searched::Space(bodies) => {
                self.last_was_space = true;
                self.space.detect(bodies.bodies()?, &mut Silent, &mut found)
            }
            Searched::Stored(AnyScene::Plane(scene), test) => {
                self.last_was_space = false;
                list(&mut self.plane, scene, *test, &mut Silent, &mut found)
            }
            Searched::Stored(AnyScene::Space(scene), test) => {
                self.last_was_space = true;
                list(&mut self.space, scene, *test, &mut Silent, &mut found)
            }
        }
    }

    fn count_images(
        &mut self,
        bodies: &Searched<'_>,
        tally: &mut Tally,
        mut sink: &mut dyn Sink,
    ) -> Result<(), Refusal> {
        match bodies {
            Searched::Plane(bodies) => {
                self.last_was_space = false;
                self.plane.detect(bodies.bodies()?, tally, &mut sink)
            }
            Searched::Space(bodies) => {
                self.last_was_space = true;
                self.space.detect(bodies.bodies()?, tally, &mut sink)
            }
            Searched::Stored(scene, test) => self.count(scene, *test, tally, sink),
        }
    }

    fn formula_bytes(&self) -> u64 {
        if self.last_was_space { self.space.formula_bytes() } else { self.plane.formula_bytes() }
    }
}

/// A detector that cannot run on this machine: it refuses every scene, for this reason.
pub struct Refuses(pub Refusal);

impl AnyDetector for Refuses {
    fn list(&mut self, _: &AnyScene<'_>, _: Test, _: &mut Vec<[u32; 2]>) -> Result<(), Refusal> {
        Err(self.0.clone())
    }

    fn visit(&mut self, _: &AnyScene<'_>, _: Test, _: &mut dyn Sink) -> Result<(), Refusal> {
        Err(self.0.clone())
    }

    fn count(
        &mut self,
        _: &AnyScene<'_>,
        _: Test,
        _: &mut Tally,
        _: &mut dyn Sink,
    ) -> Result<(), Refusal> {
        Err(self.0.clone())
    }

    fn list_images(&mut self, _: &Searched<'_>, _: &mut (dyn Sink + Send)) -> Result<(), Refusal> {
        Err(self.0.clone())
    }

    fn count_images(
        &mut self,
        _: &Searched<'_>,
        _: &mut Tally,
        _: &mut dyn Sink,
    ) -> Result<(), Refusal> {
        Err(self.0.clone())
    }

    fn formula_bytes(&self) -> u64 {
        0
    }
}

/// A detector of scenes in every storage.
pub trait DetectorOfAll<const D: usize>:
    Detector<f32, D> + Detector<f64, D> + Detector<CellF32, D>
{
}

impl<X, const D: usize> DetectorOfAll<D> for X where
    X: Detector<f32, D> + Detector<f64, D> + Detector<CellF32, D>
{
}

/// Runs a detector on a scene in f64: the entry for users of the library who hold a concrete
/// detector.
///
/// # Errors
/// What the detector refuses; see also [`with_bodies`].
pub fn run<const D: usize>(
    detector: &mut impl Detector<f64, D>,
    scene: &Scene<'_, f64, D>,
    test: Test,
    probe: &mut impl Probe,
    sink: &mut impl Sink,
) -> Result<(), Refusal> {
    with_bodies(scene, test, Run { detector, probe, sink })
}

/// As [`run`], for a scene in any storage, in which rounded tests are rounded.
///
/// # Errors
/// See [`run`].
pub fn run_stored<const D: usize>(
    detector: &mut impl DetectorOfAll<D>,
    scene: &Stored<'_, D>,
    test: Test,
    probe: &mut impl Probe,
    sink: &mut impl Sink,
) -> Result<(), Refusal> {
    with_stored(scene, test, Run { detector, probe, sink })
}

/// As [`run_stored`], compiled once for all kinds of radii and tests.
pub(crate) fn run_any<const D: usize>(
    detector: &mut impl DetectorOfAll<D>,
    scene: &Stored<'_, D>,
    test: Test,
    probe: &mut impl Probe,
    sink: &mut impl Sink,
) -> Result<(), Refusal> {
    if test == Test::Exact {
        return detector.detect(any_bodies(&*scene.widened(), test)?, probe, sink);
    }
    with_stored!(scene, scene => detector.detect(any_bodies(scene, test)?, probe, sink))
}

/// The list of pairs, compiled for every kind of radii and test where speed depends on it.
pub(crate) fn list<const D: usize, X: DetectorOfAll<D> + Declare>(
    detector: &mut X,
    scene: &Stored<'_, D>,
    test: Test,
    probe: &mut impl Probe,
    pairs: &mut PairList<'_>,
) -> Result<(), Refusal> {
    if X::DECIDES_FROM_COPIES {
        run_any(detector, scene, test, probe, pairs)
    } else {
        run_stored(detector, scene, test, probe, pairs)
    }
}

struct Run<'a, X, P, S> {
    detector: &'a mut X,
    probe: &'a mut P,
    sink: &'a mut S,
}

impl<T: Real, const D: usize, X: Detector<T, D>, P: Probe, S: Sink> WithBodies<T, D>
    for Run<'_, X, P, S>
{
    type Output = Result<(), Refusal>;
    fn call<B: Bodies<T, D>>(self, bodies: B) -> Self::Output {
        self.detector.detect(bodies, self.probe, self.sink)
    }
}
