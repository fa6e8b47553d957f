//! Visits: tests of larger particles against the particles in the grid of a finer size class.
//!
//! Larger particles visit a bundle of layers of a finer class while the bundle is in cache
//! ([`crate::dense`]). The cells within reach of a visitor form a ball; in a row they are adjacent.
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
//! are in few bundles of each larger class. From their records the code makes patches of rows, and
//! tests the patches in a second loop ([`Tests`]).
//!
//! **Which cells.** Let Q be the true coordinates of a particle in steps of the visited grid and q
//! the integers that determine its cell: |q - Q| < 1.01 ([`crate::grid`]). A visitor has integers p
//! of its own grid, also within 1.01 of the true ones. The code computes v = m·p + c in steps of
//! the visited grid, with relative errors of m and c below 2^-49. So v is within 1.01m + (m·p +
//! |c|)2^-47 of the true coordinate. A pair that touches has |Qj - Qi| <= ρ, the reach in steps,
//! computed with a relative error below 2^-49. Over three axes these errors are at most √3 · 1.01 ·
//! (1 + m), and rounding limits to whole steps adds half a step. So |qj - v| <= R = ρ + 3 + 2m +
//! (ρ + m·p + |c|)2^-46, where m·p + |c| is the largest over all axes. R exceeds the bound by 0.75
//! steps, which covers the rounding of distances of v from cell borders. Classes with m >= 2^40 or
//! an infinite c do not visit each other ([`super`]); so squares are at most 2^124 and fit
//! in f32. A visitor so far away that its margin overflows is beyond the grid.
//!
//! **Distances** are decided as in [`crate::kernel`]. Differences of coordinates are off by at most
//! 1.01 + 1.01m + (m·p + |c|)2^-47 along each axis. Along x both coordinates are rounded to 24
//! bits. Along the other axes the kernel is exact, but here two numbers are rounded to 24 bits: v
//! minus the origin of the cell, which is at most R plus one cell, and the difference. For later
//! rows of a patch whole cells are subtracted, which leaves at most R. This adds at most 2^-22 R
//! per axis, so the relative part of the bound is 2^-18 instead of 2^-19. A cell
//! wider than R adds one cell to the bound; the bound for x, with at least two cells, covers it.

use super::ball::{Patch, Visitor, max};
use crate::grid::Grid;
use crate::kernel::{Limits, Query, test};
use crate::lists::{Lists, Record};
use crate::output::Output;
use crate::plan::Plan;
use crate::slab::Slab;
use crate::unchecked::{Run16, TwoRuns8, element};
use contactbench_ground::contact::Slack;
use contactbench_ground::probe::Op;
use contactbench_ground::wide::fill;
use contactbench_ground::wide::{HALF, Kernel, LANES, Wide};

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

pub(super) struct Visit<'a, const D: usize> {
    /// All classes of larger particles, the largest first.
    pub larger: &'a [Option<Host<'a, D>>],
    pub host: Host<'a, D>,
    pub slack: Slack,
    pub number: usize,
    pub slab: &'a Slab<D>,
    pub output: Output<'a>,
}

/// Number of patches that are tested together.
const PATCHES: usize = 128;
/// Number of visitors' records that are read together; at most 256, because places are bytes.
const TOGETHER: usize = 256;
/// The bundle that is visited, in steps of its grid.
#[derive(Clone, Copy)]
struct View<'a, const D: usize> {
    grid: &'a Grid<D>,
    /// Lower and upper end of the bundle along the last axis.
    layers: [f64; 2],
    /// Number of steps along each axis.
    steps: [f64; D],
    largest: f64,
    absolute: f64,
    relative: f64,
}

/// The bundles of a larger class with visitors that may reach the visited bundle.
struct Visitors<const D: usize> {
    /// Factor and summand from the visitors' steps to those of the visited grid.
    scale: f64,
    shift: [f64; D],
    first: u64,
    last: u64,
    /// Number of bits of the last coordinate within a bundle.
    bits: u32,
    /// Limits of the last coordinate for a visitor of radius 0, and what each step of radius adds.
    below: f64,
    above: f64,
    each: f64,
}

