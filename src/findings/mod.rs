//! What a record says: findings as values, from cells alone.

pub mod bound;
pub mod claim;
pub mod compare;
pub mod cost;
pub mod crossover;
pub mod errors;
pub mod failures;
pub mod noise;
pub mod operations;
pub mod overhead;
pub mod price;
pub mod ratios;
pub mod scenes;
pub mod threads;
pub mod verdicts;
pub mod winners;
