//! Runs experiments: a process for each subject, judged answers, and rows in the record.

pub mod judge;
pub mod machine;
pub mod origins;
pub mod plan;
pub mod runner;
pub mod session;
pub mod stage;
pub mod subject;
