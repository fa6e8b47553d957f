//! Runs a detector on scenes in open space or in periodic boxes: the interface for bindings to
//! other languages.

use crate::contact::{Arithmetic, Test};
use crate::crowd;
use crate::detect::any::AnyDetector;
use crate::detect::spec::DetectorSpec;
use crate::detect::{Options, Refusal};
use crate::pair_list::{Allowance, PairList};
use crate::periodic::{Contacts, Finder, Periodic, PeriodicError};
use crate::probe::Tally;
use crate::scene::{AnyScene, Lattice, SceneError};

/// A scene that is prepared for an arithmetic.
#[derive(Debug)]
pub enum Loaded<'a> {
    /// A scene in open space, stored as the arithmetic requires.
    Open(AnyScene<'a>),
    /// A scene in a periodic box, stored as given.
    InBox(Periodic<'a>),
}

/// Why a scene cannot be prepared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LoadError {
    /// The arithmetic cannot store the scene.
    #[error(transparent)]
    Stored(#[from] SceneError),
    /// The box does not fit the scene.
    #[error(transparent)]
    Boxed(#[from] PeriodicError),
}

/// A scene that can be searched, with the contact test or arithmetic that decides its contacts.
#[derive(Clone, Copy)]
pub enum Frame<'a> {
    /// A scene in open space, with a contact test.
    Open(&'a AnyScene<'a>, Test),
    /// A scene in a periodic box, with an arithmetic.
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
    /// Returns the scene for a search; `arithmetic` must be the one for which it was prepared.
    pub fn frame(&'a self, arithmetic: Arithmetic) -> Frame<'a> {
        match self {
            Loaded::Open(scene) => Frame::Open(scene, arithmetic.test()),
            Loaded::InBox(scene) => Frame::Boxed(scene, arithmetic),
        }
    }

    /// Returns the number of particles.
    pub fn particles(&self) -> usize {
        self.scene().len()
    }

    /// Refuses a scene whose contacts without images will almost certainly take more than `limit`
    /// bytes. Contacts with images are estimated later, when the images are made. Fails with
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

    /// Prepares a scene for an arithmetic.
    ///
    /// # Errors
    /// Fails if the arithmetic cannot store the scene, or if the box does not fit the scene.
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

/// A detector, together with a finder for periodic boxes.
pub struct Searcher {
    detector: Box<dyn AnyDetector>,
    /// Finder that holds images, or `None` if the last scene was in open space.
    finder: Option<Finder>,
    /// Limit for each list of contacts, in bytes.
    memory_limit: u64,
}

impl Searcher {
    /// Creates a searcher with empty buffers.
    pub fn new(spec: &DetectorSpec, options: Options) -> Searcher {
        let memory_limit = options.memory_limit;
        Searcher { detector: spec.make(options), finder: None, memory_limit }
    }

    /// Returns the limit for each list of contacts, in bytes.
    pub fn memory_limit(&self) -> u64 {
        self.memory_limit
    }

    /// Returns the number of contacts that the last detection in a box found, even if it was
    /// refused.
    pub fn found_in_box(&self) -> u64 {
        self.finder.as_ref().map_or(0, Finder::found)
    }

    /// Returns the detector, for calls that need no list of contacts.
    pub fn detector_mut(&mut self) -> &mut dyn AnyDetector {
        &mut *self.detector
    }

    /// Returns the detector that searches the scenes.
    pub fn detector(&self) -> &dyn AnyDetector {
        &*self.detector
    }

    /// Runs one detection and replaces the contents of the lists. Benchmarks time this call.
    ///
    /// # Errors
    /// Returns the refusals of the detector; the lists are then empty or hold contacts found before
    /// the refusal.
    pub fn list(
        &mut self,
        scene: &Loaded<'_>,
        arithmetic: Arithmetic,
        contacts: &mut Contacts,
    ) -> Result<(), Refusal> {
        contacts.clear();
        self.find(scene.frame(arithmetic), None, contacts)
    }

    /// Runs one detection as [`Searcher::list`] does, and counts every operation.
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

    /// Appends the contacts to the lists, and counts operations if `tally` is given. Fails as
    /// [`Searcher::list`]; the lists are then unchanged.
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

    /// Returns the bytes of memory for the last scene according to formulas, for the detector and
    /// for images in a box.
    pub fn formula_bytes(&self) -> u64 {
        self.detector.formula_bytes() + self.finder.as_ref().map_or(0, Finder::formula_bytes)
    }
}
