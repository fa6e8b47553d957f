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
//! are in few bundles of each larger class. From their records the code makes patches of rows, and
//! tests the patches in a second loop ([`Tests`]).
//!
//! **Which cells.** Let Q be the true coordinates of a particle in steps of the visited grid and q
//! the integers that determine its cell: |q - Q| < 1.01 ([`super::grid`]). A visitor has integers p
//! of its own grid, also within 1.01 of the true ones. The code computes v = m·p + c in steps of
//! the visited grid, with relative errors of m and c below 2^-49. So v is within 1.01m + (m·p +
//! |c|)2^-47 of the true coordinate. A pair that touches has |Qj - Qi| <= ρ, the reach in steps,
//! computed with a relative error below 2^-49. Over three axes these errors are at most √3 · 1.01 ·
//! (1 + m), and rounding limits to whole steps adds half a step. So |qj - v| <= R = ρ + 3 + 2m +
//! (ρ + m·p + |c|)2^-46, where m·p + |c| is the largest over all axes. R exceeds the bound by 0.75
//! steps, which covers the rounding of distances of v from cell borders. Classes with m >= 2^40 or
//! an infinite c do not visit each other ([`super::levels`]); so squares are at most 2^124 and fit
//! in f32. A visitor so far away that its margin overflows is beyond the grid.
//!
//! **Distances** are decided as in [`super::kernel`]. Differences of coordinates are off by at most
//! 1.01 + 1.01m + (m·p + |c|)2^-47 along each axis. Along x both coordinates are rounded to 24
//! bits. Along the other axes the kernel is exact, but here two numbers are rounded to 24 bits: v
//! minus the origin of the cell, which is at most R plus one cell, and the difference. For later
//! rows of a patch whole cells are subtracted, which leaves at most R. This adds at most 2^-22 R
//! per axis, so the relative part of the bound is 2^-18 instead of 2^-19. A cell
//! wider than R adds one cell to the bound; the bound for x, with at least two cells, covers it.

use super::grid::Grid;
use super::kernel::{Limits, Query, test};
use super::lists::{Lists, Record};
use super::output::Output;
use super::plan::Plan;
use super::slab::Slab;
use super::unchecked::{Run16, TwoRuns8, element};
use contactbench_ground::contact::Slack;
use contactbench_ground::probe::Op;
use contactbench_ground::wide::fill;
use contactbench_ground::wide::{HALF, Kernel, LANES, Wide};

/// Rows in which a reach exceeds this many cells are shortened to chords, two rows at a time.
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

/// A larger particle in steps of the visited grid.
struct Visitor<const D: usize> {
    at: [f64; D],
    /// Largest distance at which a particle of the visited class can touch the visitor.
    reach: f64,
    radius: f32,
    /// Bound on the errors of distances, like [`Bounds::grow`](super::kernel::Bounds).
    grow: f32,
    id: u32,
}

/// Adjacent rows of a layer within reach of a visitor, with the same cells along x.
#[derive(Clone, Copy)]
struct Patch<const D: usize> {
    /// First cell of the first row, number of cells in a row, and number of rows.
    first: u32,
    cells: u32,
    rows: u32,
    /// The visitor's coordinates in steps, relative to the first row, apart from x.
    at: [f32; D],
    /// The visitor's radius plus `grow`.
    radius: f32,
    grow: f32,
    id: u32,
}

