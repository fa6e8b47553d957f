//! What a contender is there for.

use serde::{Deserialize, Serialize};

use crate::detect::table;

/// What a contender is there for: the record says so that nobody has to ask a table of detectors,
/// which may be another in another build.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// A detector of this program.
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

/// Names of the detectors and libraries of schemas 1 and 2, whose rows do not say their role.
const DETECTORS: [&str; 11] = [
    "direct",
    "binary-tree",
    "screening",
    "sorting",
    "nbs",
    "streamed-nbs",
    "cell-grid",
    "hash-grid",
    "sweep",
    "kd-tree",
    "bvh",
];
const PEERS: [&str; 5] = ["kiddo", "kd-tree-crate", "rstar", "parry", "zelll"];

impl Role {
    /// The role that a row of schema 1 or 2 has by its detector's name.
    pub fn by_name(name: &str) -> Role {
        match (name, name.strip_suffix("-twin")) {
            ("nothing", _) => Role::Nothing,
            (_, Some(original)) => Role::Twin(original.into()),
            _ if DETECTORS.contains(&name) => Role::Detector,
            _ if PEERS.contains(&name) => Role::Peer,
            _ => Role::Runner,
        }
    }

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

impl From<table::Role> for Role {
    fn from(role: table::Role) -> Role {
        match role {
            table::Role::Detector => Role::Detector,
            table::Role::Peer => Role::Peer,
            table::Role::Nothing => Role::Nothing,
            table::Role::Twin(original) => Role::Twin(original.into()),
        }
    }
}
