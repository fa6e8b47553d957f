//! The edge of the domain: the last cell, x = xmax, domains of one, two and three cells.

use crate::hard::Maker;
use crate::hard::build::*;

pub const MAKERS: &[Maker] = &[
    ("at-xmax", |dim| uniform(dim, &lines(dim, &[0.0, 1.0, 63.0, 64.0], 32.0), 0.5)),
    ("couples-in-the-corners", |dim| {
        let places = corners(dim).into_iter().flat_map(|corner| {
            let place = corner.map(|x| 8.0 + 8.0 * x);
            [place, plus(place, -1.0, [corner[0], 0.0, 0.0])]
        });
        uniform(dim, &places.collect::<Vec<_>>(), 0.5)
    }),
    ("not-a-multiple", |dim| {
        uniform(dim, &lines(dim, &[0.0, 1.0, 2.0, 8.0, 9.0, 10.0, 10.3], 5.0), 0.5)
    }),
    ("edge-of-one-diameter", |dim| uniform(dim, &lattice(dim, 2, |k| k), 0.5)),
    ("one-cell", |dim| uniform(dim, &lattice(dim, 4, |k| 0.25 * k), 0.375)),
    ("two-cells", |dim| uniform(dim, &lattice(dim, 5, |k| 0.4375 * k), 0.5)),
    ("three-cells", |dim| uniform(dim, &lattice(dim, 6, |k| 0.5 * k), 0.5)),
    ("one-ulp-past-the-last-cell", |dim| {
        uniform(
            dim,
            &lines(dim, &[0.0, 30.0, 31.0f64.next_down(), 31.0, 32.0f64.next_up()], 16.0),
            0.5,
        )
    }),
    ("rows-end-to-end", |dim| {
        let places =
            (0..10).flat_map(|k| [0.0, 0.5, 15.0, 15.5].map(|x| [x, 1.5 * f64::from(k), 0.0]));
        uniform(dim, &places.collect::<Vec<_>>(), 0.5)
    }),
];
