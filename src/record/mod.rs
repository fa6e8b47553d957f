//! The record: one JSON line per measurement, appended and never edited.

pub mod column;
pub mod done;
pub mod file;
pub mod id;
pub mod machines;
pub mod merge;
pub mod outcome;
pub mod provenance;
pub mod role;
pub mod row;
pub mod value;
