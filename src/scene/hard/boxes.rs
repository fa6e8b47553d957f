//! Boxes that repeat: what goes wrong where particles meet images of each other, and of themselves.
//!
//! ```text
//!   |o .     o|o .     o|      through a face, on a face, outside, through several at once; boxes
//!   |    o    |    o    |      smaller than the reach, tilted, thin, far away
//! ```
//!
//! Contacts are counted with their images, each once. Unless a case says otherwise bodies have the
//! diameter 1, and coordinates are dyadic.

use crate::scene::hard::build::*;
use crate::scene::hard::{Case, Expect, Group};

const BOXES: Case = Case::in_group(Group::Boxes);
const ALL: [bool; 3] = [true; 3];
const X: [bool; 3] = [true, false, false];

pub const CASES: &[Case] = &[
    Case {
        name: "own-images-through-faces",
        reason: "a particle meets its own images, and nobody else is there: pairs i < j miss all",
        source: "matscipy tests/test_neighbours.py: one body in a unit cube, cutoff 1.1",
        expect: Expect::Contacts([2, 3]),
        make: |dim| in_box(uniform(dim, &[[0.25; 3]], 0.55), cube(1.0), ALL),
        ..BOXES
    },
    Case {
        name: "own-images-through-edges",
        reason: "images that are shifted along two vectors at once",
        source: "matscipy tests/test_neighbours.py: cutoff 1.5",
        expect: Expect::Contacts([4, 9]),
        make: |dim| in_box(uniform(dim, &[[0.25; 3]], 0.75), cube(1.0), ALL),
        ..BOXES
    },
    Case {
        name: "own-images-through-corners",
        reason: "images that are shifted along all vectors at once",
        expect: Expect::Contacts([4, 13]),
        make: |dim| in_box(uniform(dim, &[[0.25; 3]], 0.9), cube(1.0), ALL),
        ..BOXES
    },
    Case {
        name: "own-images-two-boxes-away",
        reason: "the second image along a vector is exactly in touch: one image to either side is \
                 not enough",
        expect: Expect::Contacts([6, 16]),
        make: |dim| in_box(uniform(dim, &[[0.25; 3]], 1.0), cube(1.0), ALL),
        ..BOXES
    },
    Case {
        name: "own-images-along-x-only",
        reason: "the box repeats along one vector, and is shorter than the reach along all",
        source: "matscipy tests/test_neighbours.py: pbc along x",
        expect: Expect::Contacts([1, 1]),
        make: |dim| in_box(uniform(dim, &[[0.25; 3]], 0.55), cube(1.0), X),
        ..BOXES
    },
    Case {
        name: "own-images-along-x-and-z",
        dims: &[3],
        reason: "open along the vector in the middle",
        source: "matscipy tests/test_neighbours.py: pbc along x and z",
        expect: Expect::Contacts([0, 2]),
        make: |dim| in_box(uniform(dim, &[[0.25; 3]], 0.55), cube(1.0), [true, false, true]),
        ..BOXES
    },
    Case {
        name: "in-touch-through-a-face",
        reason: "two bodies exactly in touch through a face of a wide box",
        source: "NeighbourLists.jl#6: two atoms 1.0 apart in a box of 8",
        expect: Expect::Contacts([1, 1]),
        make: |dim| in_box(uniform(dim, &facing(0.0), 0.5), cube(8.0), ALL),
        ..BOXES
    },
    Case {
        name: "a-last-bit-short-of-a-face",
        reason: "as in-touch-through-a-face, in a box whose edge is a last bit longer: no image \
                 touches, and a coordinate of one, rounded, says that it does",
        expect: Expect::Contacts([0, 0]),
        make: |dim| in_box(uniform(dim, &facing(0.0), 0.5), cube(8f64.next_up()), ALL),
        ..BOXES
    },
    Case {
        name: "a-last-bit-over-a-face",
        reason: "as in-touch-through-a-face, in a box whose edge is a last bit shorter",
        expect: Expect::Contacts([1, 1]),
        make: |dim| in_box(uniform(dim, &facing(0.0), 0.5), cube(8f64.next_down()), ALL),
        ..BOXES
    },
    Case {
        name: "two-contacts-of-one-pair",
        reason: "the box is exactly twice the distance: the pair touches on both sides, and is two \
                 contacts, not one",
        source: "FreeBird.jl#150: images counted once",
        expect: Expect::Contacts([2, 2]),
        make: |dim| {
            in_box(
                uniform(dim, &[[0.5, 1.0, 1.0], [1.5, 1.0, 1.0]], 0.5),
                edges([2.0, 9.0, 9.0]),
                X,
            )
        },
        ..BOXES
    },
    Case {
        name: "barely-below-zero",
        reason: "a coordinate of -5e-17, which a box of edge 1 wraps to 1.0, outside of it",
        source: "NeighbourLists.jl#28 and #38",
        expect: Expect::Contacts([1, 1]),
        make: |dim| in_box(uniform(dim, &quarter(-5e-17), 0.125), cube(1.0), ALL),
        ..BOXES
    },
    Case {
        name: "barely-above-zero",
        reason: "as barely-below-zero, on the other side: the image is too far by less than a last \
                 bit of its coordinate",
        expect: Expect::Contacts([0, 0]),
        make: |dim| in_box(uniform(dim, &quarter(5e-17), 0.125), cube(1.0), ALL),
        ..BOXES
    },
    Case {
        name: "an-image-that-rounds-into-touch",
        reason: "the image of a particle at 2^-60 lies at 1 + 2^-60, which rounds to 1: there it \
                 would touch",
        expect: Expect::Contacts([1, 1]),
        make: |dim| {
            let places = [[0.5, 0.5, 0.5], [two_to(-60), 0.5, 0.5]];
            in_box(uniform(dim, &places, 0.25), cube(1.0), X)
        },
        ..BOXES
    },
    Case {
        name: "a-box-of-three-reaches",
        reason: "three bodies that touch around a box of exactly three reaches: as many cells as \
                 there are neighbours, so that a cell is the neighbour of another on both sides",
        source: "GPUMD#190",
        expect: Expect::Contacts([3, 3]),
        make: |dim| in_box(uniform(dim, &row(3), 0.5), edges([3.0, 9.0, 9.0]), X),
        ..BOXES
    },
    Case {
        name: "a-box-just-under-three-reaches",
        reason: "as a-box-of-three-reaches, a little shorter: only two cells fit",
        source: "GPUMD#190: neighbours lost near x = 0",
        expect: Expect::Contacts([3, 3]),
        make: |dim| in_box(uniform(dim, &row(3), 0.5), edges([3.0 - two_to(-40), 9.0, 9.0]), X),
        ..BOXES
    },
    Case {
        name: "a-box-just-over-three-reaches",
        reason: "as a-box-of-three-reaches, a little longer: the last contact is gone",
        source: "GPUMD#190",
        expect: Expect::Contacts([2, 2]),
        make: |dim| in_box(uniform(dim, &row(3), 0.5), edges([3.0 + two_to(-40), 9.0, 9.0]), X),
        ..BOXES
    },
    Case {
        name: "a-box-of-two-reaches",
        reason: "two cells along each axis: every cell is its neighbour's neighbour on both sides",
        expect: Expect::Contacts([8, 24]),
        make: |dim| in_box(uniform(dim, &lattice(dim, 2, |k| k), 0.5), cube(2.0), ALL),
        ..BOXES
    },
    Case {
        name: "a-lattice-through-all-faces",
        reason: "a lattice exactly in touch that goes on through the faces: every body has all of \
                 its neighbours, each once",
        expect: Expect::Contacts([2 * 36, 3 * 64]),
        make: |dim| tiled(dim, 1.0, 0.0),
        ..BOXES
    },
    Case {
        name: "a-lattice-in-a-box-far-away",
        reason: "as a-lattice-through-all-faces, 2^28 from the origin: all are outside of the box \
                 at the origin, by many vectors",
        expect: Expect::Contacts([2 * 36, 3 * 64]),
        make: |dim| tiled(dim, 1.0, two_to(28)),
        ..BOXES
    },
    Case {
        name: "a-lattice-at-a-tiny-scale",
        reason: "as a-lattice-through-all-faces, where squares of distances nearly vanish",
        expect: Expect::Contacts([2 * 36, 3 * 64]),
        make: |dim| tiled(dim, two_to(-500), 0.0),
        ..BOXES
    },
    Case {
        name: "a-lattice-at-a-huge-scale",
        reason: "as a-lattice-through-all-faces, where squares of distances nearly overflow",
        expect: Expect::Contacts([2 * 36, 3 * 64]),
        make: |dim| tiled(dim, two_to(500), 0.0),
        ..BOXES
    },
    Case {
        name: "a-lattice-of-thirds",
        reason: "coordinates that are no doubles, in a box whose edge is one: what touches is for \
                 the numbers as given to say, not for the lattice",
        make: |dim| {
            let places = lattice(dim, 6, |k| (k + 0.1) / 3.0);
            in_box(uniform(dim, &places, 0.5 / 3.0), cube(2.0), ALL)
        },
        ..BOXES
    },
    Case {
        name: "outside-by-three-vectors",
        reason: "a particle that is three vectors outside of its box, as after a long run: its \
                 image is -3, not one beside the box",
        source: "NeighbourLists.jl#6; lammps#1378",
        expect: Expect::Contacts([1, 1]),
        make: |dim| in_box(uniform(dim, &facing(24.0), 0.5), cube(8.0), ALL),
        ..BOXES
    },
    Case {
        name: "outside-by-millions-of-vectors",
        reason: "as outside-by-three-vectors, 2^28 of them",
        expect: Expect::Contacts([1, 1]),
        make: |dim| in_box(uniform(dim, &facing(two_to(31)), 0.5), cube(8.0), ALL),
        ..BOXES
    },
    Case {
        name: "on-both-faces",
        reason: "one particle at 0 and one at the edge's length, which is the same place",
        expect: Expect::Contacts([1, 1]),
        make: |dim| in_box(uniform(dim, &[[0.0, 2.0, 2.0], [4.0, 2.0, 2.0]], 0.5), cube(4.0), ALL),
        ..BOXES
    },
    Case {
        name: "one-place-in-five-boxes",
        reason: "five particles that differ by whole vectors: all lie upon each other",
        expect: Expect::Contacts([pairs(5), pairs(5)]),
        make: |dim| {
            let places = [0.0, 1.0, -2.0, 3.0, 64.0].map(|k| [0.375 + k, 0.25 - k, 0.5]);
            in_box(uniform(dim, &places, 0.25), cube(1.0), ALL)
        },
        ..BOXES
    },
    Case {
        name: "from-corner-to-corner",
        reason: "a contact through all faces at once",
        expect: Expect::Contacts([1, 1]),
        make: |dim| in_box(uniform(dim, &[[0.25; 3], [7.75; 3]], 0.45), cube(8.0), ALL),
        ..BOXES
    },
    Case {
        name: "points-on-both-faces",
        reason: "radii of zero: points touch where they coincide, here through a face",
        expect: Expect::Contacts([1, 1]),
        make: |dim| {
            let places = [[0.0, 1.0, 1.0], [4.0, 1.0, 1.0], [2.0, 1.0, 1.0]];
            in_box(uniform(dim, &places, 0.0), cube(4.0), ALL)
        },
        ..BOXES
    },
    Case {
        name: "a-slab",
        dims: &[3],
        reason: "open along z: what would touch through the floor does not",
        expect: Expect::Contacts([0, 1]),
        make: |dim| {
            let places = [[0.25, 3.0, 0.25], [7.25, 3.0, 0.25], [0.25, 3.0, 7.25]];
            in_box(uniform(dim, &places, 0.5), cube(8.0), [true, true, false])
        },
        ..BOXES
    },
    Case {
        name: "a-box-thinner-than-the-reach",
        reason: "four of its own images to either side, and seven of the other's",
        expect: Expect::Contacts([15, 15]),
        make: |dim| {
            let places = [[8.0, 0.125, 1.0], [8.5, 0.125, 1.0]];
            in_box(uniform(dim, &places, 0.5), edges([64.0, 0.25, 9.0]), [false, true, false])
        },
        ..BOXES
    },
    Case {
        name: "a-giant-larger-than-its-box",
        reason: "a radius of two edges: hundreds of images, of itself and of the small ones",
        make: |dim| {
            let bodies = [([0.5; 3], 2.0), ([0.25, 0.75, 0.5], 0.25), ([0.0; 3], 0.0)];
            in_box(each(dim, &bodies), cube(1.0), ALL)
        },
        ..BOXES
    },
    Case {
        name: "a-tilt-of-a-whole-edge",
        reason: "the same lattice of images as without tilt, by another vector",
        source: "own",
        expect: Expect::Contacts([1, 1]),
        make: |dim| sheared(dim, 1.0, 0.0),
        ..BOXES
    },
    Case {
        name: "a-tilt-of-half-an-edge",
        reason: "the images above are moved by half an edge, and the contact is with one of them",
        source: "ESPResSo#5267 and #5096: pairs missed with Lees-Edwards boundaries",
        expect: Expect::Contacts([1, 1]),
        make: |dim| sheared(dim, 0.5, 4.0),
        ..BOXES
    },
    Case {
        name: "a-negative-tilt",
        reason: "as a-tilt-of-half-an-edge, to the other side",
        source: "ESPResSo#2051: duplicates at an offset",
        expect: Expect::Contacts([1, 1]),
        make: |dim| sheared(dim, -0.5, 4.0),
        ..BOXES
    },
    Case {
        name: "a-tilt-of-many-edges",
        reason: "as a-tilt-of-half-an-edge, after five and a half: the nearest image is many \
                 vectors away",
        source: "openmm#1403 and #5382: contacts missed in triclinic boxes",
        expect: Expect::Contacts([1, 1]),
        make: |dim| sheared(dim, 5.5, 4.0),
        ..BOXES
    },
    Case {
        name: "other-vectors-of-the-unit-lattice",
        reason: "vectors (2, 1) and (1, 1): the images are those of the unit box, and by faces \
                 they are nearer than they seem",
        expect: Expect::Contacts([2, 3]),
        make: |dim| {
            let vectors = [[2.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            in_box(uniform(dim, &[[0.25; 3]], 0.55), vectors, ALL)
        },
        ..BOXES
    },
    Case {
        name: "a-rhombus",
        dims: &[2],
        reason: "the primitive cell of the hexagonal lattice: six neighbours, all of them images",
        expect: Expect::Contacts([3, 0]),
        make: |dim| {
            let vectors = [[1.0, 0.0, 0.0], [0.5, 0.875, 0.0], [0.0, 0.0, 1.0]];
            in_box(uniform(dim, &[[0.25; 3]], 0.51), vectors, ALL)
        },
        ..BOXES
    },
    Case {
        name: "the-primitive-cell-of-fcc",
        dims: &[3],
        reason: "no vector along an axis, and twelve neighbours, all of them images",
        source: "matscipy: aluminium, 12 neighbours at 2.86",
        expect: Expect::Contacts([0, 6]),
        make: |dim| {
            let vectors = [[0.0, 2.0, 2.0], [2.0, 0.0, 2.0], [2.0, 2.0, 0.0]];
            in_box(uniform(dim, &[[0.25; 3]], 1.45), vectors, ALL)
        },
        ..BOXES
    },
    Case {
        name: "nobody-in-a-box",
        reason: "no particles, and a box all the same",
        expect: Expect::Contacts([0, 0]),
        make: |dim| in_box(uniform(dim, &[], 0.5), cube(1.0), ALL),
        ..BOXES
    },
];

fn edges([x, y, z]: [f64; 3]) -> [Place; 3] {
    [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]]
}

fn cube(edge: f64) -> [Place; 3] {
    edges([edge; 3])
}

/// Two bodies that touch through a face of a box of edge 8 along x; the first `away`.
fn facing(away: f64) -> [Place; 2] {
    [[0.25 + away, 3.0, 3.0], [7.25, 3.0, 3.0]]
}

/// A body at `x` and one at 3/4.
fn quarter(x: f64) -> [Place; 2] {
    [[x, 0.5, 0.5], [0.75, 0.5, 0.5]]
}

/// So many bodies in touch along x.
fn row(n: u32) -> Vec<Place> {
    (0..n).map(|k| [f64::from(k), 1.0, 1.0]).collect()
}

/// A lattice of 6 or 4 sites per axis that goes on through the faces.
fn tiled(dim: u32, scale: f64, offset: f64) -> Steps {
    let sites = by_dim(dim, [6, 4]);
    let places = lattice(dim, sites, |k| (offset + 0.25 + k) * scale);
    in_box(uniform(dim, &places, 0.5 * scale), cube(f64::from(sites) * scale), ALL)
}

/// Two bodies that touch through the faces across y of a sheared box, one above the other but for
/// `aside`.
fn sheared(dim: u32, tilt: f64, aside: f64) -> Steps {
    let places = [[1.0, 0.25, 3.0], [1.0 + aside, 7.25, 3.0]];
    let vectors = [[8.0, 0.0, 0.0], [8.0 * tilt, 8.0, 0.0], [0.0, 0.0, 8.0]];
    in_box(uniform(dim, &places, 0.5), vectors, ALL)
}
