//! Periodic boxes: contacts between particles and images, including images of the particle itself.
//!
//! ```text
//!   |o .     o|o .     o|      through a face, on a face, outside, through several at once; boxes
//!   |    o    |    o    |      smaller than the reach, tilted, thin, far away
//! ```
//!
//! Each contact with an image counts once. Particles have diameter 1 and dyadic coordinates unless
//! a case states otherwise.

use crate::hard::Maker;
use crate::hard::build::*;

const ALL: [bool; 3] = [true; 3];
const X: [bool; 3] = [true, false, false];

pub const MAKERS: &[Maker] = &[
    ("own-images-through-faces", |dim| alone(dim, 0.55, cube(1.0), ALL)),
    ("own-images-through-edges", |dim| alone(dim, 0.75, cube(1.0), ALL)),
    ("own-images-through-corners", |dim| alone(dim, 0.9, cube(1.0), ALL)),
    ("own-images-two-boxes-away", |dim| alone(dim, 1.0, cube(1.0), ALL)),
    ("own-images-along-x-only", |dim| alone(dim, 0.55, cube(1.0), X)),
    ("own-images-along-x-and-z", |dim| alone(dim, 0.55, cube(1.0), [true, false, true])),
    ("in-touch-through-a-face", |dim| facing(dim, 0.0, 8.0)),
    ("a-last-bit-short-of-a-face", |dim| facing(dim, 0.0, 8f64.next_up())),
    ("a-last-bit-over-a-face", |dim| facing(dim, 0.0, 8f64.next_down())),
    ("two-contacts-of-one-pair", |dim| {
        in_box(uniform(dim, [[0.5, 1.0, 1.0], [1.5, 1.0, 1.0]], 0.5), edges([2.0, 9.0, 9.0]), X)
    }),
    ("barely-below-zero", |dim| quarter(dim, -5e-17)),
    ("barely-above-zero", |dim| quarter(dim, 5e-17)),
    ("an-image-that-rounds-into-touch", |dim| {
        in_box(uniform(dim, [[0.5; 3], [two_to(-60), 0.5, 0.5]], 0.25), cube(1.0), X)
    }),
    ("a-box-of-three-reaches", |dim| three(dim, 3.0)),
    ("a-box-just-under-three-reaches", |dim| three(dim, 3.0 - two_to(-40))),
    ("a-box-just-over-three-reaches", |dim| three(dim, 3.0 + two_to(-40))),
    ("a-box-of-two-reaches", |dim| in_box(grid(dim, [2; 2], 0.5, |k| k), cube(2.0), ALL)),
    ("a-lattice-through-all-faces", |dim| tiled(dim, 1.0, 0.0)),
    ("a-lattice-in-a-box-far-away", |dim| tiled(dim, 1.0, two_to(28))),
    ("a-lattice-at-a-tiny-scale", |dim| tiled(dim, two_to(-500), 0.0)),
    ("a-lattice-at-a-huge-scale", |dim| tiled(dim, two_to(500), 0.0)),
    ("a-lattice-of-thirds", |dim| {
        in_box(grid(dim, [6; 2], 0.5 / 3.0, |k| (k + 0.1) / 3.0), cube(2.0), ALL)
    }),
    ("outside-by-three-vectors", |dim| facing(dim, 24.0, 8.0)),
    ("outside-by-millions-of-vectors", |dim| facing(dim, two_to(31), 8.0)),
    ("on-both-faces", |dim| {
        in_box(uniform(dim, [[0.0, 2.0, 2.0], [4.0, 2.0, 2.0]], 0.5), cube(4.0), ALL)
    }),
    ("one-place-in-five-boxes", |dim| {
        let places = [0.0, 1.0, -2.0, 3.0, 64.0].map(|k| [0.375 + k, 0.25 - k, 0.5]);
        in_box(uniform(dim, places, 0.25), cube(1.0), ALL)
    }),
    ("from-corner-to-corner", |dim| {
        in_box(uniform(dim, [[0.25; 3], [7.75; 3]], 0.45), cube(8.0), ALL)
    }),
    ("points-on-both-faces", |dim| {
        in_box(uniform(dim, [0.0, 4.0, 2.0].map(|x| [x, 1.0, 1.0]), 0.0), cube(4.0), ALL)
    }),
    ("a-slab", |dim| {
        let places = [[0.25, 3.0, 0.25], [7.25, 3.0, 0.25], [0.25, 3.0, 7.25]];
        in_box(uniform(dim, places, 0.5), cube(8.0), [true, true, false])
    }),
    ("a-box-thinner-than-the-reach", |dim| {
        let places = [[8.0, 0.125, 1.0], [8.5, 0.125, 1.0]];
        in_box(uniform(dim, places, 0.5), edges([64.0, 0.25, 9.0]), [false, true, false])
    }),
    ("a-giant-larger-than-its-box", |dim| {
        let particles = [([0.5; 3], 2.0), ([0.25, 0.75, 0.5], 0.25), ([0.0; 3], 0.0)];
        in_box(each(dim, particles), cube(1.0), ALL)
    }),
    ("a-tilt-of-a-whole-edge", |dim| sheared(dim, 1.0, 0.0)),
    ("a-tilt-of-half-an-edge", |dim| sheared(dim, 0.5, 4.0)),
    ("a-negative-tilt", |dim| sheared(dim, -0.5, 4.0)),
    ("a-tilt-of-many-edges", |dim| sheared(dim, 5.5, 4.0)),
    ("other-vectors-of-the-unit-lattice", |dim| {
        alone(dim, 0.55, [[2.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]], ALL)
    }),
    ("a-rhombus", |dim| {
        alone(dim, 0.51, [[1.0, 0.0, 0.0], [0.5, 0.875, 0.0], [0.0, 0.0, 1.0]], ALL)
    }),
    ("the-primitive-cell-of-fcc", |dim| {
        alone(dim, 1.45, [[0.0, 2.0, 2.0], [2.0, 0.0, 2.0], [2.0, 2.0, 0.0]], ALL)
    }),
    ("nobody-in-a-box", |dim| in_box(uniform(dim, [], 0.5), cube(1.0), ALL)),
];

