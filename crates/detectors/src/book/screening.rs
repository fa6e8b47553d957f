//! `screening`: a list head for every cell of the domain (Munjiza 2004, section 3.6).
//!
//! 1. When the screening array `C[nx][ny]([nz])` is made, all its heads are set to empty, once.
//! 2. Every particle is put on the list of its cell: `E[k] = C[cell]; C[cell] = k`.
//! 3. A loop over particles finds each non-empty cell once (a *new* list, marked *old* when found)
//!    and checks it against itself and the contact mask: 4 cells in 2D, 13 in 3D.
//! 4. A second loop over *particles* sets C and E back to empty.
//!
//! * Cost: proportional to N. Memory: `4(nx·ny[·nz] + N)` bytes for N particles and nx, ny, nz
//!   cells per axis, two empty border cells included. Nothing is cached.
//! * Suits dense packings only, because the array grows with the volume of the domain. Refuses
//!   scenes over the memory limit, and more than 2^31 - 1 particles.
//! * Deviations from the book: cells are wider by 4 parts in a million
//!   ([`contactbench_ground::filter::cells`]); the highest bit marks old heads instead of an added
//!   N; particles count from 0; C and E are set back after the search, where the book does it
//!   before the next mapping (3.36, 3.37). The array is kept between detections and replaced if the
//!   domain needs a larger one.

use super::list::{Heads, Links};
use super::mask;
use contactbench_ground::contact::Particles;
use contactbench_ground::detect::numbered;
use contactbench_ground::detect::{Declare, Detector, Options, within};
use contactbench_ground::filter::Cells;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::Sink;
use contactbench_ground::probe::Probe;
use contactbench_ground::probe::event::{Event, Part};
use contactbench_ground::scene::Real;

/// The `screening` detector. Its fields have the book's names.
pub struct Screening {
    options: Options,
    /// The book's array C: the head of each cell's list.
    c: Heads,
    /// The book's array E: the link of each particle.
    e: Links<1>,
    formula: u64,
}

impl Declare for Screening {
    fn with(options: Options) -> Screening {
        Screening { options, c: Heads::named('C'), e: Links::default(), formula: 0 }
    }

    fn formula_bytes(&self) -> u64 {
        self.formula
    }
}

mask::detects_by_mask!(Screening, 2, PLANE);
mask::detects_by_mask!(Screening, 3, SPACE);

impl Screening {
    // Inlined into a large caller, the loop over candidates would load values from the stack.
    #[inline(never)]
    fn run<T: Real, const D: usize, const M: usize>(
        &mut self,
        particles: &impl Particles<T, D>,
        mask: [[i32; D]; M],
        probe: &mut impl Probe,
        sink: &mut impl Sink,
    ) -> Result<(), Refusal> {
        let cells = &Cells::new(particles)?;
        self.prepare(cells, particles.len())?;
        let n = particles.len() as u32;
        // Offsets in the array from a central cell to its mask cells.
        let offsets = mask.map(|cell| {
            (0..D)
                .rev()
                .fold(0, |place, axis| place * cells.count[axis] as isize + cell[axis] as isize)
        });
        probe.note(|| Event::Begin(Part::Cells));
        self.push(particles, cells, probe);
        probe.note(|| Event::Begin(Part::Search));
        for k in 0..n {
            probe.note(|| Event::Visit { particle: k });
            let cell = cells.place(particles.position(k), probe);
            if let Some(central) = self.c.take_new(cell, probe) {
                probe.note(|| Event::Central { cell: cells.of_place(cell) });
                let heads =
                    offsets.map(|offset| self.c.first(cell.wrapping_add_signed(offset), probe));
                self.e.check(0, particles, central, heads, probe, sink);
            }
        }
        probe.note(|| Event::Begin(Part::RemoveCells));
        for k in 0..n {
            self.c.reset(cells.place(particles.position(k), probe), probe);
            self.e.reset(k, 0, probe);
        }
        Ok(())
    }

    fn prepare<const D: usize>(&mut self, cells: &Cells<D>, n: usize) -> Result<(), Refusal> {
        numbered("screening", n)?;
        let needed = cells.volume().saturating_add(n as u64).saturating_mul(4);
        within(&self.options, "screening", needed, || {
            let counts = cells.count.map(|count| count.to_string());
            format!("{n} particles, {} cells", counts.join(" x "))
        })?;
        self.formula = needed;
        self.c.prepare(cells.volume() as usize);
        self.e.prepare(n);
        Ok(())
    }

    fn push<T: Real, const D: usize>(
        &mut self,
        particles: &impl Particles<T, D>,
        cells: &Cells<D>,
        probe: &mut impl Probe,
    ) {
        for k in 0..particles.len() as u32 {
            self.c.push(cells.place(particles.position(k), probe), k, &mut self.e, 0, probe);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::golden::{InCells, NINE, printed};
    use super::super::list::{EMPTY, as_printed};
    use super::*;
    use contactbench_ground::probe::Silent;

    /// Example G2 of the book: nine particles in 10 x 10 cells (pages 90 and 91).
    #[test]
    fn the_books_nine_particles() {
        let scene = InCells(&NINE);
        let cells = scene.grid();
        let mut screening = Screening::with(Options::default());
        screening.prepare(&cells, NINE.len()).unwrap();
        screening.push(&scene, &cells, &mut Silent);
        let nx = cells.count[0] as usize;
        for (at, &head) in screening.c.raw().iter().enumerate() {
            let expected = match (at % nx, at / nx) {
                (2, 7) => 9,
                (5, 6) => 6,
                (5, 7) => 4,
                (6, 6) => 8,
                _ => -1,
            };
            assert_eq!(as_printed(&[head]), [expected]);
        }
        assert_eq!(as_printed(&screening.e.raw(0)), [-1, 1, -1, 2, 3, -1, 5, -1, 7]);
    }

    #[test]
    fn the_mask_pairs_of_nine_particles() {
        let mut screening = Screening::with(Options::default());
        let mut pairs = Vec::new();
        screening.detect(InCells(&NINE), &mut Silent, &mut pairs).unwrap();
        assert_eq!(
            printed(&pairs, &[]),
            "1-2 1-4 1-6 1-8 2-4 2-6 2-8 3-5 3-7 3-9 4-6 4-8 5-7 5-9 6-8 7-9"
        );
        assert!(screening.c.raw().iter().chain(&screening.e.raw(0)).all(|&link| link == EMPTY));
    }
}
