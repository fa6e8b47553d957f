//! `kiddo`: the k-d tree of the crate [kiddo](https://docs.rs/kiddo).
//!
//! `ImmutableKdTree` is built from the slice of centres. It handles many points with an equal
//! coordinate, which the crate's mutable tree does not. The detector queries the neighbours of each
//! particle within reach, in the order of the leaves. A query returns them unsorted and without
//! distances, and reuses its stack, so it does not allocate. The crate's SIMD needs a nightly
//! compiler and is off, as are its threads.

use ::kiddo::{ImmutableKdTree, SquaredEuclidean};

use super::{KIDDO, positions, squared_reach};
use crate::contact::Bodies;
use crate::detect::{Declare, Detector, Options, Refusal};
use crate::probe::Probe;
use crate::scene::Real;
use crate::sink::Sink;

/// The detector of this module, in `D` dimensions: it queries the tree once per particle.
pub struct Kiddo<const D: usize>(Vec<[f64; D]>);

impl<const D: usize> Declare for Kiddo<D> {
    fn with(_: Options) -> Kiddo<D> {
        Kiddo(Vec::new())
    }

    fn formula_bytes(&self) -> u64 {
        0
    }
}

impl<T: Real, const D: usize> Detector<T, D> for Kiddo<D> {
    fn detect<B: Bodies<T, D>, P: Probe, S: Sink>(
        &mut self,
        bodies: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        positions(&bodies, &mut self.0);
        let square = squared_reach(KIDDO.name, &bodies, &self.0)?;
        let tree = ImmutableKdTree::<f64, D>::new_from_slice(&self.0).map_err(|error| {
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
                if i < j && bodies.touch(i, j, probe) {
                    sink.contact(i, j);
                }
            });
        }
        Ok(())
    }
}
