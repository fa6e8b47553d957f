//! Detectors: which bodies touch?
//!
//! One algorithm is one file here and one line in [`table`]. A detector owns its parameters and its
//! buffers and implements [`Detector`]; [`any::AnyDetector`] is the object-safe twin, implemented
//! once for all of them, for callers that choose a detector at run time ([`table::parse`]).

pub mod any;
pub mod book;
pub mod control;
mod entry;
pub mod modern;
pub mod peers;
#[cfg(test)]
mod sizes;
pub mod spec;
pub mod streamed;
pub mod table;

use crate::contact::Bodies;
use crate::memory::default_limit;
use crate::probe::Probe;
pub use crate::refusal::Refusal;
use crate::scene::Real;
use crate::sink::Sink;

/// Finds the contacts of a scene.
///
/// Every pair that [`Bodies::touch`] accepts is reported exactly once, in any order of pairs and
/// indices. What earlier calls left in the buffers may change the cost of a call, never its result;
/// a call on a scene of the same shape as the one before allocates nothing.
pub trait Detector<T: Real, const D: usize> {
    /// Reports the contacts of `bodies` to `sink` and the operations to `probe`.
    ///
    /// # Errors
    /// What the detector's documentation says it refuses; then nothing has been reported.
    fn detect<B: Bodies<T, D>, P: Probe, S: Sink>(
        &mut self,
        bodies: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal>;
}

/// How a detector is made, and how much memory it needs.
pub trait Declare: Send {
    /// Whether it decides nearly all pairs from copies of its own and seldom asks the contact test.
    /// [`any::AnyDetector`] then looks the test up for each pair, which costs nothing and spares
    /// the compiler a form for every test.
    const DECIDES_FROM_COPIES: bool = false;

    /// A detector with empty buffers.
    fn with(options: Options) -> Self
    where
        Self: Sized;

    /// The bytes that the memory formula in the detector's documentation gives for the scene of the
    /// last call.
    fn formula_bytes(&self) -> u64;
}

/// Limits that hold for any detector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// A detector refuses a scene for which its arrays, and the pairs of its threads, would need
    /// more bytes than this; the list of pairs may take as many beside them.
    pub memory_limit: u64,
    /// Threads to use; a detector that cannot use several is sequential.
    pub threads: usize,
}

impl Default for Options {
    /// What fits the machine ([`default_limit`]), and one thread.
    fn default() -> Options {
        Options { memory_limit: default_limit(), threads: 1 }
    }
}

/// Compares the bytes `needed` by `detector` with the limit; to be called before anything is
/// allocated. `shape` says in a phrase what makes the scene so large.
///
/// # Errors
/// [`Refusal::Memory`] if they are more.
pub fn within(
    options: &Options,
    detector: &'static str,
    needed: u64,
    shape: impl FnOnce() -> String,
) -> Result<(), Refusal> {
    if needed <= options.memory_limit {
        return Ok(());
    }
    Err(Refusal::Memory { detector, needed, limit: options.memory_limit, shape: shape() })
}
