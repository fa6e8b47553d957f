//! Reads particles and contact lists from files, and writes pairs and scenes.
//!
//! Each format has one module and one entry in [`FORMATS`]. The first bytes of a file give its
//! format, otherwise its ending does; the option `format` overrides both. Files may be compressed
//! with gzip. Numbers are rounded correctly. Errors name file, line and column; particles are
//! numbered from 0.
//!
//! **Dimension.** A column z or three-dimensional vectors make spheres, even if every z is 0. If
//! `dim` is `Some(2)`, they make discs, and every z must be 0. An array of three unnamed columns is
//! x, y, z, or x, y, radius with `dim: Some(2)`.
//!
//! **Radii.** A radius from the options replaces those of the file. Diameters are halved, which is
//! exact above 10^-307. Equal radii are stored as one.
//!
//! **Frames.** A file of several frames is refused unless the options choose one. [`frames`] reads
//! all of them, one at a time.
//!
//! **Boxes.** Particles keep their periodic box. They do not become an open scene unless the
//! options ask for it; see [`boxes`].
//!
//! **Memory.** Lists of particles grow by a quarter at a time, as bytes are read, whatever number
//! the header announces. Frames and sizes of npz, and arrays in Fortran order, are kept, too.

pub mod boxes;
mod columns;
mod doubts;
pub mod exchange;
mod formats;
mod frames;
mod load;
mod options;
pub mod pairs;
mod particles;
mod raw;
mod rows;
mod types;
pub mod write;

pub use boxes::Boundaries;
pub use columns::without::{Groups, Without};
pub use formats::FORMATS;
pub use load::series::exists;
pub use load::{Frames, frames, frames_from, given, load, load_from, scene};
pub use options::{FileOption, Format, OPTIONS, Options};
pub use particles::{Given, Loaded, Particles};
pub use raw::lines::{LONGEST_LINE, short};
pub use raw::room::room;
pub use types::{About, Declared, FrameChoice, Notice, RadiusSource};

#[cfg(test)]
mod tests;
