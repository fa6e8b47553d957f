//! `sorting`: sorting and binary search (Munjiza 2004, section 3.7).
//!
//! 1. Arrays X, Y (and Z) are filled with integerised coordinates, array D with particle numbers.
//! 2. They are sorted together in place, by X, then Y, then Z. The book's sort halves the range of
//!    *values*: two pointers move in from the ends, values below mid = (min + max) / 2 go left, the
//!    others right, and both sides are sorted in the same way.
//! 3. The particles of a cell are now adjacent. For every non-empty cell the mask cells (4 in 2D,
//!    13 in 3D) are found by binary search, in about log2 N steps each, and checked.
//!
//! * Cost: N log2 N for N particles in a dense packing. The sort makes at most log2 n passes over
//!   the particles for each axis with n cells, so a sparse domain costs more. A key comparison
//!   compares one integer in the sort and all D integers in a search. A step along the particles of
//!   a cell is a list step.
//! * Memory: `4N(D + 1)` bytes in D dimensions, the least of all. Nothing is cached.
//! * Refuses domains of 2^31 or more cells along an axis, and scenes over the memory limit.
//! * Deviations from the book: cells are wider by 4 parts in a million
//!   ([`contactbench_ground::filter::cells`]); the mask cells are searched once per occupied cell,
//!   not once per particle; min and max of a part are bounds of its values, not extremes; if (min +
//!   max) / 2 is min, mid is max, because otherwise the partition would not end. A search keeps the
//!   halves of figures 3.25 to 3.27.

use super::mask;
use contactbench_ground::contact::Particles;
use contactbench_ground::detect::{Declare, Detector, Options, within};
use contactbench_ground::filter::Cells;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::Sink;
use contactbench_ground::probe::event::{Event, Part, plane};
use contactbench_ground::probe::{Op, Probe};
use contactbench_ground::scene::Real;
use contactbench_ground::wide::fill;

/// The `sorting` detector, in `D` dimensions.
pub struct Sorting<const D: usize> {
    options: Options,
    /// The book's arrays X, Y (and Z): integerised coordinates of the particles.
    keys: [Vec<u32>; D],
    /// The book's array D: particle numbers.
    particles: Vec<u32>,
}

impl<const D: usize> Declare for Sorting<D> {
    fn with(options: Options) -> Sorting<D> {
        Sorting { options, keys: std::array::from_fn(|_| Vec::new()), particles: Vec::new() }
    }

    fn formula_bytes(&self) -> u64 {
        bytes::<D>(self.particles.len())
    }
}

fn bytes<const D: usize>(n: usize) -> u64 {
    4 * (D as u64 + 1) * n as u64
}

mask::detects_by_mask!(Sorting<2>, 2, PLANE);
mask::detects_by_mask!(Sorting<3>, 3, SPACE);

impl<const D: usize> Sorting<D> {
    fn run<T: Real, const M: usize>(
        &mut self,
        particles: &impl Particles<T, D>,
        mask: [[i32; D]; M],
        probe: &mut impl Probe,
        sink: &mut impl Sink,
    ) -> Result<(), Refusal> {
        let cells = Cells::new(particles)?;
        let n = particles.len();
        within(&self.options, "sorting", bytes::<D>(n), || format!("{n} particles"))?;
        probe.note(|| Event::Begin(Part::Fill));
        self.fill(particles, &cells, probe);
        probe.note(|| Event::Begin(Part::Sort));
        self.sort(0, 0..n, 0, cells.count[0] - 1, &cells, probe);
        probe.note(|| Event::Begin(Part::Search));
        let mut start = 0;
        while start < n {
            let central = self.cell(start);
            let end = self.end_of(start, central, probe);
            probe.note(|| Event::Central { cell: plane(central) });
            probe.note(|| Event::Found { cell: plane(central), places: [start, end] });
            for a in start..end {
                self.check(particles, a, a + 1..end, probe, sink);
            }
            for offset in mask {
                let cell = mask::neighbour(central, offset);
                let first = self.search(cell, probe);
                let last = self.end_of(first, cell, probe);
                probe.note(|| Event::Found { cell: plane(cell), places: [first, last] });
                for a in start..end {
                    self.check(particles, a, first..last, probe, sink);
                }
            }
            start = end;
        }
        Ok(())
    }

