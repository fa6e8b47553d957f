//! What verbs print of trackers and recommendations.

pub mod recommendation;
pub mod tracking;