impl<const D: usize> Patch<D> {
    const EMPTY: Patch<D> =
        Patch { first: 0, cells: 0, rows: 0, at: [0.0; D], radius: 0.0, grow: 0.0, id: 0 };
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
/// 2^52: adding it to a smaller number leaves the nearest integer in the lowest bits.
const WHOLE: f64 = (1u64 << 52) as f64;

/// Returns the larger number, or `b` if `a` is NaN. `f64::max` has to check both.
#[inline(always)]
fn max(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// Returns the smaller number, or `b` if `a` is NaN.
#[inline(always)]
fn min(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// Returns the first and the last cell within a distance of `x` on an axis of this many steps.
#[inline(always)]
fn cells(steps: f64, bits: u32, x: f64, distance: f64) -> (usize, usize) {
    let top = steps - 1.0;
    // The exponent of the sum is in bits 52 and above, so beyond the 32 bits that are kept.
    let cell = |x: f64| ((x + WHOLE).to_bits() >> bits) as u32 as usize;
    // For NaN the lower limit is the first cell, the upper limit the last.
    (cell(min(max(x - distance, 0.0), top)), cell(max(min(x + distance, top), 0.0)))
}

impl<const D: usize> Host<'_, D> {
    /// Calls `add` for each patch of a bundle's cells within reach of a visitor.
    #[inline(always)]
    fn ball(
        &self,
        bundle: usize,
        steps: &[f64; D],
        visitor: &Visitor<D>,
        mut add: impl FnMut(Patch<D>),
    ) {
        let Host { grid, plan, .. } = *self;
        let Visitor { at, reach, radius, grow, id } = *visitor;
        if (0..D).any(|k| at[k] + reach < 0.0 || at[k] - reach > steps[k]) {
            return;
        }
        let cells = |axis: usize, distance| {
            let parts = if axis == 0 { plan.parts } else { 0 };
            cells(steps[axis], grid.bits - parts, at[axis], distance)
        };
        let one = (1u64 << grid.bits) as f64;
        // Returns the squared distance of the visitor from a cell along an axis, and its offset
        // from the cell's origin.
        let from_cell = |axis: usize, cell: usize| {
            let origin = at[axis] - cell as f64 * one;
            let gap = max(max(-origin, origin - one), 0.0);
            (gap * gap, origin as f32)
        };
        // Adds the patches of rows in a layer. `left` is the squared reach less the squared gap to
        // the layer, `offset` the index of the first row's first cell.
        let wide = reach > CLIP * one;
        let mut rows = |left: f64, root, (mut row, last): (usize, usize), z, mut offset, stride| {
            while row <= last {
                let next = last.min(row + 1);
                let ((of_row, y), (of_next, _)) = (from_cell(1, row), from_cell(1, next));
                let (rows, chord) = if wide {
                    (next + 1 - row, max(left - min(of_row, of_next), 0.0).sqrt())
                } else {
                    (last + 1 - row, root)
                };
                let (from, to) = cells(0, chord);
                let mut patch = Patch {
                    first: (offset + from) as u32,
                    cells: (to + 1 - from) as u32,
                    rows: rows as u32,
                    at: [at[0] as f32; D],
                    radius: radius + grow,
                    grow,
                    id,
                };
                patch.at[D - 1] = z;
                patch.at[1] = y;
                add(patch);
                row += rows;
                offset += rows * stride;
            }
        };
        let square = reach * reach * (1.0 + 1.0 / (1u64 << 48) as f64);
        let (first, last) = cells(D - 1, reach);
        let begin = bundle << plan.layers;
        let (first, last) = (first.max(begin), last.min(begin + (1 << plan.layers) - 1));
        if D == 2 {
            // Each layer is a single row.
            let offset = (first - begin) * plan.layer + (1 << plan.parts);
            rows(square, reach, (first, last), 0.0, offset, plan.layer);
            return;
        }
        for layer in first..=last {
            let (of_layer, z) = from_cell(D - 1, layer);
            let left = square - of_layer;
            if left < 0.0 {
                continue;
            }
            let root = left.sqrt();
            let among = cells(1, root);
            let row = (among.0 + 1) * plan.row + (1 << plan.parts);
            let offset = (layer - begin) * plan.layer + row;
            rows(left, root, among, z, offset, plan.row);
        }
    }
}

impl<const D: usize> Kernel for Visit<'_, D> {
    type Output = ();

    #[inline(always)]
    fn run<W: Wide>(mut self, w: W) {
        let (host, number) = (self.host, self.number);
        let Host { grid, plan, .. } = host;
        if self.slab.len == 0 {
            return;
        }
        let one = (1u64 << grid.bits) as f64;
        let layers = [number, number + 1].map(|k| (k << plan.layers) as f64 * one);
        let steps: [f64; D] = fill(|k| (grid.count[k] << grid.bits) as f64);
        let (largest, absolute) = (grid.length(host.largest), grid.length(self.slack.absolute));
        let slack = self.slack;
        let reach_of =
            |radius: f64| (radius + largest) * (1.0 + slack.relative) * (1.0 + EPSILON) + absolute;
        let (mut patches, mut waiting) = ([Patch::EMPTY; PATCHES], 0);
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
            // Casts saturate; NaN becomes 0 in the lower limit and the largest integer in the upper
            // limit.
            let last = if high.is_nan() { u64::MAX } else { high as u64 };
            let bits = from.grid.bits + from.plan.layers;
            let most = from.plan.slabs as u64 - 1;
            let (first, last) = ((low as u64 >> bits).min(most), (last >> bits).min(most));
            // The same limits for a visitor of radius 0, and what each step of radius adds.
            let none = (reach_of(0.0) + spare) / scale;
            let (below, above) = (back(layers[0]) - none, back(layers[1]) + none);
            let each = (1.0 + slack.relative) * (1.0 + 2.0 * EPSILON);
            for bundle in first..=last {
                // The bundle number forms the highest bits of the last coordinate.
                let origin = (bundle << bits) as f64;
                let in_bundle = ((1u64 << bits) - 1) as u32;
                let along_last =
                    |record: &Record<D, f32>| origin + f64::from(record.at[D - 1] & in_bundle);
                let blocks = from.lists.blocks(bundle as usize);
                for records in blocks.flat_map(|block| block.chunks(TOGETHER)) {
                    // About half of the records are too far away: no branch can be predicted.
                    let (mut near, mut count) = ([0; TOGETHER], 0);
                    for (k, record) in records.iter().enumerate() {
                        let (z, reach) = (along_last(record), each * f64::from(record.radius));
                        near[count] = k as u8;
                        let far = (z + reach < below) | (z - reach > above);
                        count += usize::from(!far);
                    }
                    for &k in &near[..count] {
                        let record = &records[usize::from(k)];
                        let z = along_last(record);
                        let p: [f64; D] =
                            fill(|k| if k < D - 1 { f64::from(record.at[k]) } else { z });
                        let at: [f64; D] = fill(|k| scale * p[k] + shift[k]);
                        let radius = scale * f64::from(record.radius);
                        let far =
                            (0..D).fold(0.0, |far, k| max(scale * p[k] + shift[k].abs(), far));
                        let reach = reach_of(radius);
                        let reach = reach + 3.0 + 2.0 * scale + (reach + far) / (1u64 << 46) as f64;
                        let grow = 2.0 * (1.0 + scale)
                            + far / (1u64 << 45) as f64
                            + (steps[0] + at[0].abs()) / f64::from(1 << 23)
                            + 2.0
                            + absolute
                            + reach * (slack.relative + 1.0 / f64::from(1 << 18));
                        let (grow, radius, id) = (grow as f32, radius as f32, record.id);
                        let visitor = Visitor { at, reach, radius, grow, id };
                        host.ball(number, &steps, &visitor, |patch| {
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
