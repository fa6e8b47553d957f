//! `parry`: the bounding volume hierarchy of the crates [parry2d-f64 and
//! parry3d-f64](https://parry.rs).
//!
//! Each particle gets a box that extends by half its reach to a particle of its own size. Binning,
//! the crate's fast construction, builds a tree of these boxes. Traversing the tree against itself
//! yields each pair of overlapping boxes once. Such boxes lose no pair ([`contactbench_ground::filter`], section
//! 2).

use super::PARRY;
use super::library::{Library, squared_reach};
use contactbench_ground::contact::Bodies;
use contactbench_ground::filter::interval;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::scene::Real;

/// The library of this module.
pub struct Parry;

// The library has one crate per dimension.
macro_rules! detector {
    ($d:literal, $parry:ident) => {
        impl Library<$d> for Parry {
            fn pairs<T: Real>(
                points: &[[f64; $d]],
                bodies: &impl Bodies<T, $d>,
                mut near: impl FnMut(u32, u32),
            ) -> Result<(), Refusal> {
                use $parry::bounding_volume::Aabb;
                use $parry::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};

                // Called only to refuse large scenes, because volumes of boxes must not overflow.
                squared_reach(PARRY.name, bodies, points)?;
                let slack = bodies.slack();
                let boxes = points.iter().zip(0..).map(|(point, id)| {
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
                        near(i, j);
                    },
                );
                Ok(())
            }
        }
    };
}

detector!(2, parry2d_f64);
detector!(3, parry3d_f64);
