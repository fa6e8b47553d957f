//! `kd-tree`: the k-d tree of the crate [kd-tree](https://docs.rs/kd-tree).
//!
//! The crate sorts particles in place into a balanced tree. The detector queries the neighbours of
//! each particle within reach, in the order of the tree. Each query returns a new list.

use ::kd_tree::{KdSlice2, KdSlice3};

use super::KD_TREE;
use super::library::{Library, squared_reach};
use contactbench_ground::contact::Bodies;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::scene::Real;

/// The library of this module.
pub struct KdTree;

// The crate has one type per dimension.
macro_rules! detector {
    ($d:literal, $slice:ident) => {
        impl Library<$d> for KdTree {
            fn pairs<T: Real>(
                points: &[[f64; $d]],
                bodies: &impl Bodies<T, $d>,
                mut near: impl FnMut(u32, u32),
            ) -> Result<(), Refusal> {
                // The crate excludes points at exactly the search distance; the margin in the
                // distance covers this.
                let radius = squared_reach(KD_TREE.name, bodies, points)?.sqrt();
                let mut items: Vec<_> = points.iter().copied().zip(0u32..).collect();
                let tree = $slice::sort_by(&mut items, |(a, _), (b, _), k| a[k].total_cmp(&b[k]));
                for (point, i) in tree.items() {
                    for (_, j) in tree.within_radius_by(point, radius, |(point, _), k| point[k]) {
                        if i < j {
                            near(*i, *j);
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
