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

use crate::generate::boxes::filled;
use crate::generate::loose::uniform;
use crate::generate::table::{Generator, Parameter, ParameterKind, parameter};
use crate::generate::{Inputs, OF_PARTICLES, fraction};
use contactbench_ground::scene::{AnyScene, Scene};
use contactbench_io::Given;

pub const GENERATOR: Generator = Generator {
    name: "clustered",
    summary: "Gaussian clusters on a thin uniform background",
    params: &[
        OF_PARTICLES,
        &[
            parameter(
                "per-cluster",
                ParameterKind::COUNT,
                "100",
                "particles in a cluster; the last cluster may be smaller",
            ),
            Parameter {
                name: "width",
                kind: ParameterKind::NOT_NEGATIVE,
                default: ["4", "2"],
                meaning: "standard deviation of a cluster along each axis, in diameters",
            },
            parameter(
                "background",
                ParameterKind::SHARE,
                "0.1",
                "share of the particles that is uniform in the box",
            ),
            fraction("0.01"),
        ],
    ],
    make: |inputs| if inputs.dim == 2 { make::<2>(inputs) } else { make::<3>(inputs) },
    ..Generator::PLAIN
};

fn make<const D: usize>(inputs: &Inputs<'_>) -> anyhow::Result<Given>
where
    AnyScene<'static>: From<Scene<'static, f64, D>>,
{
    let (n, per_cluster, width) =
        (inputs.n, inputs.whole("per-cluster")?.max(1), inputs.number("width")?);
    let clustered = n - ((inputs.number("background")? * n as f64 + 0.5) as u64).min(n);
    let mut cluster = [0.0; D];
    filled(inputs, |draw, edge, k| {
        if k >= clustered {
            return uniform(draw, edge);
        }
        if k % per_cluster == 0 {
            cluster = uniform(draw, edge);
        }
        cluster.map(|x| x + width * draw.normal())
    })
}
