//! The record: one JSON line per measurement, appended and never edited.

pub mod built;
pub mod column;
pub mod copies;
pub mod done;
pub mod faults;
pub mod file;
pub mod folder;
pub mod hardware;
pub mod id;
pub mod ledger;
pub mod machines;
pub mod merge;
pub mod outcome;
pub mod provenance;
pub mod role;
pub mod row;
pub mod seal;
pub mod value;
