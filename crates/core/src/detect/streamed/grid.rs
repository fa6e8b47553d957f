//! The grid of a scene, and coordinates as whole numbers of steps in it.
//!
//! Let h be the edge of a cell, s = 1/h and F the number of bits of a fraction. A coordinate x is
//! stored as the whole number q nearest to Q = (x - xmin) s 2^F. With u = 2^-53 and fewer than 2^31
//! cells per axis, Q < 2^51 and its computed value is within (2u + u²)Q < 1/2 of it (scaling by 2^F
//! is exact); rounding to a whole number adds 1/2. So |q - Q| < 1.01, and differences of two
//! coordinates are within [`STEPS_OFF`] of the true ones.
//!
//! * **Cells.** Two particles that touch have |Qj - Qi| <= reach s 2^F. We take s <= (1 - 2^(2-F))
//!   / reach, up to its own rounding of 2^-49. So |qj - qi| < 2^F - 4 + 2.1, and their cells, q
//!   shifted by F, differ by at most one. This is the margin of [`crate::filter::cells`] once more,
//!   for whole numbers.
//! * **Distances.** What two rounded coordinates say of a distance is off by less than
//!   [`STEPS_OFF`] steps along each axis: see [`super::kernel`].
//!
//! **Which edge.** Cells of the reach are the smallest, but a loose scene has many of them that are
//! empty. Where there are more than [`CELLS_PER_PARTICLE`], the edge grows until there are not:
//! memory and time then depend on N only. Where particles crowd in a few such cells
//! ([`crate::detect::modern::crowd`]), the sparse form is used ([`super::sparse`]), with cells of
//! the smallest edge.

use crate::contact::{Bodies, Margin};
use crate::detect::Refusal;
use crate::detect::modern::crowd::{CROWD, company};
use crate::filter::bounds_by;
use crate::filter::cells::MOST_CELLS;
use crate::scene::Real;
use crate::sink::splitmix64;

/// Bits of the fraction of a coordinate, at most.
const FRACTION: u32 = 20;
/// In the sparse form: a record then has three 64-bit words.
pub(super) const SPARSE_FRACTION: u32 = 16;
/// A grid with fewer bits is not used.
const FEWEST: u32 = 12;
/// Differences of coordinates are within this many steps of the true ones.
pub(super) const STEPS_OFF: f64 = 2.1;
/// Measured: more than this cost more than longer ranges of candidates do. With 2.5 crowded scenes
/// lose more than loose ones gain.
pub(super) const CELLS_PER_PARTICLE: f64 = 3.0;
/// Measured: so many bodies in a column of a flat grid, in 2D and in 3D, are one or two vectors of
/// candidates in each range.
const COLUMN: [f64; 2] = [8.5, 8.0];
/// Columns per body in a flat grid, at most: where bodies are few, caches hold more of them.
const COLUMNS_PER_BODY: f64 = 6.0;
/// So few particles that a crowd does not matter.
pub(super) const FEW: usize = 4096;
/// 2^52: added to a number below it, it leaves the nearest whole number in the lowest bits.
const WHOLE: f64 = (1u64 << 52) as f64;

/// Cells of a scene, with its axes in the order of their lengths: cells side by side along the
/// first are side by side in memory, layers are cut across the last, the longest. A flat grid has
/// the shortest in the middle; in 2D it has one layer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid<const D: usize> {
    axes: [usize; D],
    low: [f64; D],
    /// 1 / edge.
    scale: f64,
    /// Bits of the fraction.
    pub bits: u32,
    /// Cells per axis.
    pub count: [u64; D],
    /// Are the cells of the second axis taken together?
    pub flat: bool,
}

/// How the neighbours of a particle are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// By an array over all cells of a grid.
    Dense,
    /// By an array over the columns of a grid: the second axis has no cells.
    Flat,
    /// By the occupied cells alone.
    Sparse,
}

/// The least and the largest coordinates.
type Corners<const D: usize> = ([f64; D], [f64; D]);

/// The axes of a box, the longest last.
///
/// # Errors
/// [`Refusal::Extent`].
pub(super) fn axes<const D: usize>((low, high): Corners<D>) -> Result<[usize; D], Refusal> {
    let mut axes: [usize; D] = std::array::from_fn(|k| k);
    for axis in 0..D {
        if !(high[axis] - low[axis]).is_finite() {
            let name = ["x", "y", "z"][axis.min(2)];
            return Err(Refusal::Extent { axis: name, low: low[axis], high: high[axis] });
        }
    }
    axes.sort_by(|&a, &b| (high[a] - low[a]).total_cmp(&(high[b] - low[b])));
    Ok(axes)
}

