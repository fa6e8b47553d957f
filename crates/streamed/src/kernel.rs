//! The sweep: tests every particle of a slab against the few ranges of particles that can touch it
//! ([`super::ranges`]), sixteen at a time.
//!
//! Most ranges hold fewer than eight particles: two such ranges are tested together, 0 with 1 and 2
//! with 3. If a range holds sixteen or more, the particles of the cell share copies of their
//! candidates ([`super::together`]). On registers of fewer than sixteen floats each range is tested
//! alone ([`super::single`]). [`super::bounds`] says which pairs need the contact test.
//!
//! Arrays are read without bounds checks; `unchecked.rs` gives the reasons why this is safe.

use std::mem::MaybeUninit;

use super::bounds::Bounds;
use super::output::{Output, ROOM, Space};
use super::ranges::{Find, Ranges, in_next, lengths, ranges_used};
use super::slab::Slab;
use super::together::{Copies, Together};
use super::unchecked::{Run16, Source, TwoRuns8, chunk, chunk_mut, element};
use contactbench_ground::probe::Op;
use contactbench_ground::wide::{HALF, Kernel, LANES, Level, Register, Wide};

/// 1.5·2^23: adding and subtracting it rounds a small number to the nearest integer.
pub(super) const WHOLE: f32 = 12_582_912.0;
/// Margin in squared steps: with it, an inner limit of zero accepts no pair as certain.
pub(super) const SPARE: f32 = 0.5;

pub(super) struct Query<W: Wide, const D: usize> {
    pub at: [W::Floats; D],
    /// Radius, if radii differ, plus [`Bounds::grow`].
    pub radius: W::Floats,
}

/// Squared distances up to which particles may touch (`near`) and certainly touch (`sure`).
#[derive(Clone, Copy)]
pub(super) struct Limits<W: Wide> {
    near: W::Floats,
    sure: W::Floats,
}

impl<W: Wide> Limits<W> {
    /// Computes the limits from the distance beyond which no pair touches, and from
    /// [`Bounds::grow`].
    #[inline(always)]
    pub fn new(w: W, outer: W::Floats, grow: f32) -> Limits<W> {
        let inner = w.max(w.sub(outer, w.all(2.0 * grow)), w.all(0.0));
        Limits { near: w.mul(outer, outer), sure: w.mul_add(inner, inner, w.all(-SPARE)) }
    }
}

/// Returns masks of the `valid` ones of sixteen particles: which may touch, and which certainly do.
/// For individual radii the limits of each pair replace `limits`.
#[inline(always)]
pub(super) fn test<W: Wide, const D: usize, const EACH: bool>(
    w: W,
    source: impl Source<D>,
    valid: u32,
    query: &Query<W, D>,
    limits: Limits<W>,
    grow: f32,
    turn: Option<f32>,
) -> (u32, u32) {
    let mut square = w.all(0.0);
    for k in 0..D {
        let mut d = w.sub(source.load(w, k), query.at[k]);
        if let (0, Some(turn)) = (k, turn) {
            let whole = w.all(WHOLE);
            let turns = w.sub(w.add(w.mul(d, w.all(1.0 / turn)), whole), whole);
            d = w.sub(d, w.mul(turns, w.all(turn)));
        }
        square = if k == 0 { w.mul(d, d) } else { w.mul_add(d, d, square) };
    }
    let limits =
        if EACH { Limits::new(w, w.add(query.radius, source.load(w, D)), grow) } else { limits };
    let near = w.at_most(square, limits.near) & valid;
    (near, w.at_most(square, limits.sure) & near)
}

/// A sweep of particles `places` of `slab` against their ranges in `slab` and `next`.
pub(super) struct Sweep<'a, F, const D: usize, const EACH: bool> {
    pub slab: &'a Slab<D>,
    pub next: &'a Slab<D>,
    pub places: std::ops::Range<usize>,
    pub find: F,
    pub bounds: Bounds,
    pub work: &'a mut Work,
    pub output: Output<'a>,
}

