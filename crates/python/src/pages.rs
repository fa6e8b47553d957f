//! Large pages for large arrays.
//!
//! A system that hands out memory in pages of 4 KiB does so at the first touch of each: 6,649 times
//! for the answer of a million packed spheres, which took about a quarter of such a call. numpy
//! asks for large pages from 4 MiB on; so does this. Where the system has none, or gives none to
//! those who ask, nothing changes.

use std::alloc::{GlobalAlloc, Layout};

use contactbench_run::run::alloc::Counting;

/// The allocator of the program, which asks for large pages.
pub struct Pages;

/// From so many bytes on.
const LARGE: usize = 1 << 22;

#[cfg(target_os = "linux")]
fn ask(begin: *mut u8, size: usize) {
    if size < LARGE || begin.is_null() {
        return;
    }
    // Whole pages, whatever their size on this machine.
    const PAGE: usize = 1 << 16;
    let skipped = begin.align_offset(PAGE);
    let len = size.saturating_sub(skipped) / PAGE * PAGE;
    // SAFETY: the range lies within what was just allocated, and advice changes no content.
    unsafe { libc::madvise(begin.wrapping_add(skipped).cast(), len, libc::MADV_HUGEPAGE) };
}

#[cfg(not(target_os = "linux"))]
fn ask(_: *mut u8, _: usize) {}

// SAFETY: every call is passed on to `Counting` with the same arguments, and its result is returned
// unchanged, so that its promises are kept.
unsafe impl GlobalAlloc for Pages {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promises are those that `Counting` asks for.
        let begin = unsafe { Counting.alloc(layout) };
        ask(begin, layout.size());
        begin
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above.
        let begin = unsafe { Counting.alloc_zeroed(layout) };
        ask(begin, layout.size());
        begin
    }

    unsafe fn dealloc(&self, begin: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { Counting.dealloc(begin, layout) }
    }

    unsafe fn realloc(&self, begin: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as above. What the system copies to a new place is there before it is asked.
        let begin = unsafe { Counting.realloc(begin, layout, size) };
        ask(begin, size);
        begin
    }
}
