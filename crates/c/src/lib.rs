//! Contacts for programs in C, and in languages that can call it. What its users read is
//! `include/contactbench.h`, which is made from this file; a test holds them equal.
#![allow(non_camel_case_types)]

mod given;
mod handle;
mod tracker;

use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char, c_int};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr;
use std::sync::Once;

use contactbench_core::contact::Arithmetic;
use contactbench_core::detect::spec::{self, DetectorSpec, SpecError};
use contactbench_core::detect::{Options, table};
use contactbench_core::memory;
use contactbench_core::oracle::{self, Errors};
use contactbench_core::periodic::{self, Contacts, ImagePair};
use contactbench_core::refusal::reserve;
use contactbench_core::searcher::{Loaded, Searcher};
use given::{Failure, Given, rows};
use handle::{Answer, Handle, pool};
pub use tracker::*;

/// All is well.
pub const CONTACTBENCH_OK: c_int = 0;
/// Something is wrong with what was given.
pub const CONTACTBENCH_INVALID: c_int = 1;
/// It would take more memory than there is, or than may be used.
pub const CONTACTBENCH_MEMORY: c_int = 2;
/// A defect of this library.
pub const CONTACTBENCH_DEFECT: c_int = 3;

/// A box in which a scene repeats. Discs use the first two vectors.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct contactbench_box {
    /// Three vectors, one after the other, of any direction.
    pub vectors: [f64; 9],
    /// Along which of them the scene repeats, if not 0. The others decide nothing.
    pub periodic: [c_int; 3],
    /// The corner from which they start. It decides no exact contact.
    pub origin: [f64; 3],
}

/// A scene. Nobody may write to its numbers while a call reads them.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct contactbench_scene {
    /// How many particles there are.
    pub n: usize,
    /// 2 for discs, 3 for spheres.
    pub dim: c_int,
    /// Coordinates of the first centre, then of the next: n times dim numbers.
    pub x: *const f64,
    /// How many radii there are: 1 for all particles, or n.
    pub radii: usize,
    /// The radii, in the unit of the coordinates.
    pub r: *const f64,
    /// The box; NULL for open space.
    pub bounds: *const contactbench_box,
}

/// What a list of pairs misses and adds, against the truth.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct contactbench_errors {
    /// Pairs that touch.
    pub contacts: u64,
    /// Of them, those that are not listed.
    pub missed: u64,
    /// Listed pairs that do not touch.
    pub spurious: u64,
    /// Pairs that are listed again.
    pub duplicate: u64,
    /// Particles that are listed with themselves.
    pub self_pairs: u64,
    /// The largest overlap among those missed, in mean radii of the two.
    pub deepest_miss: f64,
    /// The widest gap among the spurious ones, in mean radii of the two.
    pub widest_false: f64,
}

/// A detector that keeps its buffers, and the contacts of its last scene. Two searches at the same
/// time are an error; several threads may read the contacts between searches.
pub struct contactbench_detector {
    arithmetic: Arithmetic,
    handle: Handle<Searcher>,
}

thread_local! {
    static LAST: RefCell<CString> = RefCell::default();
}

/// Runs the work, and stores the reason if it fails.
fn done(work: impl FnOnce() -> Result<(), Failure>) -> c_int {
    static QUIET: Once = Once::new();
    // Panics become codes and sentences.
    QUIET.call_once(|| std::panic::set_hook(Box::new(|_| {})));
    let failed = match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(())) => return CONTACTBENCH_OK,
        Ok(Err(failure)) => failure,
        Err(cause) => Failure::defect(cause.as_ref()),
    };
    let (code, what) = match failed {
        Failure::Invalid(what) => (CONTACTBENCH_INVALID, what),
        Failure::Memory(what) => (CONTACTBENCH_MEMORY, what),
        Failure::Defect(what) => (CONTACTBENCH_DEFECT, what),
    };
    // Messages have no NUL; what is given in them may.
    let what = CString::new(what.replace('\0', " ")).unwrap_or_default();
    LAST.with(|last| *last.borrow_mut() = what);
    code
}

/// Why the last call of this thread that failed did so, in one sentence; until the next that
/// fails.
#[unsafe(no_mangle)]
pub extern "C" fn contactbench_last_error() -> *const c_char {
    LAST.with(|last| last.borrow().as_ptr())
}

