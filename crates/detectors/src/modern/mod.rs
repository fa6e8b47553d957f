//! Detectors that codes use today: grids, a sweep and trees, over copies of the particles.

pub mod bvh;
pub mod cell_grid;
pub mod hash_grid;
pub mod kd_tree;
pub mod sweep;
mod tree;
