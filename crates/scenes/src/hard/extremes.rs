//! Very large and very small numbers, large offsets.
//!
//! ```text
//!   0 ........................................ 10^15 diameters ........ ooo
//!   2^-1074 .. 2^-537 (squares vanish below) .. 1 .. 2^511 (squares overflow above) .. 2^1024
//! ```

use crate::hard::Maker;
use crate::hard::build::*;

pub const MAKERS: &[Maker] = &[
    ("offset-1e6", |dim| grid(dim, SITES, 0.5, |k| 1e6 + k)),
    ("offset-1e9", |dim| grid(dim, SITES, 0.5, |k| 1e9 + k)),
    ("offset-1e12", |dim| grid(dim, SITES, 0.5, |k| 1e12 + k)),
    ("offset-1e15", |dim| grid(dim, SITES, 0.5, |k| -1e15 + k)),
    ("at-2-to-53", |dim| {
        let line = [-4.0, -3.0, -2.0, -1.0, 0.0, 2.0, 4.0, 6.0].map(|x| two_to(53) + x);
        uniform(dim, lines(dim, &line, two_to(53) + 100.0), 0.5)
    }),
    ("one-ulp-lattice", |dim| grid(dim, SITES, two_to(-53), |k| 1.0 + two_to(-52) * k)),
    ("scale-1e-12", |dim| grid(dim, SITES, 0.5e-12, |k| 1e-12 * k)),
    ("scale-1e-200", |dim| scaled(dim, two_to(-664))),
    ("squares-vanish-in-f32", |dim| scaled(dim, two_to(-80))),
    ("squares-are-subnormal", |dim| scaled(dim, two_to(-530))),
    ("subnormal-coordinates", |dim| scaled(dim, two_to(-1072))),
    ("least-numbers", |dim| grid(dim, SITES, two_to(-1074), |k| k * two_to(-1074))),
    ("squares-overflow", |dim| scaled(dim, two_to(600))),
    ("extent-overflows", |dim| {
        let far = two_to(1023);
        uniform(dim, lines(dim, &[-far, -0.5 * far, 0.5 * far, far], 0.0), 0.5 * two_to(1022))
    }),
    ("largest-numbers", |dim| {
        uniform(dim, [[f64::MAX, 0.0, 0.0], [-f64::MAX, 0.0, 0.0]], f64::MAX)
    }),
    ("large-beside-least", |dim| {
        // There are three pairs: one in touch; one 2^-1074 apart across the line; and one like the
        // second, but with a radius large enough to touch.
        let (least, more) = (two_to(-1074), 0.5f64.next_up());
        let pair = |x, y, r| [([x, 0.0, 0.0], 0.5), ([x + 1.0, y, 0.0], r)];
        each(dim, [pair(0.0, 0.0, 0.5), pair(4.0, least, 0.5), pair(8.0, least, more)].concat())
    }),
];

const SITES: [u32; 2] = [12, 6];

fn scaled(dim: u32, scale: f64) -> Steps {
    grid(dim, SITES, 0.5 * scale, |k| scale * k)
}
