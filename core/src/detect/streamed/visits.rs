//! Larger bodies in the grid of a finer class.
//!
//! While a bundle of layers of a class is in cache ([`super::dense`]), the larger bodies that reach
//! into it visit it: a ball through rows of cells, of each row the cells along the chord, which are
//! side by side in memory.
//!
//! ```text
//!      . . o o o . .
//!      . o o o o o .      o: cells of a row within reach of the visitor
//!      . o o @ o o .
//!      . o o o o o .
//! ```
//!
//! **Which cells.** Let Q be the true coordinates of a body in steps of the grid, q the whole
//! numbers that its cell is made of, and v the visitor's coordinates as computed here. |q - Q| <
//! 1.01 ([`super::grid`]); v is off by less than (2u + u²)|v| with u = 2^-53, and the reach ρ in
//! steps by 2^-50 ρ. A pair that touches has |Qj - Qi| <= ρ, so |qj - v| <= ρ + 2 + (|v| + ρ)2^-50.
//! We take R = ρ + 4 + (|v| + ρ)2^-46 for it, |v| over all axes, and R² - (what the other axes have
//! at least) with as much to spare as its rounding takes. Where a number overflows or is none, the
//! whole row is looked at.
//!
//! **Distances** are those of [`super::kernel`], with these bounds: along x the rounding of v to
//! 24 bits comes in place of that of a coordinate of the grid; along the others v minus the cell's
//! origin, at most R + one cell, is rounded once to 24 bits, and the difference once more, where the
//! kernel's are exact: together below 2^-22 R per axis. So the relative part is 2^-18 instead of
//! 2^-19.

use std::ops::RangeInclusive;

use super::grid::{Grid, STEPS_OFF};
use super::kernel::{Limits, Query, Scratch, test};
use super::lists::at_least;
use super::pair_sink::PairSink;
use super::plan::Plan;
use super::slab::Slab;
use super::unchecked::{Run16, chunk, element};
use crate::contact::Slack;
use crate::probe::Op;
use crate::wide::{Kernel, LANES, Level, Wide};

/// No visitor.
const NONE: u32 = u32::MAX;

/// A larger body in the grid of a class.
#[derive(Clone, Copy)]
struct Visitor<const D: usize> {
    /// In steps, in the order of the grid's axes.
    at: [f64; D],
    /// How far a body can be that touches it, in steps.
    reach: f64,
    /// As the kernel has it, in steps.
    grow: f32,
    radius: f32,
}

/// A body that visits, and the next that comes first to the same slab.
#[derive(Clone, Copy)]
struct Arrival {
    id: u32,
    next: u32,
}

/// Buffers.
#[derive(Default)]
pub(super) struct Visits {
    arrivals: Vec<Arrival>,
    /// For each slab the first arrival.
    slabs: Vec<u32>,
    /// Who is there.
    present: Vec<u32>,
}

/// Where a body is, and its radius.
pub(super) type Whereabouts<'a, const D: usize> = &'a dyn Fn(u32) -> ([f64; D], f64);

/// The class that is visited.
#[derive(Clone, Copy)]
pub(super) struct Visited<'a, const D: usize> {
    pub grid: &'a Grid<D>,
    pub plan: &'a Plan,
    /// Its largest radius.
    pub largest: f64,
    pub slack: Slack,
    pub bodies: Whereabouts<'a, D>,
}

impl<const D: usize> Visited<'_, D> {
    /// The visitor, and the slabs that it reaches, if it reaches any.
    fn visitor(&self, id: u32) -> Option<(RangeInclusive<usize>, Visitor<D>)> {
        let (position, radius) = (self.bodies)(id);
        let at = self.grid.in_steps(position);
        let far = at.iter().fold(0.0, |far: f64, x| far.max(x.abs()));
        let reach = self.grid.length(self.slack.reach(radius, self.largest));
        let relative = self.slack.relative + 1.0 / f64::from(1 << 18);
        let most = (self.grid.count[0] << self.grid.bits) as f64 + at[0].abs();
        let grow = 2.0 * STEPS_OFF
            + most / f64::from(1 << 23)
            + 2.0
            + self.grid.length(self.slack.absolute)
            + reach * relative;
        let reach = reach + 4.0 + (far + reach) / (1u64 << 46) as f64;
        for (&x, &count) in at.iter().zip(&self.grid.count) {
            if x + reach < 0.0 || x - reach > (count << self.grid.bits) as f64 {
                return None;
            }
        }
        let (first, last) = self.cells(D - 1, at[D - 1], reach);
        let slab = |layer: u64| (layer >> self.plan.layers) as usize;
        let radius = self.grid.length(radius) as f32;
        Some((slab(first)..=slab(last), Visitor { at, reach, grow: grow as f32, radius }))
    }

    /// The first and the last cell along an axis that are within a distance.
    #[inline(always)]
    fn cells(&self, axis: usize, x: f64, distance: f64) -> (u64, u64) {
        let top = ((self.grid.count[axis] << self.grid.bits) - 1) as f64;
        // What is no number becomes the end of the axis.
        let cell = |x: f64| x.max(0.0).min(top) as u64 >> self.grid.bits;
        let high = x + distance;
        (cell(x - distance), cell(if high.is_nan() { top } else { high }))
    }
}

impl Visits {
    /// Heap needed for so many bodies and slabs.
    pub fn bytes(bodies: usize, slabs: usize) -> u64 {
        ((size_of::<Arrival>() + size_of::<u32>()) * bodies + size_of::<u32>() * slabs) as u64
    }

