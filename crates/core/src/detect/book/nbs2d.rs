//! `nbs` in 2D: Munjiza-NBS (Munjiza 2004, section 3.8; Munjiza and Andrews 1998,
//! doi:10.1002/(SICI)1097-0207(19980915)43:1<131::AID-NME447>3.0.CO;2-S).
//!
//! 1. Every particle is put on the y-list of its row.
//! 2. A loop over particles finds each row that is not empty once: a *new* list, marked *old* when
//!    found. From there it goes up, row by row, as long as rows are new and not empty.
//! 3. Its particles and those of the row below are put on two sets of x-lists: one list per cell.
//! 4. A loop over the row's particles finds each of its cells once and checks it against itself and
//!    the contact mask: the cell to the left, and the three cells below.
//! 5. Both sets of x-lists, and at the end the y-lists, are emptied by walking over *particles*. No
//!    loop over cells anywhere.
//!
//! * Cost: proportional to N, independent of the packing density; each particle is pushed at most 3
//!   times (1 y-list, 2 x-lists).
//! * Memory: `4(ny + 2nx + 2N)` bytes (BOOK 3.65) for N particles and nx, ny cells per axis, two
//!   empty border cells per axis included. Nothing is cached: integerised coordinates are computed
//!   again where they are needed.
//! * Refuses scenes whose ny + 2nx exceeds the memory limit, and more than 2^31 - 1 particles.
//! * Deviations from the book: cells are wider by 4 parts in a million ([`crate::filter::cells`]);
//!   heads are marked old with the highest bit instead of by adding N; particles count from 0; the
//!   links of one particle stand side by side, where the book has arrays X and Y; removal computes
//!   integerised coordinates again, where the book keeps them; the book takes every row where the
//!   loop over particles finds it, we go on to the row above it, whose row below is then still in
//!   the caches.

use super::list::{EMPTY, Heads, Links, numbered};
use crate::contact::Bodies;
use crate::detect::{Declare, Detector, Options, Refusal, within};
use crate::event::{Event, Part};
use crate::filter::Cells;
use crate::probe::Probe;
use crate::scene::Real;
use crate::sink::Sink;

/// Kinds of lists.
const Y: usize = 0;
const X: usize = 1;

/// Munjiza-NBS for discs. The fields carry the book's names.
pub struct Nbs2d {
    options: Options,
    /// B: heads of the y-lists.
    b: Heads,
    /// Y and X: links of the y-lists and x-lists, side by side.
    links: Links<2>,
    /// A: heads of the x-lists, of the central row and of the row below.
    a: [Heads; 2],
    formula: u64,
}

impl Declare for Nbs2d {
    fn with(options: Options) -> Nbs2d {
        Nbs2d {
            options,
            b: Heads::named('B'),
            links: Links::default(),
            a: [Heads::named('A'), Heads::named('a')],
            formula: 0,
        }
    }

    fn formula_bytes(&self) -> u64 {
        self.formula
    }
}

impl<T: Real> Detector<T, 2> for Nbs2d {
    fn detect<B: Bodies<T, 2>, P: Probe, S: Sink>(
        &mut self,
        bodies: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        let cells = Cells::new(&bodies)?;
        self.prepare(&cells, bodies.len())?;
        let n = bodies.len() as u32;
        probe.note(|| Event::Begin(Part::Rows));
        self.push_rows(&bodies, &cells, probe);
        for k in 0..n {
            probe.note(|| Event::Visit { particle: k });
            let mut row = cells.index(bodies.position(k)[1], 1, probe);
            while let Some(first) = self.b.take_new(row, probe) {
                self.row(&bodies, &cells, first, row, probe, sink);
                row += 1;
            }
        }
        probe.note(|| Event::Begin(Part::RemoveRows));
        for k in 0..n {
            self.b.reset(cells.index(bodies.position(k)[1], 1, probe), probe);
        }
        Ok(())
    }
}

impl Nbs2d {
    /// What all arrays take.
    pub(crate) fn bytes(cells: &Cells<2>, n: usize) -> u64 {
        let [nx, ny] = cells.count;
        4 * (u64::from(ny) + 2 * u64::from(nx) + 2 * n as u64)
    }

    pub(crate) fn prepare(&mut self, cells: &Cells<2>, n: usize) -> Result<(), Refusal> {
        numbered("nbs", n)?;
        let ([nx, ny], needed) = (cells.count, Nbs2d::bytes(cells, n));
        within(&self.options, "nbs", needed, || format!("{n} particles, {nx} x {ny} cells"))?;
        self.formula = needed;
        self.b.prepare(ny as usize);
        self.links.prepare(n);
        self.a.iter_mut().for_each(|heads| heads.prepare(nx as usize));
        Ok(())
    }

    fn push_rows<T: Real, P: Probe>(
        &mut self,
        bodies: &impl Bodies<T, 2>,
        cells: &Cells<2>,
        probe: &mut P,
    ) {
        for k in 0..bodies.len() as u32 {
            self.b.push(cells.index(bodies.position(k)[1], 1, probe), k, &mut self.links, Y, probe);
        }
    }

