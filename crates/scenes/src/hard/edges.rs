//! The edge of the domain: the last cell, x = xmax, domains of one, two and three cells.

use crate::hard::Maker;
use crate::hard::build::*;

pub const MAKERS: &[Maker] = &[
    ("at-xmax", |dim| uniform(dim, lines(dim, &[0.0, 1.0, 63.0, 64.0], 32.0), 0.5)),
    ("couples-in-the-corners", |dim| {
        let pair = |corner: Place| {
            let place = corner.map(|x| 8.0 + 8.0 * x);
            [place, plus(place, -1.0, [corner[0], 0.0, 0.0])]
        };
        uniform(dim, corners(dim).into_iter().flat_map(pair), 0.5)
    }),
    ("not-a-multiple", |dim| {
        uniform(dim, lines(dim, &[0.0, 1.0, 2.0, 8.0, 9.0, 10.0, 10.3], 5.0), 0.5)
    }),
    ("edge-of-one-diameter", |dim| grid(dim, [2; 2], 0.5, |k| k)),
    ("one-cell", |dim| grid(dim, [4; 2], 0.375, |k| 0.25 * k)),
    ("two-cells", |dim| grid(dim, [5; 2], 0.5, |k| 0.4375 * k)),
    ("three-cells", |dim| grid(dim, [6; 2], 0.5, |k| 0.5 * k)),
    ("one-ulp-past-the-last-cell", |dim| {
        let line = [0.0, 30.0, 31.0f64.next_down(), 31.0, 32.0f64.next_up()];
        uniform(dim, lines(dim, &line, 16.0), 0.5)
    }),
    ("rows-end-to-end", |dim| {
        let row = |k| [0.0, 0.5, 15.0, 15.5].map(|x| [x, 1.5 * f64::from(k), 0.0]);
        uniform(dim, (0..10).flat_map(row), 0.5)
    }),
];
