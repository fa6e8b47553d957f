//! The doubt whether the sizes in a file are radii.

use contactbench_io::{Notice, RadiusSource};

/// Returns a notice if each particle of a file has on average far more contacts than hard particles
/// can have. Equal ones that do not overlap have at most 6 neighbours in 2D and 12 in 3D.
pub fn crowded(dim: usize, each: f64, source: &RadiusSource) -> Option<Notice> {
    let most = if dim == 2 { 9.0 } else { 18.0 };
    (each > most).then(|| Notice::Crowded(each, source.clone()))
}