/// Neighbours of a block of particles, refilled for every block. The alignment is that of cache
/// lines.
#[repr(align(64))]
pub(super) struct Work {
    ids: [u32; ENOUGH + 5 * LANES + KEPT],
    ends: [u32; BLOCK],
    /// Copies of particles that several others are tested against.
    pub candidates: Copies,
}

/// Working space of a thread.
#[repr(align(64))]
pub(super) struct Scratch {
    pub pairs: Space,
    pub work: Work,
}

impl Default for Scratch {
    fn default() -> Scratch {
        let work = Work {
            ids: [0; ENOUGH + 5 * LANES + KEPT],
            ends: [0; BLOCK],
            candidates: Copies::default(),
        };
        Scratch { pairs: [MaybeUninit::uninit(); ROOM], work }
    }
}

/// Maximum number of particles whose neighbours are collected before they are paired.
const BLOCK: usize = 16;
/// Space for a particle's contacts in one vector; particles with more, which are rare, are swept
/// [`Together`].
const KEPT: usize = 8;
/// Number of neighbours after which a block ends.
const ENOUGH: usize = 512;
const _: () = assert!(ENOUGH + 5 * LANES + 2 * KEPT <= ROOM);

struct Tested {
    at: usize,
    /// Nonzero if the contact test must decide a pair.
    odd: u32,
    /// Bitwise or of the numbers of neighbours found in each vector.
    counts: u32,
}

#[derive(Clone, Copy)]
struct Around<'r, W: Wide, const D: usize> {
    place: usize,
    ranges: &'r Ranges,
    shifts: &'r [[W::Floats; D]; 5],
    halves: &'r [[W::Floats; D]; 2],
    limits: Limits<W>,
}

impl<F: Find, const D: usize, const EACH: bool> Kernel for Sweep<'_, F, D, EACH> {
    type Output = ();

    #[inline(always)]
    fn run<W: Wide>(mut self, w: W) {
        if W::Register::LANES < LANES {
            return self.by_range(w.register());
        }
        let limits = self.limits(w);
        let (shifts, halves) = (self.shifts(w), self.half_shifts(w));
        let mut first = self.places.start;
        while first < self.places.end {
            let most = BLOCK.min(self.places.end - first);
            let (mut many, mut kept, mut crowd) = (0, 0, None);
            while many < most && kept <= ENOUGH {
                let place = first + many;
                let ranges = self.find.ranges::<D>(place);
                let longest = lengths(&ranges);
                if longest >= LANES as u32 {
                    crowd = Some(ranges);
                    break;
                }
                let around =
                    Around { place, ranges: &ranges, shifts: &shifts, halves: &halves, limits };
                let found = self.collect(w, around, longest, kept);
                // A vector may find more than eight neighbours, but only eight are kept.
                if found.odd | found.counts & 0x18 == 0 {
                    kept = found.at;
                } else {
                    w.run(Together(&mut self, place..place + 1, &ranges));
                }
                self.work.ends[many] = kept as u32;
                many += 1;
            }
            self.pair(w, first, many, kept);
            first += many;
            if let Some(ranges) = crowd {
                let end = self.alike(first, &ranges);
                w.run(Together(&mut self, first..end, &ranges));
                first = end;
            }
        }
        self.output.hand_on();
    }
}

impl<'a, F: Find, const D: usize, const EACH: bool> Sweep<'a, F, D, EACH> {
    pub fn on(self, level: Level) {
        if self.output.sink.counts() {
            let used = ranges_used::<F, D>();
            let (mut tests, mut end) = (0, self.places.start);
            while end < self.places.end {
                let first = end;
                let ranges = self.find.ranges::<D>(first);
                let long = lengths(&ranges) >= LANES as u32;
                end = if long { self.alike(first, &ranges) } else { first + 1 };
                let images = long && self.are_images(first..end);
                let candidates = (0..used).flat_map(|r| {
                    let (begin, len) = (ranges[r].0 as usize, ranges[r].1 as usize);
                    &self.other(r).ids[begin..begin + len]
                });
                let (all, own) = (candidates.clone().count(), end - first);
                tests += if images {
                    own * candidates.filter(|&&id| id < self.bounds.first_image).count()
                } else {
                    own * all - own * (own - 1) / 2
                };
            }
            self.output.sink.count(Op::CellProbe, (self.places.len() * used) as u64);
            self.output.sink.count(Op::ContactTest, tests as u64);
        }
        level.run(self);
    }

