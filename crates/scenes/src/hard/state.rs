//! State that earlier scenes left in the detector. One detector gets all steps in order; only the
//! last is judged.
//!
//! ```text
//!   step 1  ooooooooo   step 2  oo   step 3  oooooooooo
//!                                            heads, links and marks of step 1 must be gone
//! ```

use crate::hard::Maker;
use crate::hard::build::*;

pub const MAKERS: &[Maker] = &[
    ("shrink-then-grow", |dim| {
        let two = uniform(dim, [[0.0; 3], [1.0, 0.0, 0.0]], 0.5);
        history([block(dim, 12, 6), two, block(dim, 14, 7)])
    }),
    ("grow-then-shrink", |dim| history([block(dim, 14, 7), block(dim, 3, 3)])),
    ("emptied-then-filled", |dim| {
        history([block(dim, 10, 5), uniform(dim, [], 0.5), block(dim, 10, 5)])
    }),
    ("same-scene-again", |dim| history([(); 3].map(|()| block(dim, 10, 5)))),
    ("erased-and-inserted", |dim| {
        let all = lattice(dim, [8, 5], |k| k);
        let mut fewer = all.clone();
        fewer.remove(20);
        // The removed particle is inserted again, as the last one.
        let again = [&fewer[..], &[all[20]]].concat();
        history([all, fewer, again].map(|places| uniform(dim, places, 0.5)))
    }),
    ("all-cross-a-cell", |dim| {
        // The last particle fixes the lowest corner of the scene.
        let moved = |by: f64| lattice(dim, [12, 6], |k| k + by).into_iter().chain([[-5.0; 3]]);
        history([0.0, 1.0].map(|by| uniform(dim, moved(by), 0.5)))
    }),
    ("all-swap-places", |dim| {
        let mut places = lattice(dim, [12, 6], |k| k);
        let half = places.len() / 2;
        places[..half].reverse();
        history([block(dim, 12, 6), uniform(dim, places, 0.5)])
    }),
    ("one-comes-from-afar", |dim| {
        let at = |last: Place| (0..64).map(|k| site(k, 2.0)).chain([last]);
        history([[40.0; 3], [0.25, -0.75, 0.0]].map(|last| uniform(dim, at(last), 0.5)))
    }),
    ("domain-grows", |dim| {
        history([block(dim, 10, 5), grid(dim, [10, 5], 0.5, |k| 30.0 * k), block(dim, 10, 5)])
    }),
    ("domain-turns", |dim| {
        let row = |axis| places(200, |k| on_axis(axis, k, 0.0));
        history([0, dim as usize - 1].map(|axis| uniform(dim, row(axis), 0.5)))
    }),
    ("radius-changes", |dim| history([0.5, 0.25, 1.0].map(|r| grid(dim, [12, 6], r, |k| k)))),
    ("one-radius-then-each", |dim| {
        let places = lattice(dim, [12, 6], |k| k).into_iter().enumerate();
        let particles = places.map(|(k, place)| (place, 0.25 + 0.125 * (k % 7) as f64));
        history([block(dim, 12, 6), each(dim, particles), block(dim, 12, 6)])
    }),
    ("after-a-refusal", |dim| {
        history([uniform(dim, places(100, |k| [1e14 * k; 3]), 0.5), block(dim, 12, 6)])
    }),
    ("after-a-crowd", |dim| history([uniform(dim, [[3.0; 3]; 400], 0.5), block(dim, 12, 6)])),
];

fn block(dim: u32, plane: u32, space: u32) -> Steps {
    grid(dim, [plane, space], 0.5, |k| k)
}
