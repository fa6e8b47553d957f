//! Trackers: which bodies touch, in frames that come one after the other?
//!
//! A simulation does not ask once. Bodies move a little, and it asks again; so codes keep a list of
//! all pairs that are nearly in touch, the *Verlet list* (Verlet 1967, doi:10.1103/PhysRev.159.98),
//! and look only at those until some body has moved too far. How long the list serves is decided by
//! a [`Rule`]; what is safe to leave out is proved on the page of filters ([`crate::filter`], 7,
//! and in periodic boxes 8).
//!
//! A tracker stands above any detector of the table. It gives, for each frame, what the detector
//! would give: the pairs that the contact test accepts in that frame, complete if its rule is safe,
//! so that answers can be held to the truth frame by frame.
//!
//! ```
//! use contactbench_core::contact::Test;
//! use contactbench_core::detect::Options;
//! use contactbench_core::scene::{AnyScene, Radii, Scene};
//! use contactbench_core::track::{self, Tracker};
//!
//! // Two discs that come nearer by a tenth of a diameter in each frame.
//! let frame = |k: f64| -> AnyScene<'_> {
//!     let centres = vec![[0.0, 0.0].into(), [1.25 - 0.1 * k, 0.0].into()];
//!     Scene::new(centres, Radii::Uniform(0.5)).unwrap().into()
//! };
//! let spec = track::parse("verlet(nbs,rule=top-two,skin=0.4)")?;
//! let mut tracker = spec.make(Options::default());
//! let (mut pairs, mut built) = (Vec::new(), 0);
//! for k in 0..4 {
//!     pairs.clear();
//!     built += tracker.step(&frame(f64::from(k)), Test::Exact, None, &mut pairs)?.built as u32;
//!     assert_eq!(pairs.len(), usize::from(k == 3));
//! }
//! assert_eq!(built, 1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod answer;
mod around;
#[cfg(test)]
mod box_tests;
mod cells;
mod kept;
mod pass;
mod places;
mod rule;
mod spec;
#[cfg(test)]
mod tests;
mod travel;
mod tuner;
mod verlet;

use std::time::{Duration, Instant};

pub use rule::Rule;
pub use spec::{FORMS, Skin, TrackerError, TrackerSpec, parse};
pub use travel::way;

use crate::contact::{Arithmetic, Test};
use crate::detect::any::AnyDetector;
use crate::pair_list::{Allowance, PairList};
use crate::periodic::{Contacts, Finder, Periodic};
use crate::probe::Tally;
use crate::refusal::Refusal;
use crate::scene::AnyScene;

/// Finds the contacts of frames: scenes of the same particles, one after the other.
pub trait Tracker: Send {
    /// The pairs of this frame, each once, appended to `pairs` in any order.
    ///
    /// Frames may be of any scene: where the number of particles or a radius is another than
    /// before, a list is built anew. With a `tally` every operation is counted, which takes time.
    ///
    /// # Errors
    /// What the detector refuses, and [`Refusal::Pairs`]; `pairs` is then as it was, and the next
    /// frame is taken as the first.
    fn step(
        &mut self,
        frame: &AnyScene<'_>,
        test: Test,
        tally: Option<&mut Tally>,
        pairs: &mut Vec<[u32; 2]>,
    ) -> Result<Step, Refusal>;

    /// As [`Tracker::step`], of a frame in a periodic box. The box may be another in each frame,
    /// and particles may be named by any of their images; frames in boxes and in open space may
    /// follow each other.
    ///
    /// # Errors
    /// As [`Tracker::step`]; what [`Finder::list`] refuses; [`Refusal::Rounded`] from trackers that
    /// keep lists, which decide in exact arithmetic.
    fn step_in_box(
        &mut self,
        frame: &Periodic<'_>,
        arithmetic: Arithmetic,
        tally: Option<&mut Tally>,
        contacts: &mut Contacts,
    ) -> Result<Step, Refusal>;

    /// The next frame is taken as the first; buffers stay.
    fn forget(&mut self);

    /// Bytes that the tracker and its detector need between frames, by formula; without the list of
    /// contacts, which is the caller's.
    fn formula_bytes(&self) -> u64;
}

