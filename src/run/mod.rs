//! Running experiments: every contender in a process of its own, its answers judged, its rows
//! appended to the record.

pub mod alloc;
pub mod bandwidth;
pub mod client;
pub(crate) mod contender;
mod copies;
pub mod disk;
pub mod interrupt;
pub mod job;
pub(crate) mod judge;
pub(crate) mod passes;
pub mod plan;
pub mod protocol;
pub mod server;
pub mod shard;
pub mod stage;
pub mod trajectory;
