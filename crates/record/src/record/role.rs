use serde::{Deserialize, Serialize};

/// The role of a subject. Records store it, because another build may have another table of
/// detectors.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    #[default]
    Detector,
    /// A library that people use.
    Peer,
    Runner,
    Nothing,
    /// Control: the same code as the named detector.
    Twin(String),
    Base(String),
}

impl Role {
    pub fn is_control(&self) -> bool {
        matches!(self, Role::Nothing | Role::Twin(_) | Role::Base(_))
    }

    pub fn twin_of(&self) -> Option<&str> {
        if let Role::Twin(original) = self { Some(original) } else { None }
    }

    pub fn base_of(&self) -> Option<&str> {
        if let Role::Base(original) = self { Some(original) } else { None }
    }

    /// Whether the code is this project's, so that its documented memory and refusals apply.
    pub fn is_ours(&self) -> bool {
        !matches!(self, Role::Peer | Role::Runner)
    }
}
