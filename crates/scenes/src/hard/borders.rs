//! Centres on cell borders, and pairs across them.
//!
//! ```text
//!   |     |o    |     |     |
//!   |    o|     |     o     |o
//! ```
//!
//! The rounded indices i = floor((x - xmin) / d) of two touching particles may differ by 2.

use crate::hard::Maker;
use crate::hard::build::*;

pub const MAKERS: &[Maker] = &[
    // The second and third particle are 2^-53 apart in exact arithmetic.
    ("three-across-a-border", |dim| {
        uniform(dim, lines(dim, &[0.0, 1.0f64.next_down(), 2.0], 8.0), 0.5)
    }),
    ("row-from-minus-one", |dim| {
        let row: Vec<f64> = (0..by_dim(dim, [300, 60])).map(|k| f64::from(k) - 1.0).collect();
        uniform(dim, lines(dim, &row, by_dim(dim, [400.0, 80.0])), 0.5)
    }),
    ("couples-from-minus-one", |dim| {
        uniform(dim, lines(dim, &astride(-1.0, 1.0, [4.0, 8.0, 16.0, 32.0, 64.0]), 70.0), 0.5)
    }),
    ("couples-below-zero", |dim| {
        let line = astride(-7.3, 0.1, (1..=50).map(|k| f64::from(3 * k)));
        uniform(dim, lines(dim, &line, 9.7), 0.05)
    }),
    ("couples-far-from-xmin", |dim| {
        // The row lies on the last axis, where NBS needs least memory. The last particle makes the
        // box so large along the others that `screening` refuses at once.
        let along = |x: f64, other: f64| on_axis(dim as usize - 1, x, other);
        let line = astride(-1e6, 0.1, (0..40).map(|k| f64::from(3 * k + 9_999_940)));
        let line = line.into_iter().map(|x| along(x, 0.0));
        uniform(dim, line.chain([along(0.0, 200.0)]), 0.05)
    }),
    ("spacing-is-the-diameter", |dim| grid(dim, [20, 9], 0.125, |k| 0.25 * k - 7.0)),
    ("spacing-is-half-the-cutoff", |dim| grid(dim, [16, 8], 0.5, |k| 0.5 * k)),
    ("spacing-is-a-third-of-the-cutoff", |dim| grid(dim, [16, 8], 1.5, |k| k)),
    ("decimal-spacing", |dim| grid(dim, [20, 9], 0.05, |k| 0.1 * k)),
    ("decimal-third-of-the-cutoff", |dim| grid(dim, [16, 8], 0.15, |k| 0.1 * k - 0.7)),
    ("hexagonal-pack", |dim| {
        let (row, whole) = ((0.75f64).sqrt(), |k: f64| (k / 16.0).floor());
        let at = |k: f64| [k % 16.0 + 0.5 * (whole(k) % 2.0), row * whole(k), 0.0];
        uniform(dim, places(256, at), 0.5)
    }),
    ("around-one-corner", |dim| {
        let around = corners(dim).into_iter().map(|corner| plus([5.0; 3], two_to(-12), corner));
        uniform(dim, around.chain([[0.0; 3], [10.0; 3]]), 0.5)
    }),
    // Cells begin at 0, with an edge of 1 or a few millionths more. The pair of direction v lies
    // across the face, edge or corner of a cell in that direction.
    ("every-neighbour", |dim| {
        let pair = |(k, v): (usize, Place)| {
            let middle = plus(site(k + 1, 4.0), 1.0, v.map(|x| if x == 0.0 { 4.5 } else { 4.0 }));
            [plus(middle, -0.25, v), plus(middle, 0.25, v)]
        };
        let pairs = neighbours(dim).into_iter().enumerate().flat_map(pair);
        uniform(dim, [[0.0; 3]].into_iter().chain(pairs), 0.5)
    }),
    ("all-neighbours-of-one", |dim| {
        let block = lattice(dim, [3; 2], |k| 4.5 + 0.5625 * (k - 1.0));
        uniform(dim, block.into_iter().chain([[0.0; 3]]), 0.5)
    }),
];

/// Returns `low` and, for each border of cells of edge d, two coordinates: the last one that rounds
/// to the cell before the border, and the last one at most d beyond it. Border k is k cells from
/// `low`; borders must be three cells apart.
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
