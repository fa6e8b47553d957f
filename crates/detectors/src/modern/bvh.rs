//! `bvh`: a hierarchy of boxes over particles in Morton order (Lauterbach et al. 2009, "Fast BVH
//! Construction on GPUs"; Karras 2012, "Maximizing Parallelism in the Construction of BVHs,
//! Octrees, and k-d Trees").
//!
//! 1. Every particle has a key: its coordinates in 2^21 steps (2^32 in 2D) along the longest edge
//!    of the scene, with bits interleaved. Keys are sorted and particles copied in their order,
//!    which is the order of the leaves of a quadtree or octree.
//! 2. `tree.rs` builds boxes and finds the pairs.
//!
//! * Cost: N log N key comparisons for N particles. The search visits some nodes for every leaf of
//!   at most 16 particles; in a dense packing this number hardly depends on N.
//! * Memory: `40N + 64L` bytes in 2D, `48N + 96L` in 3D, with L leaves: the smallest power of two
//!   of at least N/16.
//! * Boxes enclose particles of any size, so one giant particle adds only its own pairs and a few
//!   boxes. Keys affect only speed: if all particles of a distant clump fall into one step, their
//!   boxes overlap and the search is slow. Refuses scenes over the memory limit.
//! * Deviations from the sources: the tree is balanced and determined by N, not by the bits of the
//!   keys; no tree is kept and refitted.

use super::tree::Tree;
use contactbench_ground::contact::Particles;
use contactbench_ground::detect::bounds::Bounds;
use contactbench_ground::detect::copies::{Each, Judge, One, Record, room};
use contactbench_ground::detect::{Declare, Detector, Options, within};
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::Sink;
use contactbench_ground::probe::{Op, Probe};
use contactbench_ground::scene::Real;

/// The hierarchy of boxes, in `D` dimensions.
pub struct Bvh<const D: usize> {
    options: Options,
    /// Morton key and number of each particle.
    keys: Vec<(u64, u32)>,
    pub(crate) tree: Tree<D>,
}

impl<const D: usize> Declare for Bvh<D> {
    const DECIDES_FROM_COPIES: bool = true;

    fn with(options: Options) -> Bvh<D> {
        Bvh { options, keys: Vec::new(), tree: Tree::empty() }
    }

    fn formula_bytes(&self) -> u64 {
        KEY * self.keys.len() as u64 + self.tree.formula_bytes()
    }
}

const KEY: u64 = size_of::<(u64, u32)>() as u64;

impl<T: Real, const D: usize> Detector<T, D> for Bvh<D> {
    fn detect<B: Particles<T, D>, P: Probe, S: Sink>(
        &mut self,
        particles: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        self.order(&particles, "bvh", probe)?;
        let (slack, touch) =
            (particles.slack(), |i, j, probe: &mut P| particles.touch(i, j, probe));
        match particles.uniform() {
            Some(r) => self.tree.search(Judge::new(&touch, One::new(r, slack)), probe, sink),
            None => self.tree.search(Judge::new(&touch, Each::new(slack)), probe, sink),
        }
        Ok(())
    }
}

impl<const D: usize> Bvh<D> {
    /// Copies the particles into the tree, sorted by key; `name` is the detector's name in
    /// refusals.
    pub(crate) fn order<T: Real, P: Probe>(
        &mut self,
        particles: &impl Particles<T, D>,
        name: &'static str,
        probe: &mut P,
    ) -> Result<(), Refusal> {
        let n = particles.len();
        within(&self.options, name, KEY * n as u64 + Tree::<D>::bytes(n), || {
            format!("{n} particles")
        })?;
        room(&mut self.keys, n, (0, 0));
        self.tree.prepare(n);
        let mut bounds = Bounds::NONE;
        (0..n as u32).for_each(|id| bounds.widen(particles.position(id), particles.position(id)));
        let steps = Steps::new(bounds);
        for (id, key) in (0..).zip(&mut self.keys) {
            *key = (steps.key(particles.position(id), probe), id);
        }
        sort(&mut self.keys, probe);
        for (record, key) in self.tree.records.iter_mut().zip(&self.keys) {
            probe.count(Op::Move);
            *record = Record::new(particles, key.1);
        }
        Ok(())
    }
}

