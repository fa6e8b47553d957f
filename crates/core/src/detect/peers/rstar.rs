//! `rstar`: the R*-tree of the crate [rstar](https://docs.rs/rstar).
//!
//! The tree is bulk-loaded from the centres. The detector queries the neighbours of each particle
//! within reach, in the order of the leaves.

use ::rstar::RTree;
use ::rstar::primitives::GeomWithData;

use super::{RSTAR, positions, squared_reach};
use crate::contact::Bodies;
use crate::detect::{Declare, Detector, Options, Refusal};
use crate::probe::Probe;
use crate::scene::Real;
use crate::sink::Sink;

/// The detector of this module, in `D` dimensions: it queries the tree once per particle.
pub struct Rstar<const D: usize>(Vec<[f64; D]>);

impl<const D: usize> Declare for Rstar<D> {
    fn with(_: Options) -> Rstar<D> {
        Rstar(Vec::new())
    }

    fn formula_bytes(&self) -> u64 {
        0
    }
}

impl<T: Real, const D: usize> Detector<T, D> for Rstar<D> {
    fn detect<B: Bodies<T, D>, P: Probe, S: Sink>(
        &mut self,
        bodies: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        positions(&bodies, &mut self.0);
        let square = squared_reach(RSTAR.name, &bodies, &self.0)?;
        let tree = RTree::bulk_load(
            self.0.iter().zip(0u32..).map(|(&point, i)| GeomWithData::new(point, i)).collect(),
        );
        for particle in tree.iter() {
            let i = particle.data;
            for other in tree.locate_within_distance(*particle.geom(), square) {
                if i < other.data && bodies.touch(i, other.data, probe) {
                    sink.contact(i, other.data);
                }
            }
        }
        Ok(())
    }
}
