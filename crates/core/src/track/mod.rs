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

use crate::contact::Test;
use crate::periodic::Contacts;
use crate::probe::Tally;
use crate::refusal::Refusal;
use crate::scene::AnyScene;
pub use crate::searcher::Frame;
use crate::searcher::Searcher;

/// Finds the contacts of frames: scenes of the same particles, one after the other.
pub trait Tracker: Send {
    /// Appends the contacts of this frame, each once, in any order.
    ///
    /// Frames may be of any scene: where the number of particles or a radius is another than
    /// before, a list is built again. The box may be another in each frame, and particles may be
    /// named by any of their images; frames in boxes and in open space may follow each other. With
    /// a `tally` every operation is counted, which takes time.
    ///
    /// # Errors
    /// What the detector and [`Finder::list`](crate::periodic::Finder::list) refuse, and
    /// [`Refusal::Pairs`]; [`Refusal::Rounded`] from trackers that keep lists, which decide in
    /// exact arithmetic in a box. `contacts` is then as it was, and the next frame is taken as the
    /// first.
    fn find(
        &mut self,
        frame: Frame<'_>,
        tally: Option<&mut Tally>,
        contacts: &mut Contacts,
    ) -> Result<Step, Refusal>;

    /// As [`Tracker::find`], of a frame in open space.
    ///
    /// # Errors
    /// As [`Tracker::find`].
    fn step(
        &mut self,
        frame: &AnyScene<'_>,
        test: Test,
        tally: Option<&mut Tally>,
        pairs: &mut Vec<[u32; 2]>,
    ) -> Result<Step, Refusal> {
        let mut contacts = Contacts { plain: std::mem::take(pairs), shifted: Vec::new() };
        let step = self.find(Frame::Open(frame, test), tally, &mut contacts);
        *pairs = contacts.plain;
        step
    }

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

/// Calls its detector in every frame.
struct EveryStep(Searcher);

impl Tracker for EveryStep {
    fn find(
        &mut self,
        frame: Frame<'_>,
        tally: Option<&mut Tally>,
        contacts: &mut Contacts,
    ) -> Result<Step, Refusal> {
        let (started, before) = (Instant::now(), contacts.len());
        self.0.find(frame, tally, contacts)?;
        let listed = contacts.len() - before;
        Ok(Step { built: true, listed, dangerous: false, building: started.elapsed() })
    }

    fn forget(&mut self) {}

    fn formula_bytes(&self) -> u64 {
        self.0.formula_bytes()
    }
}
