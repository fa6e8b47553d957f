//! Very large and very small numbers, large offsets.
//!
//! ```text
//!   0 ........................................ 10^15 diameters ........ ooo
//!   2^-1074 .. 2^-537 (squares vanish below) .. 1 .. 2^511 (squares overflow above) .. 2^1024
//! ```

use crate::hard::Maker;
use crate::hard::build::*;

pub const MAKERS: &[Maker] = &[
    ("offset-1e6", |dim| far_lattice(dim, 1e6)),
    ("offset-1e9", |dim| far_lattice(dim, 1e9)),
    ("offset-1e12", |dim| far_lattice(dim, 1e12)),
    ("offset-1e15", |dim| far_lattice(dim, -1e15)),
    ("at-2-to-53", |dim| {
        let line: Vec<f64> =
            [-4.0, -3.0, -2.0, -1.0, 0.0, 2.0, 4.0, 6.0].map(|x| two_to(53) + x).to_vec();
        uniform(dim, &lines(dim, &line, two_to(53) + 100.0), 0.5)
    }),
    ("one-ulp-lattice", |dim| {
        uniform(dim, &lattice(dim, by_dim(dim, SITES), |k| 1.0 + two_to(-52) * k), two_to(-53))
    }),
    ("scale-1e-12", |dim| uniform(dim, &lattice(dim, by_dim(dim, SITES), |k| 1e-12 * k), 0.5e-12)),
    ("scale-1e-200", |dim| scaled_lattice(dim, two_to(-664))),
    ("squares-vanish-in-f32", |dim| scaled_lattice(dim, two_to(-80))),
    ("squares-are-subnormal", |dim| scaled_lattice(dim, two_to(-530))),
    ("subnormal-coordinates", |dim| scaled_lattice(dim, two_to(-1072))),
    ("least-numbers", |dim| {
        uniform(dim, &lattice(dim, by_dim(dim, SITES), |k| k * two_to(-1074)), two_to(-1074))
    }),
    ("squares-overflow", |dim| scaled_lattice(dim, two_to(600))),
    ("extent-overflows", |dim| {
        let far = two_to(1023);
        uniform(dim, &lines(dim, &[-far, -0.5 * far, 0.5 * far, far], 0.0), 0.5 * two_to(1022))
    }),
    ("largest-numbers", |dim| {
        uniform(dim, &[[f64::MAX, 0.0, 0.0], [-f64::MAX, 0.0, 0.0]], f64::MAX)
    }),
    ("large-beside-least", |dim| {
        let least = two_to(-1074);
        // Tangent; apart by a hair across; tangent with a hair across and a hair of radius
        // more.
        each(
            dim,
            &[
                ([0.0, 0.0, 0.0], 0.5),
                ([1.0, 0.0, 0.0], 0.5),
                ([4.0, 0.0, 0.0], 0.5),
                ([5.0, least, 0.0], 0.5),
                ([8.0, 0.0, 0.0], 0.5),
                ([9.0, least, 0.0], 0.5f64.next_up()),
            ],
        )
    }),
];

/// Sites per axis of the lattices here, in 2D and 3D.
const SITES: [u32; 2] = [12, 6];

fn far_lattice(dim: u32, offset: f64) -> Steps {
    uniform(dim, &lattice(dim, by_dim(dim, SITES), |k| offset + k), 0.5)
}

fn scaled_lattice(dim: u32, scale: f64) -> Steps {
    uniform(dim, &lattice(dim, by_dim(dim, SITES), |k| scale * k), 0.5 * scale)
}
