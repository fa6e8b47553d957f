//! Contacts of particles that move, by a kept list of near pairs.

use std::ffi::{c_char, c_int};
use std::ptr;

use contactbench_core::contact::Arithmetic;
use contactbench_core::detect::Options;
use contactbench_core::memory;
use contactbench_core::searcher::Loaded;
use contactbench_core::track::{self, Tracker};

use crate::given::{Failure, Given};
use crate::handle::{Answer, Handle, Worker, by, crew};
use crate::{contactbench_scene, done, text, usable};

/// The tracker to take without a reason for another.
const DEFAULT: &str = "verlet(streamed-nbs,skin=auto)";

/// A list of near pairs that is kept from frame to frame (a Verlet list), and the contacts of its
/// last frame. A call by another thread at the same time is an error.
pub struct contactbench_tracker {
    arithmetic: Arithmetic,
    limit: u64,
    handle: Handle<Worker<Course>>,
}

struct Course {
    tracker: Box<dyn Tracker>,
    built: bool,
}

/// Makes a tracker, to be freed by contactbench_tracker_free, and puts it into `made`; NULL where
/// it fails.
///
/// `tracker` is as in "verlet(streamed-nbs,rule=top-two,skin=0.3)", with the skin in diameters of
/// the largest particle, and NULL or an empty text for "verlet(streamed-nbs,skin=auto)". The other
/// arguments are those of contactbench_new; in a box a list decides in "exact" arithmetic alone.
///
/// # Safety
/// Texts end with a NUL; `made` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_tracker_new(
    tracker: *const c_char,
    arithmetic: *const c_char,
    threads: usize,
    memory_limit: u64,
    made: *mut *mut contactbench_tracker,
) -> c_int {
    done(|| {
        if made.is_null() {
            return Err(Failure::invalid("made is NULL; give a place for the tracker"));
        }
        // SAFETY: it is not null, and the caller's to be written to.
        unsafe { made.write(ptr::null_mut()) };
        // SAFETY: the caller promises that texts end.
        let (tracker, arithmetic) = unsafe { (text(tracker)?, text(arithmetic)?) };
        let spec = track::parse(tracker.unwrap_or(DEFAULT)).map_err(Failure::invalid)?;
        usable(spec.detector(), threads)?;
        let arithmetic = arithmetic.unwrap_or("exact").parse().map_err(Failure::invalid)?;
        let limit = if memory_limit == 0 { memory::default_limit() } else { memory_limit };
        let tracker = spec.make(Options { memory_limit: limit, threads });
        let search = Course { tracker, built: false };
        let worker = Worker { search, crew: crew(threads)?, answer: Answer::default() };
        let handle = Handle::new(worker, threads);
        let new = Box::new(contactbench_tracker { arithmetic, limit, handle });
        // SAFETY: as above.
        unsafe { made.write(Box::into_raw(new)) };
        Ok(())
    })
}

/// Frees a tracker with its list and contacts; nothing if it is NULL.
///
/// # Safety
/// It is NULL, or was made by contactbench_tracker_new and is not used any more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_tracker_free(tracker: *mut contactbench_tracker) {
    if !tracker.is_null() {
        // SAFETY: it was made by `Box::into_raw`, and the caller gives it up.
        drop(unsafe { Box::from_raw(tracker) });
    }
}

/// Finds the contacts of the next frame, as contactbench_contacts does. Radii, box and number of
/// particles may change from frame to frame; the list is then built again where it must be. After
/// an error the next frame is taken as the first.
///
/// # Safety
/// Tracker and scene are there, and the scene's numbers can be read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_tracker_step(
    tracker: *mut contactbench_tracker,
    scene: *const contactbench_scene,
) -> c_int {
    done(|| {
        // SAFETY: null, or one that was made and not freed.
        let Some(tracker) = (unsafe { tracker.as_ref() }) else {
            return Err(Failure::invalid(
                "the tracker is NULL; make one by contactbench_tracker_new",
            ));
        };
        let mut worker = tracker.handle.enter()?;
        let Worker { search, crew, answer } = &mut *worker;
        answer.clear();
        // SAFETY: what the caller promises of the scene.
        let given = unsafe { Given::new(scene) }?;
        let arithmetic = tracker.arithmetic;
        let loaded = Loaded::new(&given.scene, given.lattice, arithmetic)?;
        loaded.within(tracker.limit)?;
        let contacts = &mut answer.contacts;
        let step = by(crew, || match &loaded {
            Loaded::Open(scene) => {
                search.tracker.step(scene, arithmetic.test(), None, &mut contacts.plain)
            }
            Loaded::InBox(scene) => search.tracker.step_in_box(scene, arithmetic, None, contacts),
        });
        match step {
            Ok(step) => search.built = step.built,
            Err(refusal) => {
                answer.clear();
                return Err(refusal.into());
            }
        }
        answer.finish(given.lattice.is_some(), given.dim)
    })
}

/// Takes the next frame as the first: it may be of other particles, or far from the last one.
///
/// # Safety
/// The tracker is there.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_tracker_forget(tracker: *mut contactbench_tracker) -> c_int {
    done(|| {
        // SAFETY: null, or one that was made and not freed.
        let Some(tracker) = (unsafe { tracker.as_ref() }) else {
            return Err(Failure::invalid(
                "the tracker is NULL; make one by contactbench_tracker_new",
            ));
        };
        tracker.handle.enter()?.search.tracker.forget();
        Ok(())
    })
}

/// Whether the list was built in the last step: 1, or 0.
///
/// # Safety
/// The tracker is there, or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_tracker_built(tracker: *const contactbench_tracker) -> c_int {
    // SAFETY: null, or one that was made and not freed.
    let worker = unsafe { tracker.as_ref() }.and_then(|tracker| tracker.handle.enter().ok());
    worker.map_or(0, |worker| c_int::from(worker.search.built))
}

/// As contactbench_count, of the last frame.
///
/// # Safety
/// The tracker is there, or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_tracker_count(tracker: *const contactbench_tracker) -> usize {
    // SAFETY: null, or one that was made and not freed.
    let worker = unsafe { tracker.as_ref() }.and_then(|tracker| tracker.handle.enter().ok());
    worker.map_or(0, |worker| worker.answer.contacts.plain.len())
}

/// As contactbench_pairs, of the last frame.
///
/// # Safety
/// The tracker is there, or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_tracker_pairs(
    tracker: *const contactbench_tracker,
) -> *const u32 {
    // SAFETY: null, or one that was made and not freed.
    let worker = unsafe { tracker.as_ref() }.and_then(|tracker| tracker.handle.enter().ok());
    worker.map_or(ptr::null(), |worker| worker.answer.contacts.plain.as_flattened().as_ptr())
}

/// As contactbench_images, of the last frame.
///
/// # Safety
/// The tracker is there, or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_tracker_images(
    tracker: *const contactbench_tracker,
) -> *const i32 {
    // SAFETY: null, or one that was made and not freed.
    let worker = unsafe { tracker.as_ref() }.and_then(|tracker| tracker.handle.enter().ok());
    let boxed = worker.filter(|worker| worker.answer.boxed);
    boxed.map_or(ptr::null(), |worker| worker.answer.images.as_ptr())
}
