//! What several verbs share.

pub mod arithmetic;
pub mod ci;
pub mod input;
pub mod progress;
pub mod scene;
pub mod terminal;
