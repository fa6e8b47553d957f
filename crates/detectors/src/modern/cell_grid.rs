//! `cell-grid`: copies sorted by cell, with the cells of a row adjacent. Cell lists are described
//! by Allen and Tildesley 1987, section 5.3; the counting sort by Green 2008, "CUDA Particles".
//!
//! 1. A counting sort: count the particles of each cell, compute where each cell begins, and copy
//!    every particle to its place. Cells are stored row by row along x, so neighbouring cells of a
//!    row are one range of copies.
//! 2. Every non-empty cell is tested against itself and the cell to the right (one range), and
//!    against half of the neighbouring rows, three cells each: one range in 2D, four in 3D.
//!
//! * Cost: proportional to N particles and to the cells of the domain, which are traversed in order
//!   twice. Each particle is tested against about half of those in 9 cells in 2D and 27 in 3D,
//!   exactly as in [`crate::book::screening`].
//! * Memory: `4(nx·ny[·nz] + 1) + 24N` bytes in 2D, `+ 32N` in 3D, for nx, ny, nz cells per axis,
//!   two empty border cells included.
//! * Refuses domains of 2^31 or more cells along an axis, and scenes over the memory limit: such as
//!   loose packings and scenes with far-away particles.
//! * Threads share the rows of the second step and collect contacts, 8 bytes each, in arrays of at
//!   most twice the length needed, under the same limit.
//! * Deviations from the sources: cells are wider by 4 parts in a million
//!   ([`contactbench_ground::filter::cells`]); the second pass of the sort computes the cells of
//!   particles again.

use std::ops::Range;

use contactbench_ground::contact::Particles;
use contactbench_ground::detect::copies::{Each, Judge, Nearness, One, PairBuffer, Record, room};
use contactbench_ground::detect::rows::{ROWS, rows_after};
use contactbench_ground::detect::{Declare, Detector, Options, within};
use contactbench_ground::filter::Cells;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::Sink;
use contactbench_ground::parallel;
use contactbench_ground::probe::{Op, Probe, Silent};
use contactbench_ground::scene::Real;

/// The cell grid, in `D` dimensions.
pub struct CellGrid<const D: usize> {
    options: Options,
    /// Index of each cell's first record, then the end of the last cell's records.
    starts: Vec<u32>,
    records: Vec<Record<D>>,
    /// Bytes of the contacts that threads have collected.
    collected: u64,
}

impl<const D: usize> Declare for CellGrid<D> {
    const DECIDES_FROM_COPIES: bool = true;

    fn with(options: Options) -> CellGrid<D> {
        CellGrid { options, starts: Vec::new(), records: Vec::new(), collected: 0 }
    }

    fn formula_bytes(&self) -> u64 {
        self.arrays() + self.collected
    }
}

impl<T: Real, const D: usize> Detector<T, D> for CellGrid<D> {
    fn detect<B: Particles<T, D>, P: Probe, S: Sink>(
        &mut self,
        particles: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        let cells = Cells::new(&particles)?;
        self.prepare(&cells, particles.len())?;
        self.sort(&particles, &cells, probe);
        let slack = particles.slack();
        self.collected = match particles.uniform() {
            Some(radius) => self.search(&particles, One::new(radius, slack), &cells, probe, sink),
            None => self.search(&particles, Each::new(slack), &cells, probe, sink),
        }?;
        Ok(())
    }
}

impl<const D: usize> CellGrid<D> {
    fn prepare(&mut self, cells: &Cells<D>, n: usize) -> Result<(), Refusal> {
        let volume = cells.volume();
        let needed = volume
            .saturating_add(1)
            .saturating_mul(4)
            .saturating_add(Record::<D>::BYTES * n as u64);
        within(&self.options, "cell-grid", needed, || {
            format!(
                "{n} particles, {} cells",
                cells.count.map(|count| count.to_string()).join(" x ")
            )
        })?;
        self.starts.clear();
        room(&mut self.starts, volume as usize + 1, 0);
        room(&mut self.records, n, Record::NONE);
        Ok(())
    }

