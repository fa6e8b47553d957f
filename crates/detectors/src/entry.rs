//! Entries of the table of detectors, and their parameters.

use contactbench_ground::detect::Options;
use contactbench_ground::detect::any::{AnyDetector, Params};

/// Kind of an entry: a detector, a control or a twin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A detector; it finds all contacts.
    Detector,
    /// A control that reports no contacts, to measure everything but detection.
    Nothing,
    /// A second entry with the named detector's code: differences of their times are noise.
    Twin(&'static str),
}

contactbench_terms::named! {
    /// A name for several detectors in experiments.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Group {
        /// Detectors of Munjiza's book.
        Book = "@book",
        /// Grids, trees and sweeps as they are used today.
        Modern = "@modern",
        /// Forms of NBS for caches and vector registers.
        Streamed = "@streamed",
        /// Controls of the measurement.
        Controls = "@controls",
        /// Further twins of detectors, for experiments that need to measure noise well.
        Twins = "@twins",
    }
}

/// Rough class of a detector's run time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Speed {
    /// Takes about as long as twenty passes over a list of pairs.
    Fast,
    /// Takes a few times as long as fast detectors.
    Usual,
    /// Takes so long that it is tried last.
    Slow,
}

/// One entry of the table.
pub struct Entry {
    /// Name in records, experiments and on the command line.
    pub name: &'static str,
    /// Kind of the entry, such as a detector or a control.
    pub role: Role,
    /// Group that includes the detector in experiments.
    pub group: Group,
    /// The algorithm in a few words.
    pub summary: &'static str,
    /// Growth of the run time with N, the number of particles.
    pub cost: &'static str,
    /// Memory in bytes for N particles; nx, ny and nz are cells per axis, borders included.
    pub memory: &'static str,
    /// Scenes that the detector refuses or is slow on.
    pub limits: &'static str,
    /// Whether the detector can use more than one thread.
    pub threads: bool,
    /// Rough class of the detector's run time.
    pub speed: Speed,
    /// Rank of this detector among those that establish the truth, from 1; 0 if it is not used. The
    /// first detectors that accept a scene belong to different families.
    pub judge: u8,
    /// Parameters that a user can set.
    pub parameters: &'static [Parameter],
    /// Constructor behind [`Entry::make`] and
    /// [`DetectorSpec::make`](super::spec::DetectorSpec::make).
    pub constructor: fn(&Params, Options) -> Box<dyn AnyDetector>,
}

impl Entry {
    /// Creates the detector with empty buffers and default parameters.
    pub fn make(&self, options: Options) -> Box<dyn AnyDetector> {
        (self.constructor)(&Params::new(), options)
    }

    /// Returns whether the contacts must be right: false only for the control that reports none.
    pub fn must_be_right(&self) -> bool {
        self.role != Role::Nothing
    }
}

/// A choice that a detector leaves to its user. It may change times and memory, never the contacts.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Name of the parameter, written before the `=`.
    pub name: &'static str,
    /// Accepted words, the default first.
    pub values: &'static [&'static str],
    /// Effect of the parameter, in a phrase.
    pub meaning: &'static str,
}

impl Parameter {
    /// Returns the value that is used if the parameter is not given.
    pub fn default(&self) -> &'static str {
        self.values[0]
    }
}
