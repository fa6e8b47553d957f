//! The passes of a measurement, and their outcomes.

use serde::{Deserialize, Serialize};

#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
#[serde(rename_all = "lowercase")]
pub enum Pass {
    /// Measures wall time, without counting operations.
    Time,
    #[default]
    Count,
    /// Measures heap bytes and allocations, except those of the output.
    Memory,
    /// Wall time of one of k single-threaded copies that run at once, for a row with k threads. It
    /// shows how much k threads can gain on this machine if they share nothing.
    Ceiling,
}

impl Pass {
    /// The passes of every cell. Ceilings are only measured if the experiment asks for them.
    pub const ALL: [Pass; 3] = [Pass::Count, Pass::Memory, Pass::Time];

    pub fn name(self) -> &'static str {
        match self {
            Pass::Time => "time",
            Pass::Count => "count",
            Pass::Memory => "memory",
            Pass::Ceiling => "ceiling",
        }
    }

    pub fn rest(self) -> &'static [Pass] {
        match self {
            Pass::Count => &Pass::ALL,
            Pass::Memory => &Pass::ALL[1..],
            Pass::Time => &Pass::ALL[2..],
            Pass::Ceiling => &[Pass::Ceiling],
        }
    }

    /// The passes after this one, which fail for the same reason.
    pub fn owed(self) -> &'static [Pass] {
        &self.rest()[1..]
    }
}

contactbench_terms::named! {
    /// How a planned measurement ended. Every planned cell has a row.
    #[derive(
        Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
    )]
    #[serde(rename_all = "kebab-case")]
    pub enum Outcome {
        #[default]
        Ok = "ok",
        /// Contacts were lost, as textbook filters and some trackers may. The row contains the
        /// errors.
        Lossy = "lossy",
        /// A wrong answer; its time is not used.
        Wrong = "wrong",
        Control = "control",
        Timeout = "timeout",
        OutOfMemory = "out-of-memory",
        Refused = "refused",
        Unavailable = "unavailable",
        Crashed = "crashed",
    }
}

impl Outcome {
    pub fn is_good(self) -> bool {
        matches!(self, Outcome::Ok | Outcome::Lossy | Outcome::Control)
    }

    /// Whether the detector is not called again on this scene.
    pub fn is_final(self) -> bool {
        !self.is_good() && self != Outcome::Wrong
    }
}
