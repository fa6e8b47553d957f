//! One object-safe face for all detectors: dynamic once per detection, static inside.

use std::borrow::Cow;

use super::{Declare, Detector, Options, Refusal};
use crate::contact::{Arithmetic, Bodies, CellF32, Real, Test, WithBodies, any_bodies, with_bodies};
use crate::probe::{Probe, Silent, Tally};
use crate::scene::{AnyScene, Scene};
use crate::sink::Sink;

/// A detector of any algorithm, for scenes of both dimensions and precisions.
///
/// The precision is the scene's: [`AnyScene::stored`] gives the one that an [`Arithmetic`] asks for. For the exact test a scene that is not in
/// f64 is converted first, which is without error.
pub trait AnyDetector: Send {
    /// The complete list of pairs, appended to `pairs`: what is timed.
    fn list(&mut self, scene: &AnyScene<'_>, test: Test, pairs: &mut Vec<[u32; 2]>) -> Result<(), Refusal>;

    /// Hands every contact to `sink`, on one thread.
    fn visit(&mut self, scene: &AnyScene<'_>, test: Test, sink: &mut dyn Sink) -> Result<(), Refusal>;

    /// Hands every contact to `sink` and counts every operation. The code is that of [`AnyDetector::list`], compiled once for all kinds of radii and tests.
    fn count(&mut self, scene: &AnyScene<'_>, test: Test, tally: &mut Tally, sink: &mut dyn Sink) -> Result<(), Refusal>;

    /// See [`Declare::formula_bytes`]; for the dimension of the last call.
    fn formula_bytes(&self) -> u64;
}

/// The two forms of one algorithm: for the plane and for space.
pub struct Both<A, B> {
    plane: A,
    space: B,
    last_was_space: bool,
}

impl<A, B> Both<A, B>
where
    A: Detector<f32, 2> + Detector<f64, 2> + Detector<CellF32, 2> + Declare + 'static,
    B: Detector<f32, 3> + Detector<f64, 3> + Detector<CellF32, 3> + Declare + 'static,
{
    /// A boxed detector with empty buffers.
    pub fn boxed(options: Options) -> Box<dyn AnyDetector> {
        Box::new(Both { plane: A::with(options), space: B::with(options), last_was_space: false })
    }

    /// Doubles for the exact test, so that it need not be compiled for the others.
    fn widened<'s, 'a>(&mut self, scene: &'s AnyScene<'a>, test: Test) -> Result<Cow<'s, AnyScene<'a>>, Refusal> {
        self.last_was_space = scene.dim() == 3;
        if test != Test::Exact || scene.is_f64() {
            return Ok(Cow::Borrowed(scene));
        }
        // No error can be: every storage is doubles without error.
        scene.stored(Arithmetic::F64).map(Cow::Owned).map_err(|_| Refusal::NotWide { precision: "another format" })
    }
}

impl<A, B> AnyDetector for Both<A, B>
where
    A: Detector<f32, 2> + Detector<f64, 2> + Detector<CellF32, 2> + Declare + 'static,
    B: Detector<f32, 3> + Detector<f64, 3> + Detector<CellF32, 3> + Declare + 'static,
{
    fn list(&mut self, scene: &AnyScene<'_>, test: Test, pairs: &mut Vec<[u32; 2]>) -> Result<(), Refusal> {
        match &*self.widened(scene, test)? {
            AnyScene::PlaneF32(scene) => run(&mut self.plane, scene, test, &mut Silent, pairs),
            AnyScene::PlaneF64(scene) => run(&mut self.plane, scene, test, &mut Silent, pairs),
            AnyScene::PlaneCell(scene) => run(&mut self.plane, scene, test, &mut Silent, pairs),
            AnyScene::SpaceF32(scene) => run(&mut self.space, scene, test, &mut Silent, pairs),
            AnyScene::SpaceF64(scene) => run(&mut self.space, scene, test, &mut Silent, pairs),
            AnyScene::SpaceCell(scene) => run(&mut self.space, scene, test, &mut Silent, pairs),
        }
    }

    /// Counts all the same, so that a third form of every detector need not be compiled.
    fn visit(&mut self, scene: &AnyScene<'_>, test: Test, sink: &mut dyn Sink) -> Result<(), Refusal> {
        self.count(scene, test, &mut Tally::default(), sink)
    }

    fn count(&mut self, scene: &AnyScene<'_>, test: Test, tally: &mut Tally, mut sink: &mut dyn Sink) -> Result<(), Refusal> {
        let sink = &mut sink;
        match &*self.widened(scene, test)? {
            AnyScene::PlaneF32(scene) => self.plane.detect(any_bodies(scene, test)?, tally, sink),
            AnyScene::PlaneF64(scene) => self.plane.detect(any_bodies(scene, test)?, tally, sink),
            AnyScene::PlaneCell(scene) => self.plane.detect(any_bodies(scene, test)?, tally, sink),
            AnyScene::SpaceF32(scene) => self.space.detect(any_bodies(scene, test)?, tally, sink),
            AnyScene::SpaceF64(scene) => self.space.detect(any_bodies(scene, test)?, tally, sink),
            AnyScene::SpaceCell(scene) => self.space.detect(any_bodies(scene, test)?, tally, sink),
        }
    }

    fn formula_bytes(&self) -> u64 {
        if self.last_was_space { self.space.formula_bytes() } else { self.plane.formula_bytes() }
    }
}

/// Runs a detector on a scene: the entry for library users who hold a concrete detector.
///
/// A rounded test is rounded in `T`.
pub fn run<T: Real, const D: usize>(
    detector: &mut impl Detector<T, D>,
    scene: &Scene<'_, T, D>,
    test: Test,
    probe: &mut impl Probe,
    sink: &mut impl Sink,
) -> Result<(), Refusal> {
    with_bodies(scene, test, Run { detector, probe, sink })
}

struct Run<'a, X, P, S> {
    detector: &'a mut X,
    probe: &'a mut P,
    sink: &'a mut S,
}

impl<T: Real, const D: usize, X: Detector<T, D>, P: Probe, S: Sink> WithBodies<T, D> for Run<'_, X, P, S> {
    type Output = Result<(), Refusal>;
    fn call<B: Bodies<T, D>>(self, bodies: B) -> Self::Output {
        self.detector.detect(bodies, self.probe, self.sink)
    }
}
