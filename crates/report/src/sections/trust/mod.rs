//! Words for how far the numbers can be trusted.

pub mod conditions;
pub mod coverage;
pub mod failures;
pub(super) mod noise;
