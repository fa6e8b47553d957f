//! contactbench: an instrumented research testbed for contact detection.
#![warn(missing_docs)]

pub mod analyse;
pub mod cells;
pub mod check;
pub mod cli;
pub mod contact;
pub mod detect;
pub mod figure;
pub mod harness;
pub mod oracle;
pub mod probe;
pub mod read;
pub mod scene;
pub mod sink;
