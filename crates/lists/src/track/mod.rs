//! Trackers: contacts in consecutive frames of moving particles.
//!
//! In a simulation particles move a little between detections. Codes therefore keep a list of all
//! nearly touching pairs, the *Verlet list* (Verlet 1967, doi:10.1103/PhysRev.159.98), and test
//! only those pairs until some particle has moved too far. A [`Rule`] determines how long a list is
//! used. [`contactbench_ground::filter`] proves which rules are safe, in section 7 and for periodic
//! boxes in section 8.
//!
//! A tracker uses any detector of the table. For each frame it returns what the detector would: the
//! pairs that the contact test accepts. The result is complete if the rule is safe, and can be
//! compared with the truth in each frame. Steps of many particles take less time if the scene holds
//! them in spatial order, because their positions are then read one after the other.

mod answer;
mod around;
mod cells;
mod kept;
mod pass;
mod places;
mod radii;
mod rule;
mod travel;
mod tuner;
mod verlet;

use std::fmt;
use std::time::{Duration, Instant};

pub use rule::Rule;
pub use travel::distance_bound;
use verlet::Verlet;

use crate::searcher::Searcher;
use contactbench_ground::contact::Test;
use contactbench_ground::detect::any::AnyDetector;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::periodic::ContactList;
use contactbench_ground::periodic::Searchable;
use contactbench_ground::probe::Tally;
use contactbench_ground::scene::AnyScene;

/// Finds the contacts of frames: consecutive scenes of the same particles.
pub trait Tracker: Send {
    /// Appends the contacts of this frame, each once, in any order.
    ///
    /// Any scene may follow: if the number of particles or a radius changes, the list is rebuilt.
    /// The box may change in each frame, particles may be given by any of their images, and frames
    /// in boxes and in open space may alternate. If there is a `tally`, every operation is counted,
    /// which takes time.
    ///
    /// # Errors
    /// Returns the refusals of the detector and of [`Finder::list`](crate::periodic::Finder::list),
    /// and [`Refusal::Pairs`]. Trackers that keep lists return [`Refusal::Rounded`] in a box unless
    /// the arithmetic is exact. `contacts` is then unchanged, and the next frame counts as the
    /// first.
    fn find(
        &mut self,
        frame: Searchable<'_>,
        tally: Option<&mut Tally>,
        contacts: &mut ContactList,
    ) -> Result<Step, Refusal>;

    /// Appends the contacts of a frame in open space; otherwise works as [`Tracker::find`].
    fn step(
        &mut self,
        frame: &AnyScene<'_>,
        test: Test,
        tally: Option<&mut Tally>,
        pairs: &mut Vec<[u32; 2]>,
    ) -> Result<Step, Refusal> {
        let mut contacts = ContactList { plain: std::mem::take(pairs), shifted: Vec::new() };
        let step = self.find(Searchable::Open(frame, test), tally, &mut contacts);
        *pairs = contacts.plain;
        step
    }

    /// Makes the next frame count as the first. Buffers are kept.
    fn forget(&mut self);

    /// Returns the bytes that the tracker and its detector need between frames, computed by a
    /// formula. The caller's list of contacts is not included.
    fn formula_bytes(&self) -> u64;
}

/// Results of one step of a tracker, besides the contacts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Step {
    /// Whether the tracker called its detector in this frame.
    pub built: bool,
    /// Number of pairs tested in this frame, touching or not.
    pub listed: u64,
    /// Whether the build was dangerous in the sense of LAMMPS: the first check since the last build
    /// already required a rebuild, so contacts may have been missed before.
    pub dangerous: bool,
    /// Time spent on building the list, included in the time of the step.
    pub building: Duration,
}

/// Returns a tracker that calls the detector in every frame.
pub fn every_step(detector: Box<dyn AnyDetector>) -> Box<dyn Tracker> {
    Box::new(EveryStep(Searcher::new(detector)))
}

/// Returns a tracker that keeps a list of near pairs. Its lists may take the memory limit of the
/// detector, which may take as much again. Whether the detector is `fast` affects an automatic
/// skin.
pub fn verlet(
    detector: Box<dyn AnyDetector>,
    fast: bool,
    skin: Skin,
    rule: Rule,
) -> Box<dyn Tracker> {
    Box::new(Verlet::new(EveryStep(Searcher::new(detector)), fast, skin, rule))
}

/// Thickness of the skin of a list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Skin {
    /// Thickness in diameters of the largest particle.
    Diameters(f64),
    /// The tracker chooses the skin during the run to minimise the cost of steps. The same frames
    /// always yield the same skins.
    Auto,
}

impl fmt::Display for Skin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Skin::Diameters(skin) => skin.fmt(f),
            Skin::Auto => f.write_str("auto"),
        }
    }
}

struct EveryStep(Searcher);

impl Tracker for EveryStep {
    fn find(
        &mut self,
        frame: Searchable<'_>,
        tally: Option<&mut Tally>,
        contacts: &mut ContactList,
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
