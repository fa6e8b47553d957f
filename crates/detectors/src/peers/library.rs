//! Libraries as detectors.

use std::marker::PhantomData;

use contactbench_ground::contact::Bodies;
use contactbench_ground::detect::{Declare, Detector, Options};
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::Sink;
use contactbench_ground::probe::Probe;
use contactbench_ground::scene::Real;

/// A library that finds pairs of points in `D` dimensions.
pub trait Library<const D: usize>: Send {
    /// Calls `near` once for each pair of points that may be within reach of each other.
    fn pairs<T: Real>(
        points: &[[f64; D]],
        bodies: &impl Bodies<T, D>,
        near: impl FnMut(u32, u32),
    ) -> Result<(), Refusal>;
}

/// A library as a detector: the contact test decides the pairs that the library finds.
pub struct Wrapped<L, const D: usize>(Vec<[f64; D]>, PhantomData<L>);

impl<L: Library<D>, const D: usize> Declare for Wrapped<L, D> {
    fn with(_: Options) -> Wrapped<L, D> {
        Wrapped(Vec::new(), PhantomData)
    }
}

impl<T: Real, L: Library<D>, const D: usize> Detector<T, D> for Wrapped<L, D> {
    fn detect<B: Bodies<T, D>, P: Probe, S: Sink>(
        &mut self,
        bodies: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        self.0.clear();
        self.0.extend((0..bodies.len() as u32).map(|i| bodies.position(i)));
        L::pairs(&self.0, &bodies, |i, j| {
            if bodies.touch(i, j, probe) {
                sink.contact(i, j);
            }
        })
    }
}

/// Returns the bounding box of the points, or the origin if there are none.
pub(super) fn bounds<const D: usize>(points: &[[f64; D]]) -> [[f64; D]; 2] {
    let first = points.first().copied().unwrap_or([0.0; D]);
    points.iter().fold([first; 2], |[low, high], p| {
        [std::array::from_fn(|k| low[k].min(p[k])), std::array::from_fn(|k| high[k].max(p[k]))]
    })
}

/// Returns the squared search distance for libraries that prune and decide by squares. It is at
/// least the square that such a library computes for any pair that `touch` accepts.
///
/// A square computed directly is off by 6u, with u = 2^-53 ([`contactbench_ground::filter`], section 5). Trees
/// that update the distance to a box at every level may be off by a few u per level. The factor
/// 2^-40 covers thousands of levels at no cost; the added 2^-960 covers underflow. If squares
/// overflow, trees may compute infinity minus infinity: such scenes are refused.
pub(super) fn squared_reach<T: Real, const D: usize>(
    detector: &'static str,
    bodies: &impl Bodies<T, D>,
    points: &[[f64; D]],
) -> Result<f64, Refusal> {
    const PART: f64 = 1.0 / (1u64 << 40) as f64;
    // 2^-960, from its bits.
    let least = f64::from_bits((1023 - 960) << 52);
    let [low, high] = bounds(points);
    let farthest: f64 = (0..D).map(|k| (high[k] - low[k]) * (high[k] - low[k])).sum();
    let square = bodies.reach() * bodies.reach() * (1.0 + PART) + least;
    if (farthest + square) * 16.0 < f64::INFINITY {
        return Ok(square);
    }
    let reason = "squares of distances in this scene overflow; scale it down, or use direct".into();
    Err(Refusal::Library { detector, reason })
}