    /// Puts the particles of the y-list that begins with `first` on x-lists of the given set.
    #[inline(always)]
    fn push_cells<T: Real, P: Probe>(
        &mut self,
        bodies: &impl Bodies<T, 2>,
        cells: &Cells<2>,
        first: u32,
        set: usize,
        probe: &mut P,
    ) {
        let mut k = first;
        while k != EMPTY {
            self.a[set].push(
                cells.index(bodies.position(k)[0], 0, probe),
                k,
                &mut self.links,
                X,
                probe,
            );
            k = self.links.next(k, Y, probe);
        }
    }

    /// Empties the x-lists of the particles of the y-list that begins with `first`.
    #[inline(always)]
    fn reset_cells<T: Real, P: Probe>(
        &mut self,
        bodies: &impl Bodies<T, 2>,
        cells: &Cells<2>,
        first: u32,
        set: usize,
        probe: &mut P,
    ) {
        let mut k = first;
        while k != EMPTY {
            self.a[set].reset(cells.index(bodies.position(k)[0], 0, probe), probe);
            k = self.links.next(k, Y, probe);
        }
    }

    /// The y-lists, which are of kind 0.
    pub(crate) fn lists(&mut self) -> (&mut Heads, &mut Links<2>) {
        (&mut self.b, &mut self.links)
    }

    /// Checks the central row, which begins with `first`, against itself and the row below.
    pub(crate) fn row<T: Real, P: Probe, S: Sink>(
        &mut self,
        bodies: &impl Bodies<T, 2>,
        cells: &Cells<2>,
        first: u32,
        row: u32,
        probe: &mut P,
        sink: &mut S,
    ) {
        probe.note(|| Event::Begin(Part::CentralRow { row }));
        let below = self.b.first(row - 1, probe);
        self.push_cells(bodies, cells, first, 0, probe);
        self.push_cells(bodies, cells, below, 1, probe);
        let mut k = first;
        probe.note(|| Event::Begin(Part::Columns));
        while k != EMPTY {
            probe.note(|| Event::Visit { particle: k });
            let column = cells.index(bodies.position(k)[0], 0, probe);
            if let Some(central) = self.a[0].take_new(column, probe) {
                probe.note(|| Event::Central { cell: [column, row] });
                let mask = [
                    self.a[0].first(column - 1, probe),
                    self.a[1].first(column - 1, probe),
                    self.a[1].first(column, probe),
                    self.a[1].first(column + 1, probe),
                ];
                self.links.check(X, bodies, central, mask, probe, sink);
            }
            k = self.links.next(k, Y, probe);
        }
        probe.note(|| Event::Begin(Part::RemoveColumns));
        self.reset_cells(bodies, cells, first, 0, probe);
        self.reset_cells(bodies, cells, below, 1, probe);
    }
}

#[cfg(test)]
mod tests {
    use super::super::golden::{InCells, TEN};
    use super::super::list::as_printed;
    use super::*;
    use crate::probe::{Op, Silent, Tally};

    /// G5: the book's ten particles (p103-110) on the real arrays.
    #[test]
    fn the_books_ten_particles() {
        let scene = InCells(&TEN);
        let cells = scene.grid();
        let mut nbs = Nbs2d::with(Options::default());
        nbs.prepare(&cells, TEN.len()).unwrap();
        nbs.push_rows(&scene, &cells, &mut Silent);
        assert_eq!(as_printed(&nbs.b.raw()[1..=10]), [-1, -1, -1, -1, 5, 9, 10, 2, -1, -1]);
        assert_eq!(as_printed(&nbs.links.raw(Y)), [-1, -1, -1, 1, -1, 3, 4, 6, 8, 7]);
        let row = nbs.b.take_new(7u32, &mut Silent).unwrap();
        assert_eq!(nbs.b.take_new(7u32, &mut Silent), None);
        nbs.push_cells(&scene, &cells, row, 0, &mut Silent);
        assert_eq!(as_printed(&nbs.a[0].raw()[1..=10]), [-1, -1, 7, 1, 4, -1, -1, -1, -1, -1]);
        assert_eq!(as_printed(&nbs.links.raw(X)), [10, -1, -1, -1, -1, -1, -1, -1, -1, -1]);
        nbs.reset_cells(&scene, &cells, row, 0, &mut Silent);
        assert!(as_printed(nbs.a[0].raw()).iter().all(|&head| head == -1));
    }

    #[test]
    fn the_mask_couples_of_the_ten_particles() {
        // Without particle 9, whose column the book does not show: BOOK's twenty couples.
        let scene = InCells(&TEN);
        let mut nbs = Nbs2d::with(Options::default());
        let (mut tally, mut pairs) = (Tally::default(), Vec::new());
        nbs.detect(scene, &mut tally, &mut pairs).unwrap();
        let found = super::super::golden::printed(&pairs, &[9]);
        let printed =
            "1-2 1-3 1-4 1-6 1-7 1-10 2-4 2-10 3-4 3-5 3-6 3-7 3-10 4-6 4-8 4-10 5-6 6-8 6-10 7-10";
        assert_eq!(found, printed);
        assert_eq!(tally.get(Op::ContactTest), pairs.len() as u64);
        assert!(
            nbs.b
                .raw()
                .iter()
                .chain(nbs.a[0].raw())
                .chain(nbs.a[1].raw())
                .all(|&head| head == EMPTY)
        );
    }
}
