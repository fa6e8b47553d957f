//! `nbs`: Munjiza-NBS (Munjiza 2004, sections 3.8, 3.10 and 3.11; Munjiza and Andrews 1998,
//! doi:10.1002/(SICI)1097-0207(19980915)43:1<131::AID-NME447>3.0.CO;2-S).
//!
//! Steps in 2D:
//! 1. Every particle is put on the y-list of its row.
//! 2. A loop over particles finds each non-empty row once: a *new* list, marked *old* when found.
//!    From there it continues upwards while rows are new and not empty.
//! 3. The particles of this row and of the row below are put on two sets of x-lists: one list per
//!    cell.
//! 4. A loop over the row's particles finds each of its cells once and checks it against itself and
//!    the contact mask: the cell to the left and the three cells below.
//! 5. All lists are emptied by walking over *particles*. The code has no loop over cells.
//!
//! In 3D every particle is first put on the z-list of its layer. The particles of a layer and of
//! the layer below are put on two sets of y-lists, one list per row. A row's particles go on
//! x-lists; those of its four neighbouring rows (one behind in the layer, three in the layer below)
//! go together on the second set of x-lists. So the cell to the left and the three merged lists
//! left, here and right are the 13 cells of the contact mask.
//!
//! * Cost: proportional to N, independent of the packing density. Each particle is pushed at most 3
//!   times in 2D (1 y-list, 2 x-lists) and 8 times in 3D (1 z-list, 2 y-lists, 5 x-lists).
//! * Memory: `4(ny + 2nx + 2N)` bytes in 2D (book, equation 3.65), `4(nz + 2ny + 2nx + 3N)` in 3D
//!   (3.80), for N particles and nx, ny, nz cells per axis, two empty border cells included.
//!   Integerised coordinates are not stored but computed where they are needed.
//! * Refuses scenes whose lists exceed the memory limit, and more than 2^31 - 1 particles.
//! * Deviations from the book: cells are wider by 4 parts in a million
//!   ([`contactbench_ground::filter::cells`]); the highest bit marks old heads instead of an added
//!   N; particles count from 0; the links of one particle are adjacent instead of in arrays X and
//!   Y; removal computes integerised coordinates again, which the book keeps. The book takes a row
//!   where the loop over particles finds it; this code continues with the row above, whose row
//!   below is then still in the caches. In 3D layers and rows are both taken upwards in this way.

use super::list::{EMPTY, Heads, Links};
use contactbench_ground::contact::Particles;
use contactbench_ground::detect::numbered;
use contactbench_ground::detect::{Declare, Detector, Options, within};
use contactbench_ground::filter::Cells;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::Sink;
use contactbench_ground::probe::event::{Event, Part};
use contactbench_ground::probe::{Probe, Silent};
use contactbench_ground::scene::Real;

/// Munjiza-NBS for discs (`D` = 2) or spheres (`D` = 3).
pub struct Nbs<const D: usize> {
    options: Options,
    /// Heads of the lists along the last axis: rows in 2D (the book's B), layers in 3D (C).
    last: Heads,
    /// In 3D, heads of the y-lists (the book's B): for the central layer and for the layer below.
    rows: [Heads; 2],
    /// Heads of the x-lists (the book's A): for the central row, and for its neighbouring rows.
    cells: [Heads; 2],
    /// Links of the lists along each axis, last first: the book's Y and X in 2D; Z, Y and X in 3D.
    links: Links<D>,
    formula: u64,
}

impl<const D: usize> Declare for Nbs<D> {
    fn with(options: Options) -> Nbs<D> {
        let (last, cells) = (Heads::named('B'), [Heads::named('A'), Heads::named('a')]);
        let (rows, links) = Default::default();
        Nbs { options, last, rows, cells, links, formula: 0 }
    }

    fn formula_bytes(&self) -> u64 {
        self.formula
    }
}

impl<T: Real, const D: usize> Detector<T, D> for Nbs<D> {
    fn detect<B: Particles<T, D>, P: Probe, S: Sink>(
        &mut self,
        particles: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        let cells = Cells::new(&particles)?;
        self.prepare(&cells, particles.len())?;
        let (n, axis) = (particles.len() as u32, D - 1);
        probe.note(|| Event::Begin(Part::Rows));
        self.push(&particles, &cells, probe);
        for k in 0..n {
            probe.note(|| Event::Visit { particle: k });
            let mut at = cells.index(particles.position(k)[axis], axis, probe);
            while let Some(first) = self.last.take_new(at, probe) {
                probe.note(|| Event::Begin(Part::CentralRow { row: at }));
                let below = self.last.first(at - 1, probe);
                match D {
                    2 => {
                        let next = [self.last.ahead(at + 1), EMPTY];
                        self.row(&particles, &cells, at, first, [below], next, probe, sink);
                    }
                    _ => self.layer(&particles, &cells, first, below, probe, sink),
                }
                at += 1;
            }
        }
        probe.note(|| Event::Begin(Part::RemoveRows));
        for k in 0..n {
            self.last.reset(cells.index(particles.position(k)[axis], axis, probe), probe);
        }
        Ok(())
    }
}

