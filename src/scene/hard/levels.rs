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

use crate::scene::hard::build::*;
use crate::scene::hard::{Case, Expect, Group};

const LEVELS: Case = Case::in_group(Group::Sizes);

pub const CASES: &[Case] = &[
    Case {
        name: "radius-at-each-border",
        reason: "couples exactly in touch, of the largest radius and of one at a border: it \
                 belongs to one class only, and its reach must be that of the class",
        expect: Expect::Contacts([13, 13]),
        make: |dim| each(dim, &couples(1.0, |border| border)),
        ..LEVELS
    },
    Case {
        name: "radius-a-last-bit-above-each-border",
        reason: "as radius-at-each-border, a last bit larger: the class above begins here",
        expect: Expect::Contacts([13, 13]),
        make: |dim| {
            each(dim, &couples(1.0, |border| if border < 1.0 { border.next_up() } else { border }))
        },
        ..LEVELS
    },
    Case {
        name: "radius-a-last-bit-below-each-border",
        reason: "as radius-at-each-border, a last bit smaller: no couple touches, and a reach \
                 rounded up must not make it so",
        expect: Expect::Contacts([0, 0]),
        make: |dim| each(dim, &couples(1.0, f64::next_down)),
        ..LEVELS
    },
    Case {
        name: "borders-at-a-tiny-scale",
        reason: "as radius-at-each-border, where squares of distances vanish",
        expect: Expect::Contacts([13, 13]),
        make: |dim| each(dim, &couples(two_to(-1000), |border| border)),
        ..LEVELS
    },
    Case {
        name: "borders-at-a-huge-scale",
        reason: "as radius-at-each-border, where squares of distances overflow",
        expect: Expect::Contacts([13, 13]),
        make: |dim| each(dim, &couples(two_to(1000), |border| border)),
        ..LEVELS
    },
    Case {
        name: "all-radii-at-one-border",
        reason: "a lattice exactly in touch, of bodies half as large as one far away: all are at \
                 a border, and one class is nearly empty",
        expect: of_lattice([12, 6], 1),
        make: |dim| {
            let small = lattice(dim, by_dim(dim, [12, 6]), |k| k).into_iter();
            let large = ([-100.0, 0.0, 0.0], 1.0);
            each(dim, &small.map(|place| (place, 0.5)).chain([large]).collect::<Vec<_>>())
        },
        ..LEVELS
    },
    Case {
        name: "both-ends-of-a-class",
        reason: "a chain exactly in touch of radii 1, 1, 3/4, 3/4 in turn: the cells of a class \
                 must be as wide as its largest radius asks for, not as its mean",
        expect: Expect::Contacts([39, 39]),
        make: |dim| {
            let radius = |k: u32| [1.0, 1.0, 0.75, 0.75][k as usize % 4];
            each(dim, &chain(40, radius))
        },
        ..LEVELS
    },
    Case {
        name: "one-body-per-class",
        reason: "30 radii, each half of the one before, all other centres on the surface of the \
                 largest: every class has one body and must look into every other",
        make: |dim| {
            let place = |k: u32| {
                let t = f64::from(k) / 16.0 - 1.0;
                let below = 1.0 + t * t;
                [(1.0 - t * t) / below, 2.0 * t / below, 0.0]
            };
            let small = (1..30).map(|k| (place(k), two_to(-(k as i32))));
            each(dim, &small.chain([([0.0; 3], 1.0)]).collect::<Vec<_>>())
        },
        ..LEVELS
    },
    Case {
        name: "empty-classes-between",
        reason: "a giant and dust 2^30 times smaller, exactly in touch, and dust in touch with \
                 dust: 29 classes between them have no body",
        expect: Expect::Contacts([8, 12]),
        make: |dim| {
            let dust = two_to(-30);
            let place = |x: f64| move |v: Place| (v.map(|e| e * x), dust);
            let inner = axes(dim).into_iter().map(place(1.0 + dust));
            let outer = axes(dim).into_iter().map(place(1.0 + 3.0 * dust));
            each(dim, &inner.chain(outer).chain([([0.0; 3], 1.0)]).collect::<Vec<_>>())
        },
        ..LEVELS
    },
    Case {
        name: "ratio-of-a-million",
        reason: "dust exactly in touch with a body 10^6 times larger along every axis, and dust \
                 beyond its surface in the corners of the box around it",
        source: "lammps#4977",
        expect: Expect::Contacts([4, 6]),
        make: |dim| {
            let (giant, touching) = (1e6, 1e6 + 1.0);
            let place = |x: f64| move |v: Place| (v.map(|e| e * x), 1.0);
            let at = axes(dim).into_iter().map(place(touching));
            let beyond = corners(dim).into_iter().map(|v| (v.map(|e| e * touching), 1.0));
            each(dim, &at.chain(beyond).chain([([0.0; 3], giant)]).collect::<Vec<_>>())
        },
        ..LEVELS
    },
    Case {
        name: "range-of-two-to-the-32",
        reason: "radii 2^16 and 2^-16 exactly in touch: cells of the small ones cannot be numbered \
                 over the domain of the large",
        expect: Expect::Contacts([4, 6]),
        make: |dim| {
            let (large, small) = (two_to(16), two_to(-16));
            let dust = axes(dim).into_iter().map(|v| (v.map(|e| e * (large + small)), small));
            each(dim, &dust.chain([([0.0; 3], large)]).collect::<Vec<_>>())
        },
        ..LEVELS
    },
    Case {
        name: "points-around-a-giant",
        reason: "a lattice of points without extent, some exactly on the surface of a giant: their \
                 own class has no reach at all",
        // Whole points within 5 of the origin, in the plane and in space.
        expect: Expect::Contacts([81, 515]),
        make: |dim| {
            let points = lattice(dim, 13, |k| k - 6.0).into_iter().map(|place| (place, 0.0));
            each(dim, &points.chain([([0.0; 3], 5.0)]).collect::<Vec<_>>())
        },
        ..LEVELS
    },
    Case {
        name: "giants-far-apart",
        reason: "two giants 2^20 apart, each with dust in touch: the dust's class reaches over a \
                 domain that is empty between",
        source: "rapier#153",
        expect: Expect::Contacts([2 * 4, 2 * 6]),
        make: |dim| {
            let mut bodies = Vec::new();
            for centre in [[0.0; 3], [two_to(20), 0.0, 0.0]] {
                bodies.push((centre, 1024.0));
                bodies.extend(axes(dim).into_iter().map(|v| (plus(centre, 1025.0, v), 1.0)));
            }
            each(dim, &bodies)
        },
        ..LEVELS
    },
    Case {
        name: "all-sizes-in-one-point",
        reason: "200 radii over two octaves with one centre: every class has all others in one \
                 cell",
        expect: Expect::Contacts([pairs(200), pairs(200)]),
        make: |dim| {
            let body = |k: u32| ([0.3, -0.7, 0.1], 1.0 + f64::from(k) / 64.0);
            each(dim, &(0..200).map(body).collect::<Vec<_>>())
        },
        ..LEVELS
    },
    Case {
        name: "giant-tangent-from-below",
        reason: "a giant beyond the lower border of all dust, exactly in touch with one speck: a \
                 search from the giant begins below the first cell",
        expect: Expect::Contacts([1, 1]),
        make: |dim| beside_dust(dim, |_| -1000.0),
        ..LEVELS
    },
    Case {
        name: "giant-tangent-from-above",
        reason: "as giant-tangent-from-below, beyond the upper border",
        expect: Expect::Contacts([1, 1]),
        make: |dim| beside_dust(dim, |last| last + 1000.0),
        ..LEVELS
    },
    Case {
        name: "giant-over-a-line-of-dust",
        reason: "dust in a line through a giant, from surface to surface: all cells of a row, the \
                 first and the last exactly in touch",
        expect: Expect::Contacts([101, 101]),
        make: |dim| {
            let dust = (-50..=50).map(|k| ([f64::from(k), 0.0, 0.0], 0.25));
            each(dim, &dust.chain([([0.0; 3], 49.75)]).collect::<Vec<_>>())
        },
        ..LEVELS
    },
    Case {
        name: "giant-in-a-block-of-dust",
        reason: "a giant inside a lattice of dust that it partly covers: what is near along every \
                 axis need not be near",
        make: |dim| {
            let m = by_dim(dim, [40, 12]);
            let middle = 0.5 * f64::from(m - 1);
            let dust = lattice(dim, m, |k| k - middle).into_iter().map(|place| (place, 0.25));
            each(dim, &dust.chain([([0.25; 3], 0.8 * middle)]).collect::<Vec<_>>())
        },
        ..LEVELS
    },
    Case {
        name: "classes-in-turn",
        reason: "a chain exactly in touch of radii 1, 2^-3, 2^-6, 2^-9 in turn: every contact is \
                 between two classes, and the first and the last are next to each other",
        expect: Expect::Contacts([63, 63]),
        make: |dim| each(dim, &chain(64, |k| two_to(-3 * (k as i32 % 4)))),
        ..LEVELS
    },
    Case {
        name: "smallest-numbers-beside-a-giant",
        reason: "couples exactly in touch of the smallest radii that there are, and a giant far \
                 away: its radius must be halved a thousand times to get there",
        expect: Expect::Contacts([5, 5]),
        make: |dim| {
            let mut bodies = vec![([-100.0, 0.0, 0.0], 1.0)];
            for k in 0..5 {
                let (r, y) = (two_to(-1070 - k), 8.0 * f64::from(k));
                bodies.push(([0.0, y, 0.0], two_to(-1070)));
                bodies.push(([two_to(-1070) + r, y, 0.0], r));
            }
            each(dim, &bodies)
        },
        ..LEVELS
    },
    Case {
        name: "forty-classes-in-a-crowd",
        reason: "a lattice with radii from 1 to 2^-39 in turn, spaced as the middle ones: the \
                 large overlap many, the small touch nobody of their own size",
        make: |dim| {
            let places = lattice(dim, by_dim(dim, [20, 8]), |k| k / 8.0).into_iter();
            let bodies = places.zip(0..).map(|(place, k)| (place, two_to(-(k % 40))));
            each(dim, &bodies.collect::<Vec<_>>())
        },
        ..LEVELS
    },
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
