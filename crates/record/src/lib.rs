//! Records of measurements, the experiments behind them, and findings from them. This crate does
//! not depend on the core, so it cannot use a detector.

pub mod cells;
pub mod experiment;
pub mod findings;
pub mod record;
pub mod stats;