/// Where the bodies are that a grid is for, and how far they reach.
#[derive(Clone, Copy, Debug)]
pub(super) struct Domain<const D: usize> {
    axes: [usize; D],
    low: [f64; D],
    high: [f64; D],
    lengths: [f64; D],
    reach: f64,
    bodies: usize,
}

impl<const D: usize> Domain<D> {
    /// Of so many bodies in a box, of which none farther apart than `reach` touch.
    ///
    /// # Errors
    /// [`Refusal::Extent`].
    pub fn new(corners: Corners<D>, reach: f64, bodies: usize) -> Result<Domain<D>, Refusal> {
        Ok(Domain::along(axes(corners)?, corners, reach, bodies))
    }

    /// The same, with the axes in a given order.
    pub fn along(
        axes: [usize; D],
        (low, high): Corners<D>,
        reach: f64,
        bodies: usize,
    ) -> Domain<D> {
        Domain {
            axes,
            low: axes.map(|k| low[k]),
            high: axes.map(|k| high[k]),
            lengths: axes.map(|k| high[k] - low[k]),
            reach: reach.clamp(f64::MIN_POSITIVE * 4.0, f64::MAX),
            bodies,
        }
    }

    fn grid(&self, edge: f64, bits: u32) -> Grid<D> {
        let scale = (1.0 - 4.0 / (1u64 << bits) as f64) / edge;
        // The cast saturates: too many cells are too many.
        let count = self.lengths.map(|length| ((length * scale) as u64).saturating_add(2));
        Grid { axes: self.axes, low: self.low, scale, bits, count, flat: false }
    }

    /// The grid for the form by cells, if its cells can be numbered; and whether particles may
    /// crowd in them, since they are wider than they must be.
    pub fn dense(&self) -> Option<(Grid<D>, bool)> {
        let edge = edge_for(self.lengths, self.reach, self.bodies);
        let wide = self.grid(edge, FRACTION);
        // x and row of a particle must be known from 32 bits of its coordinates. Layers have lists,
        // and bundles few enough of them.
        let bits = bits_for(&wide.count[..D - 1]);
        if bits < FEWEST || wide.count[D - 1] >= 1 << 31 {
            return None;
        }
        Some((self.grid(edge, bits), edge != self.reach && self.bodies > FEW))
    }

    /// A grid that is flat along the shortest axis, where few bodies are so far apart that a column
    /// of cells holds few of them: they then have fewer ranges to look at, and cells that are not
    /// wider than they must be. In 2D all are in one layer. Where it is asked for, there only must
    /// not be too many columns.
    fn flat(&self, asked: bool) -> Option<Grid<D>> {
        let order = |k: usize| [1, 0, 2][k];
        let turned = Domain {
            axes: std::array::from_fn(|k| self.axes[order(k)]),
            low: std::array::from_fn(|k| self.low[order(k)]),
            high: std::array::from_fn(|k| self.high[order(k)]),
            lengths: std::array::from_fn(|k| self.lengths[order(k)]),
            ..*self
        };
        let count = turned.grid(self.reach, FRACTION).count;
        let columns = count[0] as f64 * if D == 2 { 1.0 } else { count[D - 1] as f64 };
        let (n, bits) = (self.bodies as f64, bits_for(&count[..2]));
        let few =
            columns <= COLUMNS_PER_BODY * n.max(64.0) && bits >= FEWEST && count[D - 1] < 1 << 31;
        let pays = self.bodies <= FEW && n <= COLUMN[D - 2] * columns;
        (few && (pays || asked)).then(|| Grid { flat: true, ..turned.grid(self.reach, bits) })
    }

    /// The grid for the sparse form.
    fn sparse(&self, points: bool) -> Result<Grid<D>, Refusal> {
        // Points without extent touch only where they coincide (or underflow): any larger cell will
        // do.
        let points = if points {
            self.lengths.iter().copied().fold(0.0, f64::max)
                / libm::pow(self.bodies.max(1) as f64, 1.0 / D as f64)
        } else {
            0.0
        };
        let small = self.grid(self.reach.max(points), SPARSE_FRACTION);
        for k in 0..D {
            let cells = self.lengths[k] * small.scale;
            if cells >= MOST_CELLS - 4.0 {
                let axis = ["x", "y", "z"][self.axes[k].min(2)];
                let (low, high) = (self.low[k], self.high[k]);
                return Err(Refusal::Domain { axis, low, high, edge: 1.0 / small.scale, cells });
            }
        }
        Ok(small)
    }
}

