//! Visits: tests of larger particles against the particles in the grid of a finer size class.
//!
//! Larger particles visit a bundle of layers of a finer class while the bundle is in cache
//! ([`super::dense`]). The cells within reach of a visitor form a ball; in a row they are adjacent.
//!
//! ```text
//!      . . o o o . .
//!      . o o o o o .      o: cells within reach of the visitor
//!      . o o @ o o .
//!      . o o o o o .
//! ```
//!
//! Visits store no further data. The larger particles are on the lists of their own classes, bundle
//! by bundle. All grids cut layers across the same axis, so the particles that may reach a bundle
//! are in few bundles of each larger class.
//!
//! **Which cells.** Let Q be the true coordinates of a particle in steps of the visited grid and q
//! the integers that determine its cell: |q - Q| < 1.01 ([`super::grid`]). A visitor has integers p
//! of its own grid, also within 1.01 of the true ones. The code computes v = m·p + c in steps of
//! the visited grid, with relative errors of m and c below 2^-49. So v is within 1.01m + (m·p +
//! |c|)2^-47 of the true coordinate. A pair that touches has |Qj - Qi| <= ρ, the reach in steps,
//! computed with a relative error below 2^-49. So |qj - v| <= R = ρ + 2 + 2m + (ρ + m·p +
//! |c|)2^-46, where m·p + |c| is the largest over all axes. R also covers the rounding of the
//! distances of v from cell borders. Classes with m >= 2^40 or an infinite c do not visit each
//! other ([`super::levels`]); so squares are at most 2^124 and fit in f32. A visitor so far away
//! that its margin overflows is beyond the grid.
//!
//! **Distances** are decided as in [`super::kernel`]. Differences of coordinates are off by at most
//! 1.01 + 1.01m + (m·p + |c|)2^-47 along each axis. Along x both coordinates are rounded to 24
//! bits. Along the other axes the kernel is exact, but here two numbers are rounded to 24 bits: v
//! minus the origin of the cell, which is at most R plus one cell, and the difference. This adds
//! less than 2^-22 R per axis, so the relative part of the bound is 2^-18 instead of 2^-19.

use super::grid::Grid;
use super::kernel::Scratch;
use super::lists::Lists;
use super::near::{Limits, Query, test};
use super::pair_sink::PairSink;
use super::plan::Plan;
use super::slab::Slab;
use super::unchecked::{Run16, TwoRuns8, element};
use crate::contact::Slack;
use crate::probe::Op;
use crate::wide::fill;
use crate::wide::{HALF, Kernel, LANES, Wide};

/// Rows of a ball are shortened to chords if its radius exceeds this many cells.
const CLIP: f64 = 4.0;
/// Bound on the sum of all relative roundings of a reach, including those of radii in f32.
const EPSILON: f64 = 1.0 / (1u64 << 21) as f64;

/// A size class: the class that is visited, or the class of the visitors.
#[derive(Clone, Copy)]
pub(super) struct Host<'a, const D: usize> {
    pub grid: &'a Grid<D>,
    pub plan: &'a Plan,
    pub largest: f64,
    pub lists: &'a Lists<D, f32>,
}

/// A larger particle that is tested against the particles of a bundle.
struct Visitor<const D: usize> {
    /// Coordinates in steps of the bundle's grid.
    at: [f64; D],
    /// Largest distance at which a particle of the bundle can touch the visitor.
    reach: f64,
    /// Bound on the errors of distances, like [`Bounds::grow`](super::kernel::Bounds).
    grow: f32,
    radius: f32,
    id: u32,
}

pub(super) struct Visit<'a, const D: usize> {
    /// All classes of larger particles, the largest first.
    pub larger: &'a [Option<Host<'a, D>>],
    pub host: Host<'a, D>,
    pub slack: Slack,
    pub number: usize,
    pub slab: &'a Slab<D>,
    pub scratch: &'a mut Scratch,
    pub sink: &'a mut dyn PairSink,
}

