//! `binary-tree:tree=kept`: the binary tree, kept between detections (Munjiza 2004, pages 86 and
//! 87).
//!
//! 1. The first detection builds the tree as [`binary_tree`](super::binary_tree) does, and keeps
//!    the cell of each particle.
//! 2. A later detection computes the cells again. A particle whose cell is another one is taken
//!    from the list of its old leaf and pushed on that of its new leaf.
//! 3. The search walks over the tree, as in [`binary_tree`](super::binary_tree).
//!
//! * Cost: moving a particle that left its cell visits 2b nodes, where b is the number of levels.
//!   The search visits at least as many nodes as in a new tree; emptied leaves add visits.
//! * Memory: `4N(D + 1) + 8·nodes` bytes. Leaves that become empty stay, so the tree may grow.
//! * Builds the tree again if the number of particles or the margin of the contact test changes, if
//!   the reach grows or halves, if a particle leaves the domain, which is at most half a cell larger
//!   on each side than the scene, or if the tree has more than twice the nodes of a new one.
//! * Deviations from the book: those of `binary-tree`; the book does not print when it builds the
//!   tree again.

use super::binary_tree::{BinaryTree, Levels, integerise};
use super::mask;
use contactbench_ground::contact::{Margin, Particles};
use contactbench_ground::detect::{Declare, Detector, Options};
use contactbench_ground::filter::cells::cell_reach;
use contactbench_ground::filter::{Cells, bounds};
use contactbench_ground::limits::refusal::{Refusal, must_reserve};
use contactbench_ground::pairs::sink::Sink;
use contactbench_ground::probe::{Op, Probe};
use contactbench_ground::scene::Real;

/// The `binary-tree` detector with a kept tree, in `D` dimensions.
pub struct KeptTree<const D: usize> {
    tree: BinaryTree,
    /// `None` before the first detection, and after one that was refused.
    domain: Option<Domain<D>>,
    /// Cell of each particle in the last detection.
    at: Vec<[u32; D]>,
}

/// Scenes that one tree serves: those of particles between two corners, up to a reach.
#[derive(Clone, Copy)]
struct Domain<const D: usize> {
    cells: Cells<D>,
    low: [f64; D],
    high: [f64; D],
    reach: f64,
    margin: Margin,
    /// Number of nodes after building.
    nodes: usize,
}

impl<const D: usize> Declare for KeptTree<D> {
    fn with(options: Options) -> KeptTree<D> {
        let mut tree = BinaryTree::with(options);
        tree.per_particle = 4 * (D as u64 + 1);
        KeptTree { tree, domain: None, at: Vec::new() }
    }

    fn formula_bytes(&self) -> u64 {
        self.tree.formula_bytes()
    }
}

mask::detects_by_mask!(KeptTree<2>, 2, PLANE);
mask::detects_by_mask!(KeptTree<3>, 3, SPACE);

impl<const D: usize> KeptTree<D> {
    fn run<T: Real, const M: usize>(
        &mut self,
        particles: &impl Particles<T, D>,
        mask: [[i32; D]; M],
        probe: &mut impl Probe,
        sink: &mut impl Sink,
    ) -> Result<(), Refusal> {
        let domain = match self.domain.take().filter(|kept| self.serves(kept, particles)) {
            Some(kept) if self.follow(&kept.cells, particles, probe).is_ok() => kept,
            _ => self.build(particles, probe)?,
        };
        self.domain = Some(domain);
        let levels = Levels::new(&domain.cells);
        self.tree.walk(particles, &domain.cells, levels, mask, probe, sink);
        Ok(())
    }

    /// Returns whether the tree and its cells can be used for these particles.
    fn serves<T: Real>(&self, kept: &Domain<D>, particles: &impl Particles<T, D>) -> bool {
        let (low, high) = bounds(particles);
        let reach = cell_reach(particles, low, high);
        particles.len() == self.at.len()
            && particles.margin() == kept.margin
            && (0.5 * kept.reach < reach && reach <= kept.reach)
            && (0..D).all(|axis| kept.low[axis] <= low[axis] && high[axis] <= kept.high[axis])
            && self.tree.nodes.len() <= 2 * kept.nodes
    }

