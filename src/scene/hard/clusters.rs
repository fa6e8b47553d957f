//! Uneven distributions and input orders.
//!
//! ```text
//!   oo..oo......oo..oo  Cantor        /   diagonal      | | | |  comb
//!                                    /                  | | | |
//!                                   /                  =========
//! ```

use crate::scene::generate::draw::Draw;
use crate::scene::hard::build::*;
use crate::scene::hard::{Allowed, Case, Expect, Group};

const CLUSTERS: Case = Case::in_group(Group::Clusters);

pub const CASES: &[Case] = &[
    Case {
        name: "gaussian",
        reason: "one normal cluster: cells in the middle hold a crowd, most cells nothing",
        make: |dim| {
            let mut draw = Draw::new(1);
            uniform(
                dim,
                &(0..500).map(|_| [(); 3].map(|()| 3.0 * draw.normal())).collect::<Vec<_>>(),
                0.5,
            )
        },
        ..CLUSTERS
    },
    Case {
        name: "clusters-of-every-density",
        reason: "normal clusters with widths from 2^-4 to 2^3: no cell size fits all",
        make: |dim| {
            let mut draw = Draw::new(2);
            let places = (0..480).map(|k| {
                let width = two_to(k / 60 - 4);
                plus([40.0 * f64::from(k / 60), 0.0, 0.0], width, [(); 3].map(|()| draw.normal()))
            });
            uniform(dim, &places.collect::<Vec<_>>(), 0.5)
        },
        ..CLUSTERS
    },
    Case {
        name: "cantor-dust",
        reason: "a fractal: the number of bodies in a box grows slower than its volume at every \
                 scale",
        expect: Expect::Contacts([2 * 8 * 16, 3 * 4 * 64]),
        make: |dim| {
            // Digits 0 and 3 to the base 4, one per bit; only sites that differ in the last digit
            // touch.
            let digits = |k: f64| {
                (0..4)
                    .map(|bit| if k as u32 >> bit & 1 == 1 { 3.0 * two_to(2 * bit) } else { 0.0 })
                    .sum()
            };
            uniform(dim, &lattice(dim, by_dim(dim, [16, 8]), digits), 1.5)
        },
        ..CLUSTERS
    },
    Case {
        name: "diagonal-of-a-box",
        reason: "a line along the diagonal, shuffled by a stride: boxes around halves overlap in \
                 no axis, yet one full grid has N^D cells",
        expect: Expect::Contacts([299, 299]),
        make: |dim| {
            uniform(dim, &(0..300).map(|k| [f64::from(k * 7 % 300); 3]).collect::<Vec<_>>(), 1.0)
        },
        ..CLUSTERS
    },
    Case {
        name: "wall",
        reason: "all within 2^-30 of one x: nearly equal keys, which a sweep along x cannot tell \
                 apart and a sort in f32 makes equal",
        source: "kiddo#475",
        // reach 1.125 against spacings of 1.0625 and, in space, a diagonal of 1.5
        expect: Expect::Contacts([399, 2 * 20 * 19]),
        make: |dim| {
            let side = by_dim(dim, [400, 20]);
            let places = (0..400).map(|k| {
                [
                    two_to(-30) * f64::from(k % 5),
                    1.0625 * f64::from(k % side),
                    1.0625 * f64::from(k / side),
                ]
            });
            uniform(dim, &places.collect::<Vec<_>>(), 0.5625)
        },
        ..CLUSTERS
    },
    Case {
        name: "comb",
        reason: "teeth on a bar: splitting in the middle of the box leaves trees with one deep \
                 side",
        expect: Expect::Contacts([60 + 20 * 20, 60 + 20 * 20]),
        make: |dim| {
            // A bar of 61 bodies along x; every third carries a tooth of 20 along y, and all of it
            // touches in a chain.
            let bar = (0..61).map(|k| [f64::from(k), 0.0, 0.0]);
            let teeth = (0..20).flat_map(|tooth| {
                (1..=20).map(move |k| [3.0 * f64::from(tooth), f64::from(k), 0.0])
            });
            uniform(dim, &bar.chain(teeth).collect::<Vec<_>>(), 0.5)
        },
        ..CLUSTERS
    },
    Case {
        name: "geometric-series",
        reason: "bodies at 2^-k: halving space separates one body per level, so a tree is as deep \
                 as it has particles",
        allows: &[Allowed::Memory],
        make: |dim| {
            uniform(dim, &(0..60).map(|k| [two_to(-k); 3]).collect::<Vec<_>>(), two_to(-20))
        },
        ..CLUSTERS
    },
    Case {
        name: "sorted-input",
        reason: "a row in ascending order: a quicksort that splits at the first particle recurses \
                 N deep; use order = generated",
        expect: Expect::Contacts([1499, 1499]),
        make: |dim| in_order(dim, |k| k),
        ..CLUSTERS
    },
    Case {
        name: "reversed-input",
        reason: "a row in descending order: insertion into lists and sorts at their worst; use \
                 order = generated",
        expect: Expect::Contacts([1499, 1499]),
        make: |dim| in_order(dim, |k| ROW - 1 - k),
        ..CLUSTERS
    },
    Case {
        name: "organ-pipe-input",
        reason: "up and down again: defeats a quicksort that splits at the middle particle; use \
                 order = generated",
        expect: Expect::Contacts([1499, 1499]),
        make: |dim| in_order(dim, |k| if k < ROW / 2 { 2 * k } else { 2 * (ROW - 1 - k) + 1 }),
        ..CLUSTERS
    },
    Case {
        name: "only-the-last-two",
        reason: "of 200 bodies only the last two in the input touch: loops that end one early \
                 find nothing; use order = generated",
        expect: Expect::Contacts([1, 1]),
        make: |dim| {
            let mut places: Vec<Place> = (0..200).map(|k| site(k, 3.0)).collect();
            places[199] = plus(places[198], 1.0, [0.0, 1.0, 0.0]);
            uniform(dim, &places, 0.5)
        },
        ..CLUSTERS
    },
    Case {
        name: "only-the-first-two",
        reason: "of 200 bodies only the first two in the input touch: 0 as the mark of an empty \
                 list loses them; use order = generated",
        expect: Expect::Contacts([1, 1]),
        make: |dim| {
            let mut places: Vec<Place> = (0..200).map(|k| site(k, 3.0)).collect();
            places[0] = plus(places[1], 1.0, [0.0, 1.0, 0.0]);
            uniform(dim, &places, 0.5)
        },
        ..CLUSTERS
    },
];

/// Bodies in the rows of the input orders.
const ROW: u32 = 1500;

/// A row of bodies 3/4 apart; the k-th in the input has place `place(k)`.
fn in_order(dim: u32, place: impl Fn(u32) -> u32) -> Steps {
    uniform(dim, &(0..ROW).map(|k| [0.75 * f64::from(place(k)), 0.0, 0.0]).collect::<Vec<_>>(), 0.5)
}
