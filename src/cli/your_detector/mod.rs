//! Verbs for authors of detectors.

pub mod check;
pub mod new_detector;
pub mod runner;
pub mod trace;
