//! What several verbs share.

pub mod arithmetic;
pub mod ci;
pub mod input;
pub mod limit;
pub mod progress;
pub mod scene;
pub mod sequence;
pub mod terminal;
pub mod values;
