//! Large pages for large arrays.
//!
//! The system clears each page at its first use. If pages have 4 KiB, this happens 6,649 times for
//! the contacts of a million packed spheres, and takes a quarter of the call. NumPy requests large
//! pages from 4 MiB on, and so does this allocator if enough of them are free.

use std::alloc::{GlobalAlloc, Layout};

use contactbench_run::run::runner::alloc::Counting;

/// The counting allocator `Counting`, with large pages.
pub struct Pages;

/// Size in bytes from which an allocation requests large pages.
const LARGE: usize = 1 << 22;

/// Allocates `size` bytes, `more` of them new, on large pages if they are many.
#[cfg(target_os = "linux")]
fn paged(size: usize, more: usize, allocate: impl FnOnce() -> *mut u8) -> *mut u8 {
    use libc::{MAP_ANONYMOUS, MAP_FAILED, MAP_PRIVATE, PROT_READ, PROT_WRITE};
    // Bytes that a large array leaves, because a report of an error needs memory, or aborts.
    const SPARE: usize = 1 << 21;
    if size < LARGE || more == 0 {
        return allocate();
    }
    let (len, kind) = (more.saturating_add(SPARE), MAP_PRIVATE | MAP_ANONYMOUS);
    // SAFETY: the new mapping only shows whether there is room, and is removed unused.
    unsafe {
        let probe = libc::mmap(std::ptr::null_mut(), len, PROT_READ | PROT_WRITE, kind, -1, 0);
        if probe == MAP_FAILED {
            return std::ptr::null_mut();
        }
        libc::munmap(probe, len);
    }
    let begin = allocate();
    if !begin.is_null() {
        contactbench_ground::limits::pages::request(begin, size, more);
    }
    begin
}

#[cfg(not(target_os = "linux"))]
fn paged(_: usize, _: usize, allocate: impl FnOnce() -> *mut u8) -> *mut u8 {
    allocate()
}

// SAFETY: every call fails, or goes to `Counting` with the same arguments, and its result is
// returned, so its guarantees are kept.
unsafe impl GlobalAlloc for Pages {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promises are those that `Counting` requires.
        paged(layout.size(), layout.size(), || unsafe { Counting.alloc(layout) })
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promises are those that `Counting` requires.
        paged(layout.size(), layout.size(), || unsafe { Counting.alloc_zeroed(layout) })
    }

    unsafe fn dealloc(&self, begin: *mut u8, layout: Layout) {
        // SAFETY: the caller's promises are those that `Counting` requires.
        unsafe { Counting.dealloc(begin, layout) }
    }

    unsafe fn realloc(&self, begin: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller's promises are those that `Counting` requires.
        let grown = || unsafe { Counting.realloc(begin, layout, size) };
        paged(size, size.saturating_sub(layout.size()), grown)
    }
}
