//! The libraries. Each finds the pairs within [`wide`] of each other, or overlapping boxes.

use kiddo::{ImmutableKdTree, SquaredEuclidean};
use linkcell::{Cell, pairs_within};
use neighbourhood::KdIndexTree;
use rstar::RTree;
use rstar::primitives::GeomWithData;
use zelll::{CellGrid, ParticleLike};

use crate::scene::Scene;
use crate::serve::Library;

/// Returns the search distance: larger than the reach by more than the rounding errors of a library
/// that computes squares, or updates the distance to a box at every level of a tree. It is not 0,
/// which some libraries refuse.
fn wide<const D: usize>(scene: &Scene<D>) -> f64 {
    const PART: f64 = 1.0 / (1u64 << 40) as f64;
    (scene.reach * (1.0 + PART)).max(f64::from_bits((1023 - 480) << 52))
}

/// The crate kd-tree: a balanced tree of the sorted particles. It excludes points at exactly the
/// search distance. Each query returns a new list.
pub struct KdTree;

// The crate has one type per dimension.
macro_rules! kd_tree {
    ($d:literal, $slice:ident) => {
        impl Library<$d> for KdTree {
            fn pairs(scene: &Scene<$d>, mut near: impl FnMut(u32, u32)) -> Result<(), String> {
                let radius = wide(scene);
                let mut items: Vec<_> = scene.centres.iter().copied().zip(0u32..).collect();
                let tree =
                    kd_tree::$slice::sort_by(&mut items, |a, b, k| a.0[k].total_cmp(&b.0[k]));
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

kd_tree!(2, KdSlice2);
kd_tree!(3, KdSlice3);

/// The crate kiddo. `ImmutableKdTree` handles many points with an equal coordinate, which the
/// mutable tree does not. Queries follow the order of the leaves, return particles unsorted and
/// without distances, and reuse their stack.
pub struct Kiddo;

impl<const D: usize> Library<D> for Kiddo {
    fn pairs(scene: &Scene<D>, mut near: impl FnMut(u32, u32)) -> Result<(), String> {
        let square = wide(scene) * wide(scene);
        let tree = ImmutableKdTree::<f64, D>::new_from_slice(&scene.centres);
        let tree = tree.map_err(|error| error.to_string())?;
        let mut scratch = tree.create_scratch::<SquaredEuclidean<f64>>();
        for (i, point) in tree.iter() {
            let query = tree.query(&point).within::<SquaredEuclidean<f64>>(square);
            query.unsorted().without_distances().with_scratch(&mut scratch).visit(|found| {
                if i < found.item {
                    near(i, found.item);
                }
            });
        }
        Ok(())
    }
}

/// The crate linkcell: linked cells in a periodic box, here so large that no pair touches through
/// its faces. It returns a list of its own, and folds particles into the box, which rounds them by
/// a few parts of the box in 2^53. While the box stays the same, as in a simulation, the crate
/// keeps the neighbours of each cell, so its first detection takes much longer than the others.
pub struct Linkcell;

impl<const D: usize> Library<D> for Linkcell {
    fn pairs(scene: &Scene<D>, mut near: impl FnMut(u32, u32)) -> Result<(), String> {
        const PART: f64 = 1.0 / (1u64 << 40) as f64;
        let [low, high] = scene.bounds();
        let space = |p: &[f64; D]| std::array::from_fn(|k| if k < D { p[k] - low[k] } else { 0.0 });
        let extent: [f64; 3] = space(&high);
        let longest = extent.iter().copied().fold(0.0, f64::max);
        let cutoff = wide(scene) + longest * PART;
        let [x, y, z] = extent.map(|length| length + 4.0 * cutoff);
        let cells = [x, y, z].map(|length| length / cutoff).iter().product::<f64>();
        if cells > 65536.0 + 16.0 * scene.centres.len() as f64 {
            return Err(format!("its box would have {cells:.0} cells; use direct"));
        }
        let centres: Vec<[f64; 3]> = scene.centres.iter().map(space).collect();
        let cell = Cell::ortho(x, y, z).map_err(|error| error.to_string())?;
        let pairs = pairs_within(&centres, &cell, cutoff, None, None, true);
        for pair in pairs.map_err(|error| error.to_string())? {
            near(pair.i as u32, pair.j as u32);
        }
        Ok(())
    }
}

/// The crate neighbourhood: a balanced tree of indices. Each query returns a new list.
pub struct Neighbourhood;

impl<const D: usize> Library<D> for Neighbourhood {
    fn pairs(scene: &Scene<D>, mut near: impl FnMut(u32, u32)) -> Result<(), String> {
        let tree = KdIndexTree::new(&scene.centres);
        for (point, i) in scene.centres.iter().zip(0u32..) {
            for j in tree.neighbourhood_by_index(point, wide(scene)) {
                if i < j as u32 {
                    near(i, j as u32);
                }
            }
        }
        Ok(())
    }
}

/// The crates parry2d and parry3d: a tree of boxes, built by binning and traversed against itself.
/// The box of a particle is larger than the particle, so no pair is lost.
pub struct Parry;

// The library has one crate per dimension.
macro_rules! parry {
    ($d:literal, $parry:ident) => {
        impl Library<$d> for Parry {
            fn pairs(scene: &Scene<$d>, mut near: impl FnMut(u32, u32)) -> Result<(), String> {
                use $parry::bounding_volume::Aabb;
                use $parry::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};

                let boxes = scene.centres.iter().zip(0u32..).map(|(point, i)| {
                    let radius = scene.radius(i);
                    let [low, high] = [
                        point.map(|x| (x - radius).next_down()),
                        point.map(|x| (x + radius).next_up()),
                    ];
                    Aabb::new(low.into(), high.into())
                });
                let tree = Bvh::from_iter(BvhBuildStrategy::Binned, boxes.enumerate());
                let workspace = &mut BvhWorkspace::default();
                tree.traverse_bvtt_single_tree::<false>(workspace, &mut |i, j| {
                    near(i, j);
                });
                Ok(())
            }
        }
    };
}

parry!(2, parry2d_f64);
parry!(3, parry3d_f64);

/// The crate rstar: a bulk-loaded R*-tree. Queries follow the order of the leaves.
pub struct Rstar;

impl<const D: usize> Library<D> for Rstar {
    fn pairs(scene: &Scene<D>, mut near: impl FnMut(u32, u32)) -> Result<(), String> {
        let square = wide(scene) * wide(scene);
        let particles = scene.centres.iter().zip(0u32..);
        let tree = RTree::bulk_load(particles.map(|(&p, i)| GeomWithData::new(p, i)).collect());
        for particle in tree.iter() {
            for other in tree.locate_within_distance(*particle.geom(), square) {
                if particle.data < other.data {
                    near(particle.data, other.data);
                }
            }
        }
        Ok(())
    }
}

/// The crate zelll: cells as wide as the reach, hashed by a 32-bit number. A new grid is made for
/// every detection: the crate can rebuild one in place, but reuses the previous cells if no
/// particle has left its cell, and does not notice a changed number of particles.
pub struct Zelll;

#[derive(Clone, Copy)]
struct Particle<const D: usize>(u32, [f64; D]);

impl<const D: usize> Default for Particle<D> {
    fn default() -> Particle<D> {
        Particle(0, [0.0; D])
    }
}

impl<const D: usize> ParticleLike<[f64; D]> for Particle<D> {
    #[inline]
    fn coords(&self) -> [f64; D] {
        self.1
    }
}

impl<const D: usize> Library<D> for Zelll {
    fn pairs(scene: &Scene<D>, mut near: impl FnMut(u32, u32)) -> Result<(), String> {
        let particles = scene.centres.iter().zip(0u32..).map(|(&p, i)| Particle(i, p));
        let grid = CellGrid::new(particles, edge(scene));
        for (Particle(i, _), Particle(j, _)) in grid.particle_pairs() {
            near(*i, *j);
        }
        Ok(())
    }
}

/// Returns the width of cells: more than the reach by the rounding errors of fewer than 2^31 cells
/// per axis, and doubled until the numbers of cells fit in 32 bits.
fn edge<const D: usize>(scene: &Scene<D>) -> f64 {
    // Leaves room: the crate numbers four more cells per axis, and adds offsets of neighbours.
    const MOST: f64 = (1u64 << 30) as f64;
    let [low, high] = scene.bounds();
    let extent: [f64; D] = std::array::from_fn(|k| high[k] - low[k]);
    let longest = extent.iter().copied().fold(0.0, f64::max);
    let mut edge = wide(scene) * (1.0 + 1.0 / (1u64 << 17) as f64);
    // If all particles are points, cells are wide enough for about one particle each.
    if scene.reach == 0.0 {
        edge = edge.max(longest / (scene.centres.len().max(1) as f64).powf(1.0 / D as f64));
    }
    while extent.iter().map(|x| x / edge + 6.0).product::<f64>() > MOST {
        edge *= 2.0;
    }
    edge
}
