//! Particles that exactly touch, or overlap or miss each other by the last bit.
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
        // Each factor makes the rounded squares report no contact, although the particles touch.
        let triples = [
            [128.0, 4095.0, 4097.0, two_to(24) - 111.0],
            [1155.0, 68.0, 1157.0, two_to(24) - 37.0],
            [3.0, 4.0, 5.0, two_to(27) - 19.0],
        ];
        let pairs = triples.into_iter().flat_map(|[x, y, length, scale]| {
            let radii = [0.5 * length * scale; 2];
            let all = orientations(dim, [x * scale, y * scale, 0.0]);
            all.into_iter().map(move |v| Pair { v, outward: 0, radii })
        });
        together(dim, two_to(38), pairs)
    }),
    ("one-ulp-in-x", |dim| {
        let (triple, r) = by_dim(dim, [([3.0, 4.0, 0.0], 2.5), ([4.0, 4.0, 7.0], 4.5)]);
        turned(dim, triple, 32.0, [-1, 0, 1].map(|outward| (outward, [r; 2])))
    }),
    ("one-ulp-in-r", |dim| {
        let triple = by_dim(dim, [[5.0, 12.0, 0.0], [2.0, 3.0, 6.0]]);
        let r: f64 = by_dim(dim, [6.5, 3.5]);
        turned(dim, triple, 64.0, [r, r.next_up(), r.next_down()].map(|other| (0, [r, other])))
    }),
    ("one-ulp-in-both", |dim| {
        let r: f64 = 2.5;
        let (up, down) = ([r, r.next_up()], [r, r.next_down()]);
        turned(dim, [3.0, 4.0, 0.0], 16.0, [(1, up), (1, down), (-1, up), (-1, down)])
    }),
    ("unequal-radii", |dim| {
        let parts = [0.5, 0.25, two_to(-10), two_to(-20), 0.0];
        let parts = parts.map(|part| (0, [5.0 * part, 5.0 * (1.0 - part)]));
        turned(dim, [3.0, 4.0, 0.0], 32.0, parts)
    }),
    ("many-scales", |dim| {
        let (triple, length) = by_dim(dim, [([3.0, 4.0, 0.0], 5.0), ([2.0, 3.0, 6.0], 7.0)]);
        // For each scale: a pair exactly in touch, one nearer by 2^-20 of its distance, one farther
        // by the same, and in 3D one with exchanged axes.
        let pairs = (-10..=10).flat_map(|k| {
            let (v, radii) = (triple.map(|x| two_to(k) * x), [0.5 * two_to(k) * length; 2]);
            let near = v.map(|x| x * (1.0 - two_to(-20)));
            let far = v.map(|x| x * (1.0 + two_to(-20)));
            let turned = (dim == 3).then_some([v[2], v[0], v[1]]);
            let all = [Some(v), Some(near), turned, Some(far)].into_iter().flatten();
            all.map(move |v| Pair { v, outward: 0, radii })
        });
        together(dim, two_to(15), pairs)
    }),
    ("dyadic-offset", |dim| uniform(dim, pairs(dim, [3.0, 4.0, 0.0], [two_to(44); 3], 16.0), 2.5)),
    ("kissing-crown", |dim| {
        let (length, r) = (by_dim(dim, [65, 9]), 0.5);
        let centre = ([0.0; 3], f64::from(length) - r);
        each(dim, [centre].into_iter().chain(of_size(of_length(dim, length), r)))
    }),
    ("sum-of-radii-rounds", |dim| {
        let r = two_to(-53);
        // Each axis has two pairs 1 + 2^-53 apart: one in touch, and one with a gap of 2^-106.
        let pair = |k: usize| {
            let (axis, small) = (k / 2, [r, r.next_down()][k % 2]);
            let at = |x| on_axis(axis, x, 8.0 * (k + 1) as f64);
            [(at(-r), small), (at(1.0), 1.0)]
        };
        each(dim, (0..2 * dim as usize).flat_map(pair))
    }),
];

/// Two particles. The second is at the first plus `v`, then moved outward by `outward` units in the
/// last place along the first axis on which `v` is not 0.
struct Pair {
    v: Place,
    outward: i32,
    radii: [f64; 2],
}

fn together(dim: u32, gap: f64, pairs: impl IntoIterator<Item = Pair>) -> Steps {
    let particles = pairs.into_iter().enumerate().flat_map(|(k, Pair { v, outward, radii })| {
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
    each(dim, particles)
}

/// Returns pairs in all directions of the triple `v`, each in all `forms` (units outward, radii).
fn turned<const N: usize>(dim: u32, v: Place, gap: f64, forms: [(i32, [f64; 2]); N]) -> Steps {
    let of = |v| forms.map(|(outward, radii)| Pair { v, outward, radii });
    together(dim, gap, orientations(dim, v).into_iter().flat_map(of))
}

/// Returns pairs in all directions of the triple `v`, with equal radii and exactly in touch.
fn ties(dim: u32, v: Place, length: f64, scale: f64) -> Steps {
    let pairs = pairs(dim, v.map(|x| x * scale), [-3.0; 3], 4.0 * length * scale);
    uniform(dim, pairs, 0.5 * length * scale)
}

/// Returns pairs in all directions of `v`, at positions `gap` apart that begin at `corner`.
fn pairs(dim: u32, v: Place, corner: Place, gap: f64) -> impl Iterator<Item = Place> {
    orientations(dim, v).into_iter().enumerate().flat_map(move |(k, v)| {
        let first = plus(corner, 1.0, site(k, gap));
        [first, plus(first, 1.0, v)]
    })
}

/// Returns all vectors that result from `v` by permutations and changes of sign.
fn orientations(dim: u32, v: Place) -> Vec<Place> {
    let orders = [[0, 1, 2], [1, 0, 2], [0, 2, 1], [2, 1, 0], [1, 2, 0], [2, 0, 1]];
    let mut all: Vec<Place> = Vec::new();
    for order in &orders[..by_dim(dim, [2, 6])] {
        for signs in corners(3) {
            let turned = |k: usize| match v[order[k]] {
                0.0 => 0.0,
                x => signs[k] * x,
            };
            let turned = std::array::from_fn(turned);
            if !all.contains(&turned) {
                all.push(turned);
            }
        }
    }
    all
}

/// Returns all vectors of whole numbers with this length.
pub fn of_length(dim: u32, length: i32) -> Vec<Place> {
    let range = -length..=length;
    let depth = if dim == 2 { 0..=0 } else { range.clone() };
    let all = range.clone().flat_map(|x| range.clone().map(move |y| (x, y)));
    all.flat_map(|(x, y)| depth.clone().map(move |z| [x, y, z]))
        .filter(|v| v.map(|x| x * x).iter().sum::<i32>() == length * length)
        .map(|v| v.map(f64::from))
        .collect()
}
