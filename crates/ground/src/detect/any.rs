//! A common interface for all detectors: dynamic dispatch once per detection, static dispatch
//! inside.

use std::collections::BTreeMap;

use super::{Declare, Detector, Options};
use crate::contact::{
    Imaged, Particles, StoredParticles, Test, WithParticles, any_particles, with_particles,
    with_stored,
};
use crate::limits::refusal::Refusal;
use crate::pairs::pair_list::{Allowance, PairList};
use crate::pairs::sink::Sink;
use crate::probe::{Probe, Silent, Tally};
use crate::scene::{AnyScene, Real, Scene, Stored};

/// A detector of any algorithm, for scenes of both dimensions and all storages.
///
/// The storage of a scene sets the precision of the search; [`AnyScene::stored`] converts a scene
/// to the storage of an [`Arithmetic`](crate::contact::Arithmetic). The exact test first widens
/// other storages to f64, without rounding.
pub trait AnyDetector: Send {
    /// Finds the contacts of `searched`. Fails with the refusals of the detector.
    fn search(&mut self, searched: &Searched<'_>, task: Task<'_, '_>) -> Result<(), Refusal>;

    /// Returns the limit for a list of pairs, in bytes.
    fn memory_limit(&self) -> u64;

    /// Returns the bytes that the memory formula gives for the scene of the last call; 0 for
    /// detectors without a formula.
    fn formula_bytes(&self) -> u64;

    /// Appends all pairs to `pairs`. This is the operation that is timed. The list may grow to the
    /// memory limit of the detector's options. Fails with the refusals of the detector and
    /// [`Refusal::Pairs`]; `pairs` is then unchanged.
    fn list(
        &mut self,
        scene: &AnyScene<'_>,
        test: Test,
        pairs: &mut Vec<[u32; 2]>,
    ) -> Result<(), Refusal> {
        let allowance = Allowance::new(self.memory_limit());
        let mut found = PairList::behind(std::mem::take(pairs), &allowance);
        let result = self.search(&Searched::scene(scene, test), Task::List(&mut found));
        let listed = found.end(scene.len(), pairs);
        result.and(listed)
    }

    /// Calls `sink` for every contact, on one thread. It counts operations, too: a form without
    /// counters would have to be compiled separately for every detector. Fails as
    /// [`AnyDetector::list`].
    fn visit(
        &mut self,
        scene: &AnyScene<'_>,
        test: Test,
        sink: &mut dyn Sink,
    ) -> Result<(), Refusal> {
        self.count(scene, test, &mut Tally::default(), sink)
    }

    /// Calls `sink` for every contact and counts every operation. The code is that of
    /// [`AnyDetector::list`], compiled once for all storages, radii and tests. Fails as
    /// [`AnyDetector::list`].
    fn count(
        &mut self,
        scene: &AnyScene<'_>,
        test: Test,
        tally: &mut Tally,
        sink: &mut dyn Sink,
    ) -> Result<(), Refusal> {
        self.search(&Searched::scene(scene, test), Task::Count(tally, sink))
    }
}

/// The result that a detector should return.
pub enum Task<'a, 'p> {
    /// A list of pairs, without counters. This task is the one that is timed.
    List(&'a mut PairList<'p>),
    /// Every contact, with all operations counted.
    Count(&'a mut Tally, &'a mut dyn Sink),
}

/// The particles to search, in two or three dimensions.
pub enum Searched<'a> {
    /// Discs, in two dimensions.
    Plane(Of<'a, 2>),
    /// Spheres, in three dimensions.
    Space(Of<'a, 3>),
}

/// The particles to search, in `D` dimensions.
pub enum Of<'a, const D: usize> {
    /// A scene in open space and its contact test.
    Scene(&'a Stored<'a, D>, Test),
    /// Particles of a periodic scene and images of them, in f64 (`contactbench_lists::periodic`).
    Images(Imaged<'a, D>),
}

impl<'a> Searched<'a> {
    /// Returns a scene in open space as particles to search.
    pub fn scene(scene: &'a AnyScene<'a>, test: Test) -> Searched<'a> {
        match scene {
            AnyScene::Plane(scene) => Searched::Plane(Of::Scene(scene, test)),
            AnyScene::Space(scene) => Searched::Space(Of::Scene(scene, test)),
        }
    }
}

impl<'a> From<Of<'a, 2>> for Searched<'a> {
    fn from(of: Of<'a, 2>) -> Self {
        Searched::Plane(of)
    }
}

impl<'a> From<Of<'a, 3>> for Searched<'a> {
    fn from(of: Of<'a, 3>) -> Self {
        Searched::Space(of)
    }
}

/// Values of a detector's parameters by name; parameters at their defaults are absent.
pub type Params = BTreeMap<String, String>;

