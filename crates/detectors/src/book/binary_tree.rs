//! `binary-tree`: the binary tree (Munjiza 2004, section 3.4).
//!
//! 1. The domain, a square or cube around all particles, is halved in x, then in y (then in z),
//!    again and again until the smallest cell is as large as the cells of the other detectors.
//! 2. Each particle descends b levels to its leaf; nodes are made only where needed. There it is
//!    pushed on the leaf's list: `E[k] = HEAD; HEAD = k`.
//! 3. Detection walks over the tree. Every leaf cell is checked against itself and its contact mask
//!    (4 cells in 2D, 13 in 3D); each mask cell is found by a descent from the root.
//!
//! * Cost: proportional to N log2 N for N particles. The tree has b = D·ceil(log2 n) levels for n
//!   cells along the longest of D axes.
//! * Memory: `4N + 8·nodes` bytes; the parent of a leaf stores the leaf's HEAD instead of a child.
//!   There are at most N·b nodes, about 2 per occupied cell in a dense packing. The number of nodes
//!   is not known in advance: the array grows by doubling, so its peak may be three times its final
//!   size.
//! * Refuses 2^31 or more cells along an axis, and trees over the memory limit. The second refusal
//!   comes while the tree is being built.
//! * Deviations from the book: cells are wider by 4 parts in a million
//!   ([`contactbench_ground::filter::cells`]); a descent reads one bit of an integerised coordinate
//!   at each level instead of comparing the coordinate with x_mid (3.16), so the additions and
//!   divisions of (3.22) are not made; HEAD is in the parent's place for the child, not in the
//!   leaf; leaves are visited in the order of the tree, and once, where the book descends for each
//!   particle. Links and children are indices of 4 bytes. The book prefers pointers (page 85), which
//!   take 8 bytes today. Their time is not measured: that needs a second form of all lists, with
//!   nodes allocated one by one.
//!
//! The parameter `tree=kept` selects the book's second variant ([`super::kept_tree`]).

use super::list::{EMPTY, Links};
use super::mask;
use contactbench_ground::contact::Particles;
use contactbench_ground::detect::numbered;
use contactbench_ground::detect::{Declare, Detector, Options, within};
use contactbench_ground::filter::Cells;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::Sink;
use contactbench_ground::probe::event::{Event, Part, plane};
use contactbench_ground::probe::{Op, Probe};
use contactbench_ground::scene::Real;
use contactbench_ground::wide::fill;

/// The `binary-tree` detector of the book.
pub struct BinaryTree {
    options: Options,
    /// Two children per node: indices of nodes or, on the last level, the HEADs of two leaves.
    pub(super) nodes: Vec<[u32; 2]>,
    e: Links<1>,
    particles: usize,
    /// Bytes of all arrays over particles, for each of them.
    pub(super) per_particle: u64,
}

impl Declare for BinaryTree {
    fn with(options: Options) -> BinaryTree {
        let (nodes, e) = Default::default();
        BinaryTree { options, nodes, e, particles: 0, per_particle: 4 }
    }

    fn formula_bytes(&self) -> u64 {
        self.per_particle * self.particles as u64 + 8 * self.nodes.len() as u64
    }
}

mask::detects_by_mask!(BinaryTree, 2, PLANE);
mask::detects_by_mask!(BinaryTree, 3, SPACE);

/// Levels of the tree: on each, one bit of a cell's index selects the half, highest bit first.
#[derive(Clone, Copy)]
pub(super) struct Levels {
    /// Number of times that each axis is halved.
    halvings: u32,
}

impl Levels {
    pub(super) fn new<const D: usize>(cells: &Cells<D>) -> Levels {
        let most = cells.count.iter().fold(0, |most, &count| most.max(count));
        Levels { halvings: 32 - (most - 1).leading_zeros() }
    }

    /// Returns which half (0 or 1) of an axis, halved `halving` times, contains the cell with this
    /// index.
    #[inline(always)]
    fn half(self, index: u32, halving: u32) -> usize {
        (index >> (self.halvings - 1 - halving) & 1) as usize
    }
}

