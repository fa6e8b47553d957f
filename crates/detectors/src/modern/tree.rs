//! A balanced tree of boxes over sorted records, shared by [`super::kd_tree`] and [`super::bvh`],
//! which sort differently.
//!
//! The number of records determines the tree: it has 2^levels leaves, and leaf k holds records
//! k·N/2^levels to (k + 1)·N/2^levels, at most [`LEAF`] of them. Nodes are numbered as in a heap:
//! the root is 1, the children of i are 2i and 2i + 1. Each node stores only a box that encloses
//! the intervals of its particles on every axis ([`contactbench_ground::filter`], section 2).
//!
//! Pairs are found by descending two nodes at a time. A node paired with itself is replaced by its
//! two halves, each paired with itself and with the other. Two nodes with overlapping boxes are
//! replaced by four pairs of halves. So each pair of leaves occurs once.

use contactbench_ground::detect::bounds::Bounds;
use contactbench_ground::detect::copies::{Judge, Nearness, PairBuffer, Record, room};
use contactbench_ground::filter;
use contactbench_ground::pairs::sink::Sink;
use contactbench_ground::probe::{Op, Probe};

/// Maximum number of records in a leaf.
pub const LEAF: usize = 16;

/// Sorted records, and boxes around them.
pub struct Tree<const D: usize> {
    pub records: Vec<Record<D>>,
    /// Boxes by node number; number 0 is unused.
    boxes: Vec<Bounds<D>>,
}

/// Distribution of records among the leaves.
#[derive(Clone, Copy)]
pub struct Leaves {
    n: usize,
    levels: u32,
}

impl Leaves {
    pub fn new(n: usize) -> Leaves {
        Leaves { n, levels: n.div_ceil(LEAF).max(1).next_power_of_two().trailing_zeros() }
    }

    pub fn count(self) -> usize {
        1 << self.levels
    }

    /// Returns the first record of a leaf. Both factors are below 2^32, so the product does not
    /// overflow.
    #[inline(always)]
    pub fn place(self, leaf: usize) -> usize {
        ((leaf as u64 * self.n as u64) >> self.levels) as usize
    }
}

impl<const D: usize> Tree<D> {
    pub fn empty() -> Tree<D> {
        Tree { records: Vec::new(), boxes: Vec::new() }
    }

    pub fn bytes(n: usize) -> u64 {
        Record::<D>::BYTES * n as u64
            + 2 * size_of::<Bounds<D>>() as u64 * Leaves::new(n).count() as u64
    }

    pub fn formula_bytes(&self) -> u64 {
        Record::<D>::BYTES * self.records.len() as u64
            + size_of::<Bounds<D>>() as u64 * self.boxes.len() as u64
    }

    /// Resizes the tree; the caller then fills the records.
    pub fn prepare(&mut self, n: usize) {
        room(&mut self.records, n, Record::NONE);
        room(&mut self.boxes, 2 * Leaves::new(n).count(), Bounds::NONE);
    }

    pub fn search<P: Probe, S: Sink>(
        &mut self,
        judge: Judge<'_, P, impl Nearness>,
        probe: &mut P,
        sink: &mut S,
    ) {
        self.enclose(judge.nearness);
        self.walk(judge, probe, sink);
    }

    pub(crate) fn enclose(&mut self, halves: impl Nearness) {
        let leaves = Leaves::new(self.records.len());
        let first = leaves.count();
        for leaf in 0..first {
            self.boxes[first + leaf] = self.around_leaf(leaves, leaf, halves);
        }
        for node in (1..first).rev() {
            self.boxes[node] = self.around_halves(node);
        }
    }

    fn around_leaf(&self, leaves: Leaves, leaf: usize, halves: impl Nearness) -> Bounds<D> {
        let mut bounds = Bounds::NONE;
        for record in &self.records[leaves.place(leaf)..leaves.place(leaf + 1)] {
            let body = around(record, halves);
            bounds.widen(body.low, body.high);
        }
        bounds
    }

