//! Classes of sizes: what goes wrong where a detector parts bodies by their radii.
//!
//! ```text
//!   radius   1         1/2       1/4       1/8
//!            |---------o---------o---------o---      a radius exactly at a border, a last bit to
//!                  coarse    middle     fine         either side of it, classes of one body, of
//!                                                    none, of all
//! ```
//!
//! Borders are taken where halving the largest radius puts them; the cases hold for all others.

use crate::hard::Maker;
use crate::hard::build::*;

pub const MAKERS: &[Maker] = &[
    ("radius-at-each-border", |dim| each(dim, &couples(1.0, |border| border))),
    ("radius-a-last-bit-above-each-border", |dim| {
        each(dim, &couples(1.0, |border| if border < 1.0 { border.next_up() } else { border }))
    }),
    ("radius-a-last-bit-below-each-border", |dim| each(dim, &couples(1.0, f64::next_down))),
    ("borders-at-a-tiny-scale", |dim| each(dim, &couples(two_to(-1000), |border| border))),
    ("borders-at-a-huge-scale", |dim| each(dim, &couples(two_to(1000), |border| border))),
    ("all-radii-at-one-border", |dim| {
        let small = lattice(dim, by_dim(dim, [12, 6]), |k| k).into_iter();
        let large = ([-100.0, 0.0, 0.0], 1.0);
        each(dim, &small.map(|place| (place, 0.5)).chain([large]).collect::<Vec<_>>())
    }),
    ("both-ends-of-a-class", |dim| {
        let radius = |k: u32| [1.0, 1.0, 0.75, 0.75][k as usize % 4];
        each(dim, &chain(40, radius))
    }),
    ("one-body-per-class", |dim| {
        let place = |k: u32| {
            let t = f64::from(k) / 16.0 - 1.0;
            let below = 1.0 + t * t;
            [(1.0 - t * t) / below, 2.0 * t / below, 0.0]
        };
        let small = (1..30).map(|k| (place(k), two_to(-(k as i32))));
        each(dim, &small.chain([([0.0; 3], 1.0)]).collect::<Vec<_>>())
    }),
    ("empty-classes-between", |dim| {
        let dust = two_to(-30);
        let place = |x: f64| move |v: Place| (v.map(|e| e * x), dust);
        let inner = axes(dim).into_iter().map(place(1.0 + dust));
        let outer = axes(dim).into_iter().map(place(1.0 + 3.0 * dust));
        each(dim, &inner.chain(outer).chain([([0.0; 3], 1.0)]).collect::<Vec<_>>())
    }),
    ("ratio-of-a-million", |dim| {
        let (giant, touching) = (1e6, 1e6 + 1.0);
        let place = |x: f64| move |v: Place| (v.map(|e| e * x), 1.0);
        let at = axes(dim).into_iter().map(place(touching));
        let beyond = corners(dim).into_iter().map(|v| (v.map(|e| e * touching), 1.0));
        each(dim, &at.chain(beyond).chain([([0.0; 3], giant)]).collect::<Vec<_>>())
    }),
    ("range-of-two-to-the-32", |dim| {
        let (large, small) = (two_to(16), two_to(-16));
        let dust = axes(dim).into_iter().map(|v| (v.map(|e| e * (large + small)), small));
        each(dim, &dust.chain([([0.0; 3], large)]).collect::<Vec<_>>())
    }),
    // Whole points within 5 of the origin, in the plane and in space.
    ("points-around-a-giant", |dim| {
        let points = lattice(dim, 13, |k| k - 6.0).into_iter().map(|place| (place, 0.0));
        each(dim, &points.chain([([0.0; 3], 5.0)]).collect::<Vec<_>>())
    }),
    ("giants-far-apart", |dim| {
        let mut bodies = Vec::new();
        for centre in [[0.0; 3], [two_to(20), 0.0, 0.0]] {
            bodies.push((centre, 1024.0));
            bodies.extend(axes(dim).into_iter().map(|v| (plus(centre, 1025.0, v), 1.0)));
        }
        each(dim, &bodies)
    }),
    ("all-sizes-in-one-point", |dim| {
        let body = |k: u32| ([0.3, -0.7, 0.1], 1.0 + f64::from(k) / 64.0);
        each(dim, &(0..200).map(body).collect::<Vec<_>>())
    }),
    ("giant-tangent-from-below", |dim| beside_dust(dim, |_| -1000.0)),
    ("giant-tangent-from-above", |dim| beside_dust(dim, |last| last + 1000.0)),
    ("giant-over-a-line-of-dust", |dim| {
        let dust = (-50..=50).map(|k| ([f64::from(k), 0.0, 0.0], 0.25));
        each(dim, &dust.chain([([0.0; 3], 49.75)]).collect::<Vec<_>>())
    }),
    ("giant-in-a-block-of-dust", |dim| {
        let m = by_dim(dim, [40, 12]);
        let middle = 0.5 * f64::from(m - 1);
        let dust = lattice(dim, m, |k| k - middle).into_iter().map(|place| (place, 0.25));
        each(dim, &dust.chain([([0.25; 3], 0.8 * middle)]).collect::<Vec<_>>())
    }),
    ("classes-in-turn", |dim| each(dim, &chain(64, |k| two_to(-3 * (k as i32 % 4))))),
    ("smallest-numbers-beside-a-giant", |dim| {
        let mut bodies = vec![([-100.0, 0.0, 0.0], 1.0)];
        for k in 0..5 {
            let (r, y) = (two_to(-1070 - k), 8.0 * f64::from(k));
            bodies.push(([0.0, y, 0.0], two_to(-1070)));
            bodies.push(([two_to(-1070) + r, y, 0.0], r));
        }
        each(dim, &bodies)
    }),
    ("forty-classes-in-a-crowd", |dim| {
        let places = lattice(dim, by_dim(dim, [20, 8]), |k| k / 8.0).into_iter();
        let bodies = places.zip(0..).map(|(place, k)| (place, two_to(-(k % 40))));
        each(dim, &bodies.collect::<Vec<_>>())
    }),
];

