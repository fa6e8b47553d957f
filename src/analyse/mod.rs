//! From the record to answers: intervals, fits, claims, tables and the report.
//!
//! Everything here works on rows that were read and on experiment files; nothing runs a detector, so that every number and
//! figure of a report can be made again from its folder alone.

pub mod bound;
pub mod claim;
pub mod compare;
pub mod cost;
pub mod crossover;
pub mod csv;
pub mod errors;
pub mod expression;
#[cfg(test)]
pub(crate) mod fake;
pub mod filter;
pub mod fit;
pub mod grid;
pub mod interval;
pub mod keyed;
pub mod machine;
pub mod nnls;
pub mod overhead;
pub mod paper;
pub mod place;
pub mod price;
pub mod ratios;
pub mod report;
pub mod speed;
pub mod summary;
pub mod text;
pub mod threads;
pub mod unpaired;
pub mod value;
pub mod verdicts;
