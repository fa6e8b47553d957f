//! `packed`: a jittered lattice, as dense as a granular pack.
//!
//! ```text
//!    hexagonal        square            fcc (z layers)
//!   o o o o o o      o o o o o        o   o     o   o
//!    o o o o o o     o o o o o          o         o       layers alternate
//!   o o o o o o      o o o o o        o   o     o   o
//! ```
//!
//! A near-square or near-cubic block of lattice sites, nearest neighbours `spacing` apart, the
//! first N in the order x fastest, then y, then z. Each coordinate is moved by a number uniform in
//! ± `jitter`. At the defaults about 58% of the lattice neighbours touch: 3.5 contacts per particle
//! in 2D and 6.9 in 3D, as in a dense granular pack. Square and cubic sites without jitter are
//! exactly i·spacing·diameter (one rounding each, none where spacing and diameter are dyadic).

use crate::scene::generate::draw::Draw;
use crate::scene::generate::sizes::{
    EXPONENT, GIANTS, GRADING, SHARE, SIZE_RATIO, SIZES, unit_radii,
};
use crate::scene::generate::table::{Generator, Kind, Parameter, Preset, no_history};
use crate::scene::generate::{DIAMETER, Inputs, OFFSET, assemble};
use crate::scene::{AnyScene, Scene};

/// The table line.
pub const GENERATOR: Generator = Generator {
    name: "packed",
    dims: &[2, 3],
    summary: "jittered lattice that overlaps and touches like a dense granular pack",
    own_n: false,
    params: &[
        DIAMETER,
        OFFSET,
        SIZE_RATIO,
        SIZES,
        EXPONENT,
        SHARE,
        GIANTS,
        GRADING,
        Parameter {
            name: "lattice",
            kind: Kind::Word([&["hexagonal", "square"], &["fcc", "cubic"]]),
            default: [Preset::Word("hexagonal"), Preset::Word("fcc")],
            meaning: "arrangement of the sites",
        },
        Parameter {
            name: "spacing",
            kind: Kind::Positive,
            default: [Preset::Number(0.99); 2],
            meaning: "distance of nearest sites, in diameters",
        },
        Parameter {
            name: "jitter",
            kind: Kind::NotNegative,
            default: [Preset::Number(0.05); 2],
            meaning: "each coordinate moves uniformly within ± this, in diameters",
        },
    ],
    make: |inputs| {
        Ok(match (inputs.dim, inputs.text("lattice")?) {
            (2, lattice) => AnyScene::from(make(inputs, plane(lattice, inputs.n))?),
            (_, lattice) => AnyScene::from(make(inputs, space(lattice, inputs.n))?),
        })
    },
    history: no_history,
};

fn make<const D: usize>(
    inputs: &Inputs<'_>,
    site: impl Fn(u64) -> [f64; D],
) -> anyhow::Result<Scene<'static, f64, D>> {
    let mut draw = Draw::new(inputs.seed);
    let radii = unit_radii(inputs, &mut draw)?;
    let (spacing, jitter) = (inputs.number("spacing")?, inputs.number("jitter")?);
    let centres = (0..inputs.n).map(|k| site(k).map(|x| x * spacing + jitter * draw.symmetric()));
    assemble(inputs, centres, radii)
}

/// Site k of a plane lattice, for a spacing of 1.
fn plane(lattice: &str, n: u64) -> impl Fn(u64) -> [f64; 2] + use<> {
    let square = lattice == "square";
    let pitch = if square { 1.0 } else { 3f64.sqrt() / 2.0 };
    let columns = ((n as f64 * pitch).sqrt().ceil() as u64).max(1);
    move |k| {
        let (column, row) = (k % columns, k / columns);
        let shift = if square || row % 2 == 0 { 0.0 } else { 0.5 };
        [column as f64 + shift, row as f64 * pitch]
    }
}

/// Site k of a space lattice, for a spacing of 1. The fcc sites are the points of a cubic lattice
/// of edge 1/√2 whose three indices have an even sum.
fn space(lattice: &str, n: u64) -> impl Fn(u64) -> [f64; 3] + use<> {
    let cubic = lattice == "cubic";
    let rows = if cubic { root(n) } else { root(2 * n) };
    let columns = if cubic { rows } else { rows.div_ceil(2) };
    move |k| {
        let (column, row, layer) = (k % columns, k / columns % rows, k / columns / rows);
        if cubic {
            [column as f64, row as f64, layer as f64]
        } else {
            [2 * column + (row + layer) % 2, row, layer]
                .map(|i| i as f64 * std::f64::consts::FRAC_1_SQRT_2)
        }
    }
}

/// The smallest whole number >= 1 whose cube is at least `n` <= 2^33. In integers, as a rounded
/// cube root may be one off.
fn root(n: u64) -> u64 {
    let near = libm::cbrt(n as f64) as u64;
    (near.saturating_sub(1)..).find(|edge| edge * edge * edge >= n).unwrap_or(near).max(1)
}
