//! Contacts of plain slices of numbers: the entry point for most programs.

use std::borrow::Cow;

use crate::contact::Test;
use crate::detect::any::AnyDetector;
use crate::detect::{Options, table};
use crate::refusal::Refusal;
use crate::scene::{AnyScene, Radii, Scene, SceneError, points};
use crate::sink::smaller_first;

/// Why [`contacts`] failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// The centres and radii do not form a valid scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The detector cannot search this scene.
    #[error(transparent)]
    Refused(#[from] Refusal),
}

/// Finds the pairs of discs (`D` = 2) or spheres (`D` = 3) that touch or overlap: |a - b| <= ra +
/// rb, decided exactly for the given numbers.
///
/// `radii` holds one radius per centre, in the same unit, or a single radius for all. A pair is two
/// positions in `centres`, the smaller first. Each pair is returned once; the order of pairs is not
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

/// Finds contacts as [`contacts`] does and keeps its buffers. A call for a scene of about the same
/// size as before allocates next to nothing.
pub struct Contacts<const D: usize> {
    detector: Box<dyn AnyDetector>,
    pairs: Vec<[u32; 2]>,
}

impl<const D: usize> Contacts<D> {
    /// Creates a finder with a memory limit and a number of threads. Threads of rayon's global pool
    /// are used from 30,000 particles on.
    pub fn new(options: Options) -> Contacts<D> {
        Contacts { detector: table::fast(options), pairs: Vec::new() }
    }

    /// Returns the touching pairs as [`contacts`] does; they are valid until the next call. Fails
    /// as [`contacts`], with the memory limit of the options.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_radius_holds_for_all_and_buffers_are_cleared() {
        let mut plane = Contacts::<2>::default();
        let row: Vec<[f64; 2]> = (0..5).map(|k| [f64::from(k), 0.0]).collect();
        let mut expected: Vec<[u32; 2]> = (0..4).map(|k| [k, k + 1]).collect();
        let sorted = |pairs: &[[u32; 2]]| {
            let mut pairs = pairs.to_vec();
            pairs.sort_unstable();
            pairs
        };
        assert_eq!(sorted(plane.find(&row, &[0.5]).unwrap()), expected);
        assert_eq!(sorted(plane.find(&row, &[0.5; 5]).unwrap()), expected);
        expected.truncate(1);
        assert_eq!(sorted(plane.find(&row[..2], &[0.25, 0.75]).unwrap()), expected);
        assert!(plane.find(&[], &[]).unwrap().is_empty());
        let space = contacts(&[[0.0, 0.0, 0.0], [2.0, 3.0, 6.0], [9.0, 9.0, 9.0]], &[3.5]);
        assert_eq!(space.unwrap(), [[0, 1]]);
    }

    #[test]
    fn invalid_scenes_are_errors() {
        let scene = |centres: &[[f64; 2]], radii: &[f64]| contacts(centres, radii).unwrap_err();
        let two = [[0.0, 0.0], [1.0, f64::NAN]];
        assert!(matches!(scene(&two, &[1.0]), Error::Scene(SceneError::Coordinate { .. })));
        assert!(matches!(
            scene(&two[..1], &[-1.0]),
            Error::Scene(SceneError::UniformRadius { .. })
        ));
        assert!(matches!(scene(&two[..1], &[1.0, 1.0]), Error::Scene(SceneError::Lengths { .. })));
    }
}