/// The two forms of a detector, for two and for three dimensions.
pub struct Both<A, B> {
    plane: A,
    space: B,
    last_was_space: bool,
    memory_limit: u64,
}

impl<A, B> Both<A, B>
where
    A: DetectorOfAll<2> + Declare + 'static,
    B: DetectorOfAll<3> + Declare + 'static,
{
    /// Creates a detector without parameters and with empty buffers.
    pub fn boxed(_: &Params, options: Options) -> Box<dyn AnyDetector> {
        Both::join(A::with(options), B::with(options), options)
    }

    /// Joins the 2D and the 3D form of a detector, both made with `options`.
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
    fn search(&mut self, searched: &Searched<'_>, task: Task<'_, '_>) -> Result<(), Refusal> {
        self.last_was_space = matches!(searched, Searched::Space(_));
        match searched {
            Searched::Plane(of) => search(&mut self.plane, of, task),
            Searched::Space(of) => search(&mut self.space, of, task),
        }
    }

    fn memory_limit(&self) -> u64 {
        self.memory_limit
    }

    fn formula_bytes(&self) -> u64 {
        if self.last_was_space { self.space.formula_bytes() } else { self.plane.formula_bytes() }
    }
}

fn search<const D: usize, X: DetectorOfAll<D> + Declare>(
    detector: &mut X,
    of: &Of<'_, D>,
    task: Task<'_, '_>,
) -> Result<(), Refusal> {
    match (of, task) {
        (Of::Scene(Stored::F64(scene), test), Task::List(pairs)) if X::DECIDES_FROM_COPIES => {
            detector.detect(any_particles(scene, *test)?, &mut Silent, pairs)
        }
        (Of::Scene(scene, test), Task::List(pairs)) if X::DECIDES_FROM_COPIES => {
            detector.detect(StoredParticles::<D, true>::new(scene, *test)?, &mut Silent, pairs)
        }
        (Of::Scene(scene, test), Task::List(pairs)) => {
            run_stored(detector, scene, *test, &mut Silent, pairs)
        }
        (Of::Scene(scene, test), Task::Count(tally, mut sink)) => {
            detector.detect(StoredParticles::<D, false>::new(scene, *test)?, tally, &mut sink)
        }
        (Of::Images(images), Task::List(pairs)) => {
            detector.detect(images.particles()?, &mut Silent, pairs)
        }
        (Of::Images(images), Task::Count(tally, mut sink)) => {
            detector.detect(StoredParticles::<D, false>::F64(images.particles()?), tally, &mut sink)
        }
    }
}

/// A detector that cannot run on this machine and refuses every scene with the given reason.
pub struct Refuses(pub Refusal);

impl AnyDetector for Refuses {
    fn search(&mut self, _: &Searched<'_>, _: Task<'_, '_>) -> Result<(), Refusal> {
        Err(self.0.clone())
    }

    fn memory_limit(&self) -> u64 {
        u64::MAX
    }

    fn formula_bytes(&self) -> u64 {
        0
    }
}

/// A detector that accepts scenes in every storage.
pub trait DetectorOfAll<const D: usize>: Detector<f32, D> + Detector<f64, D> {}

impl<X, const D: usize> DetectorOfAll<D> for X where X: Detector<f32, D> + Detector<f64, D> {}

/// Runs a concrete detector on a scene in f64. Fails with the refusals of the detector and of
/// [`with_particles`].
pub fn run<const D: usize>(
    detector: &mut impl Detector<f64, D>,
    scene: &Scene<'_, f64, D>,
    test: Test,
    probe: &mut impl Probe,
    sink: &mut impl Sink,
) -> Result<(), Refusal> {
    with_particles(scene, test, Run { detector, probe, sink })
}

/// Runs a concrete detector on a scene in any storage; rounded tests round to the precision of that
/// storage. Fails as [`run`].
pub fn run_stored<const D: usize>(
    detector: &mut impl DetectorOfAll<D>,
    scene: &Stored<'_, D>,
    test: Test,
    probe: &mut impl Probe,
    sink: &mut impl Sink,
) -> Result<(), Refusal> {
    with_stored(scene, test, Run { detector, probe, sink })
}

struct Run<'a, X, P, S> {
    detector: &'a mut X,
    probe: &'a mut P,
    sink: &'a mut S,
}

impl<T: Real, const D: usize, X: Detector<T, D>, P: Probe, S: Sink> WithParticles<T, D>
    for Run<'_, X, P, S>
{
    type Output = Result<(), Refusal>;
    fn call<B: Particles<T, D>>(self, particles: B) -> Self::Output {
        self.detector.detect(particles, self.probe, self.sink)
    }
}
