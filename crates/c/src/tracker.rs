//! Contacts of particles that move, by a kept list of near pairs.

use std::ffi::{c_char, c_int};
use std::ptr;

use contactbench_core::contact::Arithmetic;
use contactbench_core::detect::Options;
use contactbench_core::periodic::Contacts;
use contactbench_core::searcher::Loaded;
use contactbench_core::track::{self, Tracker};

use crate::given::Failure;
use crate::handle::Handle;
use crate::{contactbench_scene, done, images_of, pairs_of, text, usable};

/// The tracker to take without a reason for another.
const DEFAULT: &str = "verlet(streamed-nbs,skin=auto)";

/// A list of near pairs that is kept from frame to frame (a Verlet list), and the contacts of its
/// last frame. Two steps at the same time are an error; several threads may read the contacts
/// between steps.
pub struct contactbench_tracker {
    arithmetic: Arithmetic,
    handle: Handle<Box<dyn Tracker>>,
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
        let arithmetic: Arithmetic =
            arithmetic.unwrap_or("exact").parse().map_err(Failure::invalid)?;
        let make = move |memory_limit| spec.make(Options { memory_limit, threads });
        let handle = Handle::new(arithmetic, memory_limit, threads, make)?;
        let new = Box::new(contactbench_tracker { arithmetic, handle });
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
        let tracker = unsafe { there(tracker) }?;
        let arithmetic = tracker.arithmetic;
        let step = |search: &mut Box<dyn Tracker>, scene: &Loaded<'_>, contacts: &mut Contacts| {
            search.find(scene.frame(arithmetic), None, contacts).map(|step| step.built)
        };
        // SAFETY: what the caller promises of the scene.
        unsafe { tracker.handle.contacts(scene, step) }
    })
}

/// # Safety
/// It is null, or was made and not freed.
unsafe fn there<'a>(
    tracker: *mut contactbench_tracker,
) -> Result<&'a contactbench_tracker, Failure> {
    // SAFETY: the caller's promise.
    unsafe { tracker.as_ref() }.ok_or_else(|| {
        Failure::invalid("the tracker is NULL; make one by contactbench_tracker_new")
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
        let tracker = unsafe { there(tracker) }?;
        tracker.handle.search(|search, _, _| {
            search.forget();
            Ok(())
        })
    })
}

/// Whether the list was built in the last step: 1, or 0.
///
/// # Safety
/// The tracker is there, or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_tracker_built(tracker: *const contactbench_tracker) -> c_int {
    // SAFETY: null, or one that was made and not freed.
    let tracker = unsafe { tracker.as_ref() };
    let built = tracker.and_then(|it| it.handle.look(|answer| answer.built));
    built.map_or(0, c_int::from)
}

/// As contactbench_count, of the last frame.
///
/// # Safety
/// The tracker is there, or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_tracker_count(tracker: *const contactbench_tracker) -> usize {
    // SAFETY: null, or one that was made and not freed.
    let tracker = unsafe { tracker.as_ref() };
    tracker.and_then(|it| it.handle.look(|answer| answer.pairs().len())).unwrap_or(0)
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
    pairs_of(unsafe { tracker.as_ref() }.map(|it| &it.handle))
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
    images_of(unsafe { tracker.as_ref() }.map(|it| &it.handle))
}
