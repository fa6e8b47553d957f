//! Runs experiments and checks: plans, runners in processes of their own, the judge, the battery of
//! small scenes, trackers held to the truth, recommendations.

pub mod check;
pub mod moving;
pub mod plan;
pub mod recommend;
pub mod run;
mod truth;

#[cfg(test)]
#[path = "../../../tests/program/committed.rs"]
mod committed;
