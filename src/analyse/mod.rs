//! analyse
pub mod report;