impl<const D: usize> Nbs<D> {
    fn prepare(&mut self, cells: &Cells<D>, n: usize) -> Result<(), Refusal> {
        numbered("nbs", n)?;
        // The last axis has one set of lists, each other axis has two.
        let twice: u64 = cells.count[..D - 1].iter().map(|&count| 2 * u64::from(count)).sum();
        let needed = 4 * (u64::from(cells.count[D - 1]) + twice + (D * n) as u64);
        within(&self.options, "nbs", needed, || {
            let counts = cells.count.map(|count| count.to_string());
            format!("{n} particles, {} cells", counts.join(" x "))
        })?;
        self.formula = needed;
        self.last.prepare(cells.count[D - 1] as usize);
        self.links.prepare(n);
        if D > 2 {
            self.rows.iter_mut().for_each(|heads| heads.prepare(cells.count[1] as usize));
        }
        self.cells.iter_mut().for_each(|heads| heads.prepare(cells.count[0] as usize));
        Ok(())
    }

    fn push<T: Real, P: Probe>(
        &mut self,
        particles: &impl Particles<T, D>,
        cells: &Cells<D>,
        probe: &mut P,
    ) {
        for k in 0..particles.len() as u32 {
            let at = cells.index(particles.position(k)[D - 1], D - 1, probe);
            self.last.push(at, k, &mut self.links, 0, probe);
        }
    }

    fn layer<T: Real, P: Probe, S: Sink>(
        &mut self,
        particles: &impl Particles<T, D>,
        cells: &Cells<D>,
        first: u32,
        below: u32,
        probe: &mut P,
        sink: &mut S,
    ) {
        let row_of = |k: u32, probe: &mut P| cells.index(particles.position(k)[1], 1, probe);
        each(&mut self.links, 0, [first, below], probe, |layer, k, links, probe| {
            self.rows[layer].push(row_of(k, probe), k, links, 1, probe)
        });
        let mut k = first;
        while k != EMPTY {
            let mut row = row_of(k, probe);
            while let Some(first) = self.rows[0].take_new(row, probe) {
                let neighbours = [
                    self.rows[0].first(row - 1, probe),
                    self.rows[1].first(row - 1, probe),
                    self.rows[1].first(row, probe),
                    self.rows[1].first(row + 1, probe),
                ];
                let next = [self.rows[0].ahead(row + 1), self.rows[1].ahead(row + 2)];
                self.row(particles, cells, row, first, neighbours, next, probe, sink);
                row += 1;
            }
            k = self.links.next(k, 0, probe);
        }
        each(&mut self.links, 0, [first, below], probe, |layer, k, _, probe| {
            self.rows[layer].reset(row_of(k, probe), probe)
        });
    }

    #[expect(clippy::too_many_arguments, reason = "what a row is, and what goes through all rows")]
    fn row<T: Real, P: Probe, S: Sink, const N: usize>(
        &mut self,
        particles: &impl Particles<T, D>,
        cells: &Cells<D>,
        row: u32,
        first: u32,
        neighbours: [u32; N],
        mut next: [u32; 2],
        probe: &mut P,
        sink: &mut S,
    ) {
        let column_of = |k: u32, probe: &mut P| cells.index(particles.position(k)[0], 0, probe);
        let (links, of_rows, of_cells) = (&mut self.links, D - 2, D - 1);
        let [central, around] = &mut self.cells;
        each(links, of_rows, [first], probe, |_, k, links, probe| {
            central.push(column_of(k, probe), k, links, of_cells, probe)
        });
        for first in neighbours {
            each(links, of_rows, [first], probe, |_, k, links, probe| {
                // Lists of the next row are walked meanwhile, so that memory sends them early.
                for k in next.iter_mut().filter(|k| **k != EMPTY) {
                    particles.prefetch(*k);
                    *k = links.next(*k, of_rows, &mut Silent);
                }
                around.push(column_of(k, probe), k, links, of_cells, probe)
            });
        }
        probe.note(|| Event::Begin(Part::Columns));
        let mut k = first;
        while k != EMPTY {
            probe.note(|| Event::Visit { particle: k });
            let column = column_of(k, probe);
            if let Some(first) = central.take_new(column, probe) {
                probe.note(|| Event::Central { cell: [column, row] });
                let mask = [
                    central.first(column - 1, probe),
                    around.first(column - 1, probe),
                    around.first(column, probe),
                    around.first(column + 1, probe),
                ];
                links.check(of_cells, particles, first, mask, probe, sink);
            }
            k = links.next(k, of_rows, probe);
        }
        probe.note(|| Event::Begin(Part::RemoveColumns));
        each(links, of_rows, [first], probe, |_, k, _, probe| {
            central.reset(column_of(k, probe), probe)
        });
        for first in neighbours {
            each(links, of_rows, [first], probe, |_, k, _, probe| {
                around.reset(column_of(k, probe), probe)
            });
        }
    }
}

