//! Detectors that codes use today: grids, a sweep and trees, over copies of the particles.

pub mod bvh;
pub mod cell_grid;
pub mod copies;
pub mod crowd;
pub mod hash_grid;
pub mod hgrid;
pub mod kd_tree;
pub mod rows;
pub mod sweep;
pub mod tree;
