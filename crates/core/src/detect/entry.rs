//! An entry of the table of detectors, with its parameters.

use std::collections::BTreeMap;

use super::Options;
use super::any::AnyDetector;

/// The purpose of a detector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Finds all contacts.
    Detector,
    /// Reports nothing, on purpose: what is left of a measurement without a detector.
    Nothing,
    /// The same code as another detector: what two measurements of the same thing differ by.
    Twin(&'static str),
    /// A library that people use: finds all contacts, but is not held to our rules about memory and
    /// refusals.
    Peer,
}

/// Detectors that experiments name together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// Detectors of Munjiza's book.
    Book,
    /// Grids, trees and sweeps as they are used today.
    Modern,
    /// NBS for caches and vector registers.
    Streamed,
    /// Controls of the measurement.
    Controls,
    /// More twins of detectors, where the noise is to be known well.
    Twins,
    /// Libraries that people use.
    Peers,
}

impl Group {
    /// All groups, in the order of the table.
    pub const ALL: [Group; 6] =
        [Group::Book, Group::Modern, Group::Streamed, Group::Controls, Group::Twins, Group::Peers];

    /// The name in experiments.
    pub fn name(self) -> &'static str {
        match self {
            Group::Book => "@book",
            Group::Modern => "@modern",
            Group::Streamed => "@streamed",
            Group::Controls => "@controls",
            Group::Twins => "@twins",
            Group::Peers => "@peers",
        }
    }
}

/// How the times of a detector usually compare with those of the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Speed {
    /// About as fast as looking at a list of pairs twenty times.
    Fast,
    /// Some times as long.
    Usual,
    /// So long that it is asked last.
    Slow,
}

/// The places of a detector among those that are asked for the truth, from 1; 0: it is not asked.
/// Judges that are asked together are of different families, the fast ones first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Judge {
    /// Scenes whose particles are of similar size.
    pub alike: u8,
    /// Scenes whose sizes differ: cells as large as the largest particle hold nearly all others.
    pub differ: u8,
    /// Among the images of a periodic box.
    pub boxed: u8,
}

impl Judge {
    /// A detector that is not asked.
    pub const NOT: Judge = Judge { alike: 0, differ: 0, boxed: 0 };
}

/// Values given to a detector's parameters, by name; those left at their defaults are absent.
pub type Params = BTreeMap<String, String>;

/// One line of the table.
pub struct Entry {
    /// The name in records, experiments and on the command line.
    pub name: &'static str,
    /// Detector or control.
    pub role: Role,
    /// Which group it belongs to.
    pub group: Group,
    /// A summary of the algorithm, in a few words.
    pub summary: &'static str,
    /// Cost for N particles.
    pub cost: &'static str,
    /// Memory in bytes: n.. are cells per axis (borders included), N particles.
    pub memory: &'static str,
    /// Scenes that it refuses or is slow on.
    pub limits: &'static str,
    /// Can use more than one thread.
    pub threads: bool,
    /// How the detector's times usually compare with those of other detectors.
    pub speed: Speed,
    /// Scenes whose truth it may decide.
    pub judge: Judge,
    /// The parameters that a user can set.
    pub parameters: &'static [Parameter],
    /// How it is made; see [`Entry::make`] and
    /// [`DetectorSpec::make`](super::spec::DetectorSpec::make).
    pub constructor: fn(&Params, Options) -> Box<dyn AnyDetector>,
}

impl Entry {
    /// A detector with empty buffers and all parameters at their defaults.
    pub fn make(&self, options: Options) -> Box<dyn AnyDetector> {
        (self.constructor)(&Params::new(), options)
    }

    /// True for detectors, whose answers must be right; false for the control that reports nothing.
    pub fn must_be_right(&self) -> bool {
        self.role != Role::Nothing
    }

    /// True for the code of this project, which allocates and refuses as its documentation says;
    /// false for peers.
    pub fn is_ours(&self) -> bool {
        self.role != Role::Peer
    }
}

/// A choice that a detector leaves to its user. It may change times and memory, never the contacts.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// The name before the `=`.
    pub name: &'static str,
    /// All words that it takes, the default first.
    pub values: &'static [&'static str],
    /// Other values that it takes, if any.
    pub beside: Option<Beside>,
    /// Another parameter, which cannot be given with it.
    pub instead_of: Option<&'static str>,
    /// The choice, in a phrase.
    pub meaning: &'static str,
}

/// Values of a parameter that are too many to list.
#[derive(Clone, Copy, Debug)]
pub struct Beside {
    /// The one way to write a value, or none if it is no value.
    pub normal: fn(&str) -> Option<String>,
    /// The form of a value, with an example.
    pub form: &'static str,
}

impl Parameter {
    /// The value of a detector that is asked for without this parameter.
    pub fn default(&self) -> &'static str {
        self.values[0]
    }
}