impl BinaryTree {
    fn run<T: Real, const D: usize, const M: usize>(
        &mut self,
        particles: &impl Particles<T, D>,
        mask: [[i32; D]; M],
        probe: &mut impl Probe,
        sink: &mut impl Sink,
    ) -> Result<(), Refusal> {
        let cells = Cells::new(particles)?;
        let levels = Levels::new(&cells);
        self.begin(particles.len())?;
        probe.note(|| Event::Begin(Part::Tree { halvings: levels.halvings }));
        for k in 0..particles.len() as u32 {
            self.insert(k, integerise(particles, &cells, k, probe), levels, probe)?;
        }
        probe.note(|| Event::Begin(Part::Walk));
        self.walk(particles, &cells, levels, mask, probe, sink);
        Ok(())
    }

    /// Empties the tree, and makes room for particles.
    pub(super) fn begin(&mut self, particles: usize) -> Result<(), Refusal> {
        numbered("binary-tree", particles)?;
        self.particles = particles;
        self.nodes.clear();
        within(&self.options, "binary-tree", self.formula_bytes() + 8, || {
            format!("{particles} particles")
        })?;
        self.e.prepare(particles);
        self.nodes.push([EMPTY; 2]);
        Ok(())
    }

    /// Descends to the leaf of `cell`, makes missing nodes, and pushes particle `k` on the leaf's
    /// list.
    pub(super) fn insert<const D: usize>(
        &mut self,
        k: u32,
        cell: [u32; D],
        levels: Levels,
        probe: &mut impl Probe,
    ) -> Result<(), Refusal> {
        let mut node = 0;
        for halving in 0..levels.halvings {
            for (axis, &index) in cell.iter().enumerate() {
                probe.count(Op::NodeVisit);
                let half = levels.half(index, halving);
                probe.note(|| Event::Node { node: node as u32, half: Some(half) });
                let child = self.nodes[node][half];
                if halving + 1 == levels.halvings && axis + 1 == D {
                    probe.count(Op::ListPush);
                    self.e.set(k, 0, child);
                    self.nodes[node][half] = k;
                    let next = (child != EMPTY).then_some(child);
                    probe.note(|| Event::Leaf {
                        node: node as u32,
                        half,
                        cell: plane(cell),
                        particle: k,
                        next,
                    });
                } else if child == EMPTY {
                    let made = self.make_node()?;
                    self.nodes[node][half] = made;
                    probe.note(|| Event::Made { node: made, parent: node as u32, half });
                    node = made as usize;
                } else {
                    node = child as usize;
                }
            }
        }
        Ok(())
    }

    /// Takes particle `k` off the list of the leaf of `cell`.
    pub(super) fn remove<const D: usize>(
        &mut self,
        k: u32,
        cell: [u32; D],
        levels: Levels,
        probe: &mut impl Probe,
    ) {
        let (mut at, mut head) = (0, [0, 0]);
        for halving in 0..levels.halvings {
            for index in cell {
                probe.count(Op::NodeVisit);
                head = [at as usize, levels.half(index, halving)];
                at = self.nodes[head[0]][head[1]];
            }
        }
        let rest = self.e.next(k, 0, probe);
        if at == k {
            self.nodes[head[0]][head[1]] = rest;
            return;
        }
        let mut next = self.e.next(at, 0, probe);
        while next != k {
            (at, next) = (next, self.e.next(next, 0, probe));
        }
        self.e.set(at, 0, rest);
    }

    fn make_node(&mut self) -> Result<u32, Refusal> {
        let made = self.nodes.len();
        if made == self.nodes.capacity() {
            // The array doubles, or grows to the memory limit.
            let left =
                self.options.memory_limit.saturating_sub(self.per_particle * self.particles as u64);
            let allowed = (left / 8).min(u64::from(EMPTY)) as usize;
            let grown = (2 * made).min(allowed);
            if grown <= made {
                let shape = format!("{} particles, more than {made} nodes", self.particles);
                let needed = self.formula_bytes() + 8;
                return Err(Refusal::Memory {
                    detector: "binary-tree",
                    needed,
                    limit: self.options.memory_limit,
                    shape,
                });
            }
            contactbench_ground::limits::refusal::must_reserve(&mut self.nodes, grown - made);
        }
        self.nodes.push([EMPTY; 2]);
        Ok(made as u32)
    }