impl<const D: usize> View<'_, D> {
    /// Returns the largest distance at which a particle of this radius can touch one of the bundle.
    #[inline(always)]
    fn reach(&self, radius: f64) -> f64 {
        (radius + self.largest) * (1.0 + self.relative) * (1.0 + EPSILON) + self.absolute
    }

    /// Returns the bundles of a larger class that may reach this bundle, or `None` if none can.
    #[inline(always)]
    fn visitors(&self, from: &Host<'_, D>) -> Option<Visitors<D>> {
        let View { grid, layers, relative, .. } = *self;
        let (scale, shift) = (grid.finer_than(from.grid), grid.origin_of(from.grid));
        let most = self.reach(scale * from.grid.length(from.largest));
        let spare = 8.0 + 8.0 * scale + (most + shift[D - 1].abs() + layers[1]) * EPSILON;
        let back = |z: f64| (z - shift[D - 1]) / scale;
        let (low, high) = (back(layers[0] - most - spare), back(layers[1] + most + spare));
        if high < 0.0 {
            return None;
        }
        // Casts saturate; NaN becomes 0 in the lower limit and the largest integer in the upper
        // limit.
        let last = if high.is_nan() { u64::MAX } else { high as u64 };
        let bits = from.grid.bits + from.plan.layers;
        let most = from.plan.slabs as u64 - 1;
        let (first, last) = ((low as u64 >> bits).min(most), (last >> bits).min(most));
        let none = (self.reach(0.0) + spare) / scale;
        let (below, above) = (back(layers[0]) - none, back(layers[1]) + none);
        let each = (1.0 + relative) * (1.0 + 2.0 * EPSILON);
        Some(Visitors { scale, shift, first, last, bits, below, above, each })
    }

    /// Returns a visitor, by its record and its last coordinate.
    #[inline(always)]
    fn visitor(&self, from: &Visitors<D>, record: &Record<D, f32>, z: f64) -> Visitor<D> {
        let Visitors { scale, shift, .. } = *from;
        let p: [f64; D] = fill(|k| if k < D - 1 { f64::from(record.at[k]) } else { z });
        let at: [f64; D] = fill(|k| scale * p[k] + shift[k]);
        let radius = scale * f64::from(record.radius);
        let far = (0..D).fold(0.0, |far, k| max(scale * p[k] + shift[k].abs(), far));
        let reach = self.reach(radius);
        let reach = reach + 3.0 + 2.0 * scale + (reach + far) / (1u64 << 46) as f64;
        let grow = 2.0 * (1.0 + scale)
            + far / (1u64 << 45) as f64
            + (self.steps[0] + at[0].abs()) / f64::from(1 << 23)
            + 2.0
            + self.absolute
            + reach * (self.relative + 1.0 / f64::from(1 << 18));
        Visitor { at, reach, radius: radius as f32, grow: grow as f32, id: record.id }
    }
}

impl<const D: usize> Visitors<D> {
    /// Returns the last coordinate of a visitor in its own grid. The bundle number forms the
    /// highest bits.
    #[inline(always)]
    fn along_last(&self, bundle: u64, record: &Record<D, f32>) -> f64 {
        let in_bundle = ((1u64 << self.bits) - 1) as u32;
        (bundle << self.bits) as f64 + f64::from(record.at[D - 1] & in_bundle)
    }

    /// Writes the numbers of the records that may reach the visited bundle; returns how many.
    #[inline(always)]
    fn near(&self, bundle: u64, records: &[Record<D, f32>], near: &mut [u8; TOGETHER]) -> usize {
        // About half of the records are too far away: no branch can be predicted.
        let mut count = 0;
        for (k, record) in records.iter().enumerate() {
            let z = self.along_last(bundle, record);
            let reach = self.each * f64::from(record.radius);
            near[count] = k as u8;
            let far = (z + reach < self.below) | (z - reach > self.above);
            count += usize::from(!far);
        }
        count
    }
}

