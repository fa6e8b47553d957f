//! Detectors: which bodies touch?
//!
//! One algorithm is one file here and one line in [`table`]. A detector owns its parameters and its buffers and implements
//! [`Detector`]; [`any::AnyDetector`] is the object-safe twin that the harness, the checks and the command line use, implemented once
//! for all of them.

pub mod any;
pub mod binary_tree;
pub mod bvh;
pub mod cell_grid;
pub mod control;
pub mod copies;
pub mod direct;
#[cfg(test)]
mod golden;
pub mod hash_grid;
pub mod kd_tree;
pub mod list;
pub mod mask;
pub mod nbs2d;
pub mod nbs3d;
pub mod peers;
pub mod screening;
pub mod sorting;
pub mod streamed;
pub mod sweep;
// Tests of single detectors are here, those of all in the crate above: the table is compiled once.
#[cfg(not(test))]
pub mod table;
pub mod tree;

use crate::contact::{Bodies, Real};
use crate::probe::Probe;
use crate::sink::Sink;

/// Finds the contacts of a scene.
///
/// Every pair that [`Bodies::touch`] accepts is reported exactly once, in any order of pairs and indices. What earlier calls left in
/// the buffers may change the cost of a call, never its result; a call on a scene of the same shape as the one before
/// allocates nothing.
pub trait Detector<T: Real, const D: usize> {
    /// Reports the contacts of `bodies` to `sink` and the operations to `probe`. On a refusal nothing has been reported.
    fn detect<B: Bodies<T, D>, P: Probe, S: Sink>(&mut self, bodies: B, probe: &mut P, sink: &mut S) -> Result<(), Refusal>;
}

/// What every detector can be told, and what it says of its memory.
pub trait Declare: Send {
    /// A detector with empty buffers.
    fn with(options: Options) -> Self
    where
        Self: Sized;

    /// The bytes that the memory formula in the detector's documentation gives for the scene of the last call.
    fn formula_bytes(&self) -> u64;
}

/// Limits that hold for any detector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// A detector refuses a scene for which it would need more bytes than this.
    pub memory_limit: u64,
    /// Threads to use; a detector that cannot use several is sequential.
    pub threads: usize,
}

impl Default for Options {
    /// 4 GiB and one thread.
    fn default() -> Options {
        Options { memory_limit: 4 << 30, threads: 1 }
    }
}

/// Why a detector will not work on a scene. Nothing was reported; arrays whose size is known beforehand were not allocated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs)] // the fields are explained by the messages
pub enum Refusal {
    /// The arrays would be larger than the limit.
    #[error(
        "{detector} needs {needed} bytes for this scene ({shape}), the limit is {limit}; raise the limit (--memory-limit, in experiments memory-limit-mib), or use another detector: sorting is the leanest, direct needs nothing"
    )]
    Memory { detector: &'static str, needed: u64, limit: u64, shape: String },
    /// Cells cannot be told apart or addressed.
    #[error(
        "the scene spans {cells:.3e} cells of edge {edge:e} along {axis} ({low:e} to {high:e}), a grid can address 2^31; remove far-away elements, or use kd-tree"
    )]
    Domain { axis: &'static str, low: f64, high: f64, edge: f64, cells: f64 },
    /// Distances along an axis are no doubles.
    #[error("along {axis} the scene reaches from {low:e} to {high:e}, and the difference overflows; scale the scene down, or use kd-tree")]
    Extent { axis: &'static str, low: f64, high: f64 },
    /// More elements than the lists can number.
    #[error("{detector} numbers at most {limit} elements, the scene has {n}; use direct")]
    Elements { detector: &'static str, n: u64, limit: u64 },
    /// The exact test is asked for a scene that is not in f64.
    #[error("the exact test takes scenes in f64, this one is in {precision}; convert it, which is without error")]
    NotWide { precision: &'static str },
    /// The square of a diameter overflows in the arithmetic asked for.
    #[error("the square of the largest diameter {diameter:e} overflows in {precision}; use --arithmetic exact, or smaller units")]
    Overflow { diameter: f64, precision: &'static str },
    /// The library behind a peer cannot be trusted with the scene.
    #[error("{detector}: {reason}")]
    Library { detector: &'static str, reason: String },
}

/// Refuses if `needed` bytes are over the limit; called before anything is allocated.
pub fn within(options: &Options, detector: &'static str, needed: u64, shape: impl FnOnce() -> String) -> Result<(), Refusal> {
    if needed <= options.memory_limit {
        return Ok(());
    }
    Err(Refusal::Memory { detector, needed, limit: options.memory_limit, shape: shape() })
}
