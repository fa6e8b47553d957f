//! Very many particles in one cell: fixed capacities clip them, and N particles in one cell have
//! N²/2 pairs.
//!
//! ```text
//!   +------+------+
//!   |:::::.|      |     a table of 100 places per cell drops the others without a word
//!   |::::::|   o  |
//!   +------+------+
//! ```

use crate::scene::generate::draw::Draw;
use crate::scene::hard::build::*;
use crate::scene::hard::{Case, Expect, Group};

const CROWDS: Case = Case::in_group(Group::Crowds);

pub const CASES: &[Case] = &[
    Case {
        name: "hundred-and-one",
        reason: "101 overlapping bodies in one cell: one more than a table of 100 places holds",
        source: "PointNeighbors.jl#172",
        expect: Expect::Contacts([pairs(101), pairs(101)]),
        make: |dim| crowd(dim, 101),
        ..CROWDS
    },
    Case {
        name: "two-hundred-and-fifty-seven",
        reason: "257 overlapping bodies in one cell: a count in one byte is 1",
        expect: Expect::Contacts([pairs(257), pairs(257)]),
        make: |dim| crowd(dim, 257),
        ..CROWDS
    },
    Case {
        name: "thousand-and-twenty-five",
        reason: "1,025 overlapping bodies in one cell: 524,800 pairs, 512 per body",
        source: "PointNeighbors.jl#172",
        expect: Expect::Contacts([pairs(1025), pairs(1025)]),
        make: |dim| crowd(dim, 1025),
        ..CROWDS
    },
    Case {
        name: "dust-in-one-cell",
        reason: "1,200 bodies in one cell, none of them in touch but the last two: a clipped list \
                 looks right until its end",
        source: "PointNeighbors.jl#172",
        expect: Expect::Contacts([1, 1]),
        make: |dim| {
            let mut bodies: Vec<(Place, f64)> = (0..1200)
                .map(|k| ([f64::from(k % 40), f64::from(k / 40), 0.0].map(|x| x / 64.0), 0.0))
                .collect();
            bodies.push(bodies[bodies.len() - 1]);
            bodies.push(([8.0; 3], 1.0));
            each(dim, &bodies)
        },
        ..CROWDS
    },
    Case {
        name: "clique-on-a-corner",
        reason: "a clique around a corner of cells: all pairs touch, most of them across cells",
        expect: Expect::Contacts([pairs(240), pairs(240)]),
        make: |dim| {
            let mut draw = Draw::new(10);
            let mut places: Vec<Place> =
                (0..240).map(|_| [(); 3].map(|()| 4.0 + 0.25 * draw.symmetric())).collect();
            // Alone, so that cells of edge 1 have a corner at 4.
            places.insert(120, [0.0; 3]);
            uniform(dim, &places, 0.5)
        },
        ..CROWDS
    },
    Case {
        name: "crowded-neighbourhood",
        reason: "crowds in all cells around a crowd: 1,000 neighbours of each body in reach of \
                 the mask, a third in touch",
        make: |dim| {
            let mut draw = Draw::new(11);
            uniform(
                dim,
                &(0..900).map(|_| [(); 3].map(|()| 3.0 * draw.unit())).collect::<Vec<_>>(),
                0.5,
            )
        },
        ..CROWDS
    },
    Case {
        name: "crowd-beside-crowd",
        reason: "two crowds of 150 in neighbouring cells that do not touch: 22,500 tests, no \
                 contact between them",
        expect: Expect::Contacts([2 * pairs(150), 2 * pairs(150)]),
        make: |dim| {
            let mut draw = Draw::new(12);
            let places = (0..300).map(|k| {
                let place = [(); 3].map(|()| 0.125 * draw.unit());
                if k % 2 == 0 { place } else { plus(place, 1.0, [1.5, 0.0, 0.0]) }
            });
            uniform(dim, &places.collect::<Vec<_>>(), 0.5)
        },
        ..CROWDS
    },
];

/// `n` bodies drawn from a box of edge d/4: all touch.
fn crowd(dim: u32, n: u32) -> Steps {
    let mut draw = Draw::new(u64::from(n));
    uniform(dim, &(0..n).map(|_| [(); 3].map(|()| 0.25 * draw.unit())).collect::<Vec<_>>(), 0.5)
}
