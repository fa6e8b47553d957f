//! The sweep on narrow registers: candidates are tested one by one, and no vector reads past the
//! end of a range. Bounds and results are the same as in [`super::kernel`].

use super::kernel::{Careful, ROOM, Sweep};
use super::near::{limits, nearest};
use super::ranges::{Find, ranges_used};
use super::unchecked::{element, element_mut};
use crate::wide::Wide;
use crate::wide::fill;

impl<F: Find, const D: usize, const EACH: bool> Sweep<'_, F, D, EACH> {
    /// Sweeps all particles. The careful form handles a particle with too many candidates, or with
    /// a pair that only the contact test can decide.
    #[inline(always)]
    pub(super) fn one_by_one<W: Wide>(mut self, w: W) {
        let (used, grow) = (ranges_used::<F, D>(), self.bounds.grow);
        let shifts: [_; 5] = std::array::from_fn(|r| self.shift(r.min(used - 1)));
        let same = limits(self.bounds.sum + grow, grow);
        let mut kept = 0;
        for place in self.places.clone() {
            let ranges = self.find.ranges::<D>(place);
            let candidates = ranges.iter().map(|&(_, len)| len as usize).sum::<usize>();
            if kept + candidates > ROOM {
                self.scratch.hand_on(&mut kept, self.sink);
            }
            let before = kept;
            let mut odd = candidates > ROOM;
            if !odd {
                // SAFETY: `place` is one of `places`, which are below the slab's `len`, and every
                // array over particles has an entry for each place.
                let (id, from) = unsafe {
                    let at = |k: usize| element(&self.slab.lanes[k], place);
                    (element(&self.slab.ids, place), fill::<_, D>(at))
                };
                let radius = if EACH {
                    // SAFETY: if particles have individual radii, `radii` has one for each place.
                    grow + unsafe { element(&self.slab.radii, place) }
                } else {
                    0.0
                };
                for (r, &(begin, len)) in ranges[..used].iter().enumerate() {
                    let slab = self.other(r);
                    let at: [f32; D] = fill(|k| from[k] - shifts[r][k]);
                    for other in begin as usize..(begin + len) as usize {
                        // SAFETY: a range ends at most at the slab's `len`.
                        let of = |lane: &[f32]| unsafe { element(lane, other) };
                        let mut square = 0.0;
                        for (k, &at) in at.iter().enumerate() {
                            let mut d = of(&slab.lanes[k]) - at;
                            if let (0, Some(turn)) = (k, F::TURN) {
                                d = nearest(d, turn);
                            }
                            square += d * d;
                        }
                        let (near, sure) =
                            if EACH { limits(radius + of(&slab.radii), grow) } else { same };
                        // SAFETY: `other` is below `len`, and there is space for all candidates.
                        unsafe {
                            let partner = element(&slab.ids, other);
                            *element_mut(&mut self.scratch.pairs, kept) = [id, partner];
                        }
                        kept += usize::from(square <= near);
                        odd |= (square <= near) != (square <= sure);
                    }
                }
            }
            if odd {
                // The careful form uses the space for pairs, so earlier pairs are passed on first.
                kept = before;
                self.scratch.hand_on(&mut kept, self.sink);
                w.run(Careful(&mut self, place, &ranges[..used]));
            }
        }
        self.scratch.hand_on(&mut kept, self.sink);
    }
}
