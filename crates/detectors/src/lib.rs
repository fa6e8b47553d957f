//! Contact detectors, one file per algorithm and one entry in [`table`], for the crates of
//! contactbench. Programs use `contactbench-core`.
//!
//! [`oracle`] has the true contacts of a scene, from tests of all pairs, and the errors of a
//! detector. [`tracker`] reads specifications of trackers over any detector.

pub mod book;
pub mod control;
mod entry;
pub mod modern;
pub mod near;
pub mod oracle;
pub mod spec;
pub mod table;
pub mod tracker;
