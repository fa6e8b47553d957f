//! Recommends a detector for a scene by measuring all of them on it.
//!
//! It uses the parts of an experiment: runner processes ([`crate::run::runner::client`]), judged
//! answers, blocks in random order, and exact intervals of ratios within blocks
//! ([`contactbench_record::stats::interval`]). Because time is short, slow detectors are dropped
//! early ([`race`]).

pub mod race;
pub mod subject;
pub mod verdict;
pub mod words;
