//! Centres on cell borders, couples across them.
//!
//! ```text
//!   |     |o    |     |     |
//!   |    o|     |     o     |o
//! ```
//!
//! i = floor((x - xmin) / d) may differ by two for particles that touch.

use crate::scene::hard::build::*;
use crate::scene::hard::{Allowed, Case, Expect, Group};

const BORDERS: Case = Case::in_group(Group::Borders);

pub const CASES: &[Case] = &[
    Case {
        name: "three-across-a-border",
        reason: "with cells of edge d and rounded arithmetic, the second and the third body touch \
                 and are two cells apart",
        source: "core/src/filter/cells.rs",
        // in exact arithmetic the second and the third are 2^-53 apart
        expect: Expect::Contacts([2, 3]),
        make: |dim| uniform(dim, &lines(dim, &[0.0, 1.0f64.next_down(), 2.0], 8.0), 0.5),
        ..BORDERS
    },
    Case {
        name: "row-from-minus-one",
        reason: "every centre is on a border, and x - xmin is a sum: borders move by its rounding",
        source: "core/src/filter/cells.rs",
        expect: Expect::Contacts([2 * 299, 3 * 59]),
        make: |dim| {
            let row: Vec<f64> = (0..by_dim(dim, [300, 60])).map(|k| f64::from(k) - 1.0).collect();
            uniform(dim, &lines(dim, &row, by_dim(dim, [400.0, 80.0])), 0.5)
        },
        ..BORDERS
    },
    Case {
        name: "couples-from-minus-one",
        reason: "xmin = -1 costs x - xmin its last bit at every power of two: with cells of edge \
                 d, couples astride it are two cells apart",
        source: "core/src/filter/cells.rs",
        expect: Expect::Contacts([2 * 5, 3 * 5]),
        make: |dim| {
            uniform(dim, &lines(dim, &astride(-1.0, 1.0, [4.0, 8.0, 16.0, 32.0, 64.0]), 70.0), 0.5)
        },
        ..BORDERS
    },
    Case {
        name: "couples-below-zero",
        reason: "as couples-from-minus-one with decimal xmin and d: the quotient is rounded \
                 twice, and a third of the couples near 0 is lost",
        source: "core/src/filter/cells.rs",
        expect: Expect::Contacts([2 * 50, 3 * 50]),
        make: |dim| {
            uniform(
                dim,
                &lines(dim, &astride(-7.3, 0.1, (1..=50).map(|k| f64::from(3 * k))), 9.7),
                0.05,
            )
        },
        ..BORDERS
    },
    Case {
        name: "couples-far-from-xmin",
        reason: "as couples-below-zero with xmin = -10^6: near 0 coordinates have 33 bits more \
                 than x - xmin, and four couples in five are lost",
        source: "core/src/filter/cells.rs",
        expect: Expect::Contacts([40, 40]),
        allows: &[Allowed::Memory],
        make: |dim| {
            // Along the last axis, which costs NBS least memory; the other corner of the box is
            // wide, so that screening declines at once.
            let along = |x: f64, other: f64| {
                std::array::from_fn(|axis| if axis + 1 == dim as usize { x } else { other })
            };
            let line = astride(-1e6, 0.1, (0..40).map(|k| f64::from(3 * k + 9_999_940)));
            let places = line.into_iter().map(|x| along(x, 0.0));
            uniform(dim, &places.chain([along(0.0, 200.0)]).collect::<Vec<_>>(), 0.05)
        },
        ..BORDERS
    },
    Case {
        name: "spacing-is-the-diameter",
        reason: "lattice of spacing d: every centre is on a corner of cells, every neighbour \
                 exactly at reach",
        source: "atomman#12, CellListMap#84",
        expect: of_lattice([20, 9], 1),
        make: |dim| uniform(dim, &lattice(dim, by_dim(dim, [20, 9]), |k| 0.25 * k - 7.0), 0.125),
        ..BORDERS
    },
    Case {
        name: "spacing-is-half-the-cutoff",
        reason: "lattice of spacing d/2: second neighbours exactly at reach, two sites per cell \
                 edge",
        source: "MDAnalysis#2229",
        expect: of_lattice([16, 8], 4),
        make: |dim| uniform(dim, &lattice(dim, by_dim(dim, [16, 8]), |k| 0.5 * k), 0.5),
        ..BORDERS
    },
    Case {
        name: "spacing-is-a-third-of-the-cutoff",
        reason: "lattice of spacing d/3: third neighbours and those at (2, 2, 1) exactly at reach",
        source: "MDAnalysis#2919, freud#429",
        expect: of_lattice([16, 8], 9),
        make: |dim| uniform(dim, &lattice(dim, by_dim(dim, [16, 8]), |k| k), 1.5),
        ..BORDERS
    },
    Case {
        name: "decimal-spacing",
        reason: "lattice of spacing 0.1 and diameter 0.1: which neighbours touch is decided by \
                 the rounding of each coordinate",
        source: "atomman#12",
        make: |dim| uniform(dim, &lattice(dim, by_dim(dim, [20, 9]), |k| 0.1 * k), 0.05),
        ..BORDERS
    },
    Case {
        name: "decimal-third-of-the-cutoff",
        reason: "lattice of spacing 0.1 and cutoff 0.3, which three times 0.1 exceeds",
        source: "MDAnalysis#2919",
        make: |dim| uniform(dim, &lattice(dim, by_dim(dim, [16, 8]), |k| 0.1 * k - 0.7), 0.15),
        ..BORDERS
    },
    Case {
        name: "hexagonal-pack",
        reason: "rows √3/2 apart: six neighbours at one diameter up to the rounding of the root",
        dims: &[2],
        make: |dim| {
            let row = (0.75f64).sqrt();
            let at = |k: u32| {
                [f64::from(k % 16) + 0.5 * f64::from(k / 16 % 2), row * f64::from(k / 16), 0.0]
            };
            uniform(dim, &(0..256).map(at).collect::<Vec<_>>(), 0.5)
        },
        ..BORDERS
    },
    Case {
        name: "around-one-corner",
        reason: "one body in each cell that meets a corner, all touching: seen from several \
                 cells, a pair may come twice",
        expect: Expect::Contacts([pairs(4), pairs(8)]),
        make: |dim| {
            let around = corners(dim).into_iter().map(|corner| plus([5.0; 3], two_to(-12), corner));
            uniform(dim, &around.chain([[0.0; 3], [10.0; 3]]).collect::<Vec<_>>(), 0.5)
        },
        ..BORDERS
    },
    Case {
        name: "every-neighbour",
        reason: "a couple across every face, edge and corner of a cell, in both orders: each cell \
                 of the mask is needed",
        expect: Expect::Contacts([8, 26]),
        make: every_neighbour,
        ..BORDERS
    },
    Case {
        name: "all-neighbours-of-one",
        reason: "a body in each cell of a block of three per axis, touching those of all cells \
                 around: no cell may be seen twice",
        expect: of_lattice([3, 3], 3),
        make: |dim| {
            let mut places = lattice(dim, 3, |k| 4.5 + 0.5625 * (k - 1.0));
            places.push([0.0; 3]);
            uniform(dim, &places, 0.5)
        },
        ..BORDERS
    },
];

/// `low`, and for each border of cells of edge d from there (border k is k cells from `low`) two
/// coordinates: the last that rounded arithmetic puts before the border, and the last in reach of
/// that. The borders must be three cells apart.
fn astride(low: f64, d: f64, borders: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let mut line = vec![low];
    for border in borders {
        let (mut before, mut after) = (low + d * (border - 0.5), low + d * (border + 0.5));
        loop {
            let middle = before + 0.5 * (after - before);
            if middle <= before || middle >= after {
                break;
            }
            if (middle - low) / d < border { before = middle } else { after = middle }
        }
        line.extend([before, reach_from(before, d)]);
    }
    line
}

/// The cells have edge 1 (or a few millionths more) from 0. A couple of direction v is astride the
/// face, edge or corner in that direction.
fn every_neighbour(dim: u32) -> Steps {
    let mut places = vec![[0.0; 3]];
    for (k, v) in neighbours(dim).into_iter().enumerate() {
        let middle = plus(site(k + 1, 4.0), 1.0, v.map(|x| if x == 0.0 { 4.5 } else { 4.0 }));
        places.extend([plus(middle, -0.25, v), plus(middle, 0.25, v)]);
    }
    uniform(dim, &places, 0.5)
}
