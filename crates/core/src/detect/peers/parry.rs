//! `parry`: the bounding volume hierarchy of the crates [parry2d-f64 and
//! parry3d-f64](https://parry.rs).
//!
//! Each particle gets a box that extends by half its reach to a particle of its own size. Binning,
//! the crate's fast construction, builds a tree of these boxes. Traversing the tree against itself
//! yields each pair of overlapping boxes once. Such boxes lose no pair ([`crate::filter`], section
//! 2).

use super::{PARRY, positions, squared_reach};
use crate::contact::Bodies;
use crate::detect::{Declare, Detector, Options, Refusal};
use crate::filter::interval;
use crate::probe::Probe;
use crate::scene::Real;
use crate::sink::Sink;

/// The detector of this module, in `D` dimensions: it traverses the tree against itself.
pub struct Parry<const D: usize>(Vec<[f64; D]>);

impl<const D: usize> Declare for Parry<D> {
    fn with(_: Options) -> Parry<D> {
        Parry(Vec::new())
    }

    fn formula_bytes(&self) -> u64 {
        0
    }
}

// The library has one crate per dimension.
macro_rules! detector {
    ($d:literal, $parry:ident) => {
        impl<T: Real> Detector<T, $d> for Parry<$d> {
            fn detect<B: Bodies<T, $d>, P: Probe, S: Sink>(
                &mut self,
                bodies: B,
                probe: &mut P,
                sink: &mut S,
            ) -> Result<(), Refusal> {
                use $parry::bounding_volume::Aabb;
                use $parry::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};

                positions(&bodies, &mut self.0);
                // Called only to refuse large scenes, because volumes of boxes must not overflow.
                squared_reach(PARRY.name, &bodies, &self.0)?;
                let slack = bodies.slack();
                let boxes = self.0.iter().zip(0..).map(|(point, id)| {
                    // At least half of the reach to any particle of this size or smaller.
                    let half = slack.reach(bodies.radius(id), bodies.radius(id)) / 2.0;
                    let [low, high] =
                        [0, 1].map(|side| point.map(|x| interval(x, half)[side]).into());
                    Aabb::new(low, high)
                });
                let tree = Bvh::from_iter(BvhBuildStrategy::Binned, boxes.enumerate());
                tree.traverse_bvtt_single_tree::<false>(
                    &mut BvhWorkspace::default(),
                    &mut |i, j| {
                        if bodies.touch(i, j, probe) {
                            sink.contact(i, j);
                        }
                    },
                );
                Ok(())
            }
        }
    };
}

detector!(2, parry2d_f64);
detector!(3, parry3d_f64);
