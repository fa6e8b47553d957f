//! The scenes that detectors get: generators, hard cases, motion, and statistics of scenes.

pub mod doubts;
pub mod generate;
pub mod hard;
pub mod motion;
pub mod neighbours;
pub mod order;
pub mod origin;
pub mod spec;
pub mod stats;
pub mod touching;

pub use contactbench_ground::scene::*;
pub use contactbench_io::Given;