/// Makes a detector, to be freed by contactbench_free, and puts it into `made`; NULL where it
/// fails.
///
/// `detector` is a name with parameters, as in "streamed-nbs:level=avx2", and NULL or an empty text
/// for the one to take without a reason for another. `arithmetic` is "exact", "f64", "f32",
/// "f32-cell" or "textbook", and NULL or an empty text for "exact". `memory_limit` is in bytes, for
/// its arrays and as many for pairs; 0 for 4 GiB, or a quarter of the machine's memory if that is
/// less.
///
/// # Safety
/// Texts end with a NUL; `made` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_new(
    detector: *const c_char,
    arithmetic: *const c_char,
    threads: usize,
    memory_limit: u64,
    made: *mut *mut contactbench_detector,
) -> c_int {
    done(|| {
        if made.is_null() {
            return Err(Failure::invalid("made is NULL; give a place for the detector"));
        }
        // SAFETY: it is not null, and the caller's to be written to.
        unsafe { made.write(ptr::null_mut()) };
        // SAFETY: the caller promises that texts end.
        let (detector, arithmetic) = unsafe { (text(detector)?, text(arithmetic)?) };
        let spec = spec::parse(detector.unwrap_or(table::DEFAULT)).map_err(Failure::invalid)?;
        let arithmetic: Arithmetic =
            arithmetic.unwrap_or("exact").parse().map_err(Failure::invalid)?;
        usable(&spec, threads)?;
        let make = move |memory_limit| Searcher::new(&spec, Options { memory_limit, threads });
        let handle = Handle::new(arithmetic, memory_limit, threads, make)?;
        let new = Box::new(contactbench_detector { arithmetic, handle });
        // SAFETY: as above.
        unsafe { made.write(Box::into_raw(new)) };
        Ok(())
    })
}

/// Refuses controls, and detectors that cannot use this many threads.
fn usable(spec: &DetectorSpec, threads: usize) -> Result<(), Failure> {
    if spec.entry.is_control() {
        return Err(Failure::invalid(SpecError::Unknown { name: spec.entry.name.into() }));
    }
    if threads > 1 && !spec.entry.threads || !(1..=1024).contains(&threads) {
        return Err(Failure::invalid(format!(
            "{} cannot use {threads} threads; give 1, or with streamed-nbs, cell-grid and direct \
             up to 1024",
            spec.entry.name
        )));
    }
    Ok(())
}

/// # Safety
/// It is null, or ends with a NUL.
///
/// An empty text is none, since Fortran has no NULL for one.
unsafe fn text<'a>(text: *const c_char) -> Result<Option<&'a str>, Failure> {
    if text.is_null() {
        return Ok(None);
    }
    // SAFETY: it is not null, and the caller promises that it ends.
    let text = unsafe { CStr::from_ptr(text) };
    let text = text.to_str().map_err(|_| Failure::invalid("a name is not of UTF-8"))?;
    Ok(Some(text).filter(|text| !text.is_empty()))
}

/// Frees a detector with its buffers and contacts; nothing if it is NULL.
///
/// # Safety
/// It is NULL, or was made by contactbench_new and is not used any more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_free(detector: *mut contactbench_detector) {
    if !detector.is_null() {
        // SAFETY: it was made by `Box::into_raw`, and the caller gives it up.
        drop(unsafe { Box::from_raw(detector) });
    }
}

/// Finds the contacts of a scene: the pairs with |xi - xj| <= ri + rj, and in a box those of
/// particles with images. The numbers are read in place. A call for a scene like the one before
/// allocates next to nothing.
///
/// # Safety
/// Detector and scene are there, and the scene's numbers can be read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_contacts(
    detector: *mut contactbench_detector,
    scene: *const contactbench_scene,
) -> c_int {
    done(|| {
        // SAFETY: null, or one that was made and not freed.
        let Some(detector) = (unsafe { detector.as_ref() }) else {
            return Err(Failure::invalid("the detector is NULL; make one by contactbench_new"));
        };
        let find = |search: &mut Searcher, scene: &Loaded<'_>, contacts: &mut Contacts| {
            search.list(scene, detector.arithmetic, contacts).map(|()| false)
        };
        // SAFETY: what the caller promises of the scene.
        unsafe { detector.handle.contacts(scene, find) }
    })
}

/// How many contacts the last scene has; 0 if the call failed.
///
/// # Safety
/// The detector is there, or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_count(detector: *const contactbench_detector) -> usize {
    // SAFETY: null, or one that was made and not freed.
    let answer = unsafe { detector.as_ref() }.map(|it| &it.handle);
    answer.and_then(|it| it.look(|answer| answer.pairs().len())).unwrap_or(0)
}

/// The pairs of the last scene: two numbers of particles for each, from 0, the smaller first; each
/// pair once (in a box once for each image), in no particular order. The pointer is valid until the
/// next search with this detector.
///
/// # Safety
/// The detector is there, or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_pairs(detector: *const contactbench_detector) -> *const u32 {
    // SAFETY: null, or one that was made and not freed.
    pairs_of(unsafe { detector.as_ref() }.map(|it| &it.handle))
}

