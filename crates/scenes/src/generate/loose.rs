//! `loose`: particles uniform at random in a square or cube, as in a Poisson process.
//!
//! ```text
//!   +----------------+
//!   | o        o   o |
//!   |    o  oo       |
//!   |            o   |
//!   |  o      o     o|
//!   +----------------+
//! ```
//!
//! Centres are independent and uniform in a square or cube with a corner at the origin, whose
//! volume is that of all particles over `fraction`. Particles may overlap: about 4·fraction·n/2
//! pairs touch in 2D and 8·fraction·n/2 in 3D.

use crate::generate::boxes::filled;
use crate::generate::draw::Draw;
use crate::generate::table::Generator;
use crate::generate::{OF_PARTICLES, fraction};

pub const GENERATOR: Generator = Generator {
    name: "loose",
    summary: "uniform random in a square or cube",
    params: &[OF_PARTICLES, &[fraction("0.05")]],
    make: |inputs| match inputs.dim {
        2 => filled::<2>(inputs, |draw, edge, _| uniform(draw, edge)),
        _ => filled::<3>(inputs, |draw, edge, _| uniform(draw, edge)),
    },
    ..Generator::PLAIN
};

/// Draws a point in a square or cube with a corner at the origin.
pub fn uniform<const D: usize>(draw: &mut Draw, edge: f64) -> [f64; D] {
    [(); D].map(|()| edge * draw.unit())
}
