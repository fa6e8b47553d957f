//! Large pages for large arrays.
//!
//! The system clears each page at its first use. If pages have 4 KiB, this happens 6,649 times for
//! the contacts of a million packed spheres, and takes a quarter of the call. NumPy requests large
//! pages from 4 MiB on, and so does this allocator. If the system has none, nothing changes.

use std::alloc::{GlobalAlloc, Layout};

use contactbench_run::run::runner::alloc::Counting;

/// The counting allocator `Counting`, with large pages.
pub struct Pages;

/// Size in bytes from which an allocation requests large pages.
const LARGE: usize = 1 << 22;

#[cfg(target_os = "linux")]
fn ask(begin: *mut u8, size: usize) {
    if size < LARGE || begin.is_null() {
        return;
    }
    // The advice covers whole pages, because advice for a part splits a mapping, and the system
    // moves no split mapping: an array that grows would be copied into small pages.
    // SAFETY: the call only returns a number.
    let page = unsafe { libc::sysconf(libc::_SC_PAGESIZE) } as usize;
    let before = begin.addr() % page;
    let len = (before + size).next_multiple_of(page);
    // SAFETY: the range is the pages of the allocation, and the advice does not change content.
    unsafe { libc::madvise(begin.wrapping_sub(before).cast(), len, libc::MADV_HUGEPAGE) };
}

#[cfg(not(target_os = "linux"))]
fn ask(_: *mut u8, _: usize) {}

// SAFETY: every call goes to `Counting` with the same arguments, and its result is returned, so its
// guarantees are kept.
unsafe impl GlobalAlloc for Pages {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promises are those that `Counting` requires.
        let begin = unsafe { Counting.alloc(layout) };
        ask(begin, layout.size());
        begin
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promises are those that `Counting` requires.
        let begin = unsafe { Counting.alloc_zeroed(layout) };
        ask(begin, layout.size());
        begin
    }

    unsafe fn dealloc(&self, begin: *mut u8, layout: Layout) {
        // SAFETY: the caller's promises are those that `Counting` requires.
        unsafe { Counting.dealloc(begin, layout) }
    }

    unsafe fn realloc(&self, begin: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller's promises are those that `Counting` requires.
        let begin = unsafe { Counting.realloc(begin, layout, size) };
        ask(begin, size);
        begin
    }
}
