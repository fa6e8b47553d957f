//! What a contender is there for.

use serde::{Deserialize, Serialize};

/// What a contender is there for: the record says so that nobody has to ask a table of detectors,
/// which may be another in another build.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    #[default]
    Detector,
    /// A library that people use.
    Peer,
    /// A program of its own, in whatever language.
    Runner,
    /// Control: reports nothing, on purpose.
    Nothing,
    /// Control: the same code as the detector of this name.
    Twin(String),
    /// The detector of this name in the build that this one is compared with.
    Base(String),
}

impl Role {
    /// True for what takes part in no comparison.
    pub fn is_control(&self) -> bool {
        matches!(self, Role::Nothing | Role::Twin(_) | Role::Base(_))
    }

    /// The detector that this is the twin of.
    pub fn twin_of(&self) -> Option<&str> {
        match self {
            Role::Twin(original) => Some(original),
            _ => None,
        }
    }

    /// The detector that this is of another build.
    pub fn base_of(&self) -> Option<&str> {
        match self {
            Role::Base(original) => Some(original),
            _ => None,
        }
    }

    /// True for the code of this project, which allocates and refuses as its documentation says.
    pub fn is_ours(&self) -> bool {
        !matches!(self, Role::Peer | Role::Runner)
    }
}
