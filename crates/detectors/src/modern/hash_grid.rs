//! `hash-grid`: copies sorted by a hash of their cell (Teschner et al. 2003, "Optimized Spatial
//! Hashing for Collision Detection of Deformable Objects"; compact, as in Ihmsen et al. 2011, "A
//! Parallel SPH Implementation on Multi-Core CPUs").
//!
//! 1. Cells are grouped in bricks: 32 by 16 in 2D, 16 by 8 by 8 in 3D. A brick hashes to a first
//!    bucket; its cells, row by row along x, use that bucket and the following ones. So
//!    neighbouring cells of a row are one range of buckets and of copies, and neighbouring rows are
//!    near. Buckets of different bricks may overlap.
//! 2. A counting sort by bucket: count the particles of each, compute where each begins, and copy
//!    every particle to its place.
//! 3. Every particle is tested against the rest of its cell, the cell to the right, and three cells
//!    in each of half of the neighbouring rows: one range per brick. For a near particle the cell
//!    itself is compared, because several cells may share a bucket.
//!
//! * Cost: proportional to N particles, whatever the domain. Particles of other cells may be in the
//!   same buckets and are compared in vain: on average at most one for every cell visited.
//! * Memory: `4(B + 513) + 24N` bytes in 2D, `4(B + 1025) + 32N` in 3D, where B is the smallest
//!   power of two of at least N.
//! * Refuses domains of 2^31 or more cells along an axis, and scenes over the memory limit.
//! * Deviations from the sources: cells are wider by 4 parts in a million
//!   ([`contactbench_ground::filter::cells`]); bricks instead of cells are hashed, so that
//!   neighbours in space are mostly adjacent in memory, which the sources achieve by a sort along a
//!   space-filling curve; no pair is found twice, so duplicates need no removal.

use contactbench_ground::contact::Particles;
use contactbench_ground::detect::copies::{
    Each, Judge, Nearness, One, PairBuffer, Record, STRIDE, room,
};
use contactbench_ground::detect::rows::{mixed, rows_after};
use contactbench_ground::detect::{Declare, Detector, Options, within};
use contactbench_ground::filter::Cells;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::Sink;
use contactbench_ground::probe::{Op, Probe};
use contactbench_ground::scene::Real;
use contactbench_ground::wide::fill;

/// The hash grid, in `D` dimensions.
pub struct HashGrid<const D: usize> {
    options: Options,
    /// Index of each bucket's first record, then the end of the last bucket's records.
    starts: Vec<u32>,
    records: Vec<Record<D>>,
}

/// Returns the edges of a brick in cells: powers of two, x first.
const fn brick<const D: usize>() -> [u32; D] {
    let mut edges = [0; D];
    let of = if D == 2 { [32, 16, 1] } else { [16, 8, 8] };
    edges.copy_from_slice(of.split_at(D).0);
    edges
}

impl<const D: usize> Declare for HashGrid<D> {
    const DECIDES_FROM_COPIES: bool = true;

    fn with(options: Options) -> HashGrid<D> {
        HashGrid { options, starts: Vec::new(), records: Vec::new() }
    }

    fn formula_bytes(&self) -> u64 {
        4 * self.starts.len() as u64 + Record::<D>::BYTES * self.records.len() as u64
    }
}

impl<T: Real, const D: usize> Detector<T, D> for HashGrid<D> {
    fn detect<B: Particles<T, D>, P: Probe, S: Sink>(
        &mut self,
        particles: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        let cells = Cells::new(&particles)?;
        let n = particles.len();
        let buckets = Buckets::new(n);
        let needed = 4 * (buckets.count::<D>() + 1) + Record::<D>::BYTES * n as u64;
        within(&self.options, "hash-grid", needed, || format!("{n} particles"))?;
        self.starts.clear();
        room(&mut self.starts, buckets.count::<D>() as usize + 1, 0);
        room(&mut self.records, n, Record::NONE);
        self.sort(&particles, &cells, buckets, probe);
        let (slack, touch) =
            (particles.slack(), |i, j, probe: &mut P| particles.touch(i, j, probe));
        match particles.uniform() {
            Some(radius) => {
                let judge = Judge::new(&touch, One::new(radius, slack));
                self.search(judge, &cells, buckets, probe, sink);
            }
            None => {
                let judge = Judge::new(&touch, Each::new(slack));
                self.search(judge, &cells, buckets, probe, sink);
            }
        }
        Ok(())
    }
}

#[derive(Clone, Copy)]
struct Buckets {
    /// The first bucket of a brick is below 2^bits.
    bits: u32,
}

impl Buckets {
    fn new(n: usize) -> Buckets {
        Buckets { bits: n.max(1).next_power_of_two().trailing_zeros() }
    }

    fn count<const D: usize>(self) -> u64 {
        (1 << self.bits) + u64::from(brick::<D>().iter().product::<u32>())
    }