impl<const D: usize> Kernel for Visit<'_, D> {
    type Output = ();

    #[inline(always)]
    fn run<W: Wide>(mut self, w: W) {
        let (host, number, slack) = (self.host, self.number, self.slack);
        let Host { grid, plan, .. } = host;
        if self.slab.len == 0 {
            return;
        }
        let one = (1u64 << grid.bits) as f64;
        let view = View {
            grid,
            layers: [number, number + 1].map(|k| (k << plan.layers) as f64 * one),
            steps: fill(|k| (grid.count[k] << grid.bits) as f64),
            largest: grid.length(host.largest),
            absolute: grid.length(slack.absolute),
            relative: slack.relative,
        };
        let (mut patches, mut waiting) = ([Patch::EMPTY; PATCHES], 0);
        for host_of_visitors in self.larger.iter().flatten() {
            let Some(from) = view.visitors(host_of_visitors) else { continue };
            for bundle in from.first..=from.last {
                let blocks = host_of_visitors.lists.blocks(bundle as usize);
                for records in blocks.flat_map(|block| block.chunks(TOGETHER)) {
                    let mut near = [0; TOGETHER];
                    let count = from.near(bundle, records, &mut near);
                    for &k in &near[..count] {
                        let record = &records[usize::from(k)];
                        let visitor = view.visitor(&from, record, from.along_last(bundle, record));
                        host.ball(number, &view.steps, &visitor, |patch| {
                            patches[waiting] = patch;
                            waiting += 1;
                            if waiting == PATCHES {
                                w.run(Tests { visit: &mut self, patches: &patches });
                                waiting = 0;
                            }
                        });
                    }
                }
            }
        }
        w.run(Tests { visit: &mut self, patches: &patches[..waiting] });
    }
}

/// Tests of visitors against the particles in patches. They are a separate loop, because finding
/// patches is a long chain of instructions, of which the processor overlaps few.
struct Tests<'s, 'a, const D: usize> {
    visit: &'s mut Visit<'a, D>,
    patches: &'s [Patch<D>],
}

impl<const D: usize> Kernel for Tests<'_, '_, D> {
    type Output = ();

    #[inline(always)]
    fn run<W: Wide>(self, w: W) {
        let Visit { host: Host { grid, plan, .. }, slab, output, .. } = self.visit;
        let one = (1u64 << grid.bits) as f32;
        let limits = Limits::new(w, w.all(0.0), 0.0);
        let next_row = w.load_two(&[0.0; HALF], &[one; HALF]);
        let mut counts = [0; 2];
        let stride = if D == 2 { plan.layer } else { plan.row } as u32;
        for &Patch { first, cells, rows, at, radius, grow, id } in self.patches {
            let mut query = Query { at: [w.all(at[0]); D], radius: w.all(radius) };
            query.at[D - 1] = w.all(at[D - 1]);
            // Returns where the particles of a row begin, and how many they are.
            let places = |row: u32| {
                let cell = first + row * stride;
                // SAFETY: the cells belong to the grid, in a layer of the slab, and `begin` has an
                // entry for each cell of a slab.
                let begin = unsafe { element(&slab.begin, cell as usize) };
                // SAFETY: as for `begin`; there is an entry for the border after the row.
                (begin, unsafe { element(&slab.begin, (cell + cells) as usize) } - begin)
            };
            for row in (0..rows).step_by(2) {
                let next = (row + 1).min(rows - 1);
                let ((begin, len), (begin_next, len_next)) = (places(row), places(next));
                let len_next = if next == row { 0 } else { len_next };
                let y = at[1] - row as f32 * one;
                counts[0] += u64::from(next - row) + 1;
                counts[1] += u64::from(len + len_next);
                // SAFETY: a range of places ends at most at the slab's `len`, and the arrays are a
                // vector longer.
                let run = |at: u32| unsafe { Run16::new(slab, at as usize) };
                if len | len_next < HALF as u32 {
                    query.at[1] = w.sub(w.all(y), next_row);
                    let source = TwoRuns8([run(begin), run(begin_next)]);
                    let valid = !(!0 << len) | !(!0 << len_next) << HALF;
                    let masks = test::<_, D, true>(w, source, valid, &query, limits, grow, None);
                    output.take(w, id, source, masks);
                    continue;
                }
                for (begin, len, y) in [(begin, len, y), (begin_next, len_next, y - one)] {
                    query.at[1] = w.all(y);
                    for k in (0..len).step_by(LANES) {
                        let (source, valid) =
                            (run(begin + k), !(!0 << (len - k).min(LANES as u32)));
                        let masks =
                            test::<_, D, true>(w, source, valid, &query, limits, grow, None);
                        output.take(w, id, source, masks);
                    }
                }
            }
        }
        output.hand_on();
        output.sink.count(Op::LevelProbe, counts[0]);
        output.sink.count(Op::ContactTest, counts[1]);
    }
}
