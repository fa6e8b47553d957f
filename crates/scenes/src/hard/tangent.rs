//! Bodies that exactly touch, and one step to either side.
//!
//! ```text
//!        o        |(3, 4)| = 5 = 2.5 + 2.5: all numbers dyadic, so the tie is exact.
//!      / | 4      A strict test, a rounded root or the form p·p + q·q - 2p·q decides otherwise.
//!     o--+
//!      3
//! ```

use crate::hard::Maker;
use crate::hard::build::*;

pub const MAKERS: &[Maker] = &[
    ("tangent-3-4-5", |dim| ties(dim, [3.0, 4.0, 0.0], 5.0, 0.125)),
    ("tangent-5-12-13", |dim| ties(dim, [5.0, 12.0, 0.0], 13.0, 0.5)),
    ("tangent-8-15-17", |dim| ties(dim, [8.0, 15.0, 0.0], 17.0, 2.0)),
    ("tangent-1-2-2-3", |dim| ties(dim, [1.0, 2.0, 2.0], 3.0, 1.0)),
    ("tangent-2-3-6-7", |dim| ties(dim, [2.0, 3.0, 6.0], 7.0, 0.25)),
    ("tangent-4-4-7-9", |dim| ties(dim, [4.0, 4.0, 7.0], 9.0, 0.125)),
    ("tangent-many-bits", |dim| {
        // Triples with a factor for which the rounded squares say apart.
        let triples = [
            [128.0, 4095.0, 4097.0, two_to(24) - 111.0],
            [1155.0, 68.0, 1157.0, two_to(24) - 37.0],
            [3.0, 4.0, 5.0, two_to(27) - 19.0],
        ];
        let couples = triples.into_iter().flat_map(|[x, y, length, scale]| {
            let directions = orientations(dim, [x * scale, y * scale, 0.0]);
            directions.into_iter().map(move |v| Couple {
                v,
                outward: 0,
                radii: [0.5 * length * scale; 2],
            })
        });
        together(dim, two_to(38), couples)
    }),
    ("one-ulp-in-x", |dim| {
        let triple = by_dim(dim, [[3.0, 4.0, 0.0], [4.0, 4.0, 7.0]]);
        let length = by_dim(dim, [5.0, 9.0]);
        let couples = orientations(dim, triple)
            .into_iter()
            .flat_map(|v| [-1, 0, 1].map(|outward| (v, outward)));
        together(
            dim,
            32.0,
            couples.map(|(v, outward)| Couple { v, outward, radii: [0.5 * length; 2] }),
        )
    }),
    ("one-ulp-in-r", |dim| {
        let triple = by_dim(dim, [[5.0, 12.0, 0.0], [2.0, 3.0, 6.0]]);
        let r: f64 = by_dim(dim, [6.5, 3.5]);
        let couples = orientations(dim, triple)
            .into_iter()
            .flat_map(|v| [r, r.next_up(), r.next_down()].map(|other| (v, other)));
        together(dim, 64.0, couples.map(|(v, other)| Couple { v, outward: 0, radii: [r, other] }))
    }),
    ("one-ulp-in-both", |dim| {
        let r: f64 = 2.5;
        let changes =
            [(1, r.next_up()), (1, r.next_down()), (-1, r.next_up()), (-1, r.next_down())];
        let couples = orientations(dim, [3.0, 4.0, 0.0])
            .into_iter()
            .flat_map(|v| changes.map(|change| (v, change)));
        together(
            dim,
            16.0,
            couples.map(|(v, (outward, other))| Couple { v, outward, radii: [r, other] }),
        )
    }),
    ("unequal-radii", |dim| {
        let parts = [0.5, 0.25, two_to(-10), two_to(-20), 0.0];
        let couples = orientations(dim, [3.0, 4.0, 0.0])
            .into_iter()
            .flat_map(|v| parts.map(|part| (v, part)));
        together(
            dim,
            32.0,
            couples.map(|(v, part)| Couple {
                v,
                outward: 0,
                radii: [5.0 * part, 5.0 * (1.0 - part)],
            }),
        )
    }),
    ("many-scales", |dim| {
        let triple = by_dim(dim, [[3.0, 4.0, 0.0], [2.0, 3.0, 6.0]]);
        let length = by_dim(dim, [5.0, 7.0]);
        // Of each scale a tie, one nearer by a part in 2^20, and, in space, one with the axes
        // turned; and one too far.
        let couples = (-10..=10).flat_map(|k| {
            let v = triple.map(|x| two_to(k) * x);
            let r = 0.5 * two_to(k) * length;
            let near = v.map(|x| x * (1.0 - two_to(-20)));
            let far = v.map(|x| x * (1.0 + two_to(-20)));
            let turned = (dim == 3).then_some([v[2], v[0], v[1]]);
            [Some(v), Some(near), turned, Some(far)].into_iter().flatten().map(move |v| Couple {
                v,
                outward: 0,
                radii: [r; 2],
            })
        });
        together(dim, two_to(15), couples)
    }),
    ("dyadic-offset", |dim| {
        let couples =
            orientations(dim, [3.0, 4.0, 0.0]).into_iter().enumerate().flat_map(|(k, v)| {
                let place = plus([two_to(44); 3], 1.0, site(k, 16.0));
                [place, plus(place, 1.0, v)]
            });
        uniform(dim, &couples.collect::<Vec<_>>(), 2.5)
    }),
    ("kissing-crown", |dim| {
        let (length, r) = by_dim(dim, [(65, 0.5), (9, 0.5)]);
        let centre = ([0.0; 3], f64::from(length) - r);
        let crown = of_length(dim, length).into_iter().map(|v| (v, r));
        each(dim, &std::iter::once(centre).chain(crown).collect::<Vec<_>>())
    }),
    ("sum-of-radii-rounds", |dim| {
        let r = two_to(-53);
        // Along every axis two couples 1 + 2^-53 apart, one in touch, one 2^-106 short of it.
        let bodies = (0..dim as usize).flat_map(|axis| {
            [r, r.next_down()].into_iter().enumerate().flat_map(move |(k, small)| {
                let at =
                    |x: f64| {
                        std::array::from_fn(|a| {
                            if a == axis { x } else { 8.0 * (k + 1 + 2 * axis) as f64 }
                        })
                    };
                [(at(-r), small), (at(1.0), 1.0)]
            })
        });
        each(dim, &bodies.collect::<Vec<_>>())
    }),
];

