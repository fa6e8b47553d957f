//! The record: one JSON line per measurement, appended and never edited.

pub mod column;
pub mod faults;
pub mod folder;
pub mod id;
pub mod merge;
pub mod origin;
pub mod outcome;
pub mod possible;
pub mod role;
pub mod row;
pub mod value;
