//! Limits: memory, numbers of pairs, and refusals with a remedy.

pub mod crowd;
pub mod memory;
pub mod pages;
pub mod refusal;
