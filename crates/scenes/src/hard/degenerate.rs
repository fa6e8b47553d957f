//! Invalid numbers; scenes without, with one and with two particles; points, lines and planes.

use crate::hard::Maker;
use crate::hard::build::*;

pub const MAKERS: &[Maker] = &[
    ("nan-coordinate", |dim| spoilt(dim, |body| body.0[1] = f64::NAN)),
    ("infinite-coordinate", |dim| spoilt(dim, |body| body.0[0] = f64::INFINITY)),
    ("minus-infinite-coordinate", |dim| {
        spoilt(dim, |body| body.0[by_dim(dim, [1, 2])] = f64::NEG_INFINITY)
    }),
    ("nan-radius", |dim| spoilt(dim, |body| body.1 = f64::NAN)),
    ("infinite-radius", |dim| spoilt(dim, |body| body.1 = f64::INFINITY)),
    ("negative-radius", |dim| spoilt(dim, |body| body.1 = -3.0)),
    ("nothing-at-all", |dim| each(dim, [])),
    ("a-single-body", |dim| uniform(dim, [[3.0, -2.0, 7.0]], 1.0)),
    ("two-in-touch", |dim| uniform(dim, [[3.0, 4.0, 0.0], [0.0, 0.0, 0.0]], 2.5)),
    ("two-apart", |dim| uniform(dim, [[0.0; 3], [0.75; 3]], by_dim(dim, [0.5, 0.625]))),
    ("points-on-a-lattice", |dim| grid(dim, [15, 6], 0.0, |k| 0.1 * k)),
    ("points-in-couples", |dim| {
        let points = || lattice(dim, [15, 6], |k| 0.1 * k);
        uniform(dim, points().into_iter().chain(points()), 0.0)
    }),
    ("points-at-one-place", |dim| uniform(dim, [[0.3; 3]; 200], 0.0)),
    ("bodies-at-one-place", |dim| uniform(dim, [[-0.7, 0.3, 1e3]; 60], 1.0)),
    ("minus-zero-radius", |dim| uniform(dim, [[1.0; 3], [2.0; 3], [1.0; 3]], -0.0)),
    ("specks-far-apart", |dim| {
        uniform(dim, [[0.0; 3], [1e-100, 0.0, 0.0], [1.0, 0.0, 0.0]], 1e-100)
    }),
    ("all-on-one-x", |dim| on_a_plane(dim, 0)),
    ("all-on-one-y", |dim| on_a_plane(dim, 1)),
    ("all-on-one-z", |dim| on_a_plane(dim, 2)),
    ("collinear-diagonal", |dim| uniform(dim, places(300, |k| [k; 3]), 1.0)),
    ("coplanar-tilted", |dim| {
        // Neighbours differ by (1, 0, 1) or (0, 1.25, 0) and touch, because the diameter is 1.5.
        // Diagonals have length √3.5625 and do not touch.
        uniform(dim, places(400, |k: f64| [k % 20.0, 1.25 * (k / 20.0).floor(), k % 20.0]), 0.75)
    }),
];

/// Returns five particles; `spoil` changes particle 3.
fn spoilt(dim: u32, spoil: impl Fn(&mut Particle)) -> Steps {
    let mut particles: Vec<Particle> = of_size(places(5, |k| [k; 3]), 1.0).collect();
    spoil(&mut particles[3]);
    each(dim, particles)
}

/// Returns 400 particles at 1/3 on one axis: a touching row in 2D, a touching square in 3D.
fn on_a_plane(dim: u32, axis: usize) -> Steps {
    let width = by_dim(dim, [400.0, 20.0]);
    let at = |k: f64| {
        let (x, y) = (k % width, (k / width).floor());
        let mut place = [x, if axis == 2 { y } else { x }, y];
        place[axis] = 1.0 / 3.0;
        place
    };
    uniform(dim, places(400, at), 0.5)
}