    #[inline(always)]
    fn bucket<const D: usize>(self, cell: [u32; D]) -> usize {
        let edges = const { brick::<D>() };
        let (mut brick, mut within) = (cell, 0);
        for k in (0..D).rev() {
            brick[k] /= edges[k];
            within = within * edges[k] + cell[k] % edges[k];
        }
        // The highest `bits` bits; two shifts, because `bits` = 0 would need a shift by 64.
        (mixed(brick) >> 1 >> (63 - self.bits)) as usize + within as usize
    }
}

/// Neighbouring cells in a row of a brick, and a range of records with all their particles.
#[derive(Clone, Copy)]
struct Range<const D: usize> {
    records: [u32; 2],
    first: [u32; D],
    last: u32,
}

impl<const D: usize> Range<D> {
    #[inline(always)]
    fn holds(&self, cell: [u32; D]) -> bool {
        cell[1..] == self.first[1..] && (self.first[0]..=self.last).contains(&cell[0])
    }
}

/// Ranges of candidates: a row, and each neighbouring row, lies in at most two bricks.
struct Ranges<const D: usize> {
    ranges: [Range<D>; 10],
    count: usize,
}

impl<const D: usize> HashGrid<D> {
    fn sort<T: Real>(
        &mut self,
        particles: &impl Particles<T, D>,
        cells: &Cells<D>,
        buckets: Buckets,
        probe: &mut impl Probe,
    ) {
        let n = particles.len() as u32;
        for id in 0..n {
            self.starts[buckets.bucket(cell(particles.position(id), cells, probe))] += 1;
        }
        let mut end = 0;
        for start in &mut self.starts {
            end += *start;
            *start = end;
        }
        // Each bucket is filled from its end backwards, so that its particles stay in order.
        for id in (0..n).rev() {
            let record = Record::new(particles, id);
            let start = &mut self.starts[buckets.bucket(cell(record.position, cells, probe))];
            *start -= 1;
            probe.count(Op::Move);
            self.records[*start as usize] = record;
        }
    }

    fn search<P: Probe>(
        &self,
        judge: Judge<'_, P, impl Nearness>,
        cells: &Cells<D>,
        buckets: Buckets,
        probe: &mut P,
        sink: &mut impl Sink,
    ) {
        let mut found = PairBuffer::none();
        let mut ranges =
            Ranges { ranges: [Range { records: [0; 2], first: [0; D], last: 0 }; 10], count: 0 };
        let mut central = [0; D];
        for (i, a) in self.records.iter().enumerate() {
            let here = cell(a.position, cells, probe);
            if here != central {
                central = here;
                self.around(central, buckets, &mut ranges, probe);
            }
            let wanted = |k: u32, b: &Record<D>, probe: &mut P| {
                probe.count(Op::KeyCompare);
                ranges.ranges[k as usize].holds(cell(b.position, cells, probe))
            };
            let settle = |found: &mut PairBuffer, start: usize, probe: &mut P| {
                found.settle(start, |[k, place]| {
                    let b = &self.records[place as usize];
                    wanted(k, b, probe).then_some([a.id, b.id])
                });
            };
            let mut start = found.count();
            for (k, range) in (0..).zip(&ranges.ranges[..ranges.count]) {
                // In the first range, only records after `a` remain.
                let mut place = if k == 0 { i as u32 + 1 } else { range.records[0] };
                for others in self.records[place as usize..range.records[1] as usize].chunks(STRIDE)
                {
                    if !found.has_room() {
                        settle(&mut found, start, probe);
                        found.flush(sink);
                        start = 0;
                    }
                    judge.stride(
                        a,
                        others,
                        |at, _| [k, place + at as u32],
                        |b, probe| wanted(k, b, probe),
                        &mut found,
                        probe,
                    );
                    place = place.wrapping_add(STRIDE as u32);
                }
            }
            settle(&mut found, start, probe);
        }
        found.flush(sink);
    }

    #[inline(always)]
    fn around(
        &self,
        central: [u32; D],
        buckets: Buckets,
        ranges: &mut Ranges<D>,
        probe: &mut impl Probe,
    ) {
        ranges.count = 0;
        let x = central[0];
        self.bricks(central, x + 1, buckets, ranges, probe);
        for step in rows_after::<D>() {
            let mut first = central;
            first[0] = x - 1;
            for k in 1..D {
                first[k] = central[k].wrapping_add_signed(step[k - 1]);
            }
            self.bricks(first, x + 1, buckets, ranges, probe);
        }
    }

    #[inline(always)]
    fn bricks(
        &self,
        mut first: [u32; D],
        last: u32,
        buckets: Buckets,
        ranges: &mut Ranges<D>,
        probe: &mut impl Probe,
    ) {
        while first[0] <= last {
            probe.count(Op::CellProbe);
            let to = last.min(first[0] | (brick::<D>()[0] - 1));
            let bucket = buckets.bucket(first);
            let records = [self.starts[bucket], self.starts[bucket + (to - first[0]) as usize + 1]];
            ranges.ranges[ranges.count] = Range { records, first, last: to };
            ranges.count += 1;
            first[0] = to + 1;
        }
    }
}

#[inline(always)]
fn cell<const D: usize>(position: [f64; D], cells: &Cells<D>, probe: &mut impl Probe) -> [u32; D] {
    fill(|k| cells.index(position[k], k, probe))
}
