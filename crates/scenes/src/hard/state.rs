//! What an earlier detection left behind. One detector is given all steps in order; only the last
//! is judged.
//!
//! ```text
//!   step 1  ooooooooo   step 2  oo   step 3  oooooooooo
//!                                            heads, links and marks of step 1 must be gone
//! ```

use crate::hard::Maker;
use crate::hard::build::*;

pub const MAKERS: &[Maker] = &[
    ("shrink-then-grow", |dim| {
        history([
            block(dim, 12, 6),
            uniform(dim, &[[0.0; 3], [1.0, 0.0, 0.0]], 0.5),
            block(dim, 14, 7),
        ])
    }),
    ("grow-then-shrink", |dim| history([block(dim, 14, 7), block(dim, 3, 3)])),
    ("emptied-then-filled", |dim| {
        history([block(dim, 10, 5), uniform(dim, &[], 0.5), block(dim, 10, 5)])
    }),
    ("same-scene-again", |dim| history([block(dim, 10, 5), block(dim, 10, 5), block(dim, 10, 5)])),
    ("erased-and-inserted", |dim| {
        let all = lattice(dim, by_dim(dim, [8, 5]), |k| k);
        let fewer: Vec<Place> =
            all.iter().enumerate().filter(|(k, _)| *k != 20).map(|(_, place)| *place).collect();
        // Inserted under a new number: the last.
        let again = [&fewer[..], &[all[20]]].concat();
        history([uniform(dim, &all, 0.5), uniform(dim, &fewer, 0.5), uniform(dim, &again, 0.5)])
    }),
    ("all-cross-a-cell", |dim| {
        let moved = |by: f64| {
            let mut places = lattice(dim, by_dim(dim, [12, 6]), |k| k + by);
            places.push([-5.0; 3]); // keeps the box where it is
            uniform(dim, &places, 0.5)
        };
        history([moved(0.0), moved(1.0)])
    }),
    ("all-swap-places", |dim| {
        let mut places = lattice(dim, by_dim(dim, [12, 6]), |k| k);
        let first = uniform(dim, &places, 0.5);
        let half = places.len() / 2;
        places[..half].reverse();
        history([first, uniform(dim, &places, 0.5)])
    }),
    ("one-comes-from-afar", |dim| {
        let at = |last: Place| {
            let mut places: Vec<Place> = (0..64).map(|k| site(k, 2.0)).collect();
            places.push(last);
            uniform(dim, &places, 0.5)
        };
        history([at([40.0; 3]), at([0.25, -0.75, 0.0])])
    }),
    ("domain-grows", |dim| {
        history([
            block(dim, 10, 5),
            uniform(dim, &lattice(dim, by_dim(dim, [10, 5]), |k| 30.0 * k), 0.5),
            block(dim, 10, 5),
        ])
    }),
    ("domain-turns", |dim| {
        let row = |axis: usize| {
            (0..200)
                .map(|k| std::array::from_fn(|a| if a == axis { f64::from(k) } else { 0.0 }))
                .collect::<Vec<_>>()
        };
        history([uniform(dim, &row(0), 0.5), uniform(dim, &row(dim as usize - 1), 0.5)])
    }),
    ("radius-changes", |dim| {
        let places = lattice(dim, by_dim(dim, [12, 6]), |k| k);
        history([0.5, 0.25, 1.0].map(|r| uniform(dim, &places, r)))
    }),
    ("one-radius-then-each", |dim| {
        let places = lattice(dim, by_dim(dim, [12, 6]), |k| k);
        let bodies: Vec<(Place, f64)> = places
            .iter()
            .enumerate()
            .map(|(k, place)| (*place, 0.25 + 0.125 * (k % 7) as f64))
            .collect();
        history([uniform(dim, &places, 0.5), each(dim, &bodies), uniform(dim, &places, 0.5)])
    }),
    ("after-a-refusal", |dim| {
        let far: Vec<Place> = (0..100).map(|k| [1e14 * f64::from(k); 3]).collect();
        history([uniform(dim, &far, 0.5), block(dim, 12, 6)])
    }),
    ("after-a-crowd", |dim| history([uniform(dim, &[[3.0; 3]; 400], 0.5), block(dim, 12, 6)])),
];

/// A touching lattice with so many sites per axis, in 2D and 3D.
fn block(dim: u32, plane: u32, space: u32) -> Steps {
    uniform(dim, &lattice(dim, by_dim(dim, [plane, space]), |k| k), 0.5)
}
