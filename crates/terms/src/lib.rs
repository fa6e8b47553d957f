//! Names and numbers shared by detectors and records: counted operations, arithmetics, errors of an
//! answer, statistics of scenes and motions, the grammar of parameters, and the format of numbers
//! and words in all output.
//!
//! This crate does not compute contacts, so reading records needs no detector.
#![deny(missing_docs)]

pub mod arithmetic;
pub mod errors;
pub mod grammar;
pub mod interval;
pub mod mix;
pub mod moved;
mod must;
mod named;
pub mod nearest;
pub mod number;
pub mod op;
pub mod scene;
pub mod text;
