//! Boxes of generated scenes.
//!
//! Generators that fill a square or cube can make it periodic along all or some axes:
//! `periodic=true`, `periodic=xy`. Particles outside the box keep their coordinates. A `tilt`
//! shears the box as in Lees and Edwards (1972, doi:10.1088/0022-3719/5/15/006): it moves the
//! images above and below along x, so that the vectors are
//!
//! ```text
//! (lx, 0, 0), (tilt·lx, ly, 0), (0, 0, lz).
//! ```

use anyhow::ensure;

use crate::generate::draw::Draw;
use crate::generate::sizes::unit_radii;
use crate::generate::table::{Parameter, ParameterKind, optional};
use crate::generate::{DIAMETER, Inputs, OFFSET, assemble, box_edge};
use contactbench_ground::scene::{AnyScene, Lattice, Scene};
use contactbench_io::Given;
use contactbench_io::boxes::Axes;

pub const PERIODIC: Parameter = optional(
    "periodic",
    ParameterKind::Axes,
    "makes the box periodic: true, or the axes, such as x or xy, or none",
);

pub const TILT: Parameter = optional(
    "tilt",
    ParameterKind::FINITE,
    "shift of the images along y, in edges of the box along x",
);

#[derive(Clone, Copy, Debug)]
pub struct Repeats {
    pub axes: [bool; 3],
    /// Displacement along x of the images above, in edges along x.
    pub tilt: Option<f64>,
}

impl Repeats {
    /// Returns `None` for a scene without a box.
    pub fn new(inputs: &Inputs<'_>) -> anyhow::Result<Option<Repeats>> {
        let tilt = inputs.number(TILT.name).ok();
        let Ok(text) = inputs.text(PERIODIC.name) else {
            ensure!(tilt.is_none(), "a tilt needs a periodic box: add periodic=true");
            return Ok(None);
        };
        let axes = text.parse::<Axes>().map_err(anyhow::Error::msg)?.of(inputs.dim as usize);
        let none = axes == [false; 3] || tilt.is_none_or(|tilt| tilt == 0.0);
        ensure!(axes[1] || none, "a tilt shifts images along y; the box is not periodic along y");
        Ok(Some(Repeats { axes, tilt }))
    }
}

/// Makes a scene in a square or cube that the particles fill to the parameter `fraction`. `centre`
/// returns the centre of the particle with the given index; it also gets the edge, in diameters.
pub fn filled<const D: usize>(
    inputs: &Inputs<'_>,
    mut centre: impl FnMut(&mut Draw, f64, u64) -> [f64; D],
) -> anyhow::Result<Given>
where
    AnyScene<'static>: From<Scene<'static, f64, D>>,
{
    let mut draw = Draw::new(inputs.seed);
    let radii = unit_radii(inputs, &mut draw)?;
    let edge = box_edge::<D>(inputs.n, radii.as_deref(), inputs.number("fraction")?);
    let centres = (0..inputs.n).map(|k| centre(&mut draw, edge, k));
    boxed(inputs, assemble(inputs, centres, radii)?, [edge; D])
}

/// Puts the scene into its box, if it has one. `edges` are in diameters.
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
        // Without particles the edges would be 0.
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
