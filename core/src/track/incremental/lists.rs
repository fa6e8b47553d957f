//! Lists of the book's detectors that stay: bodies that have left theirs are put on another.
//!
//! Munjiza keeps a tree so (2004, p86-87: between detections only the elements that changed their
//! leaf are moved); here it is the y-lists of NBS (in space its z-lists) and the lists of
//! screening. A run of lists that are not empty is searched, from the lowest upwards, when the loop
//! over particles is at the first one of the lowest: so none need be marked old, and none emptied,
//! and the list below is still in the caches. There is an empty one at either end.
//!
//! * **Room:** the grid reaches one cell farther than the bodies on each side, if there is memory
//!   for it and it can be numbered. It is made anew when a body leaves it, and when the number of
//!   bodies or the reach (the largest radius) is another.
//! * **Cost:** where a body is, is known once and kept: a coordinate (of screening: D of them) is
//!   integerised for each; a push for those that left their list.
//! * **Memory:** the detector's, and for each particle the number of its list and the particle
//!   before it, by which it is taken out without walking along the list.

use std::time::{Duration, Instant};

use super::Carried;
use crate::contact::{Bodies, Corners, Margin};
use crate::detect::book::list::{EMPTY, Heads, Index, Links};
use crate::detect::{Declare, Detector, Options, Refusal, within};
use crate::filter::cells::cell_reach;
use crate::filter::{Cells, bounds};
use crate::probe::{Op, Probe};
use crate::refusal::reserve;
use crate::scene::Real;
use crate::sink::Sink;

/// A detector of the book, seen as lists that can stay; its links are of `L` kinds.
pub(super) trait Lists<const D: usize, const L: usize>: Declare {
    /// Who refuses.
    const NAME: &'static str;
    /// The number of a list.
    type List: Index + PartialEq + Send;

    /// The list of a body here.
    fn list(cells: &Cells<D>, position: [f64; D], probe: &mut impl Probe) -> Self::List;

    /// What its own arrays take.
    fn bytes(cells: &Cells<D>, n: usize) -> u64;

    /// Makes room, where all lists are empty.
    fn prepare(&mut self, cells: &Cells<D>, n: usize) -> Result<(), Refusal>;

    /// The lists that stay: their heads, and the links of which kind 0 are theirs.
    fn lists(&mut self) -> (&mut Heads, &mut Links<L>);

    /// Finds the contacts of the bodies of a list that is not empty.
    fn search<T: Real>(
        &mut self,
        bodies: &impl Bodies<T, D>,
        cells: &Cells<D>,
        list: usize,
        first: u32,
        probe: &mut impl Probe,
        sink: &mut impl Sink,
    );
}

/// A detector whose lists stay.
pub(super) struct Standing<X: Lists<D, L>, const D: usize, const L: usize> {
    detector: X,
    options: Options,
    /// None if bodies are to be put on lists anew.
    grid: Option<Grid<D>>,
    /// Of each body that is on a list, the list.
    lists: Vec<X::List>,
    /// And the body before it.
    before: Vec<u32>,
    built: Option<Duration>,
}

/// The cells, and for which bodies.
struct Grid<const D: usize> {
    cells: Cells<D>,
    /// They hold what is in this box.
    corners: Corners<D>,
    reach: f64,
}

impl<X: Lists<D, L>, const D: usize, const L: usize> Declare for Standing<X, D, L> {
    fn with(options: Options) -> Self {
        let (lists, before) = (Vec::new(), Vec::new());
        Standing { detector: X::with(options), options, grid: None, lists, before, built: None }
    }

    fn formula_bytes(&self) -> u64 {
        self.detector.formula_bytes() + Self::bytes(self.lists.len())
    }
}

impl<X: Lists<D, L>, const D: usize, const L: usize> Carried for Standing<X, D, L> {
    fn built(&self) -> Option<Duration> {
        self.built
    }

    fn forget(&mut self) {
        self.grid = None;
    }
}

