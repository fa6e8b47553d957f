//! Contacts for programs in C and in languages that can call C. `include/contactbench.h` is
//! generated from this file, and a test compares both.
#![allow(non_camel_case_types)]

mod given;
mod handle;
mod tracker;

use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char, c_int};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr;
use std::sync::Once;

use contactbench_detectors::oracle;
use contactbench_detectors::oracle::Errors;
use contactbench_detectors::oracle::loaded::{depth, truth};
use contactbench_detectors::spec;
use contactbench_detectors::table;
use contactbench_detectors::tracker::TrackerSpec;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::detect::Options;
use contactbench_ground::limits::memory;
use contactbench_ground::limits::refusal::reserve;
use contactbench_ground::periodic::ImagePair;
use contactbench_ground::periodic::Loaded;
use given::{Failure, Given, rows};
use handle::{Filled, Handle, pool};
pub use tracker::*;

/// The call succeeded.
pub const CONTACTBENCH_OK: c_int = 0;
/// An argument is invalid.
pub const CONTACTBENCH_INVALID: c_int = 1;
/// The call needs more memory than exists or is allowed.
pub const CONTACTBENCH_MEMORY: c_int = 2;
/// A defect of this library.
pub const CONTACTBENCH_DEFECT: c_int = 3;

/// A periodic box. Discs use the first two vectors.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct contactbench_box {
    /// Three vectors of any direction, one after the other.
    pub vectors: [f64; 9],
    /// Nonzero for each periodic vector; 0 for vectors to be ignored.
    pub periodic: [c_int; 3],
    /// The corner at which the vectors start. It does not affect exact contacts.
    pub origin: [f64; 3],
}

/// A scene. Its numbers must not change while a call reads them.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct contactbench_scene {
    /// Number of particles.
    pub n: usize,
    /// Dimension: 2 for discs, 3 for spheres.
    pub dim: c_int,
    /// Coordinates of the first centre, then of the next: n times dim numbers.
    pub x: *const f64,
    /// Number of radii: 1 if all particles share a radius, else n.
    pub radii: usize,
    /// Radii in the unit of the coordinates.
    pub r: *const f64,
    /// The periodic box; NULL for open space.
    pub bounds: *const contactbench_box,
}

/// Errors of a list of pairs, compared with the truth.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct contactbench_errors {
    /// Number of pairs that touch.
    pub contacts: u64,
    /// Touching pairs that are not listed.
    pub missed: u64,
    /// Listed pairs that do not touch.
    pub spurious: u64,
    /// Repeated pairs in the list.
    pub duplicate: u64,
    /// Listed pairs of a particle with itself.
    pub self_pairs: u64,
    /// The largest overlap of a missed pair, in mean radii of the two particles.
    pub deepest_miss: f64,
    /// The largest gap of a spurious pair, in mean radii of the two particles.
    pub widest_false: f64,
}

/// A detector that keeps its buffers, and the contacts of its last scene. Two searches at the same
/// time are an error; several threads may read the contacts between searches.
pub struct contactbench_detector(Handle);

thread_local! {
    static LAST: RefCell<CString> = RefCell::default();
}

/// Runs `work` and stores the reason if it fails.
fn done(work: impl FnOnce() -> Result<(), Failure>) -> c_int {
    static QUIET: Once = Once::new();
    // Panics are returned as codes with messages, so they are not printed.
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
    // Messages themselves contain no NUL, but they may quote arguments that do.
    let what = CString::new(what.replace('\0', " ")).unwrap_or_default();
    LAST.with(|last| *last.borrow_mut() = what);
    code
}

/// Returns the reason for the last failure in this thread, in one sentence. The text is valid until
/// the next failure.
#[unsafe(no_mangle)]
pub extern "C" fn contactbench_last_error() -> *const c_char {
    LAST.with(|last| last.borrow().as_ptr())
}

/// Creates a detector, to be freed by contactbench_free, and stores it in `made`; stores NULL on
/// failure.
///
/// `detector` is a name with parameters, as in "streamed-nbs:level=avx2"; NULL or an empty text
/// selects the recommended detector. `arithmetic` is "exact", "exact-open" (pairs touch at a
/// distance below ri + rj, not at it), "f64", "f32" or "textbook"; NULL or an empty
/// text selects "exact". `memory_limit` in bytes applies to the arrays and, separately, to the
/// pairs; 0 selects 4 GiB, or a quarter of the machine's memory if that is less.
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
    let spec = |text: Option<&str>| {
        let spec = spec::parse(text.unwrap_or(table::DEFAULT)).map_err(Failure::invalid)?;
        Ok(TrackerSpec::EveryStep(spec))
    };
    // SAFETY: promised by the caller.
    unsafe {
        create(made, contactbench_detector, (detector, spec), arithmetic, threads, memory_limit)
    }
}

