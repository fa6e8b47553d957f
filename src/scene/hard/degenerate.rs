//! Invalid numbers; none, one and two particles; points, lines and planes.

use crate::scene::hard::build::*;
use crate::scene::hard::{Allowed, Case, Expect, Group};

const DEGENERATE: Case = Case::in_group(Group::Degenerate);
const INVALID: Case = Case { expect: Expect::Invalid, ..DEGENERATE };

pub const CASES: &[Case] = &[
    Case {
        name: "nan-coordinate",
        reason: "NaN compares false with everything: it falls out of every box, and poisons xmin \
                 or is skipped by min",
        source: "PointNeighbors.jl#64, rapier#350",
        make: |dim| spoilt(dim, |body| body.0[1] = f64::NAN),
        ..INVALID
    },
    Case {
        name: "infinite-coordinate",
        reason: "xmax is ∞, the number of cells too, and the place in them NaN",
        make: |dim| spoilt(dim, |body| body.0[0] = f64::INFINITY),
        ..INVALID
    },
    Case {
        name: "minus-infinite-coordinate",
        reason: "xmin is -∞: x - xmin is ∞ for all others",
        make: |dim| spoilt(dim, |body| body.0[by_dim(dim, [1, 2])] = f64::NEG_INFINITY),
        ..INVALID
    },
    Case {
        name: "nan-radius",
        reason: "a largest radius that is found with > ignores NaN, one that is found otherwise \
                 becomes NaN",
        make: |dim| spoilt(dim, |body| body.1 = f64::NAN),
        ..INVALID
    },
    Case {
        name: "infinite-radius",
        reason: "cells of infinite edge; the body touches all others, but ∞ - ∞ is NaN",
        make: |dim| spoilt(dim, |body| body.1 = f64::INFINITY),
        ..INVALID
    },
    Case {
        name: "negative-radius",
        reason: "a squared sum of radii forgets the sign: -3 and 1 reach 2",
        make: |dim| spoilt(dim, |body| body.1 = -3.0),
        ..INVALID
    },
    Case {
        name: "nothing-at-all",
        reason: "no particle: the box is empty, xmin > xmax, the largest radius is that of nobody",
        source: "CellListMap#79",
        expect: Expect::Contacts([0, 0]),
        make: |dim| each(dim, &[]),
        ..DEGENERATE
    },
    Case {
        name: "a-single-body",
        reason: "one particle: the box has no extent, and it may be found in contact with \
                 itself",
        source: "CellListMap#79",
        expect: Expect::Contacts([0, 0]),
        make: |dim| uniform(dim, &[[3.0, -2.0, 7.0]], 1.0),
        ..DEGENERATE
    },
    Case {
        name: "two-in-touch",
        reason: "two particles: trees without an inner node, sorts of one comparison",
        source: "CellListMap#79",
        expect: Expect::Contacts([1, 1]),
        make: |dim| uniform(dim, &[[3.0, 4.0, 0.0], [0.0, 0.0, 0.0]], 2.5),
        ..DEGENERATE
    },
    Case {
        name: "two-apart",
        reason: "two particles in opposite corners of neighbouring cells: what is in reach by \
                 cells is not in touch",
        source: "CellListMap#79",
        expect: Expect::Contacts([0, 0]),
        make: |dim| uniform(dim, &[[0.0; 3], [0.75; 3]], by_dim(dim, [0.5, 0.625])),
        ..DEGENERATE
    },
    Case {
        name: "points-on-a-lattice",
        reason: "radius 0: cells of edge 0, quotients of x/0",
        expect: Expect::Contacts([0, 0]),
        make: |dim| uniform(dim, &lattice(dim, by_dim(dim, [15, 6]), |k| 0.1 * k), 0.0),
        ..DEGENERATE
    },
    Case {
        name: "points-in-couples",
        reason: "radius 0, two at every site: distance 0 is contact, 0 <= 0, for a closed test \
                 only",
        source: "CGAL#3077",
        expect: Expect::Contacts([15 * 15, 6 * 6 * 6]),
        make: |dim| {
            uniform(
                dim,
                &[
                    lattice(dim, by_dim(dim, [15, 6]), |k| 0.1 * k),
                    lattice(dim, by_dim(dim, [15, 6]), |k| 0.1 * k),
                ]
                .concat(),
                0.0,
            )
        },
        ..DEGENERATE
    },
    Case {
        name: "points-at-one-place",
        reason: "no extent and no radius at all: 0/0, and trees that split until the halves \
                 differ never end",
        source: "CGAL#3077",
        expect: Expect::Contacts([pairs(200), pairs(200)]),
        make: |dim| uniform(dim, &[[0.3; 3]; 200], 0.0),
        ..DEGENERATE
    },
    Case {
        name: "bodies-at-one-place",
        reason: "coincident bodies: all keys equal, direction of contact undefined",
        source: "CGAL#3077",
        expect: Expect::Contacts([pairs(60), pairs(60)]),
        make: |dim| uniform(dim, &[[-0.7, 0.3, 1e3]; 60], 1.0),
        ..DEGENERATE
    },
    Case {
        name: "minus-zero-radius",
        reason: "a radius of -0 is a radius of 0, not a negative one",
        expect: Expect::Contacts([1, 1]),
        make: |dim| uniform(dim, &[[1.0; 3], [2.0; 3], [1.0; 3]], -0.0),
        ..DEGENERATE
    },
    Case {
        name: "specks-far-apart",
        reason: "bodies of radius 10^-100 in a box of extent 1: cells as small as the reach are \
                 beyond number",
        expect: Expect::Contacts([1, 1]),
        allows: &[Allowed::Domain],
        make: |dim| uniform(dim, &[[0.0; 3], [1e-100, 0.0, 0.0], [1.0, 0.0, 0.0]], 1e-100),
        ..DEGENERATE
    },
    Case {
        name: "all-on-one-x",
        reason: "all equal on x: a split at the median of x leaves one half empty, a sweep along \
                 x tests every pair",
        source: "kiddo#475",
        expect: Expect::Contacts([399, 20 * 19 * 2]),
        make: |dim| on_a_plane(dim, 0),
        ..DEGENERATE
    },
    Case {
        name: "all-on-one-y",
        reason: "all equal on y: one row of cells, nothing below and nothing above",
        source: "kiddo#475",
        expect: Expect::Contacts([399, 20 * 19 * 2]),
        make: |dim| on_a_plane(dim, 1),
        ..DEGENERATE
    },
    Case {
        name: "all-on-one-z",
        dims: &[3],
        reason: "all equal on z: one layer of cells, the plane as a case of space",
        source: "kiddo#475",
        expect: Expect::Contacts([0, 20 * 19 * 2]),
        make: |dim| on_a_plane(dim, 2),
        ..DEGENERATE
    },
    Case {
        name: "collinear-diagonal",
        reason: "bodies on a line with coordinates that are all equal: orderings by x, y and z \
                 are one",
        expect: Expect::Contacts([299, 299]),
        make: |dim| uniform(dim, &(0..300).map(|k| [f64::from(k); 3]).collect::<Vec<_>>(), 1.0),
        ..DEGENERATE
    },
    Case {
        name: "coplanar-tilted",
        dims: &[3],
        reason: "bodies on the plane z = x: no axis is flat, most cells of the box are empty",
        expect: Expect::Contacts([0, 20 * 19 * 2]),
        make: |dim| {
            // Steps of (1, 0, 1) and (0, 1.25, 0) with reach 1.5: √2 and 1.25 touch, the diagonal
            // is √3.5625.
            let places =
                (0..400).map(|k| [f64::from(k % 20), 1.25 * f64::from(k / 20), f64::from(k % 20)]);
            uniform(dim, &places.collect::<Vec<_>>(), 0.75)
        },
        ..DEGENERATE
    },
];

/// Five bodies, of which number 3 is spoilt.
fn spoilt(dim: u32, spoil: impl Fn(&mut (Place, f64))) -> Steps {
    let mut bodies: Vec<(Place, f64)> = (0..5).map(|k| ([f64::from(k); 3], 1.0)).collect();
    spoil(&mut bodies[3]);
    each(dim, &bodies)
}

/// 400 bodies, all at 1/3 on one axis: a touching row in 2D, a touching square in 3D.
fn on_a_plane(dim: u32, axis: usize) -> Steps {
    let width = by_dim(dim, [400, 20]);
    let places = (0..400).map(|k| {
        let mut place = [f64::from(k % width), f64::from(k % width), f64::from(k / width)];
        if axis == 2 {
            place[1] = place[2];
        }
        place[axis] = 1.0 / 3.0;
        place
    });
    uniform(dim, &places.collect::<Vec<_>>(), 0.5)
}
