//! What an earlier detection left behind. One detector is given all steps in order; only the last
//! is judged.
//!
//! ```text
//!   step 1  ooooooooo   step 2  oo   step 3  oooooooooo
//!                                            heads, links and marks of step 1 must be gone
//! ```

use crate::scene::hard::build::*;
use crate::scene::hard::{Case, Expect, Group};

const STATE: Case = Case::in_group(Group::State);

pub const CASES: &[Case] = &[
    Case {
        name: "shrink-then-grow",
        reason: "many, two, more than ever: arrays of an earlier size, with an earlier content, \
                 at both ends",
        expect: of_lattice([14, 7], 1),
        make: |dim| {
            history([
                block(dim, 12, 6),
                uniform(dim, &[[0.0; 3], [1.0, 0.0, 0.0]], 0.5),
                block(dim, 14, 7),
            ])
        },
        ..STATE
    },
    Case {
        name: "grow-then-shrink",
        reason: "few after many: links of particles that no longer exist",
        expect: of_lattice([3, 3], 1),
        make: |dim| history([block(dim, 14, 7), block(dim, 3, 3)]),
        ..STATE
    },
    Case {
        name: "emptied-then-filled",
        reason: "no particle at all in between: the box, the largest radius and the counts of \
                 nobody",
        source: "CellListMap#79",
        expect: of_lattice([10, 5], 1),
        make: |dim| history([block(dim, 10, 5), uniform(dim, &[], 0.5), block(dim, 10, 5)]),
        ..STATE
    },
    Case {
        name: "same-scene-again",
        reason: "three times the same: lists marked as done are not done again",
        expect: of_lattice([10, 5], 1),
        make: |dim| history([block(dim, 10, 5), block(dim, 10, 5), block(dim, 10, 5)]),
        ..STATE
    },
    Case {
        name: "erased-and-inserted",
        reason: "a body is erased, and one is inserted at the same place: its old contacts are \
                 gone, its new ones are the same",
        source: "yade#13",
        expect: of_lattice([8, 5], 1),
        make: |dim| {
            let all = lattice(dim, by_dim(dim, [8, 5]), |k| k);
            let fewer: Vec<Place> =
                all.iter().enumerate().filter(|(k, _)| *k != 20).map(|(_, place)| *place).collect();
            // Inserted under a new number: the last.
            let again = [&fewer[..], &[all[20]]].concat();
            history([uniform(dim, &all, 0.5), uniform(dim, &fewer, 0.5), uniform(dim, &again, 0.5)])
        },
        ..STATE
    },
    Case {
        name: "all-cross-a-cell",
        reason: "every body moves by one diameter at once: each cell is left by one and entered \
                 by another",
        expect: of_lattice([12, 6], 1),
        make: |dim| {
            let moved = |by: f64| {
                let mut places = lattice(dim, by_dim(dim, [12, 6]), |k| k + by);
                places.push([-5.0; 3]); // keeps the box where it is
                uniform(dim, &places, 0.5)
            };
            history([moved(0.0), moved(1.0)])
        },
        ..STATE
    },
    Case {
        name: "all-swap-places",
        reason: "same places, other numbers: contacts kept from the step before have wrong names",
        expect: of_lattice([12, 6], 1),
        make: |dim| {
            let mut places = lattice(dim, by_dim(dim, [12, 6]), |k| k);
            let first = uniform(dim, &places, 0.5);
            let half = places.len() / 2;
            places[..half].reverse();
            history([first, uniform(dim, &places, 0.5)])
        },
        ..STATE
    },
    Case {
        name: "one-comes-from-afar",
        reason: "one body moves across the domain into contact, all others stay: a skipped update \
                 misses it",
        expect: Expect::Contacts([1, 1]),
        make: |dim| {
            let at = |last: Place| {
                let mut places: Vec<Place> = (0..64).map(|k| site(k, 2.0)).collect();
                places.push(last);
                uniform(dim, &places, 0.5)
            };
            history([at([40.0; 3]), at([0.25, -0.75, 0.0])])
        },
        ..STATE
    },
    Case {
        name: "domain-grows",
        reason: "the domain is 100 times longer than before: heads beyond the old end were never \
                 made empty",
        expect: of_lattice([10, 5], 1),
        make: |dim| {
            history([
                block(dim, 10, 5),
                uniform(dim, &lattice(dim, by_dim(dim, [10, 5]), |k| 30.0 * k), 0.5),
                block(dim, 10, 5),
            ])
        },
        ..STATE
    },
    Case {
        name: "domain-turns",
        reason: "from 200 cells wide and one high to one wide and 200 high: strides of the old \
                 shape",
        expect: Expect::Contacts([199, 199]),
        make: |dim| {
            let row = |axis: usize| {
                (0..200)
                    .map(|k| std::array::from_fn(|a| if a == axis { f64::from(k) } else { 0.0 }))
                    .collect::<Vec<_>>()
            };
            history([uniform(dim, &row(0), 0.5), uniform(dim, &row(dim as usize - 1), 0.5)])
        },
        ..STATE
    },
    Case {
        name: "radius-changes",
        reason: "same places, radius doubled and halved: cells of the old size",
        expect: of_lattice([12, 6], 4),
        make: |dim| {
            let places = lattice(dim, by_dim(dim, [12, 6]), |k| k);
            history([0.5, 0.25, 1.0].map(|r| uniform(dim, &places, r)))
        },
        ..STATE
    },
    Case {
        name: "one-radius-then-each",
        reason: "one radius for all, then one each, then one for all: radii kept from the step \
                 before",
        expect: of_lattice([12, 6], 1),
        make: |dim| {
            let places = lattice(dim, by_dim(dim, [12, 6]), |k| k);
            let bodies: Vec<(Place, f64)> = places
                .iter()
                .enumerate()
                .map(|(k, place)| (*place, 0.25 + 0.125 * (k % 7) as f64))
                .collect();
            history([uniform(dim, &places, 0.5), each(dim, &bodies), uniform(dim, &places, 0.5)])
        },
        ..STATE
    },
    Case {
        name: "after-a-refusal",
        reason: "the first step may be refused, half way through: what it left must not matter",
        source: "rapier#396",
        expect: of_lattice([12, 6], 1),
        make: |dim| {
            let far: Vec<Place> = (0..100).map(|k| [1e14 * f64::from(k); 3]).collect();
            history([uniform(dim, &far, 0.5), block(dim, 12, 6)])
        },
        ..STATE
    },
    Case {
        name: "after-a-crowd",
        reason: "a crowd of 400, then a lattice with one body per cell: lists that grew, tables \
                 that were resized",
        expect: of_lattice([12, 6], 1),
        make: |dim| history([uniform(dim, &[[3.0; 3]; 400], 0.5), block(dim, 12, 6)]),
        ..STATE
    },
];

/// A touching lattice with so many sites per axis, in 2D and 3D.
fn block(dim: u32, plane: u32, space: u32) -> Steps {
    uniform(dim, &lattice(dim, by_dim(dim, [plane, space]), |k| k), 0.5)
}
