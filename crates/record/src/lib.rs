//! Records of measurements, what is asked of them, and what they say. No detector is known here:
//! the wall is this crate, which does not depend on the core.

pub mod cells;
pub mod experiment;
pub mod findings;
pub mod record;
pub mod stats;

#[cfg(test)]
#[path = "../../../tests/program/committed.rs"]
mod committed;
