//! Contacts of moving particles, with a list of near pairs that is kept between frames.

use std::ffi::{c_char, c_int};
use std::ptr;

use contactbench_detectors::tracker;

use crate::given::Failure;
use crate::handle::{Filled, Handle};
use crate::{contactbench_scene, create, done, look, there};

const DEFAULT: &str = "verlet(streamed-nbs,skin=auto)";

/// A list of near pairs that is kept between frames (a Verlet list), and the contacts of its last
/// frame. Two steps at the same time are an error; several threads may read the contacts between
/// steps.
pub struct contactbench_tracker(Handle);

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
    let spec =
        |text: Option<&str>| tracker::parse(text.unwrap_or(DEFAULT)).map_err(Failure::invalid);
    // SAFETY: promised by the caller.
    unsafe {
        create(made, contactbench_tracker, (tracker, spec), arithmetic, threads, memory_limit)
    }
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
    // SAFETY: the pointer is null, or a tracker that was created and not freed; the caller promises
    // that the scene can be read.
    done(|| unsafe { there(tracker.as_ref().map(|it| &it.0))?.contacts(scene) })
}

/// Makes the next frame count as the first. Useful before a frame of other particles or a large
/// jump.
///
/// # Safety
/// The tracker exists.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_tracker_forget(tracker: *mut contactbench_tracker) -> c_int {
    // SAFETY: the pointer is null, or a tracker that was created and not freed.
    let tracker = unsafe { tracker.as_ref() }.map(|it| &it.0);
    done(|| {
        there(tracker)?.search(|search, _, _| {
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
    look(unsafe { tracker.as_ref() }.map(|it| &it.0), |answer| c_int::from(answer.built), 0)
}

/// Does what contactbench_count does, for the last frame of this tracker.
///
/// # Safety
/// The tracker exists or is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_tracker_count(tracker: *const contactbench_tracker) -> usize {
    // SAFETY: the pointer is null, or a tracker that was created and not freed.
    look(unsafe { tracker.as_ref() }.map(|it| &it.0), |answer| answer.pairs().len(), 0)
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
    look(unsafe { tracker.as_ref() }.map(|it| &it.0), Filled::pairs_ptr, ptr::null())
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
    look(unsafe { tracker.as_ref() }.map(|it| &it.0), Filled::images_ptr, ptr::null())
}
