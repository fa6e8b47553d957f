//! The passes of a measurement, and how each can end.

use serde::{Deserialize, Serialize};

/// Which quantity a row measured. Each is taken in a pass of its own.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
#[serde(rename_all = "lowercase")]
pub enum Pass {
    /// Wall time, with a silent probe.
    Time,
    /// Exact operation counts.
    #[default]
    Count,
    /// Heap bytes and allocations, without the output.
    Memory,
    /// Wall time of one of as many copies as the row has threads, with one thread each, while the
    /// others do the same: what the machine lets that many threads gain if they share nothing.
    Ceiling,
}

impl Pass {
    /// The passes of every cell. (Ceilings are measured beside cells with several threads, where
    /// the experiment asks for them.)
    pub const ALL: [Pass; 3] = [Pass::Count, Pass::Memory, Pass::Time];

    pub fn name(self) -> &'static str {
        match self {
            Pass::Time => "time",
            Pass::Count => "count",
            Pass::Memory => "memory",
            Pass::Ceiling => "ceiling",
        }
    }

    /// The passes that fall with a failed one, itself first.
    pub fn rest(self) -> &'static [Pass] {
        match self {
            Pass::Count => &Pass::ALL,
            Pass::Memory => &Pass::ALL[1..],
            Pass::Time => &Pass::ALL[2..],
            Pass::Ceiling => &[Pass::Ceiling],
        }
    }

    /// The passes whose rows follow that of a failed one.
    pub fn owed(self) -> &'static [Pass] {
        &self.rest()[1..]
    }
}

/// How a planned measurement ended. Every planned cell has a row.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    #[default]
    Ok,
    /// Contacts were lost, as textbook filters and careless trackers may: the answer is what was
    /// asked for, and its error stands in the row.
    Lossy,
    /// The answer was wrong: its time means nothing.
    Wrong,
    /// A control that reports nothing on purpose.
    Control,
    Timeout,
    OutOfMemory,
    /// The detector will not work on this scene, and says why.
    Refused,
    /// The runner could not be started.
    Unavailable,
    /// The runner died.
    Crashed,
}

impl Outcome {
    /// Did the detector do what it is there for?
    pub fn is_good(self) -> bool {
        matches!(self, Outcome::Ok | Outcome::Lossy | Outcome::Control)
    }

    /// After these the detector is not called again on this scene.
    pub fn is_final(self) -> bool {
        !self.is_good() && self != Outcome::Wrong
    }

    pub fn name(self) -> &'static str {
        match self {
            Outcome::Ok => "ok",
            Outcome::Lossy => "lossy",
            Outcome::Wrong => "wrong",
            Outcome::Control => "control",
            Outcome::Timeout => "timeout",
            Outcome::OutOfMemory => "out-of-memory",
            Outcome::Refused => "refused",
            Outcome::Unavailable => "unavailable",
            Outcome::Crashed => "crashed",
        }
    }
}