    /// Room for so many bodies and slabs.
    pub fn prepare(&mut self, bodies: usize, slabs: usize) {
        at_least(&mut self.arrivals, bodies, Arrival { id: 0, next: NONE });
        at_least(&mut self.slabs, slabs, NONE);
        self.present.clear();
        if bodies > self.present.capacity() {
            self.present = Vec::new();
            self.present.reserve_exact(bodies);
        }
    }

    /// Expects these bodies, which are at most as many as there is room for.
    pub fn expect<const D: usize>(
        &mut self,
        visited: Visited<'_, D>,
        ids: impl Iterator<Item = u32>,
    ) {
        let slabs = &mut self.slabs[..visited.plan.slabs];
        slabs.fill(NONE);
        let mut count = 0;
        for id in ids {
            let Some((slabs_of, _)) = visited.visitor(id) else { continue };
            let first = &mut slabs[*slabs_of.start()];
            self.arrivals[count as usize] = Arrival { id, next: *first };
            *first = count;
            count += 1;
        }
        self.present.clear();
    }

    /// Those who come to this slab, or have come before and are still there, are tested against the
    /// bodies in it.
    pub fn of_slab<const D: usize>(
        &mut self,
        visited: Visited<'_, D>,
        (number, slab): (usize, &Slab<D>),
        level: Level,
        scratch: &mut Scratch,
        sink: &mut dyn PairSink,
    ) {
        let mut arrival = self.slabs[number];
        while arrival != NONE {
            let Arrival { id, next } = self.arrivals[arrival as usize];
            self.present.push(id);
            arrival = next;
        }
        let present = &mut self.present;
        if !present.is_empty() {
            level.run(Visit { visited, present, number, slab, scratch, sink });
        }
    }
}

/// All visitors of a slab against the bodies in it.
struct Visit<'a, const D: usize> {
    visited: Visited<'a, D>,
    present: &'a mut Vec<u32>,
    number: usize,
    slab: &'a Slab<D>,
    scratch: &'a mut Scratch,
    sink: &'a mut dyn PairSink,
}

impl<const D: usize> Kernel for Visit<'_, D> {
    type Output = ();

    #[inline(always)]
    fn run<W: Wide>(self, w: W) {
        let Visit { visited, present, number, slab, scratch, sink } = self;
        let Visited { grid, plan, .. } = visited;
        let one = (1u64 << grid.bits) as f64;
        let of_slab = ((number << plan.layers) as u64, ((number + 1) << plan.layers) as u64 - 1);
        let (mut found, mut rows, mut tests, mut stay) = (0, 0, 0, 0);
        for k in 0..present.len() {
            let id = present[k];
            // It was expected, so it is one.
            let Some((slabs, visitor)) = visited.visitor(id) else { continue };
            if *slabs.end() > number {
                present[stay] = id;
                stay += 1;
            }
            let Visitor { at, reach, grow, radius } = visitor;
            let square = reach * reach * (1.0 + 1.0 / (1u64 << 48) as f64);
            // How far a coordinate is from a cell, squared, and from the cell's origin.
            let from_cell = |axis: usize, cell: u64| {
                let origin = at[axis] - cell as f64 * one;
                let gap = (-origin).max(origin - one).max(0.0);
                (gap * gap, origin as f32)
            };
            let limits = Limits::new(w, w.all(0.0), 0.0);
            let (first, last) = visited.cells(D - 1, at[D - 1], reach);
            for layer in first.max(of_slab.0)..=last.min(of_slab.1) {
                let (of_layer, z) = from_cell(D - 1, layer);
                let left = square - of_layer;
                if left < 0.0 {
                    continue;
                }
                let in_slab = (layer - of_slab.0) as usize * plan.layer;
                // In 2D a layer is a row.
                let (first, last) =
                    if D == 2 { (0, 0) } else { visited.cells(1, at[1], left.sqrt()) };
                for row in first..=last {
                    let (of_row, y) = if D == 2 { (0.0, 0.0) } else { from_cell(1, row) };
                    let left = left - of_row;
                    if left < 0.0 {
                        continue;
                    }
                    let (from, to) = visited.cells(0, at[0], left.sqrt());
                    let row = if D == 2 { 0 } else { (row as usize + 1) * plan.row };
                    let cell = in_slab + row + 1;
                    // SAFETY: the cells are of the grid, in a layer of the slab, and `begin` has an
                    // entry for each cell of a slab.
                    let begin = unsafe { element(&slab.begin, cell + from as usize) };
                    // SAFETY: likewise, and for the border after the row.
                    let end = unsafe { element(&slab.begin, cell + to as usize + 1) };
                    rows += 1;
                    tests += u64::from(end - begin);
                    let mut query = Query { at: [w.all(at[0] as f32); D], radius: w.all(0.0) };
                    query.radius = w.all(radius + grow);
                    query.at[D - 1] = w.all(z);
                    if D == 3 {
                        query.at[1] = w.all(y);
                    }
                    for k in (begin..end).step_by(LANES) {
                        let valid = !(!0 << (end - k).min(LANES as u32));
                        // SAFETY: a range of places ends at the slab's `len` at the latest, and
                        // its arrays are a vector longer.
                        let run = unsafe { Run16::new(slab, k as usize) };
                        let masks = test::<_, D, true>(w, run, valid, &query, limits, grow, None);
                        // SAFETY: likewise.
                        let ids = unsafe { chunk(&slab.ids, k as usize) };
                        scratch.take(w, id, ids, masks, &mut found, sink);
                    }
                }
            }
        }
        present.truncate(stay);
        scratch.hand_on(&mut found, sink);
        sink.count(Op::LevelProbe, rows);
        sink.count(Op::ContactTest, tests);
    }
}