    fn build<T: Real>(
        &mut self,
        particles: &impl Particles<T, D>,
        probe: &mut impl Probe,
    ) -> Result<Domain<D>, Refusal> {
        let ((low, high), margin) = (bounds(particles), particles.margin());
        let reach = cell_reach(particles, low, high);
        let wider = (low.map(|x| x - 0.5 * reach), high.map(|x| x + 0.5 * reach));
        let (cells, (low, high)) = match Cells::spanning(wider.0, wider.1, reach, margin) {
            Ok(cells) => (cells, wider),
            Err(_) => (Cells::new(particles)?, (low, high)),
        };
        let levels = Levels::new(&cells);
        self.tree.begin(particles.len())?;
        self.at.clear();
        must_reserve(&mut self.at, particles.len());
        for k in 0..particles.len() as u32 {
            let cell = integerise(particles, &cells, k, probe);
            self.tree.insert(k, cell, levels, probe)?;
            self.at.push(cell);
        }
        Ok(Domain { cells, low, high, reach, margin, nodes: self.tree.nodes.len() })
    }

    /// Moves the particles that left their cells to other leaves. If that is refused, the tree must
    /// be built again.
    fn follow<T: Real>(
        &mut self,
        cells: &Cells<D>,
        particles: &impl Particles<T, D>,
        probe: &mut impl Probe,
    ) -> Result<(), Refusal> {
        let levels = Levels::new(cells);
        for k in 0..particles.len() as u32 {
            let (new, at) = (integerise(particles, cells, k, probe), &mut self.at[k as usize]);
            if *at != new {
                probe.count(Op::Reinsert);
                self.tree.remove(k, std::mem::replace(at, new), levels, probe);
                self.tree.insert(k, new, levels, probe)?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::golden::{InCells, TEN};
    use super::*;
    use contactbench_ground::pairs::normalise::normalise;
    use contactbench_ground::probe::Tally;

    /// Returns the moved particles, the visited nodes and the pairs of one detection.
    fn detected(
        detector: &mut impl Detector<f64, 2>,
        cells: &[[u32; 2]],
    ) -> (u64, u64, Vec<[u32; 2]>) {
        let (mut tally, mut pairs) = (Tally::default(), Vec::new());
        detector.detect(InCells(cells), &mut tally, &mut pairs).unwrap();
        normalise(&mut pairs);
        (tally.get(Op::Reinsert), tally.get(Op::NodeVisit), pairs)
    }

    #[test]
    fn only_particles_that_left_their_leaf_move() {
        let (mut kept, mut cells) = (KeptTree::with(Options::default()), TEN);
        let new = |cells: &[[u32; 2]]| detected(&mut BinaryTree::with(Options::default()), cells).2;
        let (_, built, first) = detected(&mut kept, &cells);
        assert_eq!(first, new(&cells));
        let (moved, search, _) = detected(&mut kept, &cells);
        // The domain has 9 cells along x, 6 along y, borders included: 4 halvings in 2D.
        assert_eq!((moved, built - search), (0, 10 * 2 * 4));
        // The first, the middle and the only particle of a list.
        for (k, cell) in [(9, [3, 7]), (3, [5, 6]), (4, [5, 5]), (0, [3, 7]), (6, [9, 8])] {
            cells[k] = cell;
            let (moved, _, pairs) = detected(&mut kept, &cells);
            assert_eq!((moved, pairs), (1, new(&cells)), "{k}");
        }
        // Outside the domain, and with one particle less.
        cells[8] = [20, 20];
        let (moved, _, pairs) = detected(&mut kept, &cells);
        assert_eq!((moved, pairs), (0, new(&cells)));
        assert_eq!(detected(&mut kept, &cells[1..]).2, new(&cells[1..]));
    }
}
