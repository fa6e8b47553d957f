//! Negative coordinates; zeros of both signs and numbers that are nearly zero.
//!
//! ```text
//!   x        -1.5  -0.5   0.5   1.5
//!   floor      -2    -1     0     1
//!   truncated  -1     0     0     1      cell 0 is twice as wide, and a cast to unsigned wraps
//! ```

use crate::hard::Maker;
use crate::hard::build::*;

pub const MAKERS: &[Maker] = &[
    ("around-the-origin", |dim| {
        uniform(dim, &lattice(dim, by_dim(dim, [17, 9]), |k| k - by_dim(dim, [8.0, 4.0])), 0.5)
    }),
    ("all-negative", |dim| uniform(dim, &lattice(dim, by_dim(dim, [15, 7]), |k| k - 1000.0), 0.5)),
    ("all-positive", |dim| uniform(dim, &lattice(dim, by_dim(dim, [15, 7]), |k| k + 50.0), 0.5)),
    ("every-quadrant", |dim| {
        let mut places: Vec<Place> = Vec::new();
        for corner in corners(dim) {
            let place = corner.map(|x| 10.25 * x);
            places.extend([place, plus(place, 0.75, [corner[0], 0.0, 0.0])]);
        }
        for axis in 0..dim as usize {
            places.extend([-0.25, 0.5].map(|x| {
                std::array::from_fn(|k| if k == axis { x } else { 3.0 * (axis + 1) as f64 })
            }));
        }
        uniform(dim, &places, 0.5)
    }),
    ("three-quarter-steps", |dim| {
        uniform(
            dim,
            &lines(dim, &(0..120).map(|k| 0.75 * f64::from(k) - 45.0).collect::<Vec<_>>(), 60.0),
            0.5,
        )
    }),
    ("zeros-of-both-signs", |dim| {
        uniform(
            dim,
            &[[0.0, -0.0, 0.0], [-0.0, 0.0, -0.0], [-5e-17, 0.0, -0.0], [0.0, -5e-17, 5e-17]],
            0.5,
        )
    }),
    ("points-on-zeros", |dim| {
        let signed =
            corners(dim).into_iter().map(|corner| corner.map(|x| if x < 0.0 { -0.0 } else { 0.0 }));
        uniform(dim, &signed.collect::<Vec<_>>(), 0.0)
    }),
    ("lattice-a-hair-below-zero", |dim| {
        let mut places = lattice(dim, by_dim(dim, [12, 8]), |k| k);
        places.iter_mut().filter(|place| place[0] == 0.0).for_each(|place| place[0] = -5e-17);
        uniform(dim, &places, 0.5)
    }),
    ("least-number-off-zero", |dim| {
        let least = f64::from_bits(1);
        let places = (0..dim as usize).flat_map(|axis| {
            let at = move |x: f64, lane: f64| {
                std::array::from_fn(|k| if k == axis { x } else { lane + axis as f64 })
            };
            [at(least, 4.0), at(1.0, 4.0), at(-least, 12.0), at(1.0, 12.0)]
        });
        uniform(dim, &places.collect::<Vec<_>>(), 0.5)
    }),
];
