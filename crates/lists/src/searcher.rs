//! Runs a detector on scenes in open space or in periodic boxes: the interface for bindings to
//! other languages.

use crate::periodic::Finder;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::detect::any::AnyDetector;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::pair_list::{Allowance, PairList};
use contactbench_ground::periodic::{ContactList, Loaded, Searchable};
use contactbench_ground::probe::Tally;

/// A detector, together with a finder for periodic boxes.
pub struct Searcher {
    detector: Box<dyn AnyDetector>,
    /// Finder that holds images, or `None` if the last scene was in open space.
    finder: Option<Finder>,
    /// Limit for each list of contacts, in bytes.
    memory_limit: u64,
}

impl Searcher {
    /// Creates a searcher with empty buffers. Each list of contacts may take the memory limit of
    /// the detector.
    pub fn new(detector: Box<dyn AnyDetector>) -> Searcher {
        Searcher { memory_limit: detector.memory_limit(), detector, finder: None }
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
        contacts: &mut ContactList,
    ) -> Result<(), Refusal> {
        contacts.clear();
        self.find(scene.frame(arithmetic), None, contacts)
    }

    /// Appends the contacts to the lists, and counts operations if `tally` is given. Fails as
    /// [`Searcher::list`]; the lists are then unchanged.
    pub fn find(
        &mut self,
        frame: Searchable<'_>,
        tally: Option<&mut Tally>,
        contacts: &mut ContactList,
    ) -> Result<(), Refusal> {
        let (limit, detector) = (self.memory_limit, &mut *self.detector);
        if let Searchable::Open(..) = frame {
            self.finder = None;
        }
        match (frame, tally) {
            (Searchable::Open(scene, test), None) => {
                detector.list(scene, test, &mut contacts.plain)
            }
            (Searchable::Open(scene, test), Some(tally)) => {
                let allowance = Allowance::new(limit);
                let mut list = PairList::behind(std::mem::take(&mut contacts.plain), &allowance);
                let counted = detector.count(scene, test, tally, &mut list);
                list.end(scene.len(), &mut contacts.plain).and(counted)
            }
            (Searchable::Boxed(frame, arithmetic), tally) => {
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
