//! Code shared by several verbs.

#[macro_use]
pub mod terminal;

pub mod arithmetic;
pub mod ci;
pub mod input;
pub mod limit;
pub mod output;
pub mod progress;
pub mod scene;
pub mod sequence;
pub mod tracking;
pub mod values;
