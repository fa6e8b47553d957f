//! A counting global allocator, which measures the heap bytes of a detector.
//!
//! The program installs [`Counting`]. It uses the system's allocator and counts only inside
//! [`measure`]. So during timing, an allocation costs one more relaxed load, and warm detectors do
//! not allocate. It counts requested heap bytes, without the allocator's own overhead.
//!
//! If several threads work, rayon's job queue is counted too. A job may be freed shortly after the
//! work is done, and a block of 63 jobs (about 1.5 KB) even in a later measurement. So bytes of
//! several threads are accurate to about 2 KB, and never negative.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::Mutex;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU64};

pub struct Counting;

static ON: AtomicBool = AtomicBool::new(false);
static LIVE: AtomicI64 = AtomicI64::new(0);
static PEAK: AtomicI64 = AtomicI64::new(0);
static ALLOCATIONS: AtomicU64 = AtomicU64::new(0);
static MEASURING: Mutex<()> = Mutex::new(());

fn grow(bytes: i64) {
    let live = LIVE.fetch_add(bytes, Relaxed) + bytes;
    PEAK.fetch_max(live, Relaxed);
}

fn take(bytes: i64) {
    if ON.load(Relaxed) {
        ALLOCATIONS.fetch_add(1, Relaxed);
        grow(bytes);
    }
}

// SAFETY: every call is forwarded to `System` with the same arguments, and its result is returned
// unchanged; the counters do not touch the memory. So the contract of `GlobalAlloc` holds because
// it holds for `System`.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        take(layout.size() as i64);
        // SAFETY: the caller upholds the contract of this method, which is that of `System`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        take(layout.size() as i64);
        // SAFETY: the caller upholds the contract of this method, which is that of `System`.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        if ON.load(Relaxed) {
            grow(-(layout.size() as i64));
        }
        // SAFETY: the caller upholds the contract of this method, which is that of `System`.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        take(size as i64 - layout.size() as i64);
        // SAFETY: the caller upholds the contract of this method, which is that of `System`.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Usage {
    /// Peak of heap bytes, without those held at the start.
    pub peak_bytes: u64,
    pub live_bytes: u64,
    pub allocations: u64,
}

/// Runs `work` and counts its heap use in all threads. The usage is `None` if [`Counting`] is not
/// the global allocator.
pub fn measure<R>(work: impl FnOnce() -> R) -> (R, Option<Usage>) {
    let meter = Meter::start();
    let result = meter.during(work);
    (result, meter.end())
}

/// Counts the heap use of several pieces of work together. Memory that they keep stays counted;
/// allocations between them are not counted. Only one meter exists at a time; others wait.
pub struct Meter {
    _guard: std::sync::MutexGuard<'static, ()>,
    listening: bool,
}

impl Meter {
    pub fn start() -> Meter {
        let guard = MEASURING.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        ALLOCATIONS.store(0, Relaxed);
        ON.store(true, Relaxed);
        // Makes an allocation to find out whether the counting allocator is installed.
        drop(std::hint::black_box(Box::new(0u8)));
        ON.store(false, Relaxed);
        let listening = ALLOCATIONS.swap(0, Relaxed) > 0;
        LIVE.store(0, Relaxed);
        PEAK.store(0, Relaxed);
        Meter { _guard: guard, listening }
    }

    pub fn during<R>(&self, work: impl FnOnce() -> R) -> R {
        ON.store(true, Relaxed);
        let result = work();
        ON.store(false, Relaxed);
        result
    }

    pub fn end(self) -> Option<Usage> {
        let usage = Usage {
            peak_bytes: PEAK.load(Relaxed).max(0) as u64,
            live_bytes: LIVE.load(Relaxed).max(0) as u64,
            allocations: ALLOCATIONS.load(Relaxed),
        };
        self.listening.then_some(usage)
    }
}
