//! The detectors of Munjiza's book, chapter 3, and the lists and masks that they share.

pub mod binary_tree;
pub mod direct;
#[cfg(test)]
mod golden;
pub mod kept_tree;
mod list;
pub mod mask;
pub mod nbs;
pub mod screening;
pub mod sorting;
