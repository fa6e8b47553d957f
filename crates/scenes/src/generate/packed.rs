//! `packed`: a jittered lattice, as dense as a granular pack.
//!
//! ```text
//!    hexagonal        square            fcc (z layers)
//!   o o o o o o      o o o o o        o   o     o   o
//!    o o o o o o     o o o o o          o         o       layers alternate
//!   o o o o o o      o o o o o        o   o     o   o
//! ```
//!
//! The sites are a near-square or near-cubic block of a lattice, with nearest neighbours `spacing`
//! apart. Particles occupy the first N sites, with x fastest, then y, then z. Each coordinate is
//! moved by a uniform number in ± `jitter`. By default about 58% of the lattice neighbours touch:
//! 3.5 contacts per particle in 2D and 6.9 in 3D, as in a dense granular pack. Without jitter,
//! coordinates of square and cubic sites are i·spacing·diameter, rounded once; they are exact if
//! spacing and diameter are dyadic.
//!
//! `periodic` continues the lattice through the faces of the box. Hexagonal and fcc lattices then
//! have an even number of rows and layers. Sites after the last particle stay empty. All sites are
//! filled in fcc if n = 4·k³, in cubic if n = k³, and in square if n = k².

use std::f64::consts::FRAC_1_SQRT_2;

use crate::generate::boxes::{PERIODIC, boxed};
use crate::generate::draw::Draw;
use crate::generate::sizes::unit_radii;
use crate::generate::table::{Generator, Parameter, ParameterKind, parameter};
use crate::generate::{Inputs, OF_PARTICLES, assemble};
use contactbench_ground::scene::{AnyScene, Scene};
use contactbench_io::Given;

pub const GENERATOR: Generator = Generator {
    name: "packed",
    summary: "jittered lattice that overlaps and touches like a dense granular pack",
    params: &[
        OF_PARTICLES,
        &[
            Parameter {
                name: "lattice",
                kind: ParameterKind::Word([&["hexagonal", "square"], &["fcc", "cubic"]]),
                default: ["hexagonal", "fcc"],
                meaning: "arrangement of the sites",
            },
            parameter(
                "spacing",
                ParameterKind::POSITIVE,
                "0.99",
                "distance of nearest sites, in diameters",
            ),
            parameter(
                "jitter",
                ParameterKind::NOT_NEGATIVE,
                "0.05",
                "each coordinate moves uniformly within ± this, in diameters",
            ),
        ],
    ],
    make: |inputs| {
        let (lattice, n) = (inputs.text("lattice")?, inputs.n);
        let repeats = inputs.params.contains_key(PERIODIC.name);
        if inputs.dim == 2 {
            let (site, period) = plane(lattice, n);
            make(inputs, site, period)
        } else {
            let (site, period) = space(lattice, n, repeats);
            make(inputs, site, period)
        }
    },
    ..Generator::PLAIN
};

fn make<const D: usize>(
    inputs: &Inputs<'_>,
    site: impl Fn(u64) -> [f64; D],
    period: [f64; D],
) -> anyhow::Result<Given>
where
    AnyScene<'static>: From<Scene<'static, f64, D>>,
{
    let mut draw = Draw::new(inputs.seed);
    let radii = unit_radii(inputs, &mut draw)?;
    let (spacing, jitter) = (inputs.number("spacing")?, inputs.number("jitter")?);
    let centres = (0..inputs.n).map(|k| site(k).map(|x| x * spacing + jitter * draw.symmetric()));
    let scene = assemble(inputs, centres, radii)?;
    boxed(inputs, scene, period.map(|edge| edge * spacing))
}

/// Returns a function from number to lattice site in 2D, and the edges of the period, for spacing
/// 1.
fn plane(lattice: &str, n: u64) -> (impl Fn(u64) -> [f64; 2] + use<>, [f64; 2]) {
    let square = lattice == "square";
    let pitch = if square { 1.0 } else { 3f64.sqrt() / 2.0 };
    let columns = ((n as f64 * pitch).sqrt().ceil() as u64).max(1);
    let rows = n.div_ceil(columns).max(1).next_multiple_of(if square { 1 } else { 2 });
    let site = move |k| {
        let (column, row) = (k % columns, k / columns);
        let shift = if square || row % 2 == 0 { 0.0 } else { 0.5 };
        [column as f64 + shift, row as f64 * pitch]
    };
    (site, [columns as f64, rows as f64 * pitch])
}

/// Returns a function from number to lattice site in 3D, and the edges of the period, for spacing
/// 1. The fcc sites are the points of a cubic lattice of edge 1/√2 whose indices have an even sum.
///
/// A periodic fcc lattice has an even number of cubic points along each axis.
fn space(lattice: &str, n: u64, repeats: bool) -> (impl Fn(u64) -> [f64; 3] + use<>, [f64; 3]) {
    let cubic = lattice == "cubic";
    let even = if cubic { 1 } else { 2 };
    let rows = if cubic { root(n) } else { root(2 * n) };
    let rows = if repeats { rows.next_multiple_of(even) } else { rows };
    let columns = if cubic { rows } else { rows.div_ceil(2) };
    let layers = n.div_ceil(columns * rows).max(1).next_multiple_of(even);
    let site = move |k| {
        let (column, row, layer) = (k % columns, k / columns % rows, k / columns / rows);
        if cubic {
            [column as f64, row as f64, layer as f64]
        } else {
            [2 * column + (row + layer) % 2, row, layer].map(|i| i as f64 * FRAC_1_SQRT_2)
        }
    };
    let edge = if cubic { 1.0 } else { FRAC_1_SQRT_2 };
    (site, [columns * even, rows, layers].map(|i| i as f64 * edge))
}

/// Returns the smallest whole number >= 1 whose cube is at least `n` <= 2^33. Integers are
/// compared, because a rounded cube root may be off by one.
fn root(n: u64) -> u64 {
    let near = libm::cbrt(n as f64) as u64;
    (near.saturating_sub(1)..).find(|edge| edge * edge * edge >= n).unwrap_or(near).max(1)
}
