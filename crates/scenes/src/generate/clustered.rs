//! `clustered`: Gaussian clusters on a thin background.
//!
//! ```text
//!   +----------------------+
//!   |  oo              o   |
//!   | oooo      o          |
//!   |  oo               o  |
//!   |       o        oooo  |
//!   |            o    oooo |
//!   +----------------------+
//! ```
//!
//! A share `background` of the particles (rounded to the nearest whole number) is uniform in a
//! square or cube, whose volume is that of all particles over `fraction`. The others form clusters
//! of `per-cluster` particles; the last may be smaller. Each cluster has a centre uniform in the
//! box. Its particles are normally distributed about the centre, with standard deviation `width`
//! along each axis. Particles of clusters near the border may lie outside the box. The scene is
//! then slightly larger, and its packing fraction slightly smaller, than requested. In generated
//! order the clusters come first, then the background.

use crate::generate::boxes::boxed;
use crate::generate::draw::Draw;
use crate::generate::sizes::unit_radii;
use crate::generate::table::{Generator, Kind, Parameter, Preset, number};
use crate::generate::{Inputs, OF_BODIES, assemble, box_edge, fraction};
use contactbench_core::scene::{AnyScene, Scene};
use contactbench_io::Given;

pub const GENERATOR: Generator = Generator {
    name: "clustered",
    summary: "Gaussian clusters on a thin uniform background",
    params: &[
        OF_BODIES,
        &[
            Parameter {
                name: "per-cluster",
                kind: Kind::COUNT,
                default: [Preset::Whole(100); 2],
                meaning: "particles in a cluster; the last cluster may be smaller",
            },
            Parameter {
                name: "width",
                kind: Kind::NOT_NEGATIVE,
                default: [Preset::Number(4.0), Preset::Number(2.0)],
                meaning: "standard deviation of a cluster along each axis, in diameters",
            },
            number(
                "background",
                Kind::SHARE,
                0.1,
                "share of the particles that is uniform in the box",
            ),
            fraction(0.01),
        ],
    ],
    make: |inputs| if inputs.dim == 2 { make::<2>(inputs) } else { make::<3>(inputs) },
    ..Generator::PLAIN
};

fn make<const D: usize>(inputs: &Inputs<'_>) -> anyhow::Result<Given>
where
    AnyScene<'static>: From<Scene<'static, f64, D>>,
{
    let mut draw = Draw::new(inputs.seed);
    let radii = unit_radii(inputs, &mut draw)?;
    let (n, per_cluster, width) =
        (inputs.n, inputs.whole("per-cluster")?.max(1), inputs.number("width")?);
    let edge = box_edge::<D>(n, radii.as_deref(), inputs.number("fraction")?);
    let clustered = n - ((inputs.number("background")? * n as f64 + 0.5) as u64).min(n);
    let mut cluster = [0.0; D];
    let centres = (0..n).map(|k| {
        if k >= clustered {
            return [(); D].map(|()| edge * draw.unit());
        }
        if k % per_cluster == 0 {
            cluster = cluster.map(|_| edge * draw.unit());
        }
        cluster.map(|x| x + width * draw.normal())
    });
    boxed(inputs, assemble(inputs, centres, radii)?, [edge; D])
}