    fn sort<T: Real>(
        &mut self,
        particles: &impl Particles<T, D>,
        cells: &Cells<D>,
        probe: &mut impl Probe,
    ) {
        let n = particles.len() as u32;
        for id in 0..n {
            self.starts[cells.place(particles.position(id), probe)] += 1;
        }
        let mut end = 0;
        for start in &mut self.starts {
            end += *start;
            *start = end;
        }
        // Each cell is filled from its end backwards, so that its particles stay in order.
        for id in (0..n).rev() {
            let record = Record::new(particles, id);
            let start = &mut self.starts[cells.place(record.position, probe)];
            *start -= 1;
            probe.count(Op::Move);
            self.records[*start as usize] = record;
        }
    }

    fn arrays(&self) -> u64 {
        4 * self.starts.len() as u64 + Record::<D>::BYTES * self.records.len() as u64
    }

    fn search<T: Real, P: Probe>(
        &self,
        particles: &impl Particles<T, D>,
        nearness: impl Nearness,
        cells: &Cells<D>,
        probe: &mut P,
        sink: &mut impl Sink,
    ) -> Result<u64, Refusal> {
        let rows = inner(cells, 1) * inner(cells, 2);
        let Options { threads, memory_limit } = self.options;
        if threads > 1 && P::SILENT {
            let touch = |i, j, probe: &mut Silent| particles.touch(i, j, probe);
            let judge = Judge::new(&touch, nearness);
            let (count, left) =
                ((rows, particles.len()), memory_limit.saturating_sub(self.arrays()));
            let found = parallel::contacts(count, threads, left, &|rows, pairs| {
                self.rows(&judge, rows, cells, &mut Silent, pairs)
            })?;
            sink.gather(&found.iter().map(Vec::as_slice).collect::<Vec<_>>());
            Ok(parallel::bytes(&found))
        } else {
            let touch = |i, j, probe: &mut P| particles.touch(i, j, probe);
            self.rows(&Judge::new(&touch, nearness), 0..rows, cells, probe, sink);
            Ok(0)
        }
    }

    fn rows<P: Probe>(
        &self,
        judge: &Judge<'_, P, impl Nearness>,
        rows: Range<usize>,
        cells: &Cells<D>,
        probe: &mut P,
        sink: &mut impl Sink,
    ) {
        let mut found = PairBuffer::none();
        for row in rows {
            let [y, z] = [row % inner(cells, 1) + 1, row / inner(cells, 1) + usize::from(D > 2)];
            let first = (z * cells.count[1] as usize + y) * cells.count[0] as usize + 1;
            self.row(judge, first, cells, &mut found, probe, sink);
        }
        found.flush(sink);
    }

    #[inline(always)]
    fn row<P: Probe>(
        &self,
        judge: &Judge<'_, P, impl Nearness>,
        first: usize,
        cells: &Cells<D>,
        found: &mut PairBuffer,
        probe: &mut P,
        sink: &mut impl Sink,
    ) {
        let nx = cells.count[0] as usize;
        let steps =
            ROWS.map(|[y, z]| (z as isize * cells.count[1] as isize + y as isize) * nx as isize);
        for cell in first..first + nx - 2 {
            probe.count(Op::CellProbe);
            let (start, end) = (self.starts[cell] as usize, self.starts[cell + 1] as usize);
            if start == end {
                continue;
            }
            let next = self.starts[cell + 2] as usize;
            for i in start..end {
                judge.against(&self.records[i], &self.records[i + 1..next], found, probe, sink);
            }
            for &step in &steps[..rows_after::<D>().len()] {
                probe.count(Op::CellProbe);
                let middle = cell.wrapping_add_signed(step);
                let others = &self.records
                    [self.starts[middle - 1] as usize..self.starts[middle + 2] as usize];
                for a in &self.records[start..end] {
                    judge.against(a, others, found, probe, sink);
                }
            }
        }
    }
}

/// Returns the number of cells along an axis without border cells; 1 for the third axis in 2D.
fn inner<const D: usize>(cells: &Cells<D>, axis: usize) -> usize {
    if axis < D { cells.count[axis] as usize - 2 } else { 1 }
}
