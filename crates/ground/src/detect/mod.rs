//! Detectors: algorithms that find the particles that touch.
//!
//! A detector owns its parameters and buffers and implements [`Detector`]. [`any::AnyDetector`] is
//! its object-safe form, implemented once for all detectors, for callers that choose one at run
//! time.

pub mod any;
pub mod bounds;
pub mod company;
pub mod copies;
pub mod rows;

use crate::contact::Particles;
use crate::limits::memory::default_limit;
use crate::limits::refusal::Refusal;
use crate::pairs::sink::Sink;
use crate::probe::Probe;
use crate::scene::Real;

/// Finds the contacts of a scene.
///
/// Every pair that [`Particles::touch`] accepts is reported exactly once. The order of pairs, and
/// of the two numbers in a pair, is not specified. Buffers kept from earlier calls may change the
/// cost of a call, never its result. A call for a scene of the same shape as before allocates
/// nothing.
pub trait Detector<T: Real, const D: usize> {
    /// Reports the contacts of `particles` to `sink` and the operations to `probe`.
    ///
    /// # Errors
    /// Returns the refusals that the detector's documentation lists, before any contact is
    /// reported.
    fn detect<B: Particles<T, D>, P: Probe, S: Sink>(
        &mut self,
        particles: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal>;
}

/// How a detector is made, and how much memory it needs.
pub trait Declare: Send {
    /// Whether the detector decides nearly all pairs from its own copies and seldom calls the
    /// contact test. [`any::AnyDetector`] then picks the test for each pair at run time, which
    /// costs nothing here and saves compiling a form for every test.
    const DECIDES_FROM_COPIES: bool = false;

    /// Creates a detector with empty buffers.
    fn with(options: Options) -> Self
    where
        Self: Sized;

    /// Returns the bytes that the memory formula in the detector's documentation gives for the last
    /// scene; 0 if it has none.
    fn formula_bytes(&self) -> u64 {
        0
    }
}

/// Limits that hold for any detector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Limit in bytes for the arrays of a detector, including pairs collected by threads; a scene
    /// that needs more is refused. The list of pairs has a separate limit of the same size.
    pub memory_limit: u64,
    /// Number of threads; a detector that cannot use several uses one.
    pub threads: usize,
}

impl Default for Options {
    /// Returns the machine's default limit ([`default_limit`]) and one thread.
    fn default() -> Options {
        Options { memory_limit: default_limit(), threads: 1 }
    }
}

/// Compares the bytes that a detector needs with the limit, before it allocates. `shape` returns a
/// phrase that explains the size of the scene. Fails with [`Refusal::Memory`] if `needed` is over
/// the limit.
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

/// Largest number of particles whose numbers leave one bit for other uses.
pub const MOST_PARTICLES: u64 = (u32::MAX >> 1) as u64;

/// Refuses scenes with more particles than lists can number.
pub fn numbered(detector: &'static str, n: usize) -> Result<(), Refusal> {
    if n as u64 <= MOST_PARTICLES {
        return Ok(());
    }
    Err(Refusal::Particles { detector, n: n as u64, limit: MOST_PARTICLES })
}
