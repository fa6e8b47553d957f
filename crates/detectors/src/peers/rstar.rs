//! `rstar`: the R*-tree of the crate [rstar](https://docs.rs/rstar).
//!
//! The tree is bulk-loaded from the centres. The detector queries the neighbours of each particle
//! within reach, in the order of the leaves.

use ::rstar::RTree;
use ::rstar::primitives::GeomWithData;

use super::RSTAR;
use super::library::{Library, squared_reach};
use contactbench_ground::contact::Bodies;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::scene::Real;

/// The library of this module.
pub struct Rstar;

impl<const D: usize> Library<D> for Rstar {
    fn pairs<T: Real>(
        points: &[[f64; D]],
        bodies: &impl Bodies<T, D>,
        mut near: impl FnMut(u32, u32),
    ) -> Result<(), Refusal> {
        let square = squared_reach(RSTAR.name, bodies, points)?;
        let tree = RTree::bulk_load(
            points.iter().zip(0u32..).map(|(&point, i)| GeomWithData::new(point, i)).collect(),
        );
        for particle in tree.iter() {
            let i = particle.data;
            for other in tree.locate_within_distance(*particle.geom(), square) {
                if i < other.data {
                    near(i, other.data);
                }
            }
        }
        Ok(())
    }
}
