//! Unchecked access to the arrays of slabs: the reason of every `unsafe` here and in the kernel.
//!
//! Bounds checks cost 7% on 10^6 packed spheres, so only builds with debug assertions have them,
//! as tests are. What holds instead: places are below the slab's `len`, and arrays over elements are a vector longer ([`Slab::prepare`]); a range ends at
//! `len` or before, so a vector may begin at any place in it; cells of elements are no borders, so cells beside them and in the rows beside them have
//! numbers ([`super::slab::Plan`]); in the kernel's scratch an element keeps fewer than `KEPT` of a vector, of five at the most, and there is room for five vectors beyond a block.

use super::slab::Slab;
use crate::wide::{HALF, Wide};

/// Sixteen elements of slabs.
pub(super) trait Source<const D: usize>: Copy {
    /// One number of each.
    fn load<W: Wide>(&self, w: W, lane: impl Fn(&Slab<D>) -> &[f32]) -> W::Floats;
    /// See [`Wide::pack`].
    fn pack<W: Wide>(&self, w: W, mask: u32, to: &mut [u32; HALF]);
}

/// The elements from a place on.
#[derive(Clone, Copy)]
pub(super) struct From<'a, const D: usize>(pub &'a Slab<D>, pub usize);

impl<const D: usize> Source<D> for From<'_, D> {
    #[inline(always)]
    fn load<W: Wide>(&self, w: W, lane: impl Fn(&Slab<D>) -> &[f32]) -> W::Floats {
        w.load(unsafe { chunk(lane(self.0), self.1) })
    }

    #[inline(always)]
    fn pack<W: Wide>(&self, w: W, mask: u32, to: &mut [u32; HALF]) {
        w.pack(unsafe { chunk(&self.0.ids, self.1) }, mask, to);
    }
}

/// Eight from one place on, eight from another.
#[derive(Clone, Copy)]
pub(super) struct Both<'a, const D: usize>(pub [From<'a, D>; 2]);

impl<const D: usize> Source<D> for Both<'_, D> {
    #[inline(always)]
    fn load<W: Wide>(&self, w: W, lane: impl Fn(&Slab<D>) -> &[f32]) -> W::Floats {
        let [low, high] = self.0;
        unsafe { w.load_two(chunk(lane(low.0), low.1), chunk(lane(high.0), high.1)) }
    }

    #[inline(always)]
    fn pack<W: Wide>(&self, w: W, mask: u32, to: &mut [u32; HALF]) {
        let [low, high] = self.0;
        unsafe { w.pack_two(chunk(&low.0.ids, low.1), chunk(&high.0.ids, high.1), mask, to) }
    }
}

/// `N` numbers from place `at` on.
///
/// # Safety
/// They must be in the array.
#[inline(always)]
pub(super) unsafe fn chunk<A, const N: usize>(array: &[A], at: usize) -> &[A; N] {
    debug_assert!(at + N <= array.len());
    unsafe { &*array.as_ptr().add(at).cast() }
}

/// As [`chunk`], to be written.
///
/// # Safety
/// They must be in the array.
#[inline(always)]
pub(super) unsafe fn chunk_mut<A, const N: usize>(array: &mut [A], at: usize) -> &mut [A; N] {
    debug_assert!(at + N <= array.len());
    unsafe { &mut *array.as_mut_ptr().add(at).cast() }
}

/// One of them.
///
/// # Safety
/// It must be in the array.
#[inline(always)]
pub(super) unsafe fn element<A: Copy>(array: &[A], at: usize) -> A {
    debug_assert!(at < array.len());
    unsafe { *array.get_unchecked(at) }
}