    fn around_halves(&self, node: usize) -> Bounds<D> {
        let mut bounds = self.boxes[2 * node];
        bounds.widen(self.boxes[2 * node + 1].low, self.boxes[2 * node + 1].high);
        bounds
    }

    /// Finds the contacts; the boxes must enclose the current records.
    pub(crate) fn walk<P: Probe, S: Sink>(
        &self,
        judge: Judge<'_, P, impl Nearness>,
        probe: &mut P,
        sink: &mut S,
    ) {
        let leaves = Leaves::new(self.records.len());
        let mut walk = Walk {
            tree: self,
            leaves,
            judge,
            near: [Record::NONE; LEAF],
            found: PairBuffer::none(),
            probe,
            sink,
        };
        walk.inside(1);
        walk.found.flush(walk.sink);
    }
}

#[inline(always)]
fn around<const D: usize>(record: &Record<D>, nearness: impl Nearness) -> Bounds<D> {
    let half = nearness.half(record.radius);
    let ends = record.position.map(|x| filter::interval(x, half));
    Bounds { low: ends.map(|[low, _]| low), high: ends.map(|[_, high]| high) }
}

struct Walk<'a, N, P, S, const D: usize> {
    tree: &'a Tree<D>,
    leaves: Leaves,
    judge: Judge<'a, P, N>,
    /// Records of one leaf that may touch a particle of another leaf.
    near: [Record<D>; LEAF],
    found: PairBuffer,
    probe: &'a mut P,
    sink: &'a mut S,
}

impl<'a, N: Nearness, P: Probe, S: Sink, const D: usize> Walk<'a, N, P, S, D> {
    fn inside(&mut self, node: usize) {
        self.probe.count(Op::NodeVisit);
        if node < self.leaves.count() {
            self.inside(2 * node);
            self.inside(2 * node + 1);
            self.between(2 * node, 2 * node + 1);
            return;
        }
        let records = self.records(node);
        for (i, a) in records.iter().enumerate() {
            self.judge.against(a, &records[i + 1..], &mut self.found, self.probe, self.sink);
        }
    }

    fn between(&mut self, a: usize, b: usize) {
        self.probe.count(Op::BoundTest);
        if !self.tree.boxes[a].meets(&self.tree.boxes[b]) {
            return;
        }
        self.probe.count(Op::NodeVisit);
        if a >= self.leaves.count() {
            return self.leaves(a, b);
        }
        for (a, b) in
            [(2 * a + 1, 2 * b), (2 * a, 2 * b), (2 * a + 1, 2 * b + 1), (2 * a, 2 * b + 1)]
        {
            self.between(a, b);
        }
    }

    #[inline(never)]
    fn leaves(&mut self, a: usize, b: usize) {
        let [box_a, box_b] = [a, b].map(|node| self.tree.boxes[node]);
        let mut count = 0;
        for b in self.records(b) {
            self.probe.count(Op::BoundTest);
            // Always written; the record is kept only if the count is incremented.
            self.near[count % LEAF] = *b;
            count += usize::from(self.is_near(b, &box_a));
        }
        if count == 0 {
            return;
        }
        for a in self.records(a) {
            self.probe.count(Op::BoundTest);
            if self.is_near(a, &box_b) {
                let near = &self.near[..count];
                self.judge.against(a, near, &mut self.found, self.probe, self.sink);
            }
        }
    }

    #[inline(always)]
    fn is_near(&self, body: &Record<D>, bounds: &Bounds<D>) -> bool {
        around(body, self.judge.nearness).meets(bounds)
    }

    fn records(&self, leaf: usize) -> &'a [Record<D>] {
        let leaf = leaf - self.leaves.count();
        &self.tree.records[self.leaves.place(leaf)..self.leaves.place(leaf + 1)]
    }
}
