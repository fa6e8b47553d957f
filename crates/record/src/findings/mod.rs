//! Findings computed from the cells of a record.

pub mod claim;
pub mod compare;
pub mod errors;
pub mod operations;
pub mod overhead;
pub mod ratios;
pub mod scenes;
pub mod threads;
pub mod tracking;
pub mod trust;
pub mod winners;