/// Returns the first and the last of `count` cells along an axis that are within a distance of `x`.
#[inline(always)]
fn cells(count: u64, bits: u32, x: f64, distance: f64) -> (u64, u64) {
    let top = ((count << bits) - 1) as f64;
    let high = x + distance;
    // For NaN the lower limit is the first cell, the upper limit the last.
    let cell = |x: f64| x.max(0.0).min(top) as u64 >> bits;
    (cell(x - distance), cell(if high.is_nan() { top } else { high }))
}

impl<const D: usize> Kernel for Visit<'_, D> {
    type Output = ();

    #[inline(always)]
    fn run<W: Wide>(mut self, w: W) {
        let Host { grid, plan, .. } = self.host;
        if self.slab.len == 0 {
            return;
        }
        let one = (1u64 << grid.bits) as f64;
        let layers = [self.number, self.number + 1].map(|k| (k << plan.layers) as f64 * one);
        let steps = (grid.count[0] << grid.bits) as f64;
        let (largest, absolute) =
            (grid.length(self.host.largest), grid.length(self.slack.absolute));
        let slack = self.slack;
        let reach_of =
            |radius: f64| (radius + largest) * (1.0 + slack.relative) * (1.0 + EPSILON) + absolute;
        let (mut found, mut counts) = (0, [0; 2]);
        for from in self.larger.iter().flatten() {
            // Conversion from the visitors' steps to those of the bundle's grid.
            let (scale, shift) = (grid.finer_than(from.grid), grid.origin_of(from.grid));
            // Find the bundles of visitors that may reach this bundle.
            let most = reach_of(scale * from.grid.length(from.largest));
            let spare = 8.0 + 8.0 * scale + (most + shift[D - 1].abs() + layers[1]) * EPSILON;
            let back = |z: f64| (z - shift[D - 1]) / scale;
            let (low, high) = (back(layers[0] - most - spare), back(layers[1] + most + spare));
            if high < 0.0 {
                continue;
            }
            // Convert to integers before reading particles. Casts saturate; NaN becomes 0 in the
            // lower limit and the largest integer in the upper limit.
            let (low, high) = (low as u64, if high.is_nan() { u64::MAX } else { high as u64 });
            let bundle = from.grid.bits + from.plan.layers;
            let end = from.plan.slabs as u64 - 1;
            let (first, last) = ((low >> bundle).min(end), (high >> bundle).min(end));
            for number in first..=last {
                for record in from.lists.blocks(number as usize).flatten() {
                    // The bundle number forms the highest bits of the last coordinate.
                    let in_bundle = u64::from(record.at[D - 1]) & ((1 << bundle) - 1);
                    let z = number << bundle | in_bundle;
                    if !(low..=high).contains(&z) {
                        continue;
                    }
                    let p: [f64; D] =
                        fill(|k| if k < D - 1 { f64::from(record.at[k]) } else { z as f64 });
                    let at: [f64; D] = fill(|k| scale * p[k] + shift[k]);
                    let radius = scale * f64::from(record.radius);
                    let reach = reach_of(radius);
                    let far =
                        (0..D).fold(0.0, |far: f64, k| far.max(scale * p[k] + shift[k].abs()));
                    let reach = reach + 2.0 + 2.0 * scale + (reach + far) / (1u64 << 46) as f64;
                    if at[D - 1] + reach < layers[0] || at[D - 1] - reach > layers[1] {
                        continue;
                    }
                    let grow = 2.0 * (1.0 + scale)
                        + far / (1u64 << 45) as f64
                        + (steps + at[0].abs()) / f64::from(1 << 23)
                        + 2.0
                        + absolute
                        + reach * (slack.relative + 1.0 / f64::from(1 << 18));
                    let (grow, radius, id) = (grow as f32, radius as f32, record.id);
                    let visitor = Visitor { at, reach, grow, radius, id };
                    self.ball(w, &visitor, &mut found, &mut counts);
                }
            }
        }
        self.scratch.hand_on(&mut found, self.sink);
        self.sink.count(Op::LevelProbe, counts[0]);
        self.sink.count(Op::ContactTest, counts[1]);
    }
}

