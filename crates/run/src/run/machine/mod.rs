//! The machine during a run: processors, load, speed, disk space and signals.

pub mod disk;
pub mod interrupt;
pub mod load;
pub mod processors;
pub(super) mod pulse;
