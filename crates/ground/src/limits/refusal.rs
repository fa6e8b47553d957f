//! Refusals: why a detector cannot work on a scene, with the limit and a remedy.

use std::any::Any;

use super::pages;
use crate::scene::SceneError;

/// Why a detector cannot work on a scene. No contact was reported, and arrays of predictable size
/// were not allocated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs)] // the fields are explained by the messages
pub enum Refusal {
    /// The detector's arrays would exceed the memory limit.
    #[error(
        "{detector} needs {needed} bytes for this scene ({shape}), the limit is {limit} bytes; \
         raise the memory limit, or use another detector: sorting needs the least memory, direct \
         needs none"
    )]
    Memory { detector: &'static str, needed: u64, limit: u64, shape: String },
    /// There are more pairs than a list may hold. All pairs were counted.
    #[error(
        "{particles} particles have {found} touching pairs, {} each, more than a list of \
         {room} bytes holds; are the radii in another unit than the coordinates, or are particles \
         given twice? If not, raise the memory limit",
        count(2.0 * *found as f64 / *particles as f64)
    )]
    Pairs { found: u64, particles: u64, room: u64 },
    /// There will be more pairs than a list may hold, according to a sample of particles.
    #[error(
        "each of the {particles} particles touches about {} others: about {:.1e} pairs, more than \
         a list of {limit} bytes holds; are the radii in another unit than the coordinates, or are \
         particles given twice? If not, raise the memory limit",
        count(*each), 0.5 * each * *particles as f64
    )]
    Crowd { particles: u64, each: f64, limit: u64 },
    /// There are too many cells along an axis to number them.
    #[error(
        "the scene spans {cells:.3e} cells of edge {edge:e} along {axis} ({low:e} to {high:e}), \
         and a grid can address 2^31; remove far-away particles, or use kd-tree"
    )]
    Domain { axis: &'static str, low: f64, high: f64, edge: f64, cells: f64 },
    /// The largest difference of two coordinates along an axis overflows.
    #[error(
        "along {axis} the scene extends from {low:e} to {high:e}, and this difference overflows; \
         scale the scene down, or use kd-tree"
    )]
    Extent { axis: &'static str, low: f64, high: f64 },
    /// There are more particles than the detector's lists can number.
    #[error("{detector} can number at most {limit} particles, the scene has {n}; use direct")]
    Particles { detector: &'static str, n: u64, limit: u64 },
    /// The square of a diameter overflows in the selected arithmetic.
    #[error(
        "the square of the largest diameter {diameter:e} overflows in {precision}; use \
         exact arithmetic, or scale the scene down"
    )]
    Overflow { diameter: f64, precision: &'static str },
    /// The processor lacks the selected vector instructions.
    #[error(
        "this processor lacks the instructions for level={level} and has only {}; leave out level \
         to use the widest", has.join(" and ")
    )]
    Instructions { level: String, has: Vec<&'static str> },
    /// A periodic box has more images within reach of its particles than the limit allows.
    #[error(
        "the {particles} particles have about {images:.1e} images within reach ({reach:e}) in and \
         around the box, which take {needed:.1e} bytes, and the limit is {limit} bytes; {}raise \
         the memory limit",
        if *images > MANY * *particles as f64 {
            "is the box in another unit than the radii? If not, "
        } else {
            ""
        }
    )]
    Images { particles: u64, images: f64, reach: f64, needed: f64, limit: u64 },
    /// The system refused to allocate memory that the limit allows.
    #[error(
        "{bytes} bytes of memory could not be allocated; close other programs, or use fewer \
         particles"
    )]
    Exhausted { bytes: u64 },
    /// A particle is so far from its periodic box that its image has no number.
    #[error(
        "particle {particle} is {} boxes away from the periodic box along its vector {}, \
         and images are numbered below 2^29; move the particle into the box, or fix the box",
        if boxes.is_finite() { format!("{boxes:e}") } else { "over 1e308".into() },
        vector + 1
    )]
    Away { particle: u32, vector: usize, boxes: f64 },
    /// The vectors of a periodic box are nearly coplanar.
    #[error(
        "the box is too skewed along vector {}, or its numbers are too small, to separate its \
         images in f64; use shorter vectors of the same lattice, or scale the scene up",
        vector + 1
    )]
    Skewed { vector: usize },
    /// The images of a periodic box have coordinates beyond the largest double.
    #[error(
        "images of the periodic box are beyond the largest number of f64; scale the scene down"
    )]
    Range,
    /// The images of a periodic box do not fit the storage of an arithmetic.
    #[error(
        "with its images the scene cannot be stored for {arithmetic}: {error}; use exact arithmetic"
    )]
    Stored { arithmetic: &'static str, error: SceneError },
    /// Particles that are enlarged by half a skin overflow f64.
    #[error(
        "with a skin of {skin:e}, particles of diameter {diameter:e} overflow f64; use a smaller \
         skin, or scale the scene down"
    )]
    Skin { skin: f64, diameter: f64 },
    /// More pairs are at most a skin apart than a list may hold.
    #[error(
        "{particles} particles have {found} pairs within a skin of {skin:e}, more than a list of \
         {room} bytes holds; use a smaller skin, or raise the memory limit"
    )]
    Listed { found: u64, particles: u64, room: u64, skin: f64 },
    /// A list that is kept in a periodic box requires exact arithmetic.
    #[error(
        "in a periodic box a kept list works in exact arithmetic, not in {arithmetic}, whose \
         contacts depend on the images of each frame; use exact, or the tracker every-step"
    )]
    Rounded { arithmetic: &'static str },
}