impl<const D: usize> Visit<'_, D> {
    #[inline(always)]
    fn ball<W: Wide>(
        &mut self,
        w: W,
        visitor: &Visitor<D>,
        found: &mut usize,
        counts: &mut [u64; 2],
    ) {
        let Host { grid, plan, .. } = self.host;
        let Visitor { at, reach, grow, radius, id } = *visitor;
        let cells = |axis: usize, distance| {
            let parts = if axis == 0 { plan.parts } else { 0 };
            cells(grid.count[axis] << parts, grid.bits - parts, at[axis], distance)
        };
        for (&x, &count) in at.iter().zip(&grid.count) {
            if x + reach < 0.0 || x - reach > (count << grid.bits) as f64 {
                return;
            }
        }
        let one = (1u64 << grid.bits) as f64;
        let (begin, end) =
            ((self.number << plan.layers) as u64, ((self.number + 1) << plan.layers) as u64 - 1);
        let square = reach * reach * (1.0 + 1.0 / (1u64 << 48) as f64);
        // Returns the squared distance of the visitor from a cell along an axis, and its offset
        // from the cell's origin.
        let from_cell = |axis: usize, cell: u64| {
            let origin = at[axis] - cell as f64 * one;
            let gap = (-origin).max(origin - one).max(0.0);
            (gap * gap, origin as f32)
        };
        let limits = Limits::new(w, w.all(0.0), 0.0);
        let mut query = Query { at: [w.all(at[0] as f32); D], radius: w.all(radius + grow) };
        let wide = reach > CLIP * one;
        let whole = cells(0, reach);
        let second = w.load_two(&[0.0; HALF], &[one as f32; HALF]);
        let (first, last) = cells(D - 1, reach);
        for layer in first.max(begin)..=last.min(end) {
            let (of_layer, z) = from_cell(D - 1, layer);
            query.at[D - 1] = w.all(z);
            let in_slab = (layer - begin) as usize * plan.layer + (1 << plan.parts);
            let left = square - of_layer;
            if left < 0.0 {
                continue;
            }
            // Returns where the particles of a row within reach begin, how many they are, and the
            // visitor's offset from the row.
            let places = |row: u64| {
                // In 2D each layer is a single row.
                let (of_row, y) = if D == 2 { (0.0, 0.0) } else { from_cell(1, row) };
                let (from, to) =
                    if wide { cells(0, (left - of_row).max(0.0).sqrt()) } else { whole };
                let cell = in_slab + if D == 2 { 0 } else { (row as usize + 1) * plan.row };
                // SAFETY: the cells belong to the grid, in a layer of the slab, and `begin` has an
                // entry for each cell of a slab.
                let begin = unsafe { element(&self.slab.begin, cell + from as usize) };
                // SAFETY: as for `begin`; there is an entry for the border after the row.
                let end = unsafe { element(&self.slab.begin, cell + to as usize + 1) };
                (begin, end - begin, y)
            };
            let (mut row, last) = if D == 2 { (0, 0) } else { cells(1, left.sqrt()) };
            while row <= last {
                let (begin, len, y) = places(row);
                let (begin_next, len_next, y_next) = places(last.min(row + 1));
                let len_next = if row < last { len_next } else { 0 };
                counts[0] += 1 + u64::from(row < last);
                counts[1] += u64::from(len + len_next);
                row += 2;
                // SAFETY: a range of places ends at most at the slab's `len`, and the arrays are a
                // vector longer.
                let run = |at: u32| unsafe { Run16::new(self.slab, at as usize) };
                if D == 3 && len | len_next < HALF as u32 {
                    query.at[1] = w.sub(w.all(y), second);
                    let source = TwoRuns8([run(begin), run(begin_next)]);
                    let valid = !(!0 << len) | !(!0 << len_next) << HALF;
                    let masks = test::<_, D, true>(w, source, valid, &query, limits, grow, None);
                    self.scratch.take(w, id, source, masks, found, self.sink);
                    continue;
                }
                for (begin, len, y) in [(begin, len, y), (begin_next, len_next, y_next)] {
                    if D == 3 {
                        query.at[1] = w.all(y);
                    }
                    for k in (0..len).step_by(LANES) {
                        let (source, valid) =
                            (run(begin + k), !(!0 << (len - k).min(LANES as u32)));
                        let masks =
                            test::<_, D, true>(w, source, valid, &query, limits, grow, None);
                        self.scratch.take(w, id, source, masks, found, self.sink);
                    }
                }
            }
        }
    }
}
