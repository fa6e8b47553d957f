//! What detectors and readers take from the heap, under the counting allocator. It counts all
//! threads, so tests that measure and tests that do not take turns.

mod detectors;
mod files;

use std::sync::{PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

use contactbench::run::alloc::Counting;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

static QUIET: RwLock<()> = RwLock::new(());

/// For tests that measure. Who held the lock before may still be telling the harness how it ended,
/// which allocates.
fn quiet() -> RwLockWriteGuard<'static, ()> {
    let guard = QUIET.write().unwrap_or_else(PoisonError::into_inner);
    std::thread::sleep(std::time::Duration::from_millis(200));
    guard
}

/// For tests that only allocate.
fn loud() -> RwLockReadGuard<'static, ()> {
    QUIET.read().unwrap_or_else(PoisonError::into_inner)
}
