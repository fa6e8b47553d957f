//! Very many particles in one cell: fixed capacities lose some, and N particles make N²/2 pairs.
//!
//! ```text
//!   +------+------+
//!   |:::::.|      |     a table of 100 places per cell silently drops the others
//!   |::::::|   o  |
//!   +------+------+
//! ```

use crate::hard::Maker;
use crate::hard::build::*;

pub const MAKERS: &[Maker] = &[
    ("hundred-and-one", |dim| crowd(dim, 101)),
    ("two-hundred-and-fifty-seven", |dim| crowd(dim, 257)),
    ("thousand-and-twenty-five", |dim| crowd(dim, 1025)),
    ("dust-in-one-cell", |dim| {
        let mut dust = places(1200, |k: f64| [k % 40.0, (k / 40.0).floor(), 0.0].map(|x| x / 64.0));
        dust.push(dust[dust.len() - 1]);
        each(dim, of_size(dust, 0.0).chain([([8.0; 3], 1.0)]))
    }),
    ("clique-on-a-corner", |dim| {
        let mut clique = drawn(10, 240, |draw| [(); 3].map(|()| 4.0 + 0.25 * draw.symmetric()));
        // A separate particle at 0 makes cells of edge 1 have a corner at 4.
        clique.insert(120, [0.0; 3]);
        uniform(dim, clique, 0.5)
    }),
    ("crowded-neighbourhood", |dim| {
        uniform(dim, drawn(11, 900, |draw| [(); 3].map(|()| 3.0 * draw.unit())), 0.5)
    }),
    ("crowd-beside-crowd", |dim| {
        let all = drawn(12, 300, |draw| [(); 3].map(|()| 0.125 * draw.unit()));
        let beside = |(k, place)| match k % 2 {
            0 => place,
            _ => plus(place, 1.0, [1.5, 0.0, 0.0]),
        };
        uniform(dim, all.into_iter().enumerate().map(beside), 0.5)
    }),
];

/// Returns `n` particles that all touch, in a box whose edge is 1/4 of their diameter.
fn crowd(dim: u32, n: u32) -> Steps {
    uniform(dim, drawn(n.into(), n, |draw| [(); 3].map(|()| 0.25 * draw.unit())), 0.5)
}