    fn fill<T: Real>(
        &mut self,
        particles: &impl Particles<T, D>,
        cells: &Cells<D>,
        probe: &mut impl Probe,
    ) {
        let n = particles.len();
        self.particles.clear();
        contactbench_ground::limits::refusal::must_reserve(&mut self.particles, n);
        self.particles.extend(0..n as u32);
        for (axis, keys) in self.keys.iter_mut().enumerate() {
            keys.clear();
            contactbench_ground::limits::refusal::must_reserve(keys, n);
            keys.extend((0..n as u32).map(|i| {
                let key = cells.index(particles.position(i)[axis], axis, probe);
                probe.note(|| Event::Key { axis, particle: i, key });
                key
            }));
        }
    }

    /// Sorts a range in which all keys of earlier axes are equal and those of `axis` lie in
    /// `min..=max`.
    fn sort(
        &mut self,
        axis: usize,
        range: std::ops::Range<usize>,
        min: u32,
        max: u32,
        cells: &Cells<D>,
        probe: &mut impl Probe,
    ) {
        if range.len() < 2 {
        } else if min == max {
            if axis + 1 < D {
                self.sort(axis + 1, range, 0, cells.count[axis + 1] - 1, cells, probe);
            }
        } else {
            let mid = (min + (max - min) / 2).max(min + 1);
            probe.note(|| Event::Halve {
                axis,
                places: [range.start, range.end],
                values: [min, max],
                mid,
            });
            let middle = self.partition(axis, range.clone(), mid, probe);
            probe.note(|| Event::Halved { axis, places: [range.start, range.end], middle });
            self.sort(axis, range.start..middle, min, mid - 1, cells, probe);
            self.sort(axis, middle..range.end, mid, max, cells, probe);
        }
    }

    /// Moves particles with keys below `mid` to the front and returns where the others begin.
    fn partition(
        &mut self,
        axis: usize,
        range: std::ops::Range<usize>,
        mid: u32,
        probe: &mut impl Probe,
    ) -> usize {
        let (mut left, mut right) = (range.start, range.end);
        loop {
            while left < right && self.below(axis, left, mid, probe) {
                left += 1;
            }
            while left < right && !self.below(axis, right - 1, mid, probe) {
                right -= 1;
            }
            if left == right {
                return left;
            }
            right -= 1;
            probe.add(Op::Move, 2);
            probe.note(|| Event::Swap { axis, places: [left, right] });
            // Keys of earlier axes are equal in the whole range and need no swap.
            for keys in &mut self.keys[axis..] {
                keys.swap(left, right);
            }
            self.particles.swap(left, right);
            left += 1;
        }
    }

    #[inline(always)]
    fn below(&self, axis: usize, at: usize, mid: u32, probe: &mut impl Probe) -> bool {
        probe.count(Op::KeyCompare);
        self.keys[axis][at] < mid
    }

    #[inline(always)]
    fn cell(&self, at: usize) -> [u32; D] {
        fill(|k| self.keys[k][at])
    }

    /// Returns the only place at which a run of `cell` can begin. Each step compares the last place
    /// of the lower half, and keeps one half.
    #[inline]
    fn search(&self, cell: [u32; D], probe: &mut impl Probe) -> usize {
        probe.count(Op::CellProbe);
        let (mut low, mut high) = (0, self.particles.len());
        while low + 1 < high {
            let middle = low + (high - low) / 2;
            probe.count(Op::KeyCompare);
            probe.count(Op::SearchStep);
            if self.cell(middle - 1) < cell {
                low = middle;
            } else {
                high = middle;
            }
            probe.note(|| Event::Kept {
                cell: plane(cell),
                compared: middle - 1,
                places: [low, high],
            });
        }
        low
    }

