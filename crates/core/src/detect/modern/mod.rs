//! Detectors that codes use today: grids, a sweep and trees, over copies of the particles.

pub mod bvh;
pub mod cell_grid;
pub(super) mod copies;
pub(super) mod crowd;
pub mod hash_grid;
pub mod hgrid;
pub mod kd_tree;
pub(super) mod rows;
pub mod sweep;
pub(super) mod tree;
