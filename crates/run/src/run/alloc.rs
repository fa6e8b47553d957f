//! A counting global allocator: how many heap bytes a detector takes.
//!
//! The binary installs [`Counting`]. It passes everything on to the system's allocator and counts
//! only inside [`measure`], so that timed passes pay one relaxed load per allocation, and warm
//! detectors do not allocate at all. Bytes are those requested; what the system's allocator adds to
//! them, and memory that is not on the heap, is not counted.
//!
//! Where several threads work, rayon's queue of jobs is counted with them. A job may be given back
//! a moment after the work is done, and a block of 63 jobs, about 1.5 KB, in a later measurement.
//! So the bytes of several threads are good to about 2 KB either way, and never less than 0.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::Mutex;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU64};

pub struct Counting;

static ON: AtomicBool = AtomicBool::new(false);
static LIVE: AtomicI64 = AtomicI64::new(0);
static PEAK: AtomicI64 = AtomicI64::new(0);
static ALLOCATIONS: AtomicU64 = AtomicU64::new(0);
/// One measurement at a time.
static MEASURING: Mutex<()> = Mutex::new(());

fn grow(bytes: i64) {
    let live = LIVE.fetch_add(bytes, Relaxed) + bytes;
    PEAK.fetch_max(live, Relaxed);
}

// SAFETY: every call is passed on to `System` with the same arguments, and its result is returned
// unchanged; the counters do not touch the memory. So the contract of `GlobalAlloc` holds because
// it holds for `System`.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if ON.load(Relaxed) {
            ALLOCATIONS.fetch_add(1, Relaxed);
            grow(layout.size() as i64);
        }
        // SAFETY: the caller's promises are those that `System` asks for.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        if ON.load(Relaxed) {
            ALLOCATIONS.fetch_add(1, Relaxed);
            grow(layout.size() as i64);
        }
        // SAFETY: as above.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        if ON.load(Relaxed) {
            grow(-(layout.size() as i64));
        }
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        if ON.load(Relaxed) {
            ALLOCATIONS.fetch_add(1, Relaxed);
            grow(size as i64 - layout.size() as i64);
        }
        // SAFETY: as above.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Usage {
    /// Most bytes held at one time, above what was held before.
    pub peak_bytes: u64,
    /// Bytes still held at the end.
    pub live_bytes: u64,
    pub allocations: u64,
}

/// Does `work` and counts what it takes from the heap, in all threads. `None` if [`Counting`] is
/// not the global allocator.
pub fn measure<R>(work: impl FnOnce() -> R) -> (R, Option<Usage>) {
    let meter = Meter::start();
    let result = meter.during(work);
    (result, meter.end())
}

/// Counts what several pieces of work take from the heap together. What is held between them is
/// held on; what is allocated between them does not count. There is one at a time: others wait.
pub struct Meter {
    _guard: std::sync::MutexGuard<'static, ()>,
    listening: bool,
}

impl Meter {
    pub fn start() -> Meter {
        let guard = MEASURING.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        ALLOCATIONS.store(0, Relaxed);
        ON.store(true, Relaxed);
        // One allocation of our own shows whether anybody counts.
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

    /// What all of it took; `None` if [`Counting`] is not the global allocator.
    pub fn end(self) -> Option<Usage> {
        let usage = Usage {
            peak_bytes: PEAK.load(Relaxed).max(0) as u64,
            live_bytes: LIVE.load(Relaxed).max(0) as u64,
            allocations: ALLOCATIONS.load(Relaxed),
        };
        self.listening.then_some(usage)
    }
}
