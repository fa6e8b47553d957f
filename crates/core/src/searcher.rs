//! A detector at work on scenes with boundaries of either kind: what programs in other languages
//! are given.

use crate::contact::{Arithmetic, Test};
use crate::crowd;
use crate::detect::any::AnyDetector;
use crate::detect::spec::DetectorSpec;
use crate::detect::{Options, Refusal};
use crate::pair_list::{Allowance, PairList};
use crate::periodic::{Contacts, Finder, Periodic, PeriodicError};
use crate::probe::Tally;
use crate::scene::{AnyScene, Lattice, SceneError};

/// A scene as detectors get it.
#[derive(Debug)]
pub enum Loaded<'a> {
    /// As the arithmetic stores it.
    Open(AnyScene<'a>),
    /// As given.
    InBox(Periodic<'a>),
}

/// Why a scene cannot be searched.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LoadError {
    /// The arithmetic cannot store it.
    #[error(transparent)]
    Stored(#[from] SceneError),
    /// Its box does not suit it.
    #[error(transparent)]
    Boxed(#[from] PeriodicError),
}

/// A scene to search, and how its contacts are decided.
#[derive(Clone, Copy)]
pub enum Frame<'a> {
    /// In open space.
    Open(&'a AnyScene<'a>, Test),
    /// In a periodic box.
    Boxed(&'a Periodic<'a>, Arithmetic),
}

impl<'a> Frame<'a> {
    pub(crate) fn scene(&self) -> &'a AnyScene<'a> {
        match self {
            Frame::Open(scene, _) => scene,
            Frame::Boxed(periodic, _) => periodic.scene(),
        }
    }
}

impl<'a> Loaded<'a> {
    /// The scene in this arithmetic, in which it was loaded.
    pub fn frame(&'a self, arithmetic: Arithmetic) -> Frame<'a> {
        match self {
            Loaded::Open(scene) => Frame::Open(scene, arithmetic.test()),
            Loaded::InBox(scene) => Frame::Boxed(scene, arithmetic),
        }
    }

    /// How many particles there are.
    pub fn particles(&self) -> usize {
        self.scene().len()
    }

    /// Refuses a scene whose contacts are sure to take more than `limit` bytes: of particles as
    /// given. Those with images are foreseen when images are made.
    ///
    /// # Errors
    /// [`Refusal::Crowd`].
    pub fn within(&self, limit: u64) -> Result<(), Refusal> {
        crowd::within(self.scene(), limit)
    }

    fn scene(&self) -> &AnyScene<'a> {
        match self {
            Loaded::Open(scene) => scene,
            Loaded::InBox(periodic) => periodic.scene(),
        }
    }

    /// The scene as detectors get it in an arithmetic.
    ///
    /// # Errors
    /// What the arithmetic cannot store; a box that does not suit the scene.
    pub fn new(
        scene: &AnyScene<'a>,
        lattice: Option<Lattice>,
        arithmetic: Arithmetic,
    ) -> Result<Loaded<'a>, LoadError> {
        Ok(match lattice {
            Some(lattice) => Loaded::InBox(Periodic::new(scene.clone(), lattice)?),
            None => Loaded::Open(scene.as_stored(arithmetic)?.into_owned()),
        })
    }
}

/// A detector, and what finds its contacts in boxes.
pub struct Searcher {
    detector: Box<dyn AnyDetector>,
    /// Keeps the images if the last scene was in a box.
    finder: Option<Finder>,
    /// For a list of contacts, in bytes.
    memory_limit: u64,
}

impl Searcher {
    /// With empty buffers.
    pub fn new(spec: &DetectorSpec, options: Options) -> Searcher {
        let memory_limit = options.memory_limit;
        Searcher { detector: spec.make(options), finder: None, memory_limit }
    }

    /// What a list of contacts may take, in bytes.
    pub fn memory_limit(&self) -> u64 {
        self.memory_limit
    }

