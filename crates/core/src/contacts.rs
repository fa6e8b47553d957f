//! Finds contacts from plain slices of numbers: the entry point for most programs.

use std::borrow::Cow;

use contactbench_ground::contact::Test;
use contactbench_ground::detect::Options;
use contactbench_ground::detect::any::AnyDetector;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::normalise::smaller_first;
use contactbench_ground::scene::{AnyScene, Radii, Scene, SceneError, points};
use contactbench_streamed::streamed;

/// Errors of [`contacts`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// The centres and radii do not form a valid scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The detector refuses this scene.
    #[error(transparent)]
    Refused(#[from] Refusal),
}

/// Finds the pairs of discs (`D` = 2) or spheres (`D` = 3) that touch or overlap: |a - b| <= ra +
/// rb, decided exactly for the given numbers.
///
/// `radii` holds one radius per centre, in the same unit, or a single radius for all. A pair is two
/// indices into `centres`, the smaller first. Each pair is returned once; the order of pairs is not
/// specified. To call this repeatedly, as a simulation does, keep a [`Contacts`].
///
/// # Errors
/// Fails if a number is not finite or a radius is negative; if `radii` has neither one element nor
/// as many as `centres`; if there are more than 2^31 - 1 particles or 2^31 cells along an axis; or
/// if arrays or pairs need more than 4 GiB or a quarter of the machine's memory.
pub fn contacts<const D: usize>(centres: &[[f64; D]], radii: &[f64]) -> Result<Vec<[u32; 2]>, Error>
where
    for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
{
    let mut contacts = Contacts::default();
    contacts.find(centres, radii)?;
    Ok(contacts.pairs)
}

/// Finds contacts as [`contacts`] does, and keeps its buffers. Another call for a scene of about
/// the same size allocates next to nothing.
pub struct Contacts<const D: usize> {
    detector: Box<dyn AnyDetector>,
    pairs: Vec<[u32; 2]>,
}

impl<const D: usize> Contacts<D> {
    /// Creates a finder with a memory limit and a number of threads. Threads of rayon's global pool
    /// are used if there are 30,000 particles or more.
    pub fn new(options: Options) -> Contacts<D> {
        Contacts { detector: streamed(None, None, options), pairs: Vec::new() }
    }

    /// Returns the pairs that touch, as [`contacts`] does; they are valid until the next call.
    /// Fails as [`contacts`], with the memory limit of the options.
    pub fn find(&mut self, centres: &[[f64; D]], radii: &[f64]) -> Result<&[[u32; 2]], Error>
    where
        for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
    {
        let radii = match *radii {
            [radius] => Radii::Uniform(radius),
            _ => Radii::Each(Cow::Borrowed(radii)),
        };
        let scene = AnyScene::from(Scene::new(points(centres), radii)?);
        self.pairs.clear();
        self.detector.list(&scene, Test::Exact, &mut self.pairs)?;
        smaller_first(&mut self.pairs);
        Ok(&self.pairs)
    }
}

impl<const D: usize> Default for Contacts<D> {
    /// Uses one thread and at most 4 GiB, or a quarter of the machine's memory if that is less.
    fn default() -> Contacts<D> {
        Contacts::new(Options::default())
    }
}
