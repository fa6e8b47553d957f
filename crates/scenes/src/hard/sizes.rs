//! Very different radii.
//!
//! ```text
//!    .-------.  . . .
//!   /         \. . .      cells as large as the largest particle hold all the dust;
//!   \         /. . .      smaller cells need a wider mask, or miss the giant's contacts
//!    '-------'  . . .
//! ```

use crate::hard::Maker;
use crate::hard::build::*;
use crate::hard::tangent::of_length;

pub const MAKERS: &[Maker] = &[
    ("giant-first-in-dust", |dim| each(dim, [([0.1; 3], 1.0)].into_iter().chain(dust(dim)))),
    ("giant-last-in-dust", |dim| each(dim, dust(dim).chain([([0.1; 3], 1.0)]))),
    ("giant-and-far-dust", |dim| {
        let (length, scale) = by_dim(dim, [(65, two_to(5)), (9, two_to(8))]);
        let r = 0.125;
        let near = of_length(dim, length).into_iter().map(|v| v.map(|x| x * scale));
        // A second shell of points, at least one unit farther out, does not touch.
        let far = near.clone().map(|v| v.map(|x| if x == 0.0 { x } else { x + x.signum() }));
        let giant = ([0.0; 3], f64::from(length) * scale - r);
        each(dim, of_size(near.chain(far), r).chain([giant]))
    }),
    ("point-beside-a-giant", |dim| {
        let r: f64 = 1024.0;
        let points = lines(dim, &[0.5 * r, r, r.next_up(), -r, (-r).next_down()], 0.0);
        each(dim, of_size(points, 0.0).chain([([0.0; 3], r)]))
    }),
    ("giants-across-dust", |dim| {
        // The dust lies below both giants and touches neither.
        let dust = of_size(places(300, |k: f64| [k % 20.0, (k / 20.0).floor() - 700.0, 0.0]), 0.25);
        let giants = [([-300.0, 0.0, 0.0], 500.0), ([300.0, 800.0, 0.0], 500.0)];
        each(dim, giants.into_iter().chain(dust))
    }),
    ("every-size-in-a-chain", |dim| {
        // Centres are 2 - 3·2^-k and radii 2^-k, so neighbours are 1.5·2^-k = 2^-k + 2^-(k+1)
        // apart.
        each(dim, (0..14).map(|k| ([2.0 - 3.0 * two_to(-k), 0.0, 0.0], two_to(-k))))
    }),
    ("two-scales", |dim| {
        let coarse = of_size(lattice(dim, [12, 6], |k| 64.0 * k), 32.0);
        each(dim, coarse.chain(of_size(lattice(dim, [12, 6], |k| k - 100.0), 0.5)))
    }),
    ("one-inside-the-other", |dim| each(dim, (-20..20).map(|k| ([0.5, -3.0, 7.0], two_to(k))))),
    ("uniform-radii-one-by-one", |dim| each(dim, of_size(lattice(dim, [12, 6], |k| k - 3.0), 0.5))),
];

/// Returns 400 (2D) or 343 (3D) particles of radius 2^-14 near the origin; none touch.
fn dust(dim: u32) -> impl Iterator<Item = Particle> {
    of_size(lattice(dim, [20, 7], |k| by_dim(dim, [0.03125, 0.0625]) * k - 0.2), two_to(-14))
}
