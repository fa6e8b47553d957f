//! Very different radii.
//!
//! ```text
//!    .-------.  . . .
//!   /         \. . .      the largest body sets the cell: a cell holds all the dust;
//!   \         /. . .      a smaller cell needs a wider mask, or loses the giant's contacts
//!    '-------'  . . .
//! ```

use crate::hard::Maker;
use crate::hard::build::*;
use crate::hard::tangent::of_length;

pub const MAKERS: &[Maker] = &[
    ("giant-first-in-dust", |dim| {
        let mut bodies = dust(dim);
        bodies.insert(0, ([0.1; 3], 1.0));
        each(dim, &bodies)
    }),
    ("giant-last-in-dust", |dim| {
        let mut bodies = dust(dim);
        bodies.push(([0.1; 3], 1.0));
        each(dim, &bodies)
    }),
    ("giant-and-far-dust", |dim| {
        let (length, scale) = by_dim(dim, [(65, two_to(5)), (9, two_to(8))]);
        let r = 0.125;
        let giant = ([0.0; 3], f64::from(length) * scale - r);
        let near = of_length(dim, length).into_iter().map(|v| (v.map(|x| x * scale), r));
        // A second crown, at least one unit farther out: not in touch.
        let far =
            near.clone().map(|(v, r)| (v.map(|x| if x == 0.0 { x } else { x + x.signum() }), r));
        each(dim, &near.chain(far).chain([giant]).collect::<Vec<_>>())
    }),
    ("point-beside-a-giant", |dim| {
        let r: f64 = 1024.0;
        let points = [0.5 * r, r, r.next_up(), -r, (-r).next_down()];
        let around = lines(dim, &points, 0.0).into_iter().map(|place| (place, 0.0));
        each(dim, &around.chain([([0.0; 3], r)]).collect::<Vec<_>>())
    }),
    ("giants-across-dust", |dim| {
        let mut bodies: Vec<(Place, f64)> =
            vec![([-300.0, 0.0, 0.0], 500.0), ([300.0, 800.0, 0.0], 500.0)];
        // Below both giants, apart from them.
        bodies
            .extend((0..300).map(|k| ([f64::from(k % 20), f64::from(k / 20) - 700.0, 0.0], 0.25)));
        each(dim, &bodies)
    }),
    ("every-size-in-a-chain", |dim| {
        // Centres at 2 - 3·2^-k from radii 2^-k: the distances are 1.5·2^-k = 2^-k + 2^-(k+1).
        let bodies = (0..14).map(|k| ([2.0 - 3.0 * two_to(-k), 0.0, 0.0], two_to(-k)));
        each(dim, &bodies.collect::<Vec<_>>())
    }),
    ("two-scales", |dim| {
        let coarse =
            lattice(dim, by_dim(dim, [12, 6]), |k| 64.0 * k).into_iter().map(|place| (place, 32.0));
        let fine =
            lattice(dim, by_dim(dim, [12, 6]), |k| k - 100.0).into_iter().map(|place| (place, 0.5));
        each(dim, &coarse.chain(fine).collect::<Vec<_>>())
    }),
    ("one-inside-the-other", |dim| {
        each(dim, &(-20..20).map(|k| ([0.5, -3.0, 7.0], two_to(k))).collect::<Vec<_>>())
    }),
    ("uniform-radii-one-by-one", |dim| {
        each(
            dim,
            &lattice(dim, by_dim(dim, [12, 6]), |k| k - 3.0)
                .into_iter()
                .map(|place| (place, 0.5))
                .collect::<Vec<_>>(),
        )
    }),
];

/// 400 or 343 bodies of radius 2^-14 within about 1/2 of the origin, all apart.
fn dust(dim: u32) -> Vec<(Place, f64)> {
    lattice(dim, by_dim(dim, [20, 7]), |k| by_dim(dim, [0.03125, 0.0625]) * k - 0.2)
        .into_iter()
        .map(|place| (place, two_to(-14)))
        .collect()
}