    #[inline(always)]
    fn end_of(&self, start: usize, cell: [u32; D], probe: &mut impl Probe) -> usize {
        let mut end = start;
        while end < self.particles.len() && self.cell(end) == cell {
            probe.count(Op::ListStep);
            end += 1;
        }
        end
    }

    #[inline(always)]
    fn check<T: Real>(
        &self,
        particles: &impl Particles<T, D>,
        a: usize,
        others: std::ops::Range<usize>,
        probe: &mut impl Probe,
        sink: &mut impl Sink,
    ) {
        let i = self.particles[a];
        for &j in &self.particles[others] {
            let touching = particles.touch(i, j, probe);
            probe.note(|| Event::Test { i, j, touching });
            if touching {
                sink.contact(i, j);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::golden::{InCells, printed};
    use super::*;
    use contactbench_ground::probe::{Silent, Tally};

    /// Records which places searches keep, numbered from 1 as in the book.
    #[derive(Default)]
    struct Halves(Vec<[usize; 2]>);

    impl Probe for Halves {
        const SILENT: bool = false;
        fn add(&mut self, _: Op, _: u64) {}
        fn note(&mut self, event: impl FnOnce() -> Event) {
            if let Event::Kept { places: [from, to], .. } = event() {
                self.0.push([from + 1, to]);
            }
        }
    }

    /// Example G3 of the book: eight particles (pages 95 to 98).
    const EIGHT: [[u32; 2]; 8] = [[4, 7], [5, 8], [4, 6], [5, 7], [4, 5], [5, 6], [3, 7], [6, 6]];

    #[test]
    fn the_books_eight_particles() {
        let scene = InCells(&EIGHT);
        let cells = scene.grid();
        let mut sorting = Sorting::<2>::with(Options::default());
        sorting.fill(&scene, &cells, &mut Silent);
        assert_eq!(sorting.keys, [[4, 5, 4, 5, 4, 5, 3, 6], [7, 8, 6, 7, 5, 6, 7, 6]]);
        sorting.sort(0, 0..8, 0, cells.count[0] - 1, &cells, &mut Silent);
        assert_eq!(sorting.keys, [[3, 4, 4, 4, 5, 5, 5, 6], [7, 5, 6, 7, 6, 7, 8, 6]]);
        let ids: Vec<u32> = sorting.particles.iter().map(|k| k + 1).collect();
        assert_eq!(ids, [7, 5, 3, 1, 6, 4, 2, 8]);
        let mut halves = Halves::default();
        assert_eq!(ids[sorting.search([5, 7], &mut halves)], 4);
        assert_eq!(halves.0, [[5, 8], [5, 6], [6, 6]]); // Figures 3.25 to 3.27.
        let mut pairs = Vec::new();
        sorting.detect(scene, &mut Silent, &mut pairs).unwrap();
        assert_eq!(printed(&pairs, &[]), "1-2 1-3 1-4 1-6 1-7 2-4 3-4 3-5 3-6 3-7 4-6 4-8 5-6 6-8");
    }

    /// Example G4 of the book: one step of the partition (pages 99 to 101).
    #[test]
    fn the_books_partition_step() {
        let mut sorting = Sorting::<2>::with(Options::default());
        sorting.keys[0] = vec![3, 16, 7, 11, 2, 14, 5, 9, 4, 8, 12, 6, 13, 15, 1, 10];
        sorting.keys[1] = vec![0; 16];
        sorting.particles = (0..16).collect();
        let mut tally = Tally::default();
        assert_eq!(sorting.partition(0, 0..16, 8, &mut tally), 7);
        assert_eq!(sorting.keys[0], [3, 1, 7, 6, 2, 4, 5, 9, 14, 8, 12, 11, 13, 15, 16, 10]);
        assert_eq!(tally.get(Op::Move), 6);
    }
}
