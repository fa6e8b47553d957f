//! What codes use today: grids, sweep and trees over copies of the bodies in an order of their own.

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
