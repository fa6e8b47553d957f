//! Handles that callers hold. Only one call at a time may search with a handle, in the process that
//! created it; any number of calls may read its contacts between searches.

use std::cell::UnsafeCell;
use std::sync::atomic::{AtomicUsize, Ordering};

use contactbench_ground::contact::Arithmetic;
use contactbench_ground::limits::memory;
use contactbench_ground::pairs::normalise::smaller_first;
use contactbench_ground::periodic::ContactList;
use contactbench_ground::periodic::Loaded;
use contactbench_lists::track::Tracker;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::contactbench_scene;
use crate::given::{Failure, Given};

/// A searcher or tracker, and the contacts of its last scene. Calls that would have to wait fail.
pub struct Handle {
    arithmetic: Arithmetic,
    limit: u64,
    /// Number of calls that are reading the answer; [`SEARCHING`] during a search.
    users: AtomicUsize,
    process: u32,
    /// Whether the search has threads, which a forked process lacks.
    threads: bool,
    worker: UnsafeCell<Worker>,
}

const SEARCHING: usize = usize::MAX;

type Search = Box<dyn Tracker>;

struct Worker {
    search: Search,
    /// Creates `search` again after a panic, which may leave `search` in an invalid state.
    make: Box<dyn Fn() -> Search + Send>,
    crew: Option<ThreadPool>,
    answer: Filled,
}

/// Contacts in the caller's form.
#[derive(Default)]
pub struct Filled {
    contacts: ContactList,
    /// Images of the pairs in a box: one integer per dimension and pair.
    images: Vec<i32>,
    boxed: bool,
    /// Whether a tracker built its list in the last step.
    pub built: bool,
    /// Whether the call that fills the answer is still running, or panicked.
    unfinished: bool,
}

// SAFETY: only `search` gives access to the worker, to one thread at a time. `look` gives read
// access to its answer, to several threads, but not during a search.
unsafe impl Sync for Handle {}

impl Handle {
    /// Creates a handle. `limit` is in bytes; 0 selects the default of this machine.
    pub fn new(
        arithmetic: Arithmetic,
        limit: u64,
        threads: usize,
        make: impl Fn(u64) -> Search + Send + 'static,
    ) -> Result<Handle, Failure> {
        let limit = if limit == 0 { memory::default_limit() } else { limit };
        let crew = if threads == 1 { None } else { Some(pool(threads)?) };
        let make = Box::new(move || make(limit));
        let worker = Worker { search: make(), make, crew, answer: Filled::default() };
        Ok(Handle {
            arithmetic,
            limit,
            users: AtomicUsize::new(0),
            process: std::process::id(),
            threads: threads > 1,
            worker: UnsafeCell::new(worker),
        })
    }

    /// Finds the contacts of a scene.
    ///
    /// # Safety
    /// The scene is NULL, or its numbers can be read.
    pub unsafe fn contacts(&self, scene: *const contactbench_scene) -> Result<(), Failure> {
        self.search(|search, crew, answer| {
            answer.clear();
            // SAFETY: promised by the caller.
            let given = unsafe { Given::new(scene) }?;
            let loaded = Loaded::new(&given.scene, given.lattice, self.arithmetic)?;
            loaded.within(self.limit)?;
            let contacts = &mut answer.contacts;
            let mut work = || search.find(loaded.frame(self.arithmetic), None, contacts);
            let found = match crew {
                Some(crew) => crew.install(work),
                None => work(),
            };
            answer.built = found.inspect_err(|_| answer.contacts.clear())?.built;
            smaller_first(&mut answer.contacts.plain);
            answer.boxed = given.lattice.is_some();
            let dim = if answer.boxed { given.scene.dim() } else { 0 };
            Ok(answer.contacts.flatten(dim, &mut answer.images)?)
        })
    }

    /// Calls `work` with exclusive access to the search.
    pub fn search(
        &self,
        work: impl FnOnce(&mut Search, &Option<ThreadPool>, &mut Filled) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let forked = self.process != std::process::id();
        if forked && self.threads {
            return Err(Failure::invalid(
                "the handle has threads of the process that this one was forked from; make a new \
                 one here",
            ));
        }
        let begun = self.users.compare_exchange(0, SEARCHING, Ordering::Acquire, Ordering::Relaxed);
        if begun.is_err() {
            return Err(Failure::invalid(if forked {
                "the handle was at work when this process was forked; make a new one here"
            } else {
                "the handle is in use by another thread; make one for each thread"
            }));
        }
        let _end = End(&self.users);
        // SAFETY: this thread changed `users` from 0 to `SEARCHING`, and no other thread accesses
        // the worker until `_end` is dropped.
        let Worker { search, make, crew, answer } = unsafe { &mut *self.worker.get() };
        if std::mem::replace(&mut answer.unfinished, true) {
            *search = make();
            answer.clear();
        }
        let done = work(search, crew, answer);
        answer.unfinished = false;
        done
    }

