//! How far the numbers can be trusted: conditions, plan, failures and noise.

pub mod conditions;
pub mod coverage;
pub mod failures;
pub mod modes;
pub mod noise;