/// A separate function, so that it is compiled only once.
fn sort(keys: &mut [(u64, u32)], probe: &mut impl Probe) {
    keys.sort_unstable_by(|a, b| {
        probe.count(Op::KeyCompare);
        a.0.cmp(&b.0)
    });
}

/// Converts points to steps along the axes, from the lower corner of the scene.
struct Steps<const D: usize> {
    low: [f64; D],
    /// Steps per unit of length.
    scale: f64,
}

impl<const D: usize> Steps<D> {
    const BITS: u32 = if D == 2 { 32 } else { 21 };

    /// Coordinates are halved, so that edges do not overflow. If all points coincide, the scale is
    /// infinite and all keys are 0.
    fn new(bounds: Bounds<D>) -> Steps<D> {
        let low = bounds.low.map(|x| 0.5 * x);
        let [longest, _] = bounds.longest();
        Steps {
            low,
            scale: (1u64 << Self::BITS) as f64 / (0.5 * bounds.high[longest] - low[longest]),
        }
    }

    /// Returns a point's key: the bits of its steps on all axes, interleaved, the highest first.
    #[inline(always)]
    fn key(&self, position: [f64; D], probe: &mut impl Probe) -> u64 {
        probe.add(Op::Integerise, D as u64);
        let last = (1u64 << Self::BITS) - 1;
        (0..D).fold(0, |key, k| {
            let step = ((0.5 * position[k] - self.low[k]) * self.scale) as u64;
            key | spread::<D>(step.min(last)) << k
        })
    }
}

/// Inserts D - 1 zeros between the bits of a number.
#[inline(always)]
fn spread<const D: usize>(x: u64) -> u64 {
    let masks: [(u32, u64); 5] = if D == 2 {
        [
            (16, 0x0000_ffff_0000_ffff),
            (8, 0x00ff_00ff_00ff_00ff),
            (4, 0x0f0f_0f0f_0f0f_0f0f),
            (2, 0x3333_3333_3333_3333),
            (1, 0x5555_5555_5555_5555),
        ]
    } else {
        [
            (32, 0x001f_0000_0000_ffff),
            (16, 0x001f_0000_ff00_00ff),
            (8, 0x100f_00f0_0f00_f00f),
            (4, 0x10c3_0c30_c30c_30c3),
            (2, 0x1249_2492_4924_9249),
        ]
    };
    masks.into_iter().fold(x, |x, (shift, mask)| (x | x << shift) & mask)
}

#[cfg(test)]
mod tests {
    use super::*;
    use contactbench_ground::probe::Silent;

    #[test]
    fn bits_are_spread_and_interleaved() {
        for x in [0u64, 1, 2, 0b1011, 0x15_5555, 0x1f_ffff] {
            let by_bits = |d: u32| (0..21).fold(0, |sum, bit| sum | (x >> bit & 1) << (bit * d));
            assert_eq!((spread::<2>(x), spread::<3>(x)), (by_bits(2), by_bits(3)), "{x:b}");
        }
        let steps = Steps { low: [0.0; 3], scale: 2.0 };
        assert_eq!(steps.key([1.0, 2.0, 3.0], &mut Silent), 0b110_101);
        assert_eq!(steps.key([1e300, 0.0, 0.0], &mut Silent), 0x1249_2492_4924_9249);
    }

    #[test]
    fn keys_of_extreme_scenes_are_numbers() {
        for (low, high) in
            [(-f64::MAX, f64::MAX), (1.0, 1.0), (0.0, f64::from_bits(1)), (-0.0, 0.0)]
        {
            let steps = Steps::new(Bounds { low: [low; 2], high: [high; 2] });
            assert!(steps.key([low; 2], &mut Silent) <= steps.key([high; 2], &mut Silent));
        }
    }
}
