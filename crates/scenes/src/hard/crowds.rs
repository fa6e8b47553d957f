//! Very many particles in one cell: fixed capacities clip them, and N particles in one cell have
//! N²/2 pairs.
//!
//! ```text
//!   +------+------+
//!   |:::::.|      |     a table of 100 places per cell drops the others without a word
//!   |::::::|   o  |
//!   +------+------+
//! ```

use crate::generate::draw::Draw;
use crate::hard::Maker;
use crate::hard::build::*;

pub const MAKERS: &[Maker] = &[
    ("hundred-and-one", |dim| crowd(dim, 101)),
    ("two-hundred-and-fifty-seven", |dim| crowd(dim, 257)),
    ("thousand-and-twenty-five", |dim| crowd(dim, 1025)),
    ("dust-in-one-cell", |dim| {
        let mut bodies: Vec<(Place, f64)> = (0..1200)
            .map(|k| ([f64::from(k % 40), f64::from(k / 40), 0.0].map(|x| x / 64.0), 0.0))
            .collect();
        bodies.push(bodies[bodies.len() - 1]);
        bodies.push(([8.0; 3], 1.0));
        each(dim, &bodies)
    }),
    ("clique-on-a-corner", |dim| {
        let mut draw = Draw::new(10);
        let mut places: Vec<Place> =
            (0..240).map(|_| [(); 3].map(|()| 4.0 + 0.25 * draw.symmetric())).collect();
        // Alone, so that cells of edge 1 have a corner at 4.
        places.insert(120, [0.0; 3]);
        uniform(dim, &places, 0.5)
    }),
    ("crowded-neighbourhood", |dim| {
        let mut draw = Draw::new(11);
        uniform(
            dim,
            &(0..900).map(|_| [(); 3].map(|()| 3.0 * draw.unit())).collect::<Vec<_>>(),
            0.5,
        )
    }),
    ("crowd-beside-crowd", |dim| {
        let mut draw = Draw::new(12);
        let places = (0..300).map(|k| {
            let place = [(); 3].map(|()| 0.125 * draw.unit());
            if k % 2 == 0 { place } else { plus(place, 1.0, [1.5, 0.0, 0.0]) }
        });
        uniform(dim, &places.collect::<Vec<_>>(), 0.5)
    }),
];

/// `n` bodies drawn from a box of edge d/4: all touch.
fn crowd(dim: u32, n: u32) -> Steps {
    let mut draw = Draw::new(u64::from(n));
    uniform(dim, &(0..n).map(|_| [(); 3].map(|()| 0.25 * draw.unit())).collect::<Vec<_>>(), 0.5)
}
