//! One row of the record: one measurement. The record is a wall: left of it nothing knows about
//! figures, right of it nothing runs a detector.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

pub use crate::record::file::{FILE, Record, SCHEMA, WriteError, Writer, exists, read, unpacked};
use crate::record::id::CellId;
pub use crate::record::outcome::{Outcome, Pass};
use crate::record::role::Role;
use crate::stats::interval::Block;
use contactbench_terms::errors::{Causes, Errors};
use contactbench_terms::moved::Moved;
use contactbench_terms::scene::Stats;

/// One measurement.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// What was measured, on what, with what.
    #[serde(flatten)]
    pub id: CellId,
    /// What the detector is there for.
    pub role: Role,
    /// What was measured.
    pub pass: Pass,
    /// Number of the paired block; 0 for counts and memory, and for copies that did not start.
    pub block: u32,
    /// Nanoseconds per detection, from raw coordinates to the complete list of pairs; of several
    /// copies the harmonic mean.
    pub time_ns: Option<u64>,
    /// Nanoseconds of the first detection in the sample's process, which is not in the sample: cold
    /// caches, fresh memory.
    #[serde(default)]
    pub first_ns: Option<u64>,
    /// Detections in this sample.
    pub calls: Option<u64>,
    /// Of a scene in motion: of `time_ns`, what building lists took.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub building_ns: Option<u64>,
    /// The same as `time_ns` of the frame in the middle of all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub median_step_ns: Option<u64>,
    /// The same of the slowest frame.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub worst_step_ns: Option<u64>,
    /// Nanoseconds of the whole sample.
    pub elapsed_ns: Option<u64>,
    /// Where builds are timed side by side: nanoseconds per detection of each round.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rounds_ns: Vec<u64>,
    /// Of copies: the same as `time_ns` of each of them alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub alone_ns: Option<u64>,
    /// The processor that the process was kept on, if it was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub processor: Option<u32>,
    /// Milliseconds since 1970 when the sample began.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub began_ms: Option<u64>,
    /// Nanoseconds of a fixed loop, bound by caches and memory, before the sample's process began
    /// or after the sample, whichever took longer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pulse_ns: Option<u64>,
    /// How it ended.
    pub outcome: Outcome,
    /// Why, when it is not `ok`.
    pub reason: String,
    /// Pairs reported.
    pub contacts: Option<u64>,
    /// Order-free fingerprint of the pairs reported.
    pub digest: Option<String>,
    /// Operation counts; empty except in counting passes.
    pub counts: BTreeMap<String, u64>,
    /// Most heap bytes held at one time above the input.
    pub peak_bytes: Option<u64>,
    /// Heap bytes held after the detection.
    pub live_bytes: Option<u64>,
    /// Heap allocations of the first detection.
    pub allocations: Option<u64>,
    /// Heap allocations of a second detection of the same scene.
    pub warm_allocations: Option<u64>,
    /// Bytes by the detector's declared formula.
    pub formula_bytes: Option<u64>,
    /// Against exact decisions on the scene as given, where that was compared: all causes together.
    pub errors: Option<Errors>,
    /// The same by cause.
    #[serde(default)]
    pub causes: Option<Causes>,
    /// Of a scene in motion: what became of its frames.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub course: Option<Course>,
    /// The scene as realised.
    pub stats: Stats,
    /// How it moves, if it does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub moved: Option<Moved>,
    /// What answered: an entry of the ledger. None where nothing was started, and in records of
    /// older versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub process: Option<String>,
    /// When it was timed: an entry of the ledger. None where nothing is known of the load.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub span: Option<String>,
}

/// What a tracker did in the frames of a scene in motion, and what it missed: see
/// `Builds` and `Late` of the crate that runs trackers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Course {
    /// Frames in which the detector was asked, or all was made anew.
    pub builds: u64,
    /// Of those, how many LAMMPS would call dangerous.
    pub dangerous: u64,
    /// Of those, how many came after a missed contact.
    pub dangerous_rightly: u64,
    /// Builds after a missed contact, dangerous or not.
    pub missing_builds: u64,
    /// Pairs looked at, in all frames.
    pub listed: u64,
    /// The first frame with a missed contact.
    pub first_wrong: Option<u64>,
    /// Frames with one.
    pub wrong_frames: u64,
    /// The most in one frame.
    pub worst_missed: u64,
    /// Contacts that were never reported.
    pub never: u64,
    /// Of those that were reported too late, the most frames.
    pub latest: u64,
    /// Of those, the largest overlap when they were first reported, in mean radii of the couple.
    pub deepest_late: f64,
}

/// What makes a row the same measurement as another: they are repetitions of one another.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Measurement {
    /// Which cell.
    pub id: CellId,
    /// Which quantity.
    pub pass: Pass,
    /// In which block.
    pub block: u32,
}

impl Row {
    /// Pairs that touch in exact arithmetic: of a scene in motion in all frames together.
    pub fn true_contacts(&self) -> f64 {
        match &self.moved {
            Some(moved) => moved.contacts as f64,
            None => self.stats.true_contacts(self.id.n),
        }
    }

    /// What this row measures.
    pub fn measurement(&self) -> Measurement {
        Measurement { id: self.id.clone(), pass: self.pass, block: self.block }
    }

    /// Where in its run it was timed: rows of one block are compared only if they were timed in one
    /// span. What is resumed has spans of its own.
    pub fn timed_in(&self) -> Block {
        let span = self.span.as_deref().and_then(|id| u32::from_str_radix(id, 16).ok());
        Block { number: self.block, span: span.unwrap_or(0) }
    }
}
