//! Uneven distributions and input orders.
//!
//! ```text
//!   oo..oo......oo..oo  Cantor        /   diagonal      | | | |  comb
//!                                    /                  | | | |
//!                                   /                  =========
//! ```

use crate::generate::draw::Draw;
use crate::hard::Maker;
use crate::hard::build::*;

pub const MAKERS: &[Maker] = &[
    ("gaussian", |dim| {
        let mut draw = Draw::new(1);
        uniform(
            dim,
            &(0..500).map(|_| [(); 3].map(|()| 3.0 * draw.normal())).collect::<Vec<_>>(),
            0.5,
        )
    }),
    ("clusters-of-every-density", |dim| {
        let mut draw = Draw::new(2);
        let places = (0..480).map(|k| {
            let width = two_to(k / 60 - 4);
            plus([40.0 * f64::from(k / 60), 0.0, 0.0], width, [(); 3].map(|()| draw.normal()))
        });
        uniform(dim, &places.collect::<Vec<_>>(), 0.5)
    }),
    ("cantor-dust", |dim| {
        // Digits 0 and 3 to the base 4, one per bit; only sites that differ in the last digit
        // touch.
        let digits = |k: f64| {
            (0..4)
                .map(|bit| if k as u32 >> bit & 1 == 1 { 3.0 * two_to(2 * bit) } else { 0.0 })
                .sum()
        };
        uniform(dim, &lattice(dim, by_dim(dim, [16, 8]), digits), 1.5)
    }),
    ("diagonal-of-a-box", |dim| {
        uniform(dim, &(0..300).map(|k| [f64::from(k * 7 % 300); 3]).collect::<Vec<_>>(), 1.0)
    }),
    // reach 1.125 against spacings of 1.0625 and, in space, a diagonal of 1.5
    ("wall", |dim| {
        let side = by_dim(dim, [400, 20]);
        let places = (0..400).map(|k| {
            [
                two_to(-30) * f64::from(k % 5),
                1.0625 * f64::from(k % side),
                1.0625 * f64::from(k / side),
            ]
        });
        uniform(dim, &places.collect::<Vec<_>>(), 0.5625)
    }),
    ("comb", |dim| {
        // A bar of 61 bodies along x; every third carries a tooth of 20 along y, and all of it
        // touches in a chain.
        let bar = (0..61).map(|k| [f64::from(k), 0.0, 0.0]);
        let teeth = (0..20)
            .flat_map(|tooth| (1..=20).map(move |k| [3.0 * f64::from(tooth), f64::from(k), 0.0]));
        uniform(dim, &bar.chain(teeth).collect::<Vec<_>>(), 0.5)
    }),
    ("geometric-series", |dim| {
        uniform(dim, &(0..60).map(|k| [two_to(-k); 3]).collect::<Vec<_>>(), two_to(-20))
    }),
    ("sorted-input", |dim| in_order(dim, |k| k)),
    ("reversed-input", |dim| in_order(dim, |k| ROW - 1 - k)),
    ("organ-pipe-input", |dim| {
        in_order(dim, |k| if k < ROW / 2 { 2 * k } else { 2 * (ROW - 1 - k) + 1 })
    }),
    ("only-the-last-two", |dim| {
        let mut places: Vec<Place> = (0..200).map(|k| site(k, 3.0)).collect();
        places[199] = plus(places[198], 1.0, [0.0, 1.0, 0.0]);
        uniform(dim, &places, 0.5)
    }),
    ("only-the-first-two", |dim| {
        let mut places: Vec<Place> = (0..200).map(|k| site(k, 3.0)).collect();
        places[0] = plus(places[1], 1.0, [0.0, 1.0, 0.0]);
        uniform(dim, &places, 0.5)
    }),
];

/// Bodies in the rows of the input orders.
const ROW: u32 = 1500;

/// A row of bodies 3/4 apart; the k-th in the input has place `place(k)`.
fn in_order(dim: u32, place: impl Fn(u32) -> u32) -> Steps {
    uniform(dim, &(0..ROW).map(|k| [0.75 * f64::from(place(k)), 0.0, 0.0]).collect::<Vec<_>>(), 0.5)
}
