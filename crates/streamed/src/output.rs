//! Pairs that a sweep finds. They are written at the end of the receiver's list, so that no pair is
//! copied.

use std::marker::PhantomData;
use std::ptr::NonNull;

use super::PairSink;
use super::together::TOGETHER;
use super::unchecked::Source;
use contactbench_ground::wide::{HALF, LANES, Slot, Wide, fill};

/// Length of a [`Space`]: the pairs of a particle with all candidates that are copied at once, and
/// what vectors write past them.
pub(super) const ROOM: usize = TOGETHER + 6 * LANES;

pub(super) type Space = [Slot; ROOM];

/// Pairs on their way to a receiver.
pub(super) struct Output<'a> {
    /// Space for pairs if the receiver has no list, or a full one. It is a pointer, as `to` is,
    /// because a reference would claim for itself what `to` may point to.
    own: NonNull<Space>,
    of_own: PhantomData<&'a mut Space>,
    pub sink: &'a mut dyn PairSink,
    to: NonNull<Space>,
    /// Whether `to` is in the receiver's list.
    listed: bool,
    /// Number of pairs in `to`.
    pub found: usize,
}

impl<'a> Output<'a> {
    pub fn new(own: &'a mut Space, sink: &'a mut dyn PairSink) -> Output<'a> {
        let own = NonNull::from(own);
        let mut output =
            Output { own, of_own: PhantomData, sink, to: own, listed: false, found: 0 };
        output.renew();
        output
    }

    fn renew(&mut self) {
        let list = self.sink.space().map(NonNull::from);
        self.listed = list.is_some();
        self.to = list.unwrap_or(self.own);
        self.found = 0;
    }

    /// Passes all pairs on.
    #[inline(never)]
    pub fn hand_on(&mut self) {
        // SAFETY: the first `found` pairs of `to` were written, which is `own` or the space of the
        // list. The receiver has not been used since, except to count and to test contacts.
        unsafe {
            if self.listed {
                self.sink.written(self.found);
            } else {
                self.sink.sure(self.to.as_ref()[..self.found].assume_init_ref());
            }
        }
        self.renew();
    }

    /// Returns space for `N` pairs after the first `at`.
    ///
    /// # Safety
    /// `at + N` must be at most [`ROOM`].
    #[inline(always)]
    pub unsafe fn places<const N: usize>(&mut self, at: usize) -> &mut [Slot; N] {
        debug_assert!(at + N <= ROOM);
        // SAFETY: the caller ensures that the space holds `N` pairs from `at` on.
        unsafe { &mut *self.to.as_ptr().cast::<Slot>().add(at).cast() }
    }

    /// Stores a pair of `id` and each of sixteen candidates that touches it.
    #[inline(always)]
    pub fn take<W: Wide, const D: usize>(
        &mut self,
        w: W,
        id: u32,
        source: impl Source<D>,
        (near, sure): (u32, u32),
    ) {
        if near == sure {
            let ids = source.ids().map(|half| *half);
            // SAFETY: each call ends with at most `ROOM - LANES` pairs, and no caller has more.
            let places = unsafe { self.places(self.found) };
            w.pairs(id, &fill(|k| ids[k / HALF][k % HALF]), near, places);
            self.found += near.count_ones() as usize;
        } else {
            self.one_by_one(id, source, (near, sure));
        }
        if self.found > ROOM - LANES {
            self.hand_on();
        }
    }

    /// Does the same as [`Output::take`] if only the contact test can decide some of the pairs.
    /// There must be space for all of them.
    #[cold]
    pub fn one_by_one<const D: usize>(
        &mut self,
        id: u32,
        source: impl Source<D>,
        (near, sure): (u32, u32),
    ) {
        let ids = source.ids();
        for k in (0..LANES).filter(|k| near >> k & 1 == 1) {
            let other = ids[k / HALF][k % HALF];
            if sure >> k & 1 == 1 || self.sink.touches(id, other) {
                // SAFETY: `to` points to a space.
                unsafe { self.to.as_mut()[self.found].write([id, other]) };
                self.found += 1;
            }
        }
    }
}