/// Walks several lists, one particle of each in turn: a walk waits for memory at each particle, and
/// these waits overlap.
#[inline(always)]
fn each<P: Probe, const D: usize, const N: usize>(
    links: &mut Links<D>,
    kind: usize,
    mut lists: [u32; N],
    probe: &mut P,
    mut then: impl FnMut(usize, u32, &mut Links<D>, &mut P),
) {
    while lists.iter().any(|&k| k != EMPTY) {
        for (list, k) in lists.iter_mut().enumerate().filter(|(_, k)| **k != EMPTY) {
            then(list, *k, links, probe);
            *k = links.next(*k, kind, probe);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::golden::{InCells, TEN, printed};
    use super::super::list::as_printed;
    use super::*;
    use contactbench_ground::probe::{Op, Tally};

    fn found<const D: usize>(scene: InCells<'_, D>) -> (Tally, Vec<[u32; 2]>) {
        let (mut tally, mut pairs) = (Tally::default(), Vec::new());
        let mut nbs = Nbs::with(Options::default());
        nbs.detect(scene, &mut tally, &mut pairs).unwrap();
        let all = [&nbs.last].into_iter().chain(&nbs.rows).chain(&nbs.cells);
        assert!(all.flat_map(Heads::raw).all(|&head| head == EMPTY));
        (tally, pairs)
    }

    /// Example G5: the book's ten particles (pages 103 to 110).
    #[test]
    fn the_books_ten_particles() {
        let scene = InCells(&TEN);
        let cells = scene.grid();
        let mut nbs = Nbs::with(Options::default());
        nbs.prepare(&cells, TEN.len()).unwrap();
        nbs.push(&scene, &cells, &mut Silent);
        assert_eq!(as_printed(&nbs.last.raw()[1..=10]), [-1, -1, -1, -1, 5, 9, 10, 2, -1, -1]);
        assert_eq!(as_printed(&nbs.links.raw(0)), [-1, -1, -1, 1, -1, 3, 4, 6, 8, 7]);
        let row = nbs.last.take_new(7u32, &mut Silent).unwrap();
        assert_eq!(nbs.last.take_new(7u32, &mut Silent), None);
        each(&mut nbs.links, 0, [row], &mut Silent, |_, k, links, probe| {
            let column = cells.index(scene.position(k)[0], 0, probe);
            nbs.cells[0].push(column, k, links, 1, probe)
        });
        assert_eq!(as_printed(&nbs.cells[0].raw()[1..=10]), [-1, -1, 7, 1, 4, -1, -1, -1, -1, -1]);
        assert_eq!(as_printed(&nbs.links.raw(1)), [10, -1, -1, -1, -1, -1, -1, -1, -1, -1]);
    }

    #[test]
    fn the_mask_pairs_of_ten_particles() {
        // The book's twenty pairs, without particle 9, whose column the book does not print.
        let (tally, pairs) = found(InCells(&TEN));
        assert_eq!(
            printed(&pairs, &[9]),
            "1-2 1-3 1-4 1-6 1-7 1-10 2-4 2-10 3-4 3-5 3-6 3-7 3-10 4-6 4-8 4-10 5-6 6-8 6-10 7-10"
        );
        assert_eq!(tally.get(Op::ContactTest), pairs.len() as u64);
    }

    /// Example G6 of the book: nine particles in layers 7 8 6 7 5 6 7 6 6 (page 122).
    #[test]
    fn the_books_nine_particles() {
        let places = [7, 8, 6, 7, 5, 6, 7, 6, 6].map(|z| [1, 1, z]);
        let scene = InCells(&places);
        let cells = scene.grid();
        let mut nbs = Nbs::with(Options::default());
        nbs.prepare(&cells, places.len()).unwrap();
        nbs.push(&scene, &cells, &mut Silent);
        assert_eq!(as_printed(&nbs.last.raw()[1..=10]), [-1, -1, -1, -1, 5, 9, 7, 2, -1, -1]);
        assert_eq!(as_printed(&nbs.links.raw(0)), [-1, -1, -1, 1, -1, 3, 4, 6, 8]);
        found(scene);
    }
}
