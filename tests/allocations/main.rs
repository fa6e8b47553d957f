//! Tests the heap memory of detectors and readers. The counting allocator counts all threads, so
//! tests take turns.

mod detectors;
mod files;

use std::sync::{Mutex, MutexGuard, PoisonError};

use contactbench::run::runner::alloc::Counting;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

static QUIET: Mutex<()> = Mutex::new(());

/// Lets one test run at a time. The harness may still allocate while it prints the previous result.
fn quiet() -> MutexGuard<'static, ()> {
    let guard = QUIET.lock().unwrap_or_else(PoisonError::into_inner);
    std::thread::sleep(std::time::Duration::from_millis(200));
    guard
}
