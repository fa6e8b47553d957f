//! `kd-tree`: a balanced tree by medians (Bentley 1975, "Multidimensional Binary Search Trees Used
//! for Associative Searching"; with buckets and boxes as in Friedman, Bentley and Finkel 1977, and
//! traversed by pairs of nodes as in Gray and Moore 2000).
//!
//! 1. Copies of the particles are divided at the median along the longest axis, and each half
//!    likewise, down to buckets of at most 16.
//! 2. `tree.rs` builds boxes and finds the pairs.
//!
//! * Cost: N log N key comparisons for N particles. The search visits some nodes for every bucket;
//!   in a dense packing this number hardly depends on N.
//! * Memory: `24N + 64L` bytes in 2D, `32N + 96L` in 3D, with L buckets: the smallest power of two
//!   of at least N/16.
//! * The tree has no cells: far-away particles, coincident particles and very different sizes cost
//!   nothing extra. Refuses scenes over the memory limit.
//! * Deviations from the sources: the axis is the longest of the space between the cuts, not of the
//!   particles' own box, which would need another pass; the median is shifted so that the tree is
//!   determined by N; boxes enclose particles, not centres.

use super::tree::{Leaves, Tree};
use contactbench_ground::contact::Particles;
use contactbench_ground::detect::bounds::Bounds;
use contactbench_ground::detect::copies::{Each, Judge, One, Record};
use contactbench_ground::detect::{Declare, Detector, Options, within};
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::Sink;
use contactbench_ground::probe::{Op, Probe};
use contactbench_ground::scene::Real;

/// The k-d tree, in `D` dimensions.
pub struct KdTree<const D: usize> {
    options: Options,
    tree: Tree<D>,
}

impl<const D: usize> Declare for KdTree<D> {
    const DECIDES_FROM_COPIES: bool = true;

    fn with(options: Options) -> KdTree<D> {
        KdTree { options, tree: Tree::empty() }
    }

    fn formula_bytes(&self) -> u64 {
        self.tree.formula_bytes()
    }
}

impl<T: Real, const D: usize> Detector<T, D> for KdTree<D> {
    fn detect<B: Particles<T, D>, P: Probe, S: Sink>(
        &mut self,
        particles: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        let n = particles.len();
        within(&self.options, "kd-tree", Tree::<D>::bytes(n), || format!("{n} particles"))?;
        self.tree.prepare(n);
        for (id, record) in (0..).zip(&mut self.tree.records) {
            *record = Record::new(&particles, id);
        }
        let (bounds, leaves) = (Bounds::around(&self.tree.records), Leaves::new(n));
        part(&mut self.tree.records, leaves, [0, leaves.count()], bounds, probe);
        let (slack, touch) =
            (particles.slack(), |i, j, probe: &mut P| particles.touch(i, j, probe));
        match particles.uniform() {
            Some(r) => self.tree.search(Judge::new(&touch, One::new(r, slack)), probe, sink),
            None => self.tree.search(Judge::new(&touch, Each::new(slack)), probe, sink),
        }
        Ok(())
    }
}

/// Divides the records of leaves `from..to`, which lie in `space`, among these leaves.
fn part<const D: usize>(
    records: &mut [Record<D>],
    leaves: Leaves,
    [from, to]: [usize; 2],
    space: Bounds<D>,
    probe: &mut impl Probe,
) {
    if to - from == 1 {
        return;
    }
    let (middle, [axis, _]) = (from + (to - from) / 2, space.longest());
    // If there are several leaves, none is empty, so a record exists at this place.
    let place = leaves.place(middle) - leaves.place(from);
    let (before, median, _) = records.select_nth_unstable_by(place, |a, b| {
        probe.count(Op::KeyCompare);
        a.position[axis].total_cmp(&b.position[axis])
    });
    let (before, cut) = (before.len(), median.position[axis]);
    let (left, right) = records.split_at_mut(before);
    let (mut below, mut above) = (space, space);
    (below.high[axis], above.low[axis]) = (cut, cut);
    part(left, leaves, [from, middle], below, probe);
    part(right, leaves, [middle, to], above, probe);
}