/// Two bodies: the second is `v` from the first, and then `outward` last bits farther away along
/// the first axis on which it differs.
struct Couple {
    v: Place,
    outward: i32,
    radii: [f64; 2],
}

/// Couples, each at a place of its own.
fn together(dim: u32, gap: f64, couples: impl IntoIterator<Item = Couple>) -> Steps {
    let bodies = couples.into_iter().enumerate().flat_map(|(k, Couple { v, outward, radii })| {
        let first = site(k, gap);
        let mut second = plus(first, 1.0, v);
        if let Some(axis) = v.iter().position(|&x| x != 0.0) {
            let up = (outward > 0) == (v[axis] > 0.0);
            for _ in 0..outward.abs() {
                second[axis] = if up { second[axis].next_up() } else { second[axis].next_down() };
            }
        }
        [(first, radii[0]), (second, radii[1])]
    });
    each(dim, &bodies.collect::<Vec<_>>())
}

/// Couples of one radius in all directions of a triple, exactly in touch.
fn ties(dim: u32, v: Place, length: f64, scale: f64) -> Steps {
    let places =
        orientations(dim, v.map(|x| x * scale)).into_iter().enumerate().flat_map(|(k, v)| {
            let first = plus([-3.0; 3], 1.0, site(k, 4.0 * length * scale));
            [first, plus(first, 1.0, v)]
        });
    uniform(dim, &places.collect::<Vec<_>>(), 0.5 * length * scale)
}

/// All vectors that permutation and change of sign make of `v`.
fn orientations(dim: u32, v: Place) -> Vec<Place> {
    let orders = [[0, 1, 2], [1, 0, 2], [0, 2, 1], [2, 1, 0], [1, 2, 0], [2, 0, 1]];
    let mut all: Vec<Place> = Vec::new();
    for order in &orders[..by_dim(dim, [2, 6])] {
        for signs in corners(3) {
            let turned =
                std::array::from_fn(
                    |k| if v[order[k]] == 0.0 { 0.0 } else { signs[k] * v[order[k]] },
                );
            if !all.contains(&turned) {
                all.push(turned);
            }
        }
    }
    all
}

/// All vectors of whole numbers with this length.
pub fn of_length(dim: u32, length: i32) -> Vec<Place> {
    let depth = if dim == 2 { 0 } else { length };
    let (mut all, range) = (Vec::new(), -length..=length);
    for x in range.clone() {
        for y in range.clone() {
            all.extend(
                (-depth..=depth)
                    .filter(|z| x * x + y * y + z * z == length * length)
                    .map(|z| [x, y, z].map(f64::from)),
            );
        }
    }
    all
}
