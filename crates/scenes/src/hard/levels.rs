//! Radii at and near the borders between classes of sizes.
//!
//! ```text
//!   radius   1         1/2       1/4       1/8
//!            |---------o---------o---------o---      a radius exactly at a border, a last bit to
//!                  coarse    middle     fine         either side of it, classes of one body, of
//!                                                    none, of all
//! ```
//!
//! Class borders are the largest radius divided by powers of 2. The cases are also valid for
//! detectors with other borders.

use crate::hard::Maker;
use crate::hard::build::*;

pub const MAKERS: &[Maker] = &[
    ("radius-at-each-border", |dim| each(dim, pairs(1.0, |border| border))),
    ("radius-a-last-bit-above-each-border", |dim| {
        each(dim, pairs(1.0, |border| if border < 1.0 { border.next_up() } else { border }))
    }),
    ("radius-a-last-bit-below-each-border", |dim| each(dim, pairs(1.0, f64::next_down))),
    ("borders-at-a-tiny-scale", |dim| each(dim, pairs(two_to(-1000), |border| border))),
    ("borders-at-a-huge-scale", |dim| each(dim, pairs(two_to(1000), |border| border))),
    ("all-radii-at-one-border", |dim| {
        beside(dim, of_size(lattice(dim, [12, 6], |k| k), 0.5), ([-100.0, 0.0, 0.0], 1.0))
    }),
    ("both-ends-of-a-class", |dim| {
        each(dim, chain(40, |k: u32| [1.0, 1.0, 0.75, 0.75][k as usize % 4]))
    }),
    ("one-body-per-class", |dim| {
        let place = |k: i32| {
            let t = f64::from(k) / 16.0 - 1.0;
            let below = 1.0 + t * t;
            [(1.0 - t * t) / below, 2.0 * t / below, 0.0]
        };
        beside(dim, (1..30).map(|k| (place(k), two_to(-k))), ([0.0; 3], 1.0))
    }),
    ("empty-classes-between", |dim| {
        let dust = two_to(-30);
        let around = [1.0, 3.0].map(|gap| axes(dim, 1.0 + gap * dust));
        beside(dim, of_size(around.concat(), dust), ([0.0; 3], 1.0))
    }),
    ("ratio-of-a-million", |dim| {
        let (giant, touching) = (1e6, 1e6 + 1.0);
        let beyond = corners(dim).into_iter().map(|v| v.map(|e| e * touching));
        let around = axes(dim, touching).into_iter().chain(beyond);
        beside(dim, of_size(around, 1.0), ([0.0; 3], giant))
    }),
    ("range-of-two-to-the-32", |dim| {
        let (large, small) = (two_to(16), two_to(-16));
        beside(dim, of_size(axes(dim, large + small), small), ([0.0; 3], large))
    }),
    // The particles in contact are at the whole-number points within 5 of the origin.
    ("points-around-a-giant", |dim| {
        beside(dim, of_size(lattice(dim, [13; 2], |k| k - 6.0), 0.0), ([0.0; 3], 5.0))
    }),
    ("giants-far-apart", |dim| {
        let crown = |centre: Place| {
            let around = axes(dim, 1.0).into_iter().map(move |v| plus(centre, 1025.0, v));
            [(centre, 1024.0)].into_iter().chain(of_size(around, 1.0))
        };
        each(dim, [[0.0; 3], [two_to(20), 0.0, 0.0]].into_iter().flat_map(crown))
    }),
    ("all-sizes-in-one-point", |dim| {
        each(dim, (0..200).map(|k| ([0.3, -0.7, 0.1], 1.0 + f64::from(k) / 64.0)))
    }),
    ("giant-tangent-from-below", |dim| beside_dust(dim, |_| -1000.0)),
    ("giant-tangent-from-above", |dim| beside_dust(dim, |last| last + 1000.0)),
    ("giant-over-a-line-of-dust", |dim| {
        let dust = (-50..=50).map(|k| ([f64::from(k), 0.0, 0.0], 0.25));
        beside(dim, dust, ([0.0; 3], 49.75))
    }),
    ("giant-in-a-block-of-dust", |dim| {
        let middle = 0.5 * by_dim(dim, [39.0, 11.0]);
        let dust = of_size(lattice(dim, [40, 12], |k| k - middle), 0.25);
        beside(dim, dust, ([0.25; 3], 0.8 * middle))
    }),
    ("classes-in-turn", |dim| each(dim, chain(64, |k| two_to(-3 * (k as i32 % 4))))),
    ("smallest-numbers-beside-a-giant", |dim| {
        let pair = |k: i32| {
            let (r, y) = (two_to(-1070 - k), 8.0 * f64::from(k));
            [([0.0, y, 0.0], two_to(-1070)), ([two_to(-1070) + r, y, 0.0], r)]
        };
        each(dim, [([-100.0, 0.0, 0.0], 1.0)].into_iter().chain((0..5).flat_map(pair)))
    }),
    ("forty-classes-in-a-crowd", |dim| {
        let places = lattice(dim, [20, 8], |k| k / 8.0).into_iter();
        each(dim, places.zip(0..).map(|(place, k)| (place, two_to(-(k % 40)))))
    }),
];

fn beside(dim: u32, particles: impl Iterator<Item = Particle>, last: Particle) -> Steps {
    each(dim, particles.chain([last]))
}

/// Returns 13 pairs for the borders 2^-k, k = 0 to 12. The particles of a pair are (1 + 2^-k)·scale
/// apart; their radii are `scale` and `radius(2^-k)`·scale.
fn pairs(scale: f64, radius: impl Fn(f64) -> f64) -> impl Iterator<Item = Particle> {
    (0..13).flat_map(move |k| {
        let (border, y) = (two_to(-k), 8.0 * f64::from(k) * scale);
        [([0.0, y, 0.0], scale), ([(1.0 + border) * scale, y, 0.0], radius(border) * scale)]
    })
}

/// Returns particles along x, each exactly in touch with its predecessor.
fn chain(count: u32, radius: impl Fn(u32) -> f64) -> impl Iterator<Item = Particle> {
    let mut x = 0.0;
    (0..count).map(move |k| {
        if k > 0 {
            x += radius(k - 1) + radius(k);
        }
        ([x, 0.0, 0.0], radius(k))
    })
}

/// Returns a lattice of dust and a giant that exactly touches its first or last particle along x.
/// `centre` maps the x of the last site to that of the giant's centre, 1000 from the touched
/// particle.
fn beside_dust(dim: u32, centre: impl Fn(f64) -> f64) -> Steps {
    let giant = ([centre(by_dim(dim, [11.0, 5.0])), 0.0, 0.0], 999.75);
    beside(dim, of_size(lattice(dim, [12, 6], |k| k), 0.25), giant)
}
