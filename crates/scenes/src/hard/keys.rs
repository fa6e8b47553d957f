//! Cell numbers that overflow or collide.
//!
//! ```text
//!   (ix, iy) -> ix + iy·2^b
//! ```
//!
//! Cells (2^b, 0) and (0, 1) have the same key, and so share list, marks and neighbours.

use crate::hard::Maker;
use crate::hard::build::*;

pub const MAKERS: &[Maker] = &[
    ("two-couples-1e9-apart", |dim| two_pairs(dim, 1e9)),
    ("two-couples-1e12-apart", |dim| two_pairs(dim, 1e12)),
    ("two-couples-1e300-apart", |dim| two_pairs(dim, 1e300)),
    ("just-below-2-to-31-cells", |dim| two_pairs(dim, two_to(31) - 64.0)),
    ("just-above-2-to-31-cells", |dim| two_pairs(dim, two_to(31) + two_to(15))),
    ("two-to-the-32-cells", |dim| two_pairs(dim, two_to(32))),
    ("thin-diagonal", |dim| {
        let pair = |k| [1000.0 * f64::from(k), 1000.0 * f64::from(k) + 0.5].map(|x| [x; 3]);
        uniform(dim, (0..100).flat_map(pair), 0.5)
    }),
    ("product-over-2-to-32", |dim| {
        let at = |x: f64, y: f64| [[x, y, y], [x + 0.5, y, y]];
        // 66,000² exceeds 2^32 by 61,032,704, which is the number of a cell in row 924.
        uniform(dim, [at(0.0, 0.0), at(50_000.0, 924.0), at(65_999.0, 66_000.0)].concat(), 0.5)
    }),
    ("keys-of-16-bits", |dim| aliases(dim, two_to(16))),
    ("keys-of-21-bits", |dim| aliases(dim, two_to(21))),
    ("chains-across-2-to-16", |dim| chains(dim, two_to(16))),
    ("chains-across-2-to-21", |dim| chains(dim, two_to(21))),
    ("single-precision-keys", |dim| {
        let row = places(64, |k| on_axis(dim as usize - 1, two_to(24) + k, 50.0));
        uniform(dim, [[0.0; 3], [100.0; 3]].into_iter().chain(row), 0.5)
    }),
    ("one-hash-bucket", |dim| {
        let clump = lattice(dim, [3; 2], |k| k);
        let far = lattice(dim, [3; 2], |k| 1024.0 * k);
        let clumps = far.iter().flat_map(|&far| clump.iter().map(move |&at| plus(far, 1.0, at)));
        uniform(dim, clumps, 0.5)
    }),
    ("neighbours-in-one-bucket", |dim| grid(dim, [24, 10], by_dim(dim, [0.75, 0.875]), |k| k)),
];

/// Returns two touching pairs, one at the origin and one at `far` on every axis. If doubles are too
/// coarse at `far`, the two particles there coincide.
fn two_pairs(dim: u32, far: f64) -> Steps {
    uniform(dim, [[0.0; 3], [1.0, 0.0, 0.0], [far; 3], [far + 1.0, far, far]], 0.5)
}

/// Returns rows of particles whose cells collide if a key holds `period` cells per axis.
///
/// Two rows lie one above the other, in cells 0 to 15 along x. A third row, level with the lower
/// one, lies around x = `period`. It continues until its cells, modulo `period`, are those of the
/// first row, also for cells a few millionths wider than a diameter. Colliding keys confuse it with
/// the upper row. All three rows occur twice: the far row comes first, and last. One particle far
/// up makes an array of all cells impossible. Contacts: along three rows of 22 particles and
/// between two of them, twice.
fn aliases(dim: u32, period: f64) -> Steps {
    let row = |x: f64, y: f64| places(22, |k| [x + 0.75 * k, y, 0.5]);
    let near = |y: f64| [row(0.0, y + 0.5), row(0.0, y + 1.25)].concat();
    let far = |y: f64| row(period - 4.0, y + 0.5);
    let corners = vec![[0.0; 3], [0.0, two_to(31) / period, 0.0]];
    uniform(dim, [corners, far(4.0), near(4.0), near(12.0), far(12.0)].concat(), 0.5)
}

/// Returns two touching chains along every axis: 64 particles from 0, and 64 across `period`. Cell
/// numbers that wrap at `period` confuse both chains. The second chain crosses the border of cell
/// `period` even if cells are some millionths wider than a diameter.
fn chains(dim: u32, period: f64) -> Steps {
    let far = (-40..24).map(|k| period + f64::from(k));
    uniform(dim, lines(dim, &(0..64).map(f64::from).chain(far).collect::<Vec<_>>(), 200.0), 0.5)
}
