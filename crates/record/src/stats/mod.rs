//! Statistics: medians with exact intervals, unpaired comparisons, laws of growth, least squares.

pub mod growth;
pub mod interval;
pub mod line;
pub mod unpaired;
