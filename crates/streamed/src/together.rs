//! The sweep of particles that share their candidates: those of a cell with many.
//!
//! The candidates are first copied side by side, with coordinates relative to the particles' cell.
//! All vectors but the last are then full, and each copy serves all particles from the nearest
//! cache. The sweep handles any number of candidates, any number of contacts per vector, and
//! pairs that need the contact test. If all of the particles are images in a periodic box, images
//! among the candidates are left out, because the test would reject them.

use std::ops::Range;

use super::kernel::{Sweep, test};
use super::output::ROOM;
use super::ranges::{Find, Ranges, ranges_used};
use super::slab::Slab;
use super::unchecked::{Source, chunk, chunk_mut};
use contactbench_ground::wide::{HALF, Kernel, LANES, Wide, fill};

/// Number of candidates that are copied at once.
pub(super) const TOGETHER: usize = 1024;

/// A sweep of the particles at these places, whose candidates are those of the given ranges, which
/// belong to the first place. In range 0, only later particles are candidates of a particle.
pub(super) struct Together<'s, 'a, F, const D: usize, const EACH: bool>(
    pub &'s mut Sweep<'a, F, D, EACH>,
    pub Range<usize>,
    pub &'s Ranges,
);

impl<F: Find, const D: usize, const EACH: bool> Kernel for Together<'_, '_, F, D, EACH> {
    type Output = ();

    #[inline(always)]
    fn run<W: Wide>(self, w: W) {
        let Together(sweep, places, ranges) = self;
        let (limits, none) = (sweep.limits(w), [w.all(0.0); D]);
        let (mut r, mut taken) = (0, 0);
        let mut own = ranges[0].0 as usize;
        let images = sweep.are_images(places.clone());
        while r < ranges_used::<F, D>() {
            let (mut filled, mut of_own) = (0, 0);
            while r < ranges_used::<F, D>() && filled < TOGETHER {
                let (begin, len) = (ranges[r].0 as usize + taken, ranges[r].1 as usize - taken);
                let many = len.min(TOGETHER - filled);
                let (from, shift) = (sweep.other(r), sweep.shift(r));
                let to = &mut sweep.work.candidates;
                copy::<D, EACH>(from, begin, many, &shift, to, filled);
                filled += many;
                of_own += if r == 0 { many } else { 0 };
                (r, taken) = if many == len { (r + 1, 0) } else { (r, taken + many) };
            }
            if images {
                let first_image = sweep.bounds.first_image;
                (filled, of_own) = (sweep.work.candidates.keep_below(first_image, filled), 0);
            }
            sweep.work.candidates.lanes[0][filled..][..LANES].fill(f32::INFINITY);
            for place in places.clone() {
                let first = (place + 1).saturating_sub(own).min(of_own);
                if sweep.output.found + filled > ROOM - LANES {
                    sweep.output.hand_on();
                }
                let query = sweep.query(w, place, &none);
                let id = sweep.slab.ids[place];
                let output = &mut sweep.output;
                let (mut many, mut odd) = (output.found, 0);
                let mut row = Candidates::new(&sweep.work.candidates, first);
                while row.at < filled {
                    let (near, sure) =
                        test::<_, D, EACH>(w, row, !0, &query, limits, sweep.bounds.grow, F::TURN);
                    // SAFETY: there is space for all candidates, and a vector more.
                    w.pairs(id, row.all_ids(), near, unsafe { output.places(many) });
                    many += near.count_ones() as usize;
                    odd |= near ^ sure;
                    row.at += LANES;
                }
                if odd == 0 {
                    output.found = many;
                } else {
                    w.run(Doubtful(&mut *sweep, place, first..filled));
                }
            }
            own += of_own;
        }
    }
}

/// Tests a particle against copied candidates, some of which only the contact test can decide. It
/// is a separate function so that its calls take no registers from the sweep.
struct Doubtful<'s, 'a, F, const D: usize, const EACH: bool>(
    &'s mut Sweep<'a, F, D, EACH>,
    usize,
    Range<usize>,
);

impl<F: Find, const D: usize, const EACH: bool> Kernel for Doubtful<'_, '_, F, D, EACH> {
    type Output = ();

