//! Negative coordinates; zeros of both signs and numbers that are nearly zero.
//!
//! ```text
//!   x        -1.5  -0.5   0.5   1.5
//!   floor      -2    -1     0     1
//!   truncated  -1     0     0     1      cell 0 is twice as wide, and a cast to unsigned wraps
//! ```

use crate::scene::hard::build::*;
use crate::scene::hard::{Case, Expect, Group};

const SIGNS: Case = Case::in_group(Group::Signs);
const ZEROS: Case = Case::in_group(Group::Zeros);

pub const CASES: &[Case] = &[
    Case {
        name: "around-the-origin",
        reason: "a touching lattice astride the origin: truncation is not floor below 0",
        source: "jax-md#168",
        expect: of_lattice([17, 9], 1),
        make: |dim| {
            uniform(dim, &lattice(dim, by_dim(dim, [17, 9]), |k| k - by_dim(dim, [8.0, 4.0])), 0.5)
        },
        ..SIGNS
    },
    Case {
        name: "all-negative",
        reason: "no coordinate is positive: cells numbered from 0 at the origin, or from an xmax \
                 that began as 0, do not hold it",
        source: "jax-md#168",
        expect: of_lattice([15, 7], 1),
        make: |dim| uniform(dim, &lattice(dim, by_dim(dim, [15, 7]), |k| k - 1000.0), 0.5),
        ..SIGNS
    },
    Case {
        name: "all-positive",
        reason: "no coordinate is near 0: an xmin that began as 0 makes a domain of mostly empty \
                 cells, and must lose nothing",
        expect: of_lattice([15, 7], 1),
        make: |dim| uniform(dim, &lattice(dim, by_dim(dim, [15, 7]), |k| k + 50.0), 0.5),
        ..SIGNS
    },
    Case {
        name: "every-quadrant",
        reason: "a couple deep in each quadrant or octant, and one across each axis: signs that \
                 mix in one key",
        expect: Expect::Contacts([4 + 2, 8 + 3]),
        make: |dim| {
            let mut places: Vec<Place> = Vec::new();
            for corner in corners(dim) {
                let place = corner.map(|x| 10.25 * x);
                places.extend([place, plus(place, 0.75, [corner[0], 0.0, 0.0])]);
            }
            for axis in 0..dim as usize {
                places.extend([-0.25, 0.5].map(|x| {
                    std::array::from_fn(|k| if k == axis { x } else { 3.0 * (axis + 1) as f64 })
                }));
            }
            uniform(dim, &places, 0.5)
        },
        ..SIGNS
    },
    Case {
        name: "three-quarter-steps",
        reason: "steps of 3/4 from below 0: where cell numbers repeat or jump at 0, neighbours \
                 are two cells apart",
        source: "jax-md#168",
        expect: Expect::Contacts([2 * 119, 3 * 119]),
        make: |dim| {
            uniform(
                dim,
                &lines(
                    dim,
                    &(0..120).map(|k| 0.75 * f64::from(k) - 45.0).collect::<Vec<_>>(),
                    60.0,
                ),
                0.5,
            )
        },
        ..SIGNS
    },
    Case {
        name: "zeros-of-both-signs",
        reason: "0, -0 and -5e-17 as coordinates: the same place, or nearly, and another bit \
                 pattern",
        source: "NeighbourLists.jl#38",
        expect: Expect::Contacts([pairs(4), pairs(4)]),
        make: |dim| {
            uniform(
                dim,
                &[[0.0, -0.0, 0.0], [-0.0, 0.0, -0.0], [-5e-17, 0.0, -0.0], [0.0, -5e-17, 5e-17]],
                0.5,
            )
        },
        ..ZEROS
    },
    Case {
        name: "points-on-zeros",
        reason: "points without extent on zeros of all signs are one place: keys of bits, and \
                 orders that put -0 first, tear them apart",
        expect: Expect::Contacts([pairs(4), pairs(8)]),
        make: |dim| {
            let signed = corners(dim)
                .into_iter()
                .map(|corner| corner.map(|x| if x < 0.0 { -0.0 } else { 0.0 }));
            uniform(dim, &signed.collect::<Vec<_>>(), 0.0)
        },
        ..ZEROS
    },
    Case {
        name: "lattice-a-hair-below-zero",
        reason: "a touching lattice whose first layer is at -5e-17, not at 0: x - xmin rounds \
                 that away, the exact test does not",
        source: "NeighbourLists.jl#38",
        expect: Expect::Contacts([lattice_contacts(2, 12, 1) - 12, lattice_contacts(3, 8, 1) - 64]),
        make: |dim| {
            let mut places = lattice(dim, by_dim(dim, [12, 8]), |k| k);
            places.iter_mut().filter(|place| place[0] == 0.0).for_each(|place| place[0] = -5e-17);
            uniform(dim, &places, 0.5)
        },
        ..ZEROS
    },
    Case {
        name: "least-number-off-zero",
        reason: "couples 1 - 2^-1074 apart touch, couples 1 + 2^-1074 apart do not; every rounded \
                 difference is 1",
        expect: Expect::Contacts([2, 3]),
        make: |dim| {
            let least = f64::from_bits(1);
            let places = (0..dim as usize).flat_map(|axis| {
                let at = move |x: f64, lane: f64| {
                    std::array::from_fn(|k| if k == axis { x } else { lane + axis as f64 })
                };
                [at(least, 4.0), at(1.0, 4.0), at(-least, 12.0), at(1.0, 12.0)]
            });
            uniform(dim, &places.collect::<Vec<_>>(), 0.5)
        },
        ..ZEROS
    },
];