    /// Calls `of` with the answer; returns `None` during a search or after one that panicked.
    pub fn look<R>(&self, of: impl FnOnce(&Filled) -> R) -> Option<R> {
        let enter = |users| (users < SEARCHING - 1).then(|| users + 1);
        self.users.fetch_update(Ordering::Acquire, Ordering::Relaxed, enter).ok()?;
        // SAFETY: `users` is neither 0 nor `SEARCHING`, so no search begins before this call ends,
        // and no other field of the worker is read.
        let answer = unsafe { &(*self.worker.get()).answer };
        let seen = (!answer.unfinished).then(|| of(answer));
        self.users.fetch_sub(1, Ordering::Release);
        seen
    }
}

/// Ends a search, even after a panic.
struct End<'a>(&'a AtomicUsize);

impl Drop for End<'_> {
    fn drop(&mut self) {
        self.0.store(0, Ordering::Release);
    }
}

impl Filled {
    fn clear(&mut self) {
        self.contacts.clear();
        self.images.clear();
        (self.boxed, self.built) = (false, false);
    }

    /// Returns two particle numbers per contact.
    pub fn pairs(&self) -> &[[u32; 2]] {
        &self.contacts.plain
    }

    pub fn pairs_ptr(&self) -> *const u32 {
        self.pairs().as_flattened().as_ptr()
    }

    /// Returns the images of the contacts in a box; NULL in open space.
    pub fn images_ptr(&self) -> *const i32 {
        if self.boxed { self.images.as_ptr() } else { std::ptr::null() }
    }
}

pub fn pool(threads: usize) -> Result<ThreadPool, Failure> {
    let made = ThreadPoolBuilder::new().num_threads(threads).build();
    made.map_err(|error| Failure::Memory(format!("threads could not be started: {error}")))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use contactbench_detectors::tracker::parse;
    use contactbench_ground::detect::Options;

    use super::*;

    /// Returns a handle that counts in `made` how often it makes a search.
    fn counted(threads: usize, made: &Arc<AtomicUsize>) -> Handle {
        let (made, spec) = (made.clone(), parse("every-step(direct)").expect("a tracker"));
        let make = move |memory_limit| {
            made.fetch_add(1, Ordering::Relaxed);
            spec.make(Options { memory_limit, threads })
        };
        Handle::new(Arithmetic::Exact, 0, threads, make).ok().expect("threads start")
    }

    fn handle(threads: usize) -> Handle {
        counted(threads, &Arc::default())
    }

    fn found(handle: &Handle) -> Result<(), Failure> {
        handle.search(|_, _, answer| {
            answer.clear();
            answer.contacts.plain.push([0, 1]);
            Ok(())
        })
    }

    fn count(handle: &Handle) -> Option<usize> {
        handle.look(|answer| answer.pairs().len())
    }

    #[test]
    fn calls_read_the_answer_side_by_side_and_search_alone() {
        let handle = handle(1);
        assert!(found(&handle).is_ok());
        let beside = handle.look(|_| (count(&handle), found(&handle).is_ok()));
        assert_eq!(beside, Some((Some(1), false)));
        let mut beside = None;
        let done = handle.search(|_, _, _| {
            beside = Some((count(&handle), found(&handle).is_ok()));
            Ok(())
        });
        assert_eq!((beside, done.is_ok()), (Some((None, false)), true));
        assert_eq!(count(&handle), Some(1));
    }

    #[test]
    fn a_panic_leaves_no_answer_and_no_half_changed_search() {
        let made = Arc::default();
        let handle = counted(1, &made);
        assert!(found(&handle).is_ok());
        let panics = || {
            handle.search(|_, _, answer| {
                answer.contacts.plain.push([2, 3]);
                panic!("on purpose")
            })
        };
        assert!(std::panic::catch_unwind(std::panic::AssertUnwindSafe(panics)).is_err());
        assert_eq!(count(&handle), None);
        assert_eq!(made.load(Ordering::Relaxed), 1);
        let again = handle.search(|_, _, _| Ok(()));
        assert_eq!(
            (again.is_ok(), made.load(Ordering::Relaxed), count(&handle)),
            (true, 2, Some(0))
        );
    }

    #[test]
    fn a_forked_process_has_no_threads() {
        let forked = |threads| Handle { process: 0, ..handle(threads) };
        assert!(found(&forked(1)).is_ok() && found(&forked(2)).is_err());
        let busy = forked(1);
        busy.users.store(SEARCHING, Ordering::Relaxed);
        assert!(found(&busy).is_err());
    }
}
