//! The harness: experiments, runners, the record.

pub mod experiment;
pub mod record;
