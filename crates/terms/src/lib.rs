//! What detectors and records must both name: operations that are counted, arithmetics, errors of
//! an answer, statistics of scenes and motions; names with parameters as they are
//! written, and which known name was meant; and numbers and words as every output prints them.
//!
//! Nothing here computes contacts. A crate that reads records needs this one, and no detector.
#![deny(missing_docs)]

pub mod arithmetic;
pub mod errors;
pub mod grammar;
pub mod interval;
pub mod mix;
pub mod moved;
pub mod nearest;
pub mod number;
pub mod op;
pub mod scene;
pub mod text;