    /// Returns the end of the particles from `place` on that share the candidates of `place`, whose
    /// ranges are given.
    pub fn alike(&self, place: usize, ranges: &Ranges) -> usize {
        let end = |own: (u32, u32)| own.0 + own.1;
        let same = |&at: &usize| {
            let of = self.find.ranges::<D>(at);
            end(of[0]) == end(ranges[0]) && of[1..] == ranges[1..]
        };
        (place + 1..self.places.end).take_while(same).last().map_or(place + 1, |last| last + 1)
    }

    /// Returns whether the particles at these places are images, none of which touches another.
    pub fn are_images(&self, places: std::ops::Range<usize>) -> bool {
        self.slab.ids[places].iter().all(|&id| id >= self.bounds.first_image)
    }

    pub fn other(&self, r: usize) -> &'a Slab<D> {
        if in_next::<F, D>(r) { self.next } else { self.slab }
    }

    /// Returns the offset along y and across layers from the origin of a particle's cell to the
    /// origin of its cells in range `r`.
    pub fn shift(&self, r: usize) -> [f32; D] {
        let one = self.bounds.one;
        let mut shift = [0.0; D];
        if D == 3 && !F::FLAT {
            shift[1] = [0.0, one, -one, 0.0, one][r];
        }
        shift[D - 1] += if in_next::<F, D>(r) { one } else { 0.0 };
        shift
    }

    #[inline(always)]
    fn shifts<W: Wide>(&self, w: W) -> [[W::Floats; D]; 5] {
        let mut all = [[w.all(0.0); D]; 5];
        for (r, all) in all.iter_mut().enumerate() {
            let shift = self.shift(r.min(ranges_used::<F, D>() - 1));
            for k in 0..D {
                all[k] = w.all(shift[k]);
            }
        }
        all
    }

    /// Returns offsets for two ranges tested together: the first range in the lower half of the
    /// lanes, the second in the upper half.
    #[inline(always)]
    fn half_shifts<W: Wide>(&self, w: W) -> [[W::Floats; D]; 2] {
        let half = |r: usize| {
            let last = ranges_used::<F, D>() - 1;
            let (low, high) = (self.shift(r.min(last)), self.shift(last.min(r + 1)));
            std::array::from_fn(|k| w.load_two(&[low[k]; HALF], &[high[k]; HALF]))
        };
        [half(0), half(2)]
    }

    /// Returns the particle at `place`, with coordinates relative to the cells of a range.
    #[inline(always)]
    pub fn query<W: Wide>(&self, w: W, place: usize, shift: &[W::Floats; D]) -> Query<W, D> {
        // SAFETY: `place` is one of `places`, and every lane has a number for each.
        let at = |k: usize| w.all(unsafe { element(&self.slab.lanes[k], place) });
        let radius = if EACH {
            // SAFETY: if particles have individual radii, `radii` has one for each place.
            unsafe { element(&self.slab.radii, place) }
        } else {
            0.0
        };
        // x is relative to the origin of the grid and needs no shift.
        let mut all = [at(0); D];
        for k in 1..D {
            all[k] = w.sub(at(k), shift[k]);
        }
        Query { at: all, radius: w.all(radius + self.bounds.grow) }
    }

    /// Returns the next sixteen particles of range `r`, and a mask of those inside the range.
    #[inline(always)]
    fn range(&self, (at, len): (u32, u32), r: usize) -> (Run16<'a, D>, u32) {
        // SAFETY: a range begins at most at the slab's `len`, and the arrays are a vector longer.
        (unsafe { Run16::new(self.other(r), at as usize) }, !(!0 << len))
    }

    /// Collects the neighbours of a particle behind those `kept` so far.
    #[inline(always)]
    fn collect<W: Wide>(
        &mut self,
        w: W,
        around: Around<W, D>,
        longest: u32,
        kept: usize,
    ) -> Tested {
        let (used, ranges) = (ranges_used::<F, D>(), around.ranges);
        let mut found = Tested { at: kept, odd: 0, counts: 0 };
        // Most ranges are short, so two are tested at a time.
        let short = |r: usize| ranges[r].1 | ranges[r + 1].1 < HALF as u32;
        let mut r = 0;
        if longest < HALF as u32 {
            while r + 1 < used {
                self.keep_two(w, around, r, &mut found);
                r += 2;
            }
        }
        while r < used {
            if r % 2 == 0 && r + 1 < used && short(r) {
                self.keep_two(w, around, r, &mut found);
                r += 2;
            } else {
                self.keep_one(w, around, r, &mut found);
                r += 1;
            }
        }
        found
    }

    /// Pairs `many` particles from `first` on with their `kept` neighbours.
    #[inline(always)]
    fn pair<W: Wide>(&mut self, w: W, first: usize, many: usize, kept: usize) {
        if self.output.found + kept > ROOM - KEPT {
            self.output.hand_on();
        }
        let mut begin = 0;
        for k in 0..many {
            let end = self.work.ends[k] as usize;
            // SAFETY: `first + k` is one of `places`, which are below the slab's `len`.
            let id = unsafe { element(&self.slab.ids, first + k) };
            let mut at = begin;
            loop {
                // SAFETY: `at` is at most `kept`, and at least `KEPT` places follow.
                let ids = unsafe { chunk(&self.work.ids, at) };
                // SAFETY: there is space for `kept` pairs, and `KEPT` more.
                w.pair(id, ids, unsafe { self.output.places(self.output.found + at) });
                at += KEPT;
                if at >= end {
                    break;
                }
            }
            begin = end;
        }
        self.output.found += kept;
    }

    #[inline(always)]
    fn keep_one<W: Wide>(&mut self, w: W, a: Around<W, D>, r: usize, found: &mut Tested) {
        let (source, valid) = self.range(a.ranges[r], r);
        let query = self.query(w, a.place, &a.shifts[r]);
        self.keep(w, source, valid, &query, a.limits, found);
    }

    #[inline(always)]
    fn keep_two<W: Wide>(&mut self, w: W, a: Around<W, D>, r: usize, found: &mut Tested) {
        let (low, valid) = self.range(a.ranges[r], r);
        let (high, valid_high) = self.range(a.ranges[r + 1], r + 1);
        let query = self.query(w, a.place, &a.halves[r / 2]);
        self.keep(w, TwoRuns8([low, high]), valid | valid_high << HALF, &query, a.limits, found);
    }

    #[inline(always)]
    fn keep<W: Wide>(
        &mut self,
        w: W,
        source: impl Source<D>,
        valid: u32,
        query: &Query<W, D>,
        limits: Limits<W>,
        found: &mut Tested,
    ) {
        let (near, sure) =
            test::<_, D, EACH>(w, source, valid, query, limits, self.bounds.grow, F::TURN);
        // SAFETY: before `found.at` are at most `ENOUGH` ids and those of four vectors; there is
        // space for one vector more.
        let to = unsafe { chunk_mut(&mut self.work.ids, found.at) };
        let [low, high] = source.ids();
        w.pack_two(low, high, near, to);
        let count = near.count_ones();
        found.at += count as usize;
        found.odd |= near ^ sure;
        found.counts |= count;
    }

    #[inline(always)]
    pub fn limits<W: Wide>(&self, w: W) -> Limits<W> {
        Limits::new(w, w.all(self.bounds.sum + self.bounds.grow), self.bounds.grow)
    }
}
