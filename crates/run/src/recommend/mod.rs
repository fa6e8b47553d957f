//! Which detector for this scene: all are measured on it, and the times are read at once.
//!
//! The parts are those of an experiment: runner processes ([`crate::run::client`]), every answer
//! held to the truth, samples in blocks in random order, medians with exact intervals and ratios
//! within blocks ([`contactbench_record::stats::interval`]). What differs is that time is short: a
//! detector that is far behind after a first probe is not measured again ([`race`]).

pub mod race;
pub mod standing;
pub mod verdict;
pub mod words;