    #[inline(always)]
    fn find<const D: usize>(&self, cell: [u32; D], levels: Levels, probe: &mut impl Probe) -> u32 {
        let mut at = 0;
        for halving in 0..levels.halvings {
            for index in cell {
                probe.count(Op::NodeVisit);
                probe.note(|| Event::Node { node: at, half: Some(levels.half(index, halving)) });
                at = self.nodes[at as usize][levels.half(index, halving)];
                if at == EMPTY {
                    return EMPTY;
                }
            }
        }
        at
    }

    /// Checks every leaf, depth first, so that consecutive descents share most of their nodes.
    pub(super) fn walk<T: Real, const D: usize, const M: usize>(
        &self,
        particles: &impl Particles<T, D>,
        cells: &Cells<D>,
        levels: Levels,
        mask: [[i32; D]; M],
        probe: &mut impl Probe,
        sink: &mut impl Sink,
    ) {
        let depth = levels.halvings as usize * D;
        // At most one sibling waits per level, and there are at most 31 * 3 levels.
        let (mut waiting, mut top) = ([(0u32, 0usize); 96], 0);
        let mut next = Some((0u32, 0usize));
        while let Some((at, level)) = next.take() {
            if level == depth {
                let central = integerise(particles, cells, at, probe);
                probe.note(|| Event::Central { cell: plane(central) });
                let heads = mask.map(|offset| {
                    let cell = mask::neighbour(central, offset);
                    let head = self.find(cell, levels, probe);
                    let first = (head != EMPTY).then_some(head);
                    probe.note(|| Event::Descended { cell: plane(cell), first });
                    head
                });
                self.e.check(0, particles, at, heads, probe, sink);
            } else {
                probe.count(Op::NodeVisit);
                probe.note(|| Event::Node { node: at, half: None });
                let [low, high] = self.nodes[at as usize];
                next = (low != EMPTY).then_some((low, level + 1));
                if high != EMPTY {
                    waiting[top] = (high, level + 1);
                    top += 1;
                }
            }
            if next.is_none() && top > 0 {
                top -= 1;
                next = Some(waiting[top]);
            }
        }
    }
}

#[inline(always)]
pub(super) fn integerise<T: Real, const D: usize>(
    particles: &impl Particles<T, D>,
    cells: &Cells<D>,
    k: u32,
    probe: &mut impl Probe,
) -> [u32; D] {
    let position = particles.position(k);
    fill(|axis| cells.index(position[axis], axis, probe))
}

#[cfg(test)]
mod tests {
    use super::super::golden::{InCells, TEN};
    use super::super::list::as_printed;
    use super::*;
    use contactbench_ground::probe::Silent;

    /// Example G1 of the book: the list of a leaf (pages 84 and 85).
    #[test]
    fn the_books_leaf_list() {
        let mut tree = BinaryTree::with(Options::default());
        let levels = Levels { halvings: 4 };
        tree.particles = 10;
        tree.e.prepare(10);
        tree.nodes.push([EMPTY; 2]);
        for k in [3, 5, 7, 9] {
            tree.insert(k - 1, [6, 3], levels, &mut Silent).unwrap();
        }
        assert_eq!(as_printed(&[tree.find([6, 3], levels, &mut Silent)]), [9]);
        assert_eq!(as_printed(&tree.e.raw(0)), [-1, -1, -1, -1, 3, -1, 5, -1, 7, -1]);
        tree.insert(0, [6, 3], levels, &mut Silent).unwrap();
        assert_eq!(as_printed(&[tree.find([6, 3], levels, &mut Silent)]), [1]);
        assert_eq!(as_printed(&tree.e.raw(0)), [9, -1, -1, -1, 3, -1, 5, -1, 7, -1]);
        assert_eq!(tree.find([6, 2], levels, &mut Silent), EMPTY);
        assert_eq!(tree.nodes.len(), 8); // One path of eight levels.
    }

    #[test]
    fn the_mask_pairs_of_ten_particles() {
        let mut pairs = Vec::new();
        BinaryTree::with(Options::default())
            .detect(InCells(&TEN), &mut Silent, &mut pairs)
            .unwrap();
        let printed =
            "1-2 1-3 1-4 1-6 1-7 1-10 2-4 2-10 3-4 3-5 3-6 3-7 3-10 4-6 4-8 4-10 5-6 6-8 6-10 7-10";
        assert_eq!(super::super::golden::printed(&pairs, &[9]), printed);
    }
}
