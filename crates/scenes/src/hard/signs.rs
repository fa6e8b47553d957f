//! Negative coordinates, zeros of both signs, and numbers near zero.
//!
//! ```text
//!   x        -1.5  -0.5   0.5   1.5
//!   floor      -2    -1     0     1
//!   truncated  -1     0     0     1      cell 0 is twice as wide, and a cast to unsigned wraps
//! ```

use crate::hard::Maker;
use crate::hard::build::*;

pub const MAKERS: &[Maker] = &[
    ("around-the-origin", |dim| grid(dim, [17, 9], 0.5, |k| k - by_dim(dim, [8.0, 4.0]))),
    ("all-negative", |dim| grid(dim, [15, 7], 0.5, |k| k - 1000.0)),
    ("all-positive", |dim| grid(dim, [15, 7], 0.5, |k| k + 50.0)),
    ("every-quadrant", |dim| {
        let in_corners = corners(dim).into_iter().flat_map(|corner| {
            let place = corner.map(|x| 10.25 * x);
            [place, plus(place, 0.75, [corner[0], 0.0, 0.0])]
        });
        let across = (0..dim as usize)
            .flat_map(|axis| [-0.25, 0.5].map(|x| on_axis(axis, x, 3.0 * (axis + 1) as f64)));
        uniform(dim, in_corners.chain(across), 0.5)
    }),
    ("three-quarter-steps", |dim| {
        let line: Vec<f64> = (0..120).map(|k| 0.75 * f64::from(k) - 45.0).collect();
        uniform(dim, lines(dim, &line, 60.0), 0.5)
    }),
    ("zeros-of-both-signs", |dim| {
        let e = 5e-17;
        uniform(dim, [[0.0, -0.0, 0.0], [-0.0, 0.0, -0.0], [-e, 0.0, -0.0], [0.0, -e, e]], 0.5)
    }),
    ("points-on-zeros", |dim| {
        let signed = |corner: Place| corner.map(|x| if x < 0.0 { -0.0 } else { 0.0 });
        uniform(dim, corners(dim).into_iter().map(signed), 0.0)
    }),
    ("lattice-a-hair-below-zero", |dim| {
        let mut places = lattice(dim, [12, 8], |k| k);
        places.iter_mut().filter(|place| place[0] == 0.0).for_each(|place| place[0] = -5e-17);
        uniform(dim, places, 0.5)
    }),
    ("least-number-off-zero", |dim| {
        let least = f64::from_bits(1);
        let line = [(least, 4.0), (1.0, 4.0), (-least, 12.0), (1.0, 12.0)];
        let along = |axis| line.map(|(x, lane)| on_axis(axis, x, lane + axis as f64));
        uniform(dim, (0..dim as usize).flat_map(along), 0.5)
    }),
];