impl<const D: usize> Grid<D> {
    /// The grid for a scene, and the form that suits it or is asked for; `threads` look for the
    /// scene's box.
    pub fn new<T: Real>(
        bodies: &impl Bodies<T, D>,
        asked: Option<Form>,
        threads: usize,
    ) -> Result<(Grid<D>, Form), Refusal> {
        let reach = reach_of(bodies);
        let domain = Domain::new(bounds_by(bodies, threads), reach, bodies.len())?;
        if let None | Some(Form::Flat) = asked
            && let Some(grid) = domain.flat(asked.is_some())
            && (asked.is_some() || !crowded(&grid, bodies))
        {
            return Ok((grid, Form::Flat));
        }
        if asked != Some(Form::Sparse)
            && let Some((grid, may_crowd)) = domain.dense()
            && (asked.is_some() || !may_crowd || !crowded(&grid, bodies))
        {
            return Ok((grid, Form::Dense));
        }
        Ok((domain.sparse(reach <= T::UNDERFLOW)?, Form::Sparse))
    }

    /// The coordinates of a particle in steps, in the order of the grid's axes.
    #[inline(always)]
    pub fn steps(&self, position: [f64; D]) -> [u64; D] {
        std::array::from_fn(|k| self.along(k, position[self.axes[k]]))
    }

    /// The same along one of the grid's axes.
    #[inline(always)]
    pub fn along(&self, k: usize, x: f64) -> u64 {
        // Not negative: the box was made from all particles.
        let cells = (x - self.low[k]) * self.scale;
        (cells * (1u64 << self.bits) as f64 + WHOLE).to_bits() & ((1 << 52) - 1)
    }

    /// Which of the scene's axes is this one of the grid's?
    pub fn axis(&self, k: usize) -> usize {
        self.axes[k]
    }

    /// How many steps of this grid are in one of another.
    pub fn finer_than(&self, other: &Grid<D>) -> f64 {
        let bits = (1u64 << self.bits) as f64 / (1u64 << other.bits) as f64;
        self.scale / other.scale * bits
    }

    /// The origin of another grid with the same order of axes, in steps of this one.
    pub fn origin_of(&self, other: &Grid<D>) -> [f64; D] {
        std::array::from_fn(|k| self.length(other.low[k] - self.low[k]))
    }

    /// A length in steps.
    pub fn length(&self, length: f64) -> f64 {
        length * self.scale * (1u64 << self.bits) as f64
    }

    /// The cell of a point, or its column, as a number that others hardly have.
    pub fn cell(&self, position: [f64; D]) -> u64 {
        let mut steps = self.steps(position);
        if self.flat {
            steps[1] = 0;
        }
        steps.iter().fold(0, |key, q| splitmix64(key ^ q >> self.bits))
    }
}

/// Do bodies crowd in few cells, or columns, of a grid?
fn crowded<T: Real, const D: usize>(grid: &Grid<D>, bodies: &impl Bodies<T, D>) -> bool {
    let cell = |id| (0, grid.cell(bodies.position(id)));
    company(bodies.len(), cell, |_| bodies.len())[0] > CROWD
}

/// The reach of the contact test; of the test without the book's filters, where those are asked
/// for: whole numbers of steps have no such form.
pub(super) fn reach_of<T: Real, const D: usize>(bodies: &impl Bodies<T, D>) -> f64 {
    match bodies.margin() {
        Margin::Safe => bodies.reach(),
        Margin::Textbook => {
            let half = 0.5 * bodies.reach();
            bodies.slack().reach(half, half)
        }
    }
}

/// Bits of a fraction with which coordinates along axes of so many cells have 32 bits.
fn bits_for(count: &[u64]) -> u32 {
    let most = count.iter().fold(1, |most, &count| most.max(count));
    FRACTION.min(most.leading_zeros().saturating_sub(32))
}

/// The smallest edge from `reach` on with which there are not too many cells.
fn edge_for<const D: usize>(lengths: [f64; D], reach: f64, n: usize) -> f64 {
    let most = CELLS_PER_PARTICLE * n.max(64) as f64;
    // With the borders.
    let cells = |edge: f64| lengths.iter().map(|length| length / edge + 2.0).product::<f64>();
    if cells(reach) <= most {
        return reach;
    }
    // Between the reach and the longest axis; an axis shorter than the edge has one cell.
    let (mut small, mut large) = (reach, lengths.iter().copied().fold(reach, f64::max));
    while large / small > 1.02 {
        let middle = small.sqrt() * large.sqrt();
        if cells(middle) <= most { large = middle } else { small = middle }
    }
    large
}
