//! Larger bodies in the grid of a finer class.
//!
//! While a bundle of layers of a class is in cache ([`super::dense`]), the larger bodies that reach
//! into it visit it: a ball through rows of cells. The cells of a row that are within reach are
//! side by side in memory.
//!
//! ```text
//!      . . o o o . .
//!      . o o o o o .      o: cells within reach of the visitor
//!      . o o @ o o .
//!      . o o o o o .
//! ```
//!
//! Nothing is kept for this. The larger bodies are on the lists of their own classes, bundle by
//! bundle, and all grids cut their layers across the same axis, so those who may reach a bundle are
//! in few bundles of each larger class.
//!
//! **Which cells.** Let Q be the true coordinates of a body in steps of the visited grid, q the
//! whole numbers that its cell is made of: |q - Q| < 1.01 ([`super::grid`]). A visitor has whole
//! numbers p of its own grid, within 1.01 of the true ones, too. From them v = m·p + c is computed,
//! m and c with relative errors below 2^-49: v is within 1.01m + (m·p + |c|)2^-47 of the truth. A
//! pair that touches has |Qj - Qi| <= ρ, the reach in steps, computed with a relative error below
//! 2^-49. So |qj - v| <= R = ρ + 2 + 2m + (ρ + m·p + |c|)2^-46, with the largest of m·p + |c| over
//! all axes. Distances of v from the borders of cells are rounded by less than what R has to spare.
//! Where m would be 2^40 or more, or c is not finite, classes do not visit each other
//! ([`super::levels`]): so squares are at most 2^124, and fit f32 as well. A visitor so far away
//! that its margin overflows is beyond the grid.
//!
//! **Distances** are decided as in [`super::kernel`]. Coordinates are off by at most 1.01 + 1.01m
//! along each axis, and by (m·p + |c|)2^-47; along x both have 24 bits; along the others v minus
//! the origin of the cell, at most R + one cell, is rounded to 24 bits, and so is the difference,
//! where the kernel's are exact: below 2^-22 R per axis. The relative part of the bound is 2^-18
//! for that, instead of 2^-19.

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
use crate::wide::{HALF, Kernel, LANES, Wide};

/// So many cells from the middle of a ball its rows are cut to their chords.
const CLIP: f64 = 4.0;
/// More than all roundings of a reach together, those of radii in f32 among them.
const EPSILON: f64 = 1.0 / (1u64 << 21) as f64;

/// A class of sizes, as visitors and those who are visited need it.
#[derive(Clone, Copy)]
pub(super) struct Host<'a, const D: usize> {
    pub grid: &'a Grid<D>,
    pub plan: &'a Plan,
    /// The largest radius.
    pub largest: f64,
    pub lists: &'a Lists<D, f32>,
}

/// A body of one class against those of a bundle of another.
struct Visitor<const D: usize> {
    /// In steps of the bundle's grid.
    at: [f64; D],
    /// How far a body can be that touches it.
    reach: f64,
    /// As the kernel has it.
    grow: f32,
    radius: f32,
    id: u32,
}

/// The bodies of larger classes against those of a bundle.
pub(super) struct Visit<'a, const D: usize> {
    /// The classes, the largest first.
    pub larger: &'a [Option<Host<'a, D>>],
    pub host: Host<'a, D>,
    pub slack: Slack,
    /// The number of the bundle.
    pub number: usize,
    pub slab: &'a Slab<D>,
    pub scratch: &'a mut Scratch,
    pub sink: &'a mut dyn PairSink,
}

/// The first and the last cell along an axis of `count` cells that are within a distance.
#[inline(always)]
fn cells(count: u64, bits: u32, x: f64, distance: f64) -> (u64, u64) {
    let top = ((count << bits) - 1) as f64;
    let high = x + distance;
    // What is no number becomes the end of the axis.
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
        // The layers of the bundle, in steps.
        let layers = [self.number, self.number + 1].map(|k| (k << plan.layers) as f64 * one);
        let steps = (grid.count[0] << grid.bits) as f64;
        let (largest, absolute) =
            (grid.length(self.host.largest), grid.length(self.slack.absolute));
        let slack = self.slack;
        let reach_of =
            |radius: f64| (radius + largest) * (1.0 + slack.relative) * (1.0 + EPSILON) + absolute;
        let (mut found, mut counts) = (0, [0; 2]);
        for from in self.larger.iter().flatten() {
            // From its steps to those of the bundle's grid.
            let (scale, shift) = (grid.finer_than(from.grid), grid.origin_of(from.grid));
            // The bundles of those who may reach this one.
            let most = reach_of(scale * from.grid.length(from.largest));
            let spare = 8.0 + 8.0 * scale + (most + shift[D - 1].abs() + layers[1]) * EPSILON;
            let back = |z: f64| (z - shift[D - 1]) / scale;
            let (low, high) = (back(layers[0] - most - spare), back(layers[1] + most + spare));
            if high < 0.0 {
                continue;
            }
            // As whole numbers, before anything is computed of a body. Casts saturate; what is no
            // number is the least for the one and the most for the other.
            let (low, high) = (low as u64, if high.is_nan() { u64::MAX } else { high as u64 });
            let bundle = from.grid.bits + from.plan.layers;
            let end = from.plan.slabs as u64 - 1;
            let (first, last) = ((low >> bundle).min(end), (high >> bundle).min(end));
            for number in first..=last {
                for record in from.lists.blocks(number as usize).flatten() {
                    // Along the last axis, the bundle has the highest bits.
                    let in_bundle = u64::from(record.at[D - 1]) & ((1 << bundle) - 1);
                    let z = number << bundle | in_bundle;
                    if !(low..=high).contains(&z) {
                        continue;
                    }
                    let p: [f64; D] = std::array::from_fn(|k| {
                        if k < D - 1 { f64::from(record.at[k]) } else { z as f64 }
                    });
                    let at: [f64; D] = std::array::from_fn(|k| scale * p[k] + shift[k]);
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
    /// A visitor against what is within reach of it.
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
        let cells = |axis: usize, distance| cells(grid.count[axis], grid.bits, at[axis], distance);
        for (&x, &count) in at.iter().zip(&grid.count) {
            if x + reach < 0.0 || x - reach > (count << grid.bits) as f64 {
                return;
            }
        }
        let one = (1u64 << grid.bits) as f64;
        let (begin, end) =
            ((self.number << plan.layers) as u64, ((self.number + 1) << plan.layers) as u64 - 1);
        let square = reach * reach * (1.0 + 1.0 / (1u64 << 48) as f64);
        // How far a coordinate is from a cell, squared, and from the cell's origin.
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
            let in_slab = (layer - begin) as usize * plan.layer + 1;
            let left = square - of_layer;
            if left < 0.0 {
                continue;
            }
            // The bodies of a row that are not too far, and where the visitor is from its origin.
            let places = |row: u64| {
                // In 2D a layer is a row.
                let (of_row, y) = if D == 2 { (0.0, 0.0) } else { from_cell(1, row) };
                let (from, to) =
                    if wide { cells(0, (left - of_row).max(0.0).sqrt()) } else { whole };
                let cell = in_slab + if D == 2 { 0 } else { (row as usize + 1) * plan.row };
                // SAFETY: the cells are of the grid, in a layer of the slab, and `begin` has an
                // entry for each cell of a slab.
                let begin = unsafe { element(&self.slab.begin, cell + from as usize) };
                // SAFETY: likewise, and for the border after the row.
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
                // SAFETY: a range of places ends at the slab's `len` at the latest, and its arrays
                // are a vector longer.
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
