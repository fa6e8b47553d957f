//! Uneven distributions and input orders.
//!
//! ```text
//!   oo..oo......oo..oo  Cantor        /   diagonal      | | | |  comb
//!                                    /                  | | | |
//!                                   /                  =========
//! ```

use crate::hard::Maker;
use crate::hard::build::*;

pub const MAKERS: &[Maker] = &[
    ("gaussian", |dim| {
        uniform(dim, drawn(1, 500, |draw| [(); 3].map(|()| 3.0 * draw.normal())), 0.5)
    }),
    ("clusters-of-every-density", |dim| {
        let normal = drawn(2, 480, |draw| [(); 3].map(|()| draw.normal()));
        let spread = |(place, cluster): (Place, i32)| {
            plus([40.0 * f64::from(cluster), 0.0, 0.0], two_to(cluster - 4), place)
        };
        uniform(dim, normal.into_iter().zip((0..480).map(|k| k / 60)).map(spread), 0.5)
    }),
    ("cantor-dust", |dim| {
        // Coordinates have the digits 0 and 3 in base 4, one per bit of k. Two sites touch only if
        // they differ in the last digit of one coordinate alone.
        let digit =
            |k: f64, bit: i32| if k as u32 >> bit & 1 == 1 { 3.0 * two_to(2 * bit) } else { 0.0 };
        grid(dim, [16, 8], 1.5, |k| (0..4).map(|bit| digit(k, bit)).sum())
    }),
    ("diagonal-of-a-box", |dim| uniform(dim, places(300, |k| [k * 7.0 % 300.0; 3]), 1.0)),
    // Centres up to 1.125 apart touch. Neighbours are 1.0625 apart; in 3D a diagonal is 1.5.
    ("wall", |dim| {
        let (side, step) = (by_dim(dim, [400.0, 20.0]), 1.0625);
        let at = |k: f64| [two_to(-30) * (k % 5.0), step * (k % side), step * (k / side).floor()];
        uniform(dim, places(400, at), 0.5625)
    }),
    ("comb", |dim| {
        // A bar of 61 particles lies along x. Every third particle carries a tooth of 20 particles
        // along y. Bar and teeth are chains of touching particles.
        let teeth = places(400, |k: f64| [3.0 * (k / 20.0).floor(), k % 20.0 + 1.0, 0.0]);
        uniform(dim, places(61, |k| [k, 0.0, 0.0]).into_iter().chain(teeth), 0.5)
    }),
    ("geometric-series", |dim| uniform(dim, (0..60).map(|k| [two_to(-k); 3]), two_to(-20))),
    ("sorted-input", |dim| in_order(dim, |k| k)),
    ("reversed-input", |dim| in_order(dim, |k| ROW - 1 - k)),
    ("organ-pipe-input", |dim| {
        in_order(dim, |k| if k < ROW / 2 { 2 * k } else { 2 * (ROW - 1 - k) + 1 })
    }),
    ("only-the-last-two", |dim| one_pair(dim, 199, 198)),
    ("only-the-first-two", |dim| one_pair(dim, 0, 1)),
];

const ROW: u32 = 1500;

/// Returns a row of particles 3/4 apart; particle k of the input is at index place(k) of the row.
fn in_order(dim: u32, place: impl Fn(u32) -> u32) -> Steps {
    uniform(dim, (0..ROW).map(|k| [0.75 * f64::from(place(k)), 0.0, 0.0]), 0.5)
}

/// Returns 200 separate particles, except that particle `moved` is moved to touch particle `other`.
fn one_pair(dim: u32, moved: usize, other: usize) -> Steps {
    let mut places: Vec<Place> = (0..200).map(|k| site(k, 3.0)).collect();
    places[moved] = plus(places[other], 1.0, [0.0, 1.0, 0.0]);
    uniform(dim, places, 0.5)
}