/// What a tracker did for a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Step {
    /// Whether the tracker called its detector.
    pub built: bool,
    /// Pairs that it looked at, in touch or not.
    pub listed: u64,
    /// What LAMMPS calls a dangerous build: the rule was broken at the first frame at which it was
    /// looked at, so it may have been broken before.
    pub dangerous: bool,
    /// Time for building, of the whole time of the step.
    pub building: Duration,
}

/// Asks its detector in every frame.
struct EveryStep {
    detector: Box<dyn AnyDetector>,
    /// For the list of contacts, in bytes.
    limit: u64,
    /// Of images, once a frame is in a box.
    finder: Option<Finder>,
}

impl Tracker for EveryStep {
    fn step(
        &mut self,
        frame: &AnyScene<'_>,
        test: Test,
        tally: Option<&mut Tally>,
        pairs: &mut Vec<[u32; 2]>,
    ) -> Result<Step, Refusal> {
        self.finder = None;
        ask(&mut *self.detector, frame, test, self.limit, tally, pairs)
    }

    fn step_in_box(
        &mut self,
        frame: &Periodic<'_>,
        arithmetic: Arithmetic,
        tally: Option<&mut Tally>,
        contacts: &mut Contacts,
    ) -> Result<Step, Refusal> {
        let finder = self.finder.get_or_insert_with(|| Finder::new(self.limit));
        ask_in_box(finder, &mut *self.detector, frame, arithmetic, tally, contacts)
    }

    fn forget(&mut self) {}

    fn formula_bytes(&self) -> u64 {
        self.detector.formula_bytes() + self.finder.as_ref().map_or(0, Finder::formula_bytes)
    }
}

/// A step in which the detector is asked.
fn ask(
    detector: &mut dyn AnyDetector,
    frame: &AnyScene<'_>,
    test: Test,
    limit: u64,
    tally: Option<&mut Tally>,
    pairs: &mut Vec<[u32; 2]>,
) -> Result<Step, Refusal> {
    let (started, before) = (Instant::now(), pairs.len());
    list(detector, frame, test, limit, tally, pairs)?;
    let listed = (pairs.len() - before) as u64;
    Ok(Step { built: true, listed, dangerous: false, building: started.elapsed() })
}

/// A step in a box in which the detector is asked.
fn ask_in_box(
    finder: &mut Finder,
    detector: &mut dyn AnyDetector,
    frame: &Periodic<'_>,
    arithmetic: Arithmetic,
    tally: Option<&mut Tally>,
    contacts: &mut Contacts,
) -> Result<Step, Refusal> {
    let (started, before) = (Instant::now(), contacts.len());
    list_in_box(finder, detector, frame, arithmetic, tally, contacts)?;
    let listed = contacts.len() - before;
    Ok(Step { built: true, listed, dangerous: false, building: started.elapsed() })
}

/// Asks a detector for a list of at most so many bytes; counts if there is a tally.
fn list(
    detector: &mut dyn AnyDetector,
    scene: &AnyScene<'_>,
    test: Test,
    limit: u64,
    tally: Option<&mut Tally>,
    pairs: &mut Vec<[u32; 2]>,
) -> Result<(), Refusal> {
    let Some(tally) = tally else { return detector.list(scene, test, pairs) };
    let allowance = Allowance::new(limit);
    let mut list = PairList::behind(std::mem::take(pairs), &allowance);
    let counted = detector.count(scene, test, tally, &mut list);
    list.end(scene.len(), pairs).and(counted)
}

/// Asks a detector for the contacts in a box; counts if there is a tally.
fn list_in_box(
    finder: &mut Finder,
    detector: &mut dyn AnyDetector,
    frame: &Periodic<'_>,
    arithmetic: Arithmetic,
    tally: Option<&mut Tally>,
    contacts: &mut Contacts,
) -> Result<(), Refusal> {
    match tally {
        Some(tally) => finder.count(frame, detector, arithmetic, tally, contacts),
        None => finder.list(frame, detector, arithmetic, contacts),
    }
}