fn edges([x, y, z]: [f64; 3]) -> [Place; 3] {
    [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]]
}

fn cube(edge: f64) -> [Place; 3] {
    edges([edge; 3])
}

fn alone(dim: u32, r: f64, vectors: [Place; 3], periodic: [bool; 3]) -> Steps {
    in_box(uniform(dim, [[0.25; 3]], r), vectors, periodic)
}

/// Returns two particles that touch through the face across x if `away` is 0 and `edge`, the edge
/// of the box, is 8.
fn facing(dim: u32, away: f64, edge: f64) -> Steps {
    in_box(uniform(dim, [[0.25 + away, 3.0, 3.0], [7.25, 3.0, 3.0]], 0.5), cube(edge), ALL)
}

fn quarter(dim: u32, x: f64) -> Steps {
    in_box(uniform(dim, [[x, 0.5, 0.5], [0.75, 0.5, 0.5]], 0.125), cube(1.0), ALL)
}

fn three(dim: u32, edge: f64) -> Steps {
    in_box(uniform(dim, places(3, |k| [k, 1.0, 1.0]), 0.5), edges([edge, 9.0, 9.0]), X)
}

/// Returns a lattice of 6 (2D) or 4 (3D) sites per axis that continues through the faces.
fn tiled(dim: u32, scale: f64, offset: f64) -> Steps {
    let edge = by_dim(dim, [6.0, 4.0]) * scale;
    in_box(grid(dim, [6, 4], 0.5 * scale, |k| (offset + 0.25 + k) * scale), cube(edge), ALL)
}

/// Returns two particles, `aside` apart along x, in touch through the y faces of a sheared box.
fn sheared(dim: u32, tilt: f64, aside: f64) -> Steps {
    let places = [[1.0, 0.25, 3.0], [1.0 + aside, 7.25, 3.0]];
    let vectors = [[8.0, 0.0, 0.0], [8.0 * tilt, 8.0, 0.0], [0.0, 0.0, 8.0]];
    in_box(uniform(dim, places, 0.5), vectors, ALL)
}
