//! Running experiments: every contender in a process of its own, its answers judged, its rows
//! appended to the record.

pub mod alloc;
pub mod client;
pub(crate) mod contender;
mod copies;
pub mod disk;
mod duet;
mod family;
pub mod interrupt;
pub mod job;
pub(crate) mod judge;
pub(crate) mod load;
pub mod origins;
pub(crate) mod passes;
pub mod plan;
pub mod possible;
pub(crate) mod processors;
pub mod protocol;
mod pulse;
pub mod server;
pub mod session;
pub mod stage;
pub mod trajectory;
mod walk;