impl Refusal {
    /// Returns the refusal of a detector with the name of another one that delegates to it.
    pub fn of(self, name: &'static str) -> Refusal {
        match self {
            Refusal::Memory { needed, limit, shape, .. } => {
                Refusal::Memory { detector: name, needed, limit, shape }
            }
            other => other,
        }
    }

    /// Returns whether a lack of memory or a memory limit is the reason.
    pub fn is_of_memory(&self) -> bool {
        matches!(
            self,
            Refusal::Memory { .. }
                | Refusal::Pairs { .. }
                | Refusal::Crowd { .. }
                | Refusal::Images { .. }
                | Refusal::Listed { .. }
                | Refusal::Exhausted { .. }
        )
    }

    /// Returns whether every detector would refuse the scene: too many pairs or images, an invalid
    /// box, or too little memory.
    pub fn is_of_scene(&self) -> bool {
        matches!(
            self,
            Refusal::Pairs { .. }
                | Refusal::Crowd { .. }
                | Refusal::Images { .. }
                | Refusal::Exhausted { .. }
                | Refusal::Away { .. }
                | Refusal::Skewed { .. }
                | Refusal::Range
                | Refusal::Stored { .. }
        )
    }
}

/// Reserves space for `more` elements. Fails with [`Refusal::Exhausted`] if memory runs out.
pub fn reserve<T>(list: &mut Vec<T>, more: usize) -> Result<(), Refusal> {
    let bytes = (more as u64).saturating_mul(size_of::<T>() as u64);
    list.try_reserve_exact(more).map_err(|_| Refusal::Exhausted { bytes })
}

/// Reserves space as [`reserve`] does, but panics if memory runs out, for detectors, whose arrays
/// are within the limit. A program can catch this panic (see [`no_memory`]), but not an abort of
/// the process.
pub fn must_reserve<T>(list: &mut Vec<T>, more: usize) {
    if let Err(Refusal::Exhausted { bytes }) = reserve(list, more) {
        out_of_memory(bytes);
    }
}

pub(super) fn out_of_memory(bytes: u64) -> ! {
    std::panic::panic_any(NoMemory { bytes })
}

/// Makes an array at least `count` long. If it must grow, its contents are dropped first, so that
/// the old and the new array do not coexist.
pub fn at_least<A: Copy>(array: &mut Vec<A>, count: usize, value: A) {
    if count > array.len() {
        if count > array.capacity() {
            *array = Vec::new();
            must_reserve(array, count);
            pages::request(array.as_ptr().cast(), count * size_of::<A>(), count * size_of::<A>());
        }
        array.resize(count, value);
    }
}

struct NoMemory {
    bytes: u64,
}

/// Returns the refusal that the payload of a panic represents, if a detector ran out of memory.
pub fn no_memory(payload: &(dyn Any + Send)) -> Option<Refusal> {
    let &NoMemory { bytes } = payload.downcast_ref()?;
    Some(Refusal::Exhausted { bytes })
}

/// Returns the text of the payload of a panic.
pub fn panic_text(payload: &(dyn Any + Send)) -> &str {
    let text = payload.downcast_ref::<String>().map(String::as_str);
    text.or(payload.downcast_ref().copied()).unwrap_or("panic")
}

/// Number of images per particle above which the box is much smaller than the particles.
const MANY: f64 = 100.0;

fn count(each: f64) -> String {
    if each < 10.0 { format!("{each:.1}") } else { format!("{each:.0}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_panic_of_missing_memory_stands_for_a_refusal() {
        let panics = |more| {
            let ask = || must_reserve(&mut Vec::<u64>::new(), more);
            std::panic::catch_unwind(ask).err().and_then(|payload| no_memory(&*payload))
        };
        // These bytes are half of the address space, more than any allocation may take.
        let bytes = 1 << 63;
        assert_eq!(panics(1 << 60), Some(Refusal::Exhausted { bytes }));
        assert_eq!(panics(1), None);
        assert_eq!(no_memory(&"8 bytes of memory could not be allocated"), None);
    }
}