    #[inline(always)]
    fn run<W: Wide>(self, w: W) {
        let Doubtful(sweep, place, candidates) = self;
        let (query, limits) = (sweep.query(w, place, &[w.all(0.0); D]), sweep.limits(w));
        let id = sweep.slab.ids[place];
        for at in candidates.step_by(LANES) {
            let row = Candidates::new(&sweep.work.candidates, at);
            let (near, sure) =
                test::<_, D, EACH>(w, row, !0, &query, limits, sweep.bounds.grow, F::TURN);
            sweep.output.one_by_one(id, row, (near, sure));
        }
    }
}

/// Sixteen copied candidates, from place `at` on.
#[derive(Clone, Copy)]
struct Candidates<'a, const D: usize> {
    lanes: [&'a [f32; TOGETHER + LANES]; D],
    radii: &'a [f32],
    ids: &'a [u32; TOGETHER + LANES],
    at: usize,
}

impl<'a, const D: usize> Candidates<'a, D> {
    #[inline(always)]
    fn new(copies: &'a Copies, at: usize) -> Candidates<'a, D> {
        Candidates {
            lanes: std::array::from_fn(|k| &copies.lanes[k]),
            radii: &copies.radii,
            ids: &copies.ids,
            at,
        }
    }

    #[inline(always)]
    fn all_ids(&self) -> &'a [u32; LANES] {
        // SAFETY: `at` is at most `TOGETHER`, and the arrays are a vector longer.
        unsafe { chunk(self.ids, self.at) }
    }
}

impl<const D: usize> Source<D> for Candidates<'_, D> {
    #[inline(always)]
    fn load<W: Wide>(&self, w: W, axis: usize) -> W::Floats {
        let lane: &[f32] = if axis < D { self.lanes[axis] } else { self.radii };
        // SAFETY: `at` is at most `TOGETHER`, and the arrays are a vector longer.
        w.load(unsafe { chunk(lane, self.at) })
    }

    #[inline(always)]
    fn ids(&self) -> [&[u32; HALF]; 2] {
        // SAFETY: as for the coordinates.
        [self.at, self.at + HALF].map(|at| unsafe { chunk(self.ids, at) })
    }
}

/// Copies of particles that several others are tested against.
#[repr(align(64))]
pub(super) struct Copies {
    lanes: [[f32; TOGETHER + LANES]; 3],
    radii: [f32; TOGETHER + LANES],
    ids: [u32; TOGETHER + LANES],
}

impl Default for Copies {
    fn default() -> Copies {
        let none = [0.0; TOGETHER + LANES];
        Copies { lanes: [none; 3], radii: none, ids: [0; TOGETHER + LANES] }
    }
}

impl Copies {
    /// Keeps the candidates with numbers below `first_image`, and returns how many they are.
    #[inline(never)]
    fn keep_below(&mut self, first_image: u32, filled: usize) -> usize {
        let mut kept = 0;
        for k in 0..filled {
            let id = self.ids[k];
            (self.ids[kept], self.radii[kept]) = (id, self.radii[k]);
            self.lanes.iter_mut().for_each(|lane| lane[kept] = lane[k]);
            kept += usize::from(id < first_image);
        }
        kept
    }
}

/// Copies `many` particles of a slab, from place `begin` on, to the places from `at` on.
#[inline(always)]
fn copy<const D: usize, const EACH: bool>(
    from: &Slab<D>,
    begin: usize,
    many: usize,
    shift: &[f32; D],
    to: &mut Copies,
    at: usize,
) {
    for k in (0..many).step_by(LANES) {
        let (begin, at) = (begin + k, at + k);
        for ((from, to), shift) in from.lanes.iter().zip(&mut to.lanes).zip(shift) {
            // SAFETY: `begin` is in a range, so that a vector can be loaded.
            let lane: &[f32; LANES] = unsafe { chunk(from, begin) };
            // SAFETY: `at` is below `TOGETHER`, and the arrays are a vector longer.
            *unsafe { chunk_mut(to, at) } = fill::<_, LANES>(|k| lane[k] + shift);
        }
        // SAFETY: as for the coordinates.
        unsafe {
            *chunk_mut::<_, LANES>(&mut to.ids, at) = *chunk(&from.ids, begin);
            if EACH {
                *chunk_mut::<_, LANES>(&mut to.radii, at) = *chunk(&from.radii, begin);
            }
        }
    }
}
