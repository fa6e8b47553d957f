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

use crate::generate::boxes::boxed;
use crate::generate::draw::Draw;
use crate::generate::sizes::unit_radii;
use crate::generate::table::Generator;
use crate::generate::{Inputs, OF_BODIES, assemble, box_edge, fraction};
use contactbench_core::scene::{AnyScene, Scene};
use contactbench_io::Given;

pub const GENERATOR: Generator = Generator {
    name: "loose",
    summary: "uniform random in a square or cube",
    params: &[OF_BODIES, &[fraction(0.05)]],
    make: |inputs| if inputs.dim == 2 { make::<2>(inputs) } else { make::<3>(inputs) },
    ..Generator::PLAIN
};

fn make<const D: usize>(inputs: &Inputs<'_>) -> anyhow::Result<Given>
where
    AnyScene<'static>: From<Scene<'static, f64, D>>,
{
    let mut draw = Draw::new(inputs.seed);
    let radii = unit_radii(inputs, &mut draw)?;
    let edge = box_edge::<D>(inputs.n, radii.as_deref(), inputs.number("fraction")?);
    let centres = (0..inputs.n).map(|_| [(); D].map(|()| edge * draw.unit()));
    boxed(inputs, assemble(inputs, centres, radii)?, [edge; D])
}
