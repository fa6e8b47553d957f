//! The sweep on registers of four or eight floats: each range is tested alone, because most ranges
//! hold as many particles as a register or fewer. Bounds are the same as in [`super::kernel`].

use super::kernel::{SPARE, Sweep, WHOLE};
use super::output::ROOM;
use super::ranges::{Find, lengths, ranges_used};
use super::slab::Slab;
use super::together::Together;
use super::unchecked::{element, load};
use contactbench_ground::wide::{LANES, Register, fill};

impl<F: Find, const D: usize, const EACH: bool> Sweep<'_, F, D, EACH> {
    /// Sweeps all particles. [`Together`] handles particles with a long range, and a particle with
    /// a pair that only the contact test can decide.
    #[inline(always)]
    pub(super) fn by_range<R: Register>(mut self, r: R) {
        let (used, grow) = (ranges_used::<F, D>(), self.bounds.grow);
        let shifts: [_; 5] = std::array::from_fn(|k| self.shift(k.min(used - 1)));
        let limits = limits(r, r.all(self.bounds.sum + grow), grow);
        let mut end = self.places.start;
        while end < self.places.end {
            let first = end;
            let ranges = self.find.ranges::<D>(first);
            let long = lengths(&ranges) >= LANES as u32;
            end = if long { self.alike(first, &ranges) } else { first + 1 };
            let (mut kept, mut odd) = (0, u32::from(long));
            if odd == 0 {
                // The last register is written in full.
                let most = ranges.iter().map(|&(_, len)| len as usize).sum::<usize>() + LANES;
                if self.output.found + most > ROOM {
                    self.output.hand_on();
                }
                kept = self.output.found;
                let (id, from, radius) = self.particle(first);
                let radius = r.all(grow + radius);
                for (k, &(begin, len)) in ranges[..used].iter().enumerate() {
                    let slab = self.other(k);
                    let mut at = [r.all(from[0]); D];
                    for axis in 1..D {
                        at[axis] = r.all(from[axis] - shifts[k][axis]);
                    }
                    let (mut place, end) = (begin as usize, (begin + len) as usize);
                    // An empty range is tested too: a branch would be unpredictable.
                    loop {
                        let square = square::<F, R, D>(r, slab, place, &at);
                        let [near, sure] = if EACH {
                            self::limits(r, r.add(radius, of_range(&slab.radii, place)), grow)
                        } else {
                            limits
                        };
                        let valid = !(!0 << (end - place).min(R::LANES));
                        let near = r.at_most(square, near) & valid;
                        odd |= near & !r.at_most(square, sure);
                        self.write(r, id, (slab, place), near, kept);
                        kept += R::count(near);
                        place += R::LANES;
                        if place >= end {
                            break;
                        }
                    }
                }
            }
            if odd == 0 {
                self.output.found = kept;
            } else {
                r.run(Together(&mut self, first..end, &ranges));
            }
        }
        self.output.hand_on();
    }
    /// Returns number, coordinates and radius of the particle at a place; 0 if all radii are equal.
    #[inline(always)]
    fn particle(&self, first: usize) -> (u32, [f32; D], f32) {
        // SAFETY: `first` is one of `places`, which are below the slab's `len`, and every array
        // over particles has an entry for each place; `radii` if particles have individual radii.
        unsafe {
            let at = |k: usize| element(&self.slab.lanes[k], first);
            let radius = if EACH { element(&self.slab.radii, first) } else { 0.0 };
            (element(&self.slab.ids, first), fill::<_, D>(at), radius)
        }
    }

    /// Writes a particle's pairs with the `near` ones from a place on, behind the `kept` pairs.
    #[inline(always)]
    fn write<R: Register>(
        &mut self,
        r: R,
        id: u32,
        (slab, place): (&Slab<D>, usize),
        near: u32,
        kept: usize,
    ) {
        // SAFETY: as in `of_range`; and there is space for all candidates.
        unsafe {
            let ids = r.pack(load(&slab.ids, place), near);
            let to: &mut [_; LANES] = self.output.places(kept);
            to.as_mut_ptr().cast::<R::Pairs>().write_unaligned(r.pair(id, ids));
        }
    }
}

/// Loads the numbers of an array over particles from a place in a range on.
#[inline(always)]
fn of_range<V: Copy>(lane: &[f32], place: usize) -> V {
    // SAFETY: `place` is at most the slab's `len`, and each array over particles is a vector
    // longer.
    unsafe { load(lane, place) }
}

/// Computes the squared distances of the particles from a place on.
#[inline(always)]
fn square<F: Find, R: Register, const D: usize>(
    r: R,
    slab: &Slab<D>,
    place: usize,
    at: &[R::Floats; D],
) -> R::Floats {
    let mut square = r.all(0.0);
    for (axis, &at) in at.iter().enumerate() {
        let mut d = r.sub(of_range(&slab.lanes[axis], place), at);
        if let (0, Some(turn)) = (axis, F::TURN) {
            d = nearest(r, d, turn);
        }
        square = if axis == 0 { r.mul(d, d) } else { r.mul_add(d, d, square) };
    }
    square
}

/// Computes the limits of pairs like [`super::kernel::Limits::new`].
#[inline(always)]
fn limits<R: Register>(r: R, outer: R::Floats, grow: f32) -> [R::Floats; 2] {
    let inner = r.max(r.sub(outer, r.all(2.0 * grow)), r.all(0.0));
    [r.mul(outer, outer), r.mul_add(inner, inner, r.all(-SPARE))]
}

/// Returns the differences along x that are nearest to zero if coordinates wrap around after
/// `turn`, like [`super::kernel::test`].
#[inline(always)]
fn nearest<R: Register>(r: R, d: R::Floats, turn: f32) -> R::Floats {
    let whole = r.all(WHOLE);
    let turns = r.sub(r.add(r.mul(d, r.all(1.0 / turn)), whole), whole);
    r.sub(d, r.mul(turns, r.all(turn)))
}
