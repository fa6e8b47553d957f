//! What a caller holds: used by one call at a time, in the process that has made it.

use std::cell::UnsafeCell;
use std::ops::{Deref, DerefMut};
use std::sync::atomic::{AtomicBool, Ordering};

use contactbench_core::periodic::Contacts;
use contactbench_core::refusal::reserve;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::given::Failure;

/// A value that says no where it would have to wait.
pub struct Handle<T> {
    busy: AtomicBool,
    process: u32,
    /// It has threads, which a forked process has not.
    threads: bool,
    value: UnsafeCell<T>,
}

// SAFETY: the value is reached through `enter` alone, by one thread at a time.
unsafe impl<T: Send> Sync for Handle<T> {}

impl<T> Handle<T> {
    pub fn new(value: T, threads: usize) -> Handle<T> {
        let (busy, process) = (AtomicBool::new(false), std::process::id());
        Handle { busy, process, threads: threads > 1, value: UnsafeCell::new(value) }
    }

    /// The value, for one call.
    pub fn enter(&self) -> Result<Entered<'_, T>, Failure> {
        let forked = self.process != std::process::id();
        if forked && self.threads {
            return Err(Failure::invalid(
                "the handle has threads of the process that this one was forked from; make a new \
                 one here",
            ));
        }
        if self.busy.swap(true, Ordering::Acquire) {
            return Err(Failure::invalid(if forked {
                "the handle was at work when this process was forked; make a new one here"
            } else {
                "the handle is in use by another thread; make one for each thread"
            }));
        }
        Ok(Entered(self))
    }
}

/// See [`Handle::enter`].
pub struct Entered<'a, T>(&'a Handle<T>);

impl<T> Deref for Entered<'_, T> {
    type Target = T;
    fn deref(&self) -> &T {
        // SAFETY: whoever has set the flag is alone with the value until this is dropped.
        unsafe { &*self.0.value.get() }
    }
}

impl<T> DerefMut for Entered<'_, T> {
    fn deref_mut(&mut self) -> &mut T {
        // SAFETY: as above.
        unsafe { &mut *self.0.value.get() }
    }
}

impl<T> Drop for Entered<'_, T> {
    fn drop(&mut self) {
        self.0.busy.store(false, Ordering::Release);
    }
}

/// A searcher or tracker, its threads, and the contacts of its last scene.
pub struct Worker<S> {
    pub search: S,
    pub crew: Option<ThreadPool>,
    pub answer: Answer,
}

/// Contacts as callers see them.
#[derive(Default)]
pub struct Answer {
    pub contacts: Contacts,
    /// As many numbers for each pair as there are dimensions, in a box.
    pub images: Vec<i32>,
    pub boxed: bool,
}

impl Answer {
    pub fn clear(&mut self) {
        self.contacts.clear();
        self.images.clear();
        self.boxed = false;
    }

    /// Converts the contacts that were found to the caller's form.
    pub fn finish(&mut self, boxed: bool, dim: usize) -> Result<(), Failure> {
        contactbench_core::sink::smaller_first(&mut self.contacts.plain);
        self.boxed = boxed;
        if !boxed {
            return Ok(());
        }
        let Contacts { plain, shifted } = &mut self.contacts;
        reserve(&mut self.images, (plain.len() + shifted.len()) * dim)?;
        reserve(plain, shifted.len())?;
        self.images.resize(plain.len() * dim, 0);
        self.images.extend(shifted.iter().flat_map(|pair| pair.image[..dim].iter()));
        plain.extend(shifted.iter().map(|pair| [pair.i, pair.j]));
        shifted.clear();
        Ok(())
    }
}

/// Threads; none where one is enough.
pub fn crew(threads: usize) -> Result<Option<ThreadPool>, Failure> {
    if threads == 1 {
        return Ok(None);
    }
    pool(threads).map(Some)
}

pub fn pool(threads: usize) -> Result<ThreadPool, Failure> {
    let made = ThreadPoolBuilder::new().num_threads(threads).build();
    made.map_err(|error| Failure::Memory(format!("threads could not be started: {error}")))
}

pub fn by<R: Send>(crew: &Option<ThreadPool>, work: impl FnOnce() -> R + Send) -> R {
    match crew {
        Some(crew) => crew.install(work),
        None => work(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_call_at_the_same_time_is_an_error() {
        let handle = Handle::new(1, 1);
        let mut entered = handle.enter().ok().expect("nobody is in");
        *entered += 1;
        let other = std::thread::scope(|scope| scope.spawn(|| handle.enter().is_ok()).join());
        assert!(!other.expect("it returns"));
        drop(entered);
        assert!(handle.enter().is_ok_and(|value| *value == 2));
    }

    #[test]
    fn a_forked_process_has_no_threads() {
        let forked = |threads| Handle { process: 0, ..Handle::new((), threads) };
        assert!(forked(1).enter().is_ok() && forked(2).enter().is_err());
        let busy = forked(1);
        std::mem::forget(busy.enter());
        assert!(busy.enter().is_err());
    }
}
