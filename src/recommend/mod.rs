//! Which detector for this scene, and which tracker for these frames: all are measured on them, and
//! the record of the race is read at once.
//!
//! The parts are those of an experiment: runner processes ([`crate::run::client`]), every answer
//! held to the truth, samples in blocks in random order, medians with exact intervals and ratios
//! within blocks ([`crate::stats::interval`]). What differs is that time is short: a detector
//! that is far behind after a first probe is not measured again ([`race`]).
//!
//! Of frames ([`motion`]) the detectors run a short race on the first; the best of them take part
//! in trackers, which run the race on all frames, written to files. What settings of other codes
//! would miss is told by the code of `track` ([`crate::moving`]).

pub mod motion;
pub mod race;
pub mod standing;
pub mod verdict;