type Parse = fn(Option<&str>) -> Result<TrackerSpec, Failure>;

/// Creates a detector or tracker: parses its name, and stores the handle in `made`.
///
/// # Safety
/// Texts are NULL or end with a NUL; `made` is NULL or can be written to.
unsafe fn create<T>(
    made: *mut *mut T,
    wrap: fn(Handle) -> T,
    (name, parse): (*const c_char, Parse),
    arithmetic: *const c_char,
    threads: usize,
    memory_limit: u64,
) -> c_int {
    done(|| {
        if made.is_null() {
            return Err(Failure::invalid("made is NULL; give a place for the result"));
        }
        // SAFETY: `made` is not null, and the caller promises that it can be written to.
        unsafe { made.write(ptr::null_mut()) };
        // SAFETY: the caller promises that texts end with a NUL.
        let (name, arithmetic) = unsafe { (text(name)?, self::arithmetic(arithmetic)?) };
        let spec = parse(name)?;
        spec.detector().usable(threads).map_err(Failure::invalid)?;
        let make = move |memory_limit| spec.make(Options { memory_limit, threads });
        let handle = Handle::new(arithmetic, memory_limit, threads, make)?;
        // SAFETY: `made` is not null, and the caller promises that it can be written to.
        unsafe { made.write(Box::into_raw(Box::new(wrap(handle)))) };
        Ok(())
    })
}

/// # Safety
/// The pointer is null, or the text ends with a NUL.
///
/// Returns `None` also for an empty text, because Fortran cannot pass NULL for a text.
unsafe fn text<'a>(text: *const c_char) -> Result<Option<&'a str>, Failure> {
    if text.is_null() {
        return Ok(None);
    }
    // SAFETY: the pointer is not null, and the caller promises that the text ends with a NUL.
    let text = unsafe { CStr::from_ptr(text) };
    let text = text.to_str().map_err(|_| Failure::invalid("a name is not valid UTF-8"))?;
    Ok(Some(text).filter(|text| !text.is_empty()))
}

/// # Safety
/// As for [`text`].
unsafe fn arithmetic(name: *const c_char) -> Result<Arithmetic, Failure> {
    // SAFETY: promised by the caller.
    let name = unsafe { text(name) }?;
    name.unwrap_or("exact").parse().map_err(Failure::invalid)
}

/// Frees a detector with its buffers and contacts; does nothing if it is NULL.
///
/// # Safety
/// The detector is NULL, or was created by contactbench_new and is not used any more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_free(detector: *mut contactbench_detector) {
    if !detector.is_null() {
        // SAFETY: `Box::into_raw` created the pointer, and the caller gives it up.
        drop(unsafe { Box::from_raw(detector) });
    }
}

/// Finds the contacts of a scene: the pairs with |xi - xj| <= ri + rj, and in a box also pairs of a
/// particle and an image. The numbers are read in place. Buffers are reused, so a further call for
/// a similar scene allocates next to nothing.
///
/// # Safety
/// Detector and scene exist, and the scene's numbers can be read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_contacts(
    detector: *mut contactbench_detector,
    scene: *const contactbench_scene,
) -> c_int {
    // SAFETY: the pointer is null, or a detector that was created and not freed; the caller
    // promises that the scene can be read.
    done(|| unsafe { there(detector.as_ref().map(|it| &it.0))?.contacts(scene) })
}

fn there(handle: Option<&Handle>) -> Result<&Handle, Failure> {
    handle.ok_or_else(|| {
        Failure::invalid("the handle is NULL; make one by contactbench_new or ..._tracker_new")
    })
}

/// Returns the number of contacts of the last scene; 0 if the search for them failed.
///
/// # Safety
/// The detector exists or is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_count(detector: *const contactbench_detector) -> usize {
    // SAFETY: the pointer is null, or a detector that was created and not freed.
    look(unsafe { detector.as_ref() }.map(|it| &it.0), |answer| answer.pairs().len(), 0)
}

