//! `kd-tree`: the k-d tree of the crate [kd-tree](https://docs.rs/kd-tree).
//!
//! The crate sorts particles in place into a balanced tree. The detector queries the neighbours of
//! each particle within reach, in the order of the tree. Each query returns a new list.

use ::kd_tree::{KdSlice2, KdSlice3};

use super::{KD_TREE, positions, squared_reach};
use crate::contact::Bodies;
use crate::detect::{Declare, Detector, Options, Refusal};
use crate::probe::Probe;
use crate::scene::Real;
use crate::sink::Sink;

/// The detector of this module, in `D` dimensions: it queries the tree once per particle.
pub struct KdTree<const D: usize> {
    points: Vec<[f64; D]>,
    items: Vec<([f64; D], u32)>,
}

impl<const D: usize> Declare for KdTree<D> {
    fn with(_: Options) -> KdTree<D> {
        KdTree { points: Vec::new(), items: Vec::new() }
    }

    fn formula_bytes(&self) -> u64 {
        0
    }
}

// The crate has one type per dimension.
macro_rules! detector {
    ($d:literal, $slice:ident) => {
        impl<T: Real> Detector<T, $d> for KdTree<$d> {
            fn detect<B: Bodies<T, $d>, P: Probe, S: Sink>(
                &mut self,
                bodies: B,
                probe: &mut P,
                sink: &mut S,
            ) -> Result<(), Refusal> {
                positions(&bodies, &mut self.points);
                // The crate excludes points at exactly the search distance; the margin in the
                // distance covers this.
                let radius = squared_reach(KD_TREE.name, &bodies, &self.points)?.sqrt();
                self.items.clear();
                self.items.extend(self.points.iter().copied().zip(0u32..));
                let tree =
                    $slice::sort_by(&mut self.items, |(a, _), (b, _), k| a[k].total_cmp(&b[k]));
                for (point, i) in tree.items() {
                    for (_, j) in tree.within_radius_by(point, radius, |(point, _), k| point[k]) {
                        if i < j && bodies.touch(*i, *j, probe) {
                            sink.contact(*i, *j);
                        }
                    }
                }
                Ok(())
            }
        }
    };
}

detector!(2, KdSlice2);
detector!(3, KdSlice3);
