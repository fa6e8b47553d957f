//! The harness: experiments become rows of the record. Every detector runs in a process of its own.

pub mod alloc;
pub mod bake;
pub mod bandwidth;
pub mod builtin;
mod ceiling;
pub mod child;
pub(crate) mod contender;
pub mod experiment;
mod index;
pub mod interrupt;
pub mod merge;
mod plan;
pub mod protocol;
pub mod provenance;
pub mod record;
pub mod run;
pub mod runner;
pub mod shard;
pub mod space;
mod toml_error;
pub(crate) mod truths;
