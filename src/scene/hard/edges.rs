//! The edge of the domain: the last cell, x = xmax, domains of one, two and three cells.

use crate::scene::hard::build::*;
use crate::scene::hard::{Case, Expect, Group};

const EDGES: Case = Case::in_group(Group::Edges);

pub const CASES: &[Case] = &[
    Case {
        name: "at-xmax",
        reason: "the extent is a whole number of cells: x = xmax falls one cell beyond the last",
        source: "Munjiza 2004, chapter 3",
        expect: Expect::Contacts([2 * 2, 3 * 2]),
        make: |dim| uniform(dim, &lines(dim, &[0.0, 1.0, 63.0, 64.0], 32.0), 0.5),
        ..EDGES
    },
    Case {
        name: "couples-in-the-corners",
        reason: "a couple exactly in touch in each corner of the box: the first and the last cell \
                 of every axis",
        expect: Expect::Contacts([4, 8]),
        make: |dim| {
            let places = corners(dim).into_iter().flat_map(|corner| {
                let place = corner.map(|x| 8.0 + 8.0 * x);
                [place, plus(place, -1.0, [corner[0], 0.0, 0.0])]
            });
            uniform(dim, &places.collect::<Vec<_>>(), 0.5)
        },
        ..EDGES
    },
    Case {
        name: "not-a-multiple",
        reason: "the extent is 10.3 cells: the last, partial cell is dropped where the number of \
                 cells is rounded down",
        source: "MDAnalysis#2229",
        expect: Expect::Contacts([2 * 5, 3 * 5]),
        make: |dim| uniform(dim, &lines(dim, &[0.0, 1.0, 2.0, 8.0, 9.0, 10.0, 10.3], 5.0), 0.5),
        ..EDGES
    },
    Case {
        name: "edge-of-one-diameter",
        reason: "the whole box is one diameter wide: 2^D bodies on its corners, each exactly in \
                 touch with D others",
        expect: of_lattice([2, 2], 1),
        make: |dim| uniform(dim, &lattice(dim, 2, |k| k), 0.5),
        ..EDGES
    },
    Case {
        name: "one-cell",
        reason: "all bodies in one cell: no neighbour exists, and what wraps around meets itself",
        make: |dim| uniform(dim, &lattice(dim, 4, |k| 0.25 * k), 0.375),
        ..EDGES
    },
    Case {
        name: "two-cells",
        reason: "two cells per axis: where neighbours wrap around, the cell to the left is the \
                 cell to the right and pairs come twice",
        source: "MDAnalysis#2919",
        expect: of_lattice([5, 5], 5),
        make: |dim| uniform(dim, &lattice(dim, 5, |k| 0.4375 * k), 0.5),
        ..EDGES
    },
    Case {
        name: "three-cells",
        reason: "three cells per axis: where neighbours wrap around, every cell is a neighbour of \
                 every other",
        expect: of_lattice([6, 6], 4),
        make: |dim| uniform(dim, &lattice(dim, 6, |k| 0.5 * k), 0.5),
        ..EDGES
    },
    Case {
        name: "one-ulp-past-the-last-cell",
        reason: "coordinates a last bit below, at and above a whole number of cells, the largest \
                 above: one cell more than planned",
        expect: Expect::Contacts([2 * 3, 3 * 3]),
        make: |dim| {
            uniform(
                dim,
                &lines(dim, &[0.0, 30.0, 31.0f64.next_down(), 31.0, 32.0f64.next_up()], 16.0),
                0.5,
            )
        },
        ..EDGES
    },
    Case {
        name: "rows-end-to-end",
        reason: "the end of each row of cells is full, and so is the begin of the next: numbers \
                 of cells without a border run from one into the other",
        expect: Expect::Contacts([2 * 10, 2 * 10]),
        make: |dim| {
            let places =
                (0..10).flat_map(|k| [0.0, 0.5, 15.0, 15.5].map(|x| [x, 1.5 * f64::from(k), 0.0]));
            uniform(dim, &places.collect::<Vec<_>>(), 0.5)
        },
        ..EDGES
    },
];