/// In a box the images of the pairs: dim whole numbers for each, so that the first particle touches
/// the second one moved by this many vectors of the box. NULL in open space. The pointer is valid
/// until the next search with this detector.
///
/// # Safety
/// The detector is there, or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_images(detector: *const contactbench_detector) -> *const i32 {
    // SAFETY: null, or one that was made and not freed.
    images_of(unsafe { detector.as_ref() }.map(|it| &it.handle))
}

fn pairs_of<S: Send>(handle: Option<&Handle<S>>) -> *const u32 {
    let pairs = |answer: &Answer| answer.pairs().as_flattened().as_ptr();
    handle.and_then(|handle| handle.look(pairs)).unwrap_or(ptr::null())
}

fn images_of<S: Send>(handle: Option<&Handle<S>>) -> *const i32 {
    let images = |answer: &Answer| answer.images().map(<[i32]>::as_ptr);
    handle.and_then(|handle| handle.look(images)?).unwrap_or(ptr::null())
}

/// Holds a list of `count` pairs, of particles numbered from 0, to the exact truth, which is found
/// by testing all pairs, or, of many particles, by detectors that agree. In a box `images` has dim
/// numbers for each pair, as contactbench_images gives them; in open space it is NULL.
///
/// # Safety
/// Scene and lists can be read, `errors` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_verify(
    scene: *const contactbench_scene,
    count: usize,
    pairs: *const u32,
    images: *const i32,
    errors: *mut contactbench_errors,
) -> c_int {
    done(|| {
        if errors.is_null() {
            return Err(Failure::invalid("errors is NULL; give a place for them"));
        }
        // SAFETY: what the caller promises of the scene.
        let given = unsafe { Given::new(scene) }?;
        if given.lattice.is_some() == images.is_null() && count > 0 {
            return Err(Failure::invalid(
                "images are given for scenes in boxes, and for no others",
            ));
        }
        // SAFETY: what the caller promises of the lists.
        let pairs: &[[u32; 2]] = unsafe { rows(pairs, count, 2, "pairs") }?.as_chunks().0;
        let n = given.scene.len();
        if let Some([i, j]) = pairs.iter().find(|pair| pair[0].max(pair[1]) as usize >= n) {
            return Err(Failure::invalid(format!(
                "the list has the pair {i},{j}, and there are {n} particles, numbered from 0"
            )));
        }
        let images = match given.lattice {
            // SAFETY: as above.
            Some(_) => unsafe { rows(images, count, given.dim, "images") }?,
            None => &[],
        };
        // On one thread: more are the caller's to start.
        let found = pool(1)?.install(|| held(&given, pairs, images))?;
        // SAFETY: it is not null, and the caller's to be written to.
        unsafe { errors.write(found) };
        Ok(())
    })
}

fn held(
    given: &Given<'_>,
    pairs: &[[u32; 2]],
    images: &[i32],
) -> Result<contactbench_errors, Failure> {
    let limit = memory::limit_for(given.scene.len());
    let loaded = Loaded::new(&given.scene, given.lattice, Arithmetic::Exact)?;
    let (contacts, found) = match &loaded {
        Loaded::Open(scene) => {
            let truth = oracle::truth_as_stored(scene, Arithmetic::Exact.test(), limit)?.pairs;
            let mut pairs = copied(pairs.iter().copied())?;
            contactbench_core::sink::normalise(&mut pairs);
            (truth.len(), oracle::compare(&pairs, &truth, scene))
        }
        Loaded::InBox(scene) => {
            let truth = periodic::truth(scene, Arithmetic::Exact, limit)?.pairs;
            let named = pairs.iter().zip(images.chunks(given.dim));
            let mut pairs = copied(named.map(|(&[i, j], image)| {
                let at = |k| image.get(k).copied().unwrap_or(0);
                ImagePair::new(i, j, std::array::from_fn(at))
            }))?;
            pairs.sort_unstable();
            let of_itself = |pair: ImagePair| pair.i == pair.j && pair.image == [0; 3];
            let depth = |pair| periodic::depth(scene, pair);
            (truth.len(), oracle::compare_by(&pairs, &truth, of_itself, depth))
        }
    };
    let Errors { missed, spurious, duplicate, self_pairs, deepest_miss, widest_false } = found;
    let contacts = contacts as u64;
    Ok(contactbench_errors {
        contacts,
        missed,
        spurious,
        duplicate,
        self_pairs,
        deepest_miss,
        widest_false,
    })
}

fn copied<T>(pairs: impl ExactSizeIterator<Item = T>) -> Result<Vec<T>, Failure> {
    let mut copy = Vec::new();
    reserve(&mut copy, pairs.len())?;
    copy.extend(pairs);
    Ok(copy)
}
