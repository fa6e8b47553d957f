//! Bounding boxes, for detectors that build trees.

use super::copies::Record;
use crate::filter::axes_by_length;
use crate::wide::fill;

/// An axis-aligned box.
#[derive(Clone, Copy, Debug)]
pub struct Bounds<const D: usize> {
    pub low: [f64; D],
    pub high: [f64; D],
}

impl<const D: usize> Bounds<D> {
    pub const NONE: Bounds<D> = Bounds { low: [f64::INFINITY; D], high: [f64::NEG_INFINITY; D] };

    pub fn around(records: &[Record<D>]) -> Bounds<D> {
        let mut bounds = Bounds::NONE;
        records.iter().for_each(|record| bounds.widen(record.position, record.position));
        bounds
    }

    #[inline(always)]
    pub fn widen(&mut self, low: [f64; D], high: [f64; D]) {
        for k in 0..D {
            self.low[k] = self.low[k].min(low[k]);
            self.high[k] = self.high[k].max(high[k]);
        }
    }

    #[inline(always)]
    pub fn meets(&self, other: &Bounds<D>) -> bool {
        (0..D).fold(true, |meet, k| {
            meet & (self.low[k] <= other.high[k]) & (other.low[k] <= self.high[k])
        })
    }

    /// Returns the axes of the two longest edges, the longest first.
    pub fn longest(&self) -> [usize; 2] {
        let axes: [usize; D] = axes_by_length(fill(|k| -self.half_edge(k)));
        [axes[0], axes[1]]
    }

    /// Returns half the length of an edge; the length itself could overflow.
    pub fn half_edge(&self, axis: usize) -> f64 {
        0.5 * self.high[axis] - 0.5 * self.low[axis]
    }
}
