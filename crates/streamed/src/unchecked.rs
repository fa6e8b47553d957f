//! Unchecked access to the arrays of slabs and of the kernel's scratch.
//!
//! Bounds checks cost 7% of the time on 10^6 packed spheres. Only builds with debug assertions,
//! such as tests, have them. The code relies on three facts:
//!
//! * Places are at most the slab's `len`, and its arrays over particles are [`LANES`] longer
//!   ([`Slab::prepare`]). So a vector may begin at any place of a range.
//! * Borders surround the cells that can hold particles ([`super::plan::Plan`]). So all cells
//!   around a particle's cell, in its layer and the next, have numbers.
//! * A block of particles ends while there is still space for the candidates of one more: at most
//!   one vector for each range. Particles with more candidates are swept
//!   [`Together`](super::together::Together), which passes pairs on before space runs out.

use super::slab::Slab;
use contactbench_ground::wide::{HALF, LANES, Wide, read};

/// Sixteen particles from one or two slabs.
pub(super) trait Source<const D: usize>: Copy {
    /// Loads the coordinates along an axis, or the radii if `axis` is D.
    fn load<W: Wide>(&self, w: W, axis: usize) -> W::Floats;
    /// Returns the first eight and the last eight ids.
    fn ids(&self) -> [&[u32; HALF]; 2];
}

/// Sixteen consecutive particles of a slab.
#[derive(Clone, Copy)]
pub(super) struct Run16<'a, const D: usize> {
    slab: &'a Slab<D>,
    at: usize,
}

impl<'a, const D: usize> Run16<'a, D> {
    /// Creates a run of particles that starts at place `at`.
    ///
    /// # Safety
    /// The slab's arrays over particles must extend [`LANES`] beyond `at`.
    #[inline(always)]
    pub unsafe fn new(slab: &'a Slab<D>, at: usize) -> Run16<'a, D> {
        debug_assert!(at + LANES <= slab.ids.len());
        Run16 { slab, at }
    }
}

impl<const D: usize> Source<D> for Run16<'_, D> {
    #[inline(always)]
    fn load<W: Wide>(&self, w: W, axis: usize) -> W::Floats {
        // SAFETY: the caller of `new` ensures that the arrays extend a vector beyond `at`.
        w.load(unsafe { chunk(self.slab.lane(axis), self.at) })
    }

    #[inline(always)]
    fn ids(&self) -> [&[u32; HALF]; 2] {
        // SAFETY: the caller of `new` ensures that the arrays extend a vector beyond `at`.
        [self.at, self.at + HALF].map(|at| unsafe { chunk(&self.slab.ids, at) })
    }
}

/// Sixteen particles: the first eight of one run, then the first eight of another.
#[derive(Clone, Copy)]
pub(super) struct TwoRuns8<'a, const D: usize>(pub [Run16<'a, D>; 2]);

impl<const D: usize> Source<D> for TwoRuns8<'_, D> {
    #[inline(always)]
    fn load<W: Wide>(&self, w: W, axis: usize) -> W::Floats {
        let [low, high] = self.0;
        // SAFETY: both places are followed by sixteen numbers in the arrays ([`Run16::new`]).
        unsafe {
            let (low, high) =
                (chunk(low.slab.lane(axis), low.at), chunk(high.slab.lane(axis), high.at));
            w.load_two(low, high)
        }
    }

    #[inline(always)]
    fn ids(&self) -> [&[u32; HALF]; 2] {
        // SAFETY: both places are followed by sixteen ids in the arrays ([`Run16::new`]).
        [0, 1].map(|k: usize| unsafe { chunk(&self.0[k].slab.ids, self.0[k].at) })
    }
}

/// Returns a reference to `N` values of an array, from place `at` on.
///
/// # Safety
/// `at + N` must be at most the length of the array.
#[inline(always)]
pub(super) unsafe fn chunk<A, const N: usize>(array: &[A], at: usize) -> &[A; N] {
    debug_assert!(at + N <= array.len());
    // SAFETY: the caller ensures that `N` initialised values follow `at`, and an array of `A` has
    // the alignment of `A`.
    unsafe { &*array.as_ptr().add(at).cast() }
}

/// Loads a register of values from an array, from place `at` on.
///
/// # Safety
/// `at + LANES` must be at most the length of the array. `V` must be at most `LANES` plain numbers.
#[inline(always)]
pub(super) unsafe fn load<A, V: Copy>(array: &[A], at: usize) -> V {
    debug_assert!(at + LANES <= array.len() && size_of::<V>() <= LANES * size_of::<A>());
    // SAFETY: the caller ensures that as many values as a register has lanes follow `at`.
    unsafe { read(array.as_ptr().add(at)) }
}

/// Mutable form of [`chunk`].
///
/// # Safety
/// `at + N` must be at most the length of the array.
#[inline(always)]
pub(super) unsafe fn chunk_mut<A, const N: usize>(array: &mut [A], at: usize) -> &mut [A; N] {
    debug_assert!(at + N <= array.len());
    // SAFETY: as for `chunk`; `array` is borrowed mutably for the lifetime of the result.
    unsafe { &mut *array.as_mut_ptr().add(at).cast() }
}

/// Returns the value of an array at place `at`.
///
/// # Safety
/// `at` must be below the length of the array.
#[inline(always)]
pub(super) unsafe fn element<A: Copy>(array: &[A], at: usize) -> A {
    debug_assert!(at < array.len());
    // SAFETY: the caller ensures that `at` is in the array.
    unsafe { *array.get_unchecked(at) }
}
