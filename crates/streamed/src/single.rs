//! The sweep on registers of four or eight floats: each range is tested alone, because most ranges
//! hold as many particles as a register or fewer. Bounds are the same as in [`super::kernel`].

use super::kernel::{SPARE, Sweep, WHOLE};
use super::output::ROOM;
use super::ranges::{Find, lengths, ranges_used};
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
                // SAFETY: `first` is one of `places`, which are below the slab's `len`, and every
                // array over particles has an entry for each place.
                let (id, from) = unsafe {
                    let at = |k: usize| element(&self.slab.lanes[k], first);
                    (element(&self.slab.ids, first), fill::<_, D>(at))
                };
                let radius = if EACH {
                    // SAFETY: if particles have individual radii, `radii` has one for each place.
                    r.all(grow + unsafe { element(&self.slab.radii, first) })
                } else {
                    r.all(0.0)
                };
                for (k, &(begin, len)) in ranges[..used].iter().enumerate() {
                    let slab = self.other(k);
                    let mut at = [r.all(from[0]); D];
                    for axis in 1..D {
                        at[axis] = r.all(from[axis] - shifts[k][axis]);
                    }
                    let (mut place, end) = (begin as usize, (begin + len) as usize);
                    // An empty range is tested too: a branch would be unpredictable.
                    loop {
                        // SAFETY: a range begins at most at the slab's `len`, and the arrays over
                        // particles are a vector longer.
                        let of = |lane: &[f32]| unsafe { load(lane, place) };
                        let mut square = r.all(0.0);
                        for (axis, &at) in at.iter().enumerate() {
                            let mut d = r.sub(of(&slab.lanes[axis]), at);
                            if let (0, Some(turn)) = (axis, F::TURN) {
                                d = nearest(r, d, turn);
                            }
                            square = if axis == 0 { r.mul(d, d) } else { r.mul_add(d, d, square) };
                        }
                        let [near, sure] = if EACH {
                            self::limits(r, r.add(radius, of(&slab.radii)), grow)
                        } else {
                            limits
                        };
                        let valid = !(!0 << (end - place).min(R::LANES));
                        let near = r.at_most(square, near) & valid;
                        odd |= near & !r.at_most(square, sure);
                        // SAFETY: as for the coordinates; and there is space for all candidates.
                        unsafe {
                            let ids = r.pack(load(&slab.ids, place), near);
                            let to: &mut [_; LANES] = self.output.places(kept);
                            to.as_mut_ptr().cast::<R::Pairs>().write_unaligned(r.pair(id, ids));
                        }
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
