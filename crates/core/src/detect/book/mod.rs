//! The detectors of Munjiza's book, chapter 3, with the lists and masks that they share.

pub mod binary_tree;
pub mod direct;
#[cfg(test)]
mod golden;
pub mod list;
pub mod mask;
#[expect(dead_code, reason = "`lists` goes with the next change of this timed code")]
pub mod nbs2d;
#[expect(dead_code, reason = "`lists` goes with the next change of this timed code")]
pub mod nbs3d;
pub mod nbs_levels;
#[expect(dead_code, reason = "`lists` goes with the next change of this timed code")]
pub mod screening;
pub mod sorting;
