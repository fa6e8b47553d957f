//! The table of all detectors. An algorithm that has a line here is in the command line, every experiment and every test.

use super::any::{AnyDetector, Both};
use super::{Options, control, direct};

/// What a detector is there for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Finds all contacts.
    Detector,
    /// Reports nothing, on purpose: what is left of a measurement without a detector.
    Nothing,
    /// The same code as another detector: what two measurements of the same thing differ by.
    Twin(&'static str),
}

/// One line of the table.
pub struct Entry {
    /// The name in records, experiments and on the command line.
    pub name: &'static str,
    /// Detector or control.
    pub role: Role,
    /// What it does, in a few words.
    pub summary: &'static str,
    /// Cost: N elements, b bits per cell number.
    pub cost: &'static str,
    /// Memory in bytes: n.. are cells per axis (borders included), N elements.
    pub memory: &'static str,
    /// What it refuses or does badly.
    pub limits: &'static str,
    /// Can use more than one thread.
    pub threads: bool,
    make: fn(Options) -> Box<dyn AnyDetector>,
}

impl Entry {
    /// A detector with empty buffers.
    pub fn make(&self, options: Options) -> Box<dyn AnyDetector> {
        (self.make)(options)
    }

    /// True for detectors, whose answers must be right; false for the control that reports nothing.
    pub fn must_be_right(&self) -> bool {
        self.role != Role::Nothing
    }
}

/// All detectors and controls.
pub static TABLE: &[Entry] = &[
    Entry {
        name: "direct",
        role: Role::Detector,
        summary: "tests every pair",
        cost: "N(N-1)/2 contact tests",
        memory: "0",
        limits: "time: hopeless at scale",
        threads: true,
        make: Both::<direct::Direct, direct::Direct>::boxed,
    },
    Entry {
        name: "nothing",
        role: Role::Nothing,
        summary: "control: does nothing, the floor of every measurement",
        cost: "0",
        memory: "0",
        limits: "finds nothing",
        threads: false,
        make: Both::<control::Nothing, control::Nothing>::boxed,
    },
];

/// The line of a detector.
pub fn find(name: &str) -> Option<&'static Entry> {
    TABLE.iter().find(|entry| entry.name == name)
}

/// The names of all detectors and controls, for messages.
pub fn names() -> String {
    TABLE.iter().map(|entry| entry.name).collect::<Vec<_>>().join(", ")
}