/// Couples at distance (1 + 2^-k)·scale for k from 0 to 12, of radii `scale` and what `radius`
/// makes of the border 2^-k.
fn couples(scale: f64, radius: impl Fn(f64) -> f64) -> Vec<(Place, f64)> {
    let couple = |k: i32| {
        let (border, y) = (two_to(-k), 8.0 * f64::from(k) * scale);
        [([0.0, y, 0.0], scale), ([(1.0 + border) * scale, y, 0.0], radius(border) * scale)]
    };
    (0..13).flat_map(couple).collect()
}

/// Bodies along x, each exactly in touch with the one before it.
fn chain(count: u32, radius: impl Fn(u32) -> f64) -> Vec<(Place, f64)> {
    let mut x = 0.0;
    let body = |k: u32| {
        if k > 0 {
            x += radius(k - 1) + radius(k);
        }
        ([x, 0.0, 0.0], radius(k))
    };
    (0..count).map(body).collect()
}

/// The vectors of length 1 along every axis, in both directions.
fn axes(dim: u32) -> Vec<Place> {
    let along = |axis: usize, x: f64| std::array::from_fn(|k| if k == axis { x } else { 0.0 });
    (0..dim as usize).flat_map(|axis| [along(axis, 1.0), along(axis, -1.0)]).collect()
}

/// A lattice of dust, and a giant exactly in touch with its first or last speck along x: its centre
/// is 1000 from there.
fn beside_dust(dim: u32, centre: impl Fn(f64) -> f64) -> Steps {
    let m = by_dim(dim, [12, 6]);
    let dust = lattice(dim, m, |k| k).into_iter().map(|place| (place, 0.25));
    let giant = ([centre(f64::from(m - 1)), 0.0, 0.0], 999.75);
    each(dim, &dust.chain([giant]).collect::<Vec<_>>())
}
