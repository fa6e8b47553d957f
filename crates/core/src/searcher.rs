//! A detector at work on scenes with boundaries of either kind: what programs in other languages
//! are given.

use crate::contact::Arithmetic;
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

impl<'a> Loaded<'a> {
    /// How many particles there are.
    pub fn particles(&self) -> usize {
        match self {
            Loaded::Open(scene) => scene.len(),
            Loaded::InBox(periodic) => periodic.scene().len(),
        }
    }

    /// Refuses a scene whose contacts are sure to take more than `limit` bytes: of particles as
    /// given. Those with images are foreseen when images are made.
    ///
    /// # Errors
    /// [`Refusal::Crowd`].
    pub fn within(&self, limit: u64) -> Result<(), Refusal> {
        crowd::within(
            match self {
                Loaded::Open(scene) => scene,
                Loaded::InBox(periodic) => periodic.scene(),
            },
            limit,
        )
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
    finder: Finder,
    /// For a list of contacts, in bytes.
    memory_limit: u64,
}

impl Searcher {
    /// With empty buffers.
    pub fn new(spec: &DetectorSpec, options: Options) -> Searcher {
        let memory_limit = options.memory_limit;
        Searcher { detector: spec.make(options), finder: Finder::new(memory_limit), memory_limit }
    }

    /// What a list of contacts may take, in bytes.
    pub fn memory_limit(&self) -> u64 {
        self.memory_limit
    }

    /// How many contacts the last detection in a box has reported, also if it was refused.
    pub fn found_in_box(&self) -> u64 {
        self.finder.found()
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
        match scene {
            Loaded::Open(scene) => {
                self.detector.list(scene, arithmetic.test(), &mut contacts.plain)
            }
            Loaded::InBox(scene) => {
                self.finder.list(scene, &mut *self.detector, arithmetic, contacts)
            }
        }
    }

    /// The same, counted.
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
        match scene {
            Loaded::Open(scene) => {
                let allowance = Allowance::new(self.memory_limit);
                let pairs = std::mem::take(&mut contacts.plain);
                let mut list = PairList::behind(pairs, &allowance);
                let counted = self.detector.count(scene, arithmetic.test(), &mut tally, &mut list);
                list.end(scene.len(), &mut contacts.plain).and(counted)?;
            }
            Loaded::InBox(scene) => {
                self.finder.count(scene, &mut *self.detector, arithmetic, &mut tally, contacts)?;
            }
        }
        Ok(tally)
    }

    /// The bytes of the last detection by the formulas of detector and images.
    pub fn formula_bytes(&self, scene: &Loaded<'_>) -> u64 {
        let images = match scene {
            Loaded::Open(_) => 0,
            Loaded::InBox(_) => self.finder.formula_bytes(),
        };
        self.detector.formula_bytes() + images
    }
}
