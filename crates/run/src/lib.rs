//! Runs experiments and checks. It plans them, starts runners, judges answers, follows trackers,
//! and recommends detectors.

pub mod check;
pub mod plan;
pub mod recommend;
pub mod run;
pub mod tracking;
pub mod verify;
