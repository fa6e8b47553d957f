//! Findings computed from the cells of a record.

pub mod claim;
pub mod compare;
pub mod conditions;
pub mod courses;
pub mod coverage;
pub mod errors;
pub mod every;
pub mod failures;
pub mod map;
pub mod noise;
pub mod operations;
pub mod overhead;
pub mod ratios;
pub mod scenes;
pub mod threads;
pub mod verdicts;
pub mod winners;
