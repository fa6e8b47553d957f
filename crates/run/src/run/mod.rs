//! Runs experiments: a process for each subject, judged answers, and rows in the record.

pub mod alloc;
mod block;
pub mod client;
mod copies;
pub mod disk;
mod family;
pub mod interrupt;
pub mod judge;
pub mod load;
pub mod origins;
pub mod passes;
pub mod plan;
pub mod possible;
pub mod processors;
pub mod protocol;
mod pulse;
pub mod server;
pub mod session;
pub mod stage;
pub mod subject;
pub mod trajectory;