    /// How many contacts the last detection in a box has reported, also if it was refused.
    pub fn found_in_box(&self) -> u64 {
        self.finder.as_ref().map_or(0, Finder::found)
    }

    /// The detector, to be asked otherwise.
    pub fn detector_mut(&mut self) -> &mut dyn AnyDetector {
        &mut *self.detector
    }

    /// The detector.
    pub fn detector(&self) -> &dyn AnyDetector {
        &*self.detector
    }

    /// One detection, in the place of what is in the lists: what is timed.
    ///
    /// # Errors
    /// What the detector refuses; the lists are empty then, or hold what was reported before.
    pub fn list(
        &mut self,
        scene: &Loaded<'_>,
        arithmetic: Arithmetic,
        contacts: &mut Contacts,
    ) -> Result<(), Refusal> {
        contacts.clear();
        self.find(scene.frame(arithmetic), None, contacts)
    }

    /// As [`Searcher::list`], with every operation counted.
    ///
    /// # Errors
    /// As [`Searcher::list`].
    pub fn count(
        &mut self,
        scene: &Loaded<'_>,
        arithmetic: Arithmetic,
        contacts: &mut Contacts,
    ) -> Result<Tally, Refusal> {
        let mut tally = Tally::default();
        contacts.clear();
        self.find(scene.frame(arithmetic), Some(&mut tally), contacts)?;
        Ok(tally)
    }

    /// Appends the contacts to the lists; counts operations if there is a tally.
    ///
    /// # Errors
    /// As [`Searcher::list`]; the lists are then as they were.
    pub fn find(
        &mut self,
        frame: Frame<'_>,
        tally: Option<&mut Tally>,
        contacts: &mut Contacts,
    ) -> Result<(), Refusal> {
        let (limit, detector) = (self.memory_limit, &mut *self.detector);
        if let Frame::Open(..) = frame {
            self.finder = None;
        }
        match (frame, tally) {
            (Frame::Open(scene, test), None) => detector.list(scene, test, &mut contacts.plain),
            (Frame::Open(scene, test), Some(tally)) => {
                let allowance = Allowance::new(limit);
                let mut list = PairList::behind(std::mem::take(&mut contacts.plain), &allowance);
                let counted = detector.count(scene, test, tally, &mut list);
                list.end(scene.len(), &mut contacts.plain).and(counted)
            }
            (Frame::Boxed(frame, arithmetic), tally) => {
                let finder = self.finder.get_or_insert_with(|| Finder::new(limit));
                finder.find(frame, detector, arithmetic, tally, contacts)
            }
        }
    }

    /// The bytes that the memory formulas of the detector, and of images in a box, give for the
    /// last scene.
    pub fn formula_bytes(&self) -> u64 {
        self.detector.formula_bytes() + self.finder.as_ref().map_or(0, Finder::formula_bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detect::spec;
    use crate::scene::{Radii, Scene};

    /// The images that a box needed are not kept for a scene in open space.
    #[test]
    fn open_space_pays_nothing_for_the_box_before() {
        let scene = || -> AnyScene<'static> {
            let centres = [0.5, 4.0, 7.5].map(|x| nalgebra::Point::from([x, 1.0])).to_vec();
            Scene::new(centres, Radii::Uniform(0.5)).unwrap().into()
        };
        let lattice = Lattice::along_axes([8.0, 8.0, 1.0], [true, true, false]).unwrap();
        let boxed = Loaded::InBox(Periodic::new(scene(), lattice).unwrap());
        let open = Loaded::Open(scene());
        let bytes = |scenes: &[&Loaded<'_>]| {
            let mut searcher = Searcher::new(&spec::parse("nbs").unwrap(), Options::default());
            for scene in scenes {
                searcher.list(scene, Arithmetic::Exact, &mut Contacts::default()).unwrap();
            }
            searcher.formula_bytes()
        };
        assert!(bytes(&[&boxed]) > bytes(&[&open]));
        assert_eq!(bytes(&[&boxed, &open]), bytes(&[&open]));
    }
}