impl<T: Real, X: Lists<D, L>, const D: usize, const L: usize> Detector<T, D> for Standing<X, D, L> {
    fn detect<B: Bodies<T, D>, P: Probe, S: Sink>(
        &mut self,
        bodies: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        let (started, corners) = (Instant::now(), bounds(&bodies));
        let serves = |grid: &Grid<D>| {
            grid.reach == bodies.reach()
                && self.lists.len() == bodies.len()
                && (0..D)
                    .all(|k| grid.corners.0[k] <= corners.0[k] && corners.1[k] <= grid.corners.1[k])
        };
        let grid = self.grid.take().filter(serves);
        self.built = None;
        let grid = match grid {
            Some(grid) => {
                self.repair(&bodies, &grid.cells, probe);
                grid
            }
            None => {
                let grid = self.build(&bodies, corners, probe)?;
                self.built = Some(started.elapsed());
                grid
            }
        };
        for k in 0..bodies.len() as u32 {
            let (mut list, mut first) = (self.lists[k as usize].at(), k);
            let heads = self.detector.lists().0;
            let is_lowest = heads.first(list, probe) == k && heads.first(list - 1, probe) == EMPTY;
            while is_lowest && first != EMPTY {
                self.detector.search(&bodies, &grid.cells, list, first, probe, sink);
                list += 1;
                first = self.detector.lists().0.first(list, probe);
            }
        }
        self.grid = Some(grid);
        Ok(())
    }
}

impl<X: Lists<D, L>, const D: usize, const L: usize> Standing<X, D, L> {
    fn bytes(n: usize) -> u64 {
        (size_of::<X::List>() + size_of::<u32>()) as u64 * n as u64
    }

    /// Puts all bodies on lists.
    fn build<T: Real, P: Probe>(
        &mut self,
        bodies: &impl Bodies<T, D>,
        corners: Corners<D>,
        probe: &mut P,
    ) -> Result<Grid<D>, Refusal> {
        for list in self.lists.drain(..) {
            self.detector.lists().0.reset(list, probe);
        }
        self.before.clear();
        let n = bodies.len();
        let grid = self.room(bodies, corners)?;
        self.detector.prepare(&grid.cells, n)?;
        reserve(&mut self.lists, n)?;
        reserve(&mut self.before, n)?;
        self.before.resize(n, EMPTY);
        for k in 0..n as u32 {
            let list = X::list(&grid.cells, bodies.position(k), probe);
            self.lists.push(list);
            self.put(k, list, probe);
        }
        Ok(grid)
    }

    /// The grid of the bodies: with spare room, or else without.
    fn room<T: Real>(
        &self,
        bodies: &impl Bodies<T, D>,
        (low, high): Corners<D>,
    ) -> Result<Grid<D>, Refusal> {
        let (n, edge) = (bodies.len(), cell_reach(bodies, low, high));
        let grid = |corners: Corners<D>| {
            let cells = Cells::spanning(corners.0, corners.1, edge, Margin::Safe)?;
            let needed = X::bytes(&cells, n).saturating_add(Self::bytes(n));
            within(&self.options, X::NAME, needed, || {
                let counts = cells.count.map(|count| count.to_string());
                format!("{n} particles, {} cells", counts.join(" x "))
            })?;
            Ok(Grid { cells, corners, reach: bodies.reach() })
        };
        grid((low.map(|x| x - edge), high.map(|x| x + edge))).or_else(|_| grid((low, high)))
    }

    /// Moves the bodies that have left their lists.
    fn repair<T: Real, P: Probe>(
        &mut self,
        bodies: &impl Bodies<T, D>,
        cells: &Cells<D>,
        probe: &mut P,
    ) {
        for k in 0..bodies.len() as u32 {
            let list = X::list(cells, bodies.position(k), probe);
            if list != self.lists[k as usize] {
                probe.count(Op::Reinsert);
                self.take_out(k, probe);
                self.lists[k as usize] = list;
                self.put(k, list, probe);
            }
        }
    }

    fn put(&mut self, k: u32, list: X::List, probe: &mut impl Probe) {
        let (heads, links) = self.detector.lists();
        let next = heads.first(list, probe);
        heads.push(list, k, links, 0, probe);
        self.before[k as usize] = EMPTY;
        if next != EMPTY {
            self.before[next as usize] = k;
        }
    }

    fn take_out(&mut self, k: u32, probe: &mut impl Probe) {
        let (heads, links) = self.detector.lists();
        let (before, next) = (self.before[k as usize], links.next(k, 0, probe));
        match before {
            EMPTY => heads.set(self.lists[k as usize], next),
            _ => links.set(before, 0, next),
        }
        if next != EMPTY {
            self.before[next as usize] = before;
        }
    }
}
