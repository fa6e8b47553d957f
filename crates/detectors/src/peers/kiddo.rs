//! `kiddo`: the k-d tree of the crate [kiddo](https://docs.rs/kiddo).
//!
//! `ImmutableKdTree` is built from the slice of centres. It handles many points with an equal
//! coordinate, which the crate's mutable tree does not. The detector queries the neighbours of each
//! particle within reach, in the order of the leaves. A query returns them unsorted and without
//! distances, and reuses its stack, so it does not allocate. The crate's SIMD needs a nightly
//! compiler and is off, as are its threads.

use ::kiddo::{ImmutableKdTree, SquaredEuclidean};

use super::KIDDO;
use super::library::{Library, squared_reach};
use contactbench_ground::contact::Bodies;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::scene::Real;

/// The library of this module.
pub struct Kiddo;

impl<const D: usize> Library<D> for Kiddo {
    fn pairs<T: Real>(
        points: &[[f64; D]],
        bodies: &impl Bodies<T, D>,
        mut near: impl FnMut(u32, u32),
    ) -> Result<(), Refusal> {
        let square = squared_reach(KIDDO.name, bodies, points)?;
        let tree = ImmutableKdTree::<f64, D>::new_from_slice(points).map_err(|error| {
            Refusal::Library { detector: KIDDO.name, reason: error.to_string() }
        })?;
        let mut scratch = tree.create_scratch::<SquaredEuclidean<f64>>();
        for (i, point) in tree.iter() {
            let query = tree
                .query(&point)
                .within::<SquaredEuclidean<f64>>(square)
                .unsorted()
                .without_distances();
            query.with_scratch(&mut scratch).visit(|found| {
                let j = found.item;
                if i < j {
                    near(i, j);
                }
            });
        }
        Ok(())
    }
}