/// Returns the pairs of the last scene: two particle numbers each, from 0, the smaller first. Each
/// pair occurs once (in a box once per image), in no particular order. The pointer is valid until
/// the next search with this detector.
///
/// # Safety
/// The detector exists or is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_pairs(detector: *const contactbench_detector) -> *const u32 {
    // SAFETY: the pointer is null, or a detector that was created and not freed.
    look(unsafe { detector.as_ref() }.map(|it| &it.0), Filled::pairs_ptr, ptr::null())
}

/// Returns the images of the pairs in a box: dim integers each. The first particle touches the
/// second one shifted by this many vectors of the box. NULL in open space. The pointer is valid
/// until the next search with this detector.
///
/// # Safety
/// The detector exists or is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_images(detector: *const contactbench_detector) -> *const i32 {
    // SAFETY: the pointer is null, or a detector that was created and not freed.
    look(unsafe { detector.as_ref() }.map(|it| &it.0), Filled::images_ptr, ptr::null())
}

/// Returns a part of the answer, or `absent` if there is no handle or no answer.
fn look<R>(handle: Option<&Handle>, part: fn(&Filled) -> R, absent: R) -> R {
    handle.and_then(|handle| handle.look(part)).unwrap_or(absent)
}

/// Compares a list of `count` pairs, of particles numbered from 0, with the exact truth. The truth
/// comes from testing all pairs or, for many particles, from detectors that agree. In a box
/// `images` has dim numbers per pair, like contactbench_images; in open space it is NULL.
/// `arithmetic` is as for contactbench_new: a neighbour list is right in "exact-open".
///
/// # Safety
/// Scene and lists can be read, texts end with a NUL, `errors` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn contactbench_verify(
    scene: *const contactbench_scene,
    arithmetic: *const c_char,
    count: usize,
    pairs: *const u32,
    images: *const i32,
    errors: *mut contactbench_errors,
) -> c_int {
    done(|| {
        if errors.is_null() {
            return Err(Failure::invalid("errors is NULL; give a place for them"));
        }
        // SAFETY: promised by the caller.
        let (given, arithmetic) = unsafe { (Given::new(scene)?, self::arithmetic(arithmetic)?) };
        if given.lattice.is_some() == images.is_null() && count > 0 {
            return Err(Failure::invalid(
                "give images for a scene in a box, and NULL in open space",
            ));
        }
        // SAFETY: promised by the caller.
        let pairs: &[[u32; 2]] = unsafe { rows(pairs, count, 2, "pairs") }?.as_chunks().0;
        let n = given.scene.len();
        if let Some([i, j]) = pairs.iter().find(|pair| pair[0].max(pair[1]) as usize >= n) {
            return Err(Failure::invalid(format!(
                "the list has the pair {i},{j}, and there are {n} particles, numbered from 0"
            )));
        }
        let images = match given.lattice {
            // SAFETY: promised by the caller.
            Some(_) => unsafe { rows(images, count, given.scene.dim(), "images") }?,
            None => &[],
        };
        // The comparison runs on one thread, since only the caller may decide to use more.
        let found = pool(1)?.install(|| held(&given, arithmetic, pairs, images))?;
        // SAFETY: `errors` is not null, and the caller promises that it can be written to.
        unsafe { errors.write(found) };
        Ok(())
    })
}

fn held(
    given: &Given<'_>,
    arithmetic: Arithmetic,
    pairs: &[[u32; 2]],
    images: &[i32],
) -> Result<contactbench_errors, Failure> {
    let limit = memory::limit_for(given.scene.len());
    let loaded = Loaded::new(&given.scene, given.lattice, arithmetic)?;
    let (truth, dim) = (truth(&loaded, arithmetic, limit)?.pairs, given.scene.dim());
    let mut listed = Vec::new();
    reserve(&mut listed, pairs.len())?;
    listed.extend(pairs.iter().enumerate().map(|(k, &[i, j])| {
        let image = images.get(k * dim..(k + 1) * dim).unwrap_or_default();
        let along = |axis| image.get(axis).copied().unwrap_or(0);
        ImagePair::new(i, j, std::array::from_fn(along))
    }));
    listed.sort_unstable();
    let of_itself = |pair: ImagePair| pair.i == pair.j && pair.image == [0; 3];
    let found = oracle::compare_by(&listed, &truth, of_itself, |pair| depth(&loaded, pair));
    let Errors { missed, spurious, duplicate, self_pairs, deepest_miss, widest_false } = found;
    Ok(contactbench_errors {
        contacts: truth.len() as u64,
        missed,
        spurious,
        duplicate,
        self_pairs,
        deepest_miss,
        widest_false,
    })
}
