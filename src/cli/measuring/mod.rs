//! Verbs that measure, and those that read records.

pub mod compare;
pub mod merge;
pub mod report;
pub mod run;
pub mod site;
