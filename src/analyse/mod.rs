//! From the record to answers: intervals, fits, claims, tables and the report.
//!
//! Everything here works on rows that were read and on experiment files; nothing runs a detector, so that every number and
//! figure of a report can be made again from its folder alone.

pub mod claim;
pub mod csv;
pub mod errors;
#[cfg(test)]
pub(crate) mod fake;
pub mod filter;
pub mod fit;
pub mod interval;
pub mod place;
pub mod price;
pub mod report;
pub mod summary;
pub mod text;
pub mod value;
pub mod verdicts;
