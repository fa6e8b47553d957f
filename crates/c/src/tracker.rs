//! Contacts of moving particles, with a list of near pairs that is kept between frames.

use std::ffi::{c_char, c_int};
use std::ptr;

use contactbench_detectors::tracker;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::detect::Options;
use contactbench_ground::periodic::ContactList;
use contactbench_ground::periodic::Loaded;
use contactbench_lists::track::Tracker;

use crate::given::Failure;
use crate::handle::Handle;
use crate::{contactbench_scene, done, images_of, pairs_of, text, usable};

const DEFAULT: &str = "verlet(streamed-nbs,skin=auto)";

/// A list of near pairs that is kept between frames (a Verlet list), and the contacts of its last
/// frame. Two steps at the same time are an error; several threads may read the contacts between
/// steps.
pub struct contactbench_tracker {
    arithmetic: Arithmetic,
    handle: Handle<Box<dyn Tracker>>,
}

/// Creates a tracker, to be freed by contactbench_tracker_free, and stores it in `made`; stores
/// NULL on failure.
///
/// `tracker` is a text such as "verlet(streamed-nbs,rule=top-two,skin=0.3)", with the skin in
/// diameters of the largest particle; NULL or an empty text selects
/// "verlet(streamed-nbs,skin=auto)". The other arguments are those of contactbench_new; a list in a
/// box requires "exact" or "exact-open" arithmetic.
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
        // SAFETY: `made` is not null, and the caller promises that it can be written to.
        unsafe { made.write(ptr::null_mut()) };
        // SAFETY: the caller promises that texts end with a NUL.
        let (tracker, arithmetic) = unsafe { (text(tracker)?, super::arithmetic(arithmetic)?) };
        let spec = tracker::parse(tracker.unwrap_or(DEFAULT)).map_err(Failure::invalid)?;
        usable(spec.detector(), threads)?;
        let make = move |memory_limit| spec.make(Options { memory_limit, threads });
        let handle = Handle::new(arithmetic, memory_limit, threads, make)?;
        let new = Box::new(contactbench_tracker { arithmetic, handle });
        // SAFETY: `made` is not null, and the caller promises that it can be written to.
        unsafe { made.write(Box::into_raw(new)) };
        Ok(())
    })
}

/// Frees a tracker with its list and contacts; does nothing if it is NULL.
///
/// # Safety
/// The tracker is NULL, or was created by contactbench_tracker_new and is not used any more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_tracker_free(tracker: *mut contactbench_tracker) {
    if !tracker.is_null() {
        // SAFETY: `Box::into_raw` created the pointer, and the caller gives it up.
        drop(unsafe { Box::from_raw(tracker) });
    }
}

/// Finds the contacts of the next frame, as contactbench_contacts does. Radii, box and number of
/// particles may change between frames; the list is then rebuilt if necessary. After an error the
/// next frame counts as the first.
///
/// # Safety
/// Tracker and scene exist, and the scene's numbers can be read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_tracker_step(
    tracker: *mut contactbench_tracker,
    scene: *const contactbench_scene,
) -> c_int {
    done(|| {
        // SAFETY: the pointer is null, or a tracker that was created and not freed.
        let tracker = unsafe { there(tracker) }?;
        let arithmetic = tracker.arithmetic;
        let step =
            |search: &mut Box<dyn Tracker>, scene: &Loaded<'_>, contacts: &mut ContactList| {
                search.find(scene.frame(arithmetic), None, contacts).map(|step| step.built)
            };
        // SAFETY: promised by the caller.
        unsafe { tracker.handle.contacts(scene, step) }
    })
}

/// # Safety
/// The pointer is null, or points to a tracker that was created and not freed.
unsafe fn there<'a>(
    tracker: *mut contactbench_tracker,
) -> Result<&'a contactbench_tracker, Failure> {
    // SAFETY: promised by the caller.
    unsafe { tracker.as_ref() }.ok_or_else(|| {
        Failure::invalid("the tracker is NULL; make one by contactbench_tracker_new")
    })
}

/// Makes the next frame count as the first. Useful before a frame of other particles or a large
/// jump.
///
/// # Safety
/// The tracker exists.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_tracker_forget(tracker: *mut contactbench_tracker) -> c_int {
    done(|| {
        // SAFETY: the pointer is null, or a tracker that was created and not freed.
        let tracker = unsafe { there(tracker) }?;
        tracker.handle.search(|search, _, _| {
            search.forget();
            Ok(())
        })
    })
}

/// Returns 1 if the last step built the list, else 0.
///
/// # Safety
/// The tracker exists or is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_tracker_built(tracker: *const contactbench_tracker) -> c_int {
    // SAFETY: the pointer is null, or a tracker that was created and not freed.
    let tracker = unsafe { tracker.as_ref() };
    let built = tracker.and_then(|it| it.handle.look(|answer| answer.built));
    built.map_or(0, c_int::from)
}

/// Does what contactbench_count does, for the last frame of this tracker.
///
/// # Safety
/// The tracker exists or is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_tracker_count(tracker: *const contactbench_tracker) -> usize {
    // SAFETY: the pointer is null, or a tracker that was created and not freed.
    let tracker = unsafe { tracker.as_ref() };
    tracker.and_then(|it| it.handle.look(|answer| answer.pairs().len())).unwrap_or(0)
}

/// Does what contactbench_pairs does, for the last frame of this tracker.
///
/// # Safety
/// The tracker exists or is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_tracker_pairs(
    tracker: *const contactbench_tracker,
) -> *const u32 {
    // SAFETY: the pointer is null, or a tracker that was created and not freed.
    pairs_of(unsafe { tracker.as_ref() }.map(|it| &it.handle))
}

/// Does what contactbench_images does, for the last frame of this tracker.
///
/// # Safety
/// The tracker exists or is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_tracker_images(
    tracker: *const contactbench_tracker,
) -> *const i32 {
    // SAFETY: the pointer is null, or a tracker that was created and not freed.
    images_of(unsafe { tracker.as_ref() }.map(|it| &it.handle))
}
