//! Boxes of generated scenes.
//!
//! The generators that draw places in a square or cube can let it repeat, along all axes or some of
//! them: `periodic=true`, `periodic=xy`. Particles that are thrown out of it stay where they are.
//! With a `tilt` the box is sheared as by Lees and Edwards (1972, doi:10.1088/0022-3719/5/15/006):
//! the images above and below are moved along x, so that the vectors are
//!
//! ```text
//! (lx, 0, 0), (tilt·lx, ly, 0), (0, 0, lz).
//! ```

use anyhow::ensure;

use crate::generate::table::{Kind, Parameter, optional};
use crate::generate::{DIAMETER, Inputs, OFFSET};
use contactbench_core::scene::{AnyScene, Lattice};
use contactbench_io::Given;
use contactbench_io::boxes::Axes;

/// Along which axes the box repeats.
pub const PERIODIC: Parameter = optional(
    "periodic",
    Kind::Axes,
    "the box repeats: true, or along these axes: x, xy and so on, none",
);

/// The shear.
pub const TILT: Parameter = optional(
    "tilt",
    Kind::FINITE,
    "the images along y are moved along x by this, in edges of the box along x",
);

/// How the box of a scene repeats.
#[derive(Clone, Copy, Debug)]
pub struct Repeats {
    /// Along which axes.
    pub axes: [bool; 3],
    /// By how much the images along y are moved along x, in edges.
    pub tilt: Option<f64>,
}

impl Repeats {
    /// As asked for; `None` for a scene without a box.
    pub fn new(inputs: &Inputs<'_>) -> anyhow::Result<Option<Repeats>> {
        let tilt = inputs.number(TILT.name).ok();
        let Ok(text) = inputs.text(PERIODIC.name) else {
            ensure!(tilt.is_none(), "a tilt belongs to a box that repeats: add periodic=true");
            return Ok(None);
        };
        let axes = text.parse::<Axes>().map_err(anyhow::Error::msg)?.of(inputs.dim as usize);
        let none = axes == [false; 3] || tilt.is_none_or(|tilt| tilt == 0.0);
        ensure!(
            axes[1] || none,
            "a tilt moves images along y, and the box does not repeat along y"
        );
        Ok(Some(Repeats { axes, tilt }))
    }
}

/// The scene in its box, if it has one. `edges` are in diameters.
pub fn boxed<const D: usize>(
    inputs: &Inputs<'_>,
    scene: impl Into<AnyScene<'static>>,
    edges: [f64; D],
) -> anyhow::Result<Given> {
    let Some(Repeats { axes, tilt }) = Repeats::new(inputs)? else {
        return Ok(Given::from(scene));
    };
    let diameter = inputs.number(DIAMETER.name)?;
    let mut vectors = [[0.0; 3]; 3];
    for (k, edge) in edges.into_iter().enumerate() {
        // Nobody fills no box.
        vectors[k][k] = if inputs.n == 0 { diameter } else { edge * diameter };
    }
    if let Some(tilt) = tilt {
        vectors[1][0] = tilt * vectors[0][0];
    }
    let corner = inputs.number(OFFSET.name).unwrap_or(0.0) * diameter;
    let mut origin = [0.0; 3];
    origin[..D].fill(corner);
    Given::in_box(scene.into(), Lattice::new(vectors, axes, origin)?)
}
