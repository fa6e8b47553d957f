//! The grid of a scene, and coordinates as integer steps in it.
//!
//! Let h be the edge of a cell, s = 1/h and F the number of fraction bits. A coordinate x is stored
//! as the integer q nearest to Q = (x - xmin) s 2^F. Let u = 2^-53, and let an axis have fewer than
//! 2^31 cells. Then Q < 2^51, and its computed value is off by at most (2u + u²)Q < 1/2 (scaling by
//! 2^F is exact). Rounding to an integer adds 1/2. So |q - Q| < 1.01, and the difference of two
//! coordinates is within [`STEPS_OFF`] of the true one.
//!
//! * **Cells.** Two particles that touch have |Qj - Qi| <= reach s 2^F. The code chooses s <= (1 -
//!   2^(2-F)) / reach, up to its own rounding of 2^-49. So |qj - qi| < 2^F - 4 + 2.1, and their
//!   cells, q shifted right by F, differ by at most one. This margin corresponds to that of
//!   [`contactbench_ground::filter::cells`].
//! * **Distances.** A distance computed from two rounded coordinates is off by less than
//!   [`STEPS_OFF`] steps along each axis: see [`super::kernel`].
//!
//! **Which edge.** Cells as wide as the reach are the smallest, but in a loose scene many of them
//! are empty. Above [`CELLS_PER_PARTICLE`] cells per particle the edge grows, so that memory and
//! time depend only on the number of particles. If particles crowd in a few of these wider cells
//! ([`contactbench_ground::detect::company`]), the sparse form with the smallest cells is used
//! ([`super::sparse`]).

use contactbench_ground::contact::{Margin, Particles};
use contactbench_ground::detect::company::{CROWD, company};
use contactbench_ground::filter::cells::MOST_CELLS;
use contactbench_ground::filter::{axes_by_length, bounds_by};
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::scene::Real;
use contactbench_ground::wide::fill;
use contactbench_terms::mix::splitmix64;

/// Maximum number of fraction bits of a coordinate.
const FRACTION: u32 = 20;
/// Number of fraction bits in the sparse form, in which a record has three 64-bit words.
pub(super) const SPARSE_FRACTION: u32 = 16;
/// Minimum number of fraction bits; a grid with fewer is not used.
const FEWEST: u32 = 12;
/// Error bound for a difference of two coordinates, in steps.
pub(super) const STEPS_OFF: f64 = 2.1;
/// Maximum number of cells per particle, a measured optimum: more cells cost more than longer
/// ranges of candidates. A value of 2.5 costs crowded scenes more time than it saves loose ones.
pub(super) const CELLS_PER_PARTICLE: f64 = 3.0;
/// Maximum number of particles per column of a flat grid, in 2D and 3D: one or two vectors of
/// candidates per range (measured).
const COLUMN: [f64; 2] = [8.5, 8.0];
/// Maximum number of columns per particle in a flat grid; with few particles, caches hold more
/// columns.
const COLUMNS_PER_BODY: f64 = 6.0;
/// Scenes with at most this many particles are not checked for crowds.
pub(super) const FEW: usize = 4096;
/// 2^52: adding it to a smaller number leaves the nearest integer in the lowest bits.
const WHOLE: f64 = (1u64 << 52) as f64;

/// Grid of cells with its axes sorted by length. Cells adjacent along the first axis are adjacent
/// in memory. Layers are perpendicular to the last, longest axis. In a flat grid the shortest axis
/// is the second; in 2D a flat grid has one layer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid<const D: usize> {
    axes: [usize; D],
    low: [f64; D],
    /// Reciprocal of the cell's edge, slightly reduced.
    scale: f64,
    /// Number of fraction bits of a coordinate.
    pub bits: u32,
    pub count: [u64; D],
    /// Whether cells along the second axis are merged into columns.
    pub flat: bool,
}

contactbench_terms::named! {
    /// How a grid finds the neighbours of a particle.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Form {
        /// Reads an array over all cells of a grid.
        Dense = "dense",
        /// Reads an array over the columns of a grid, whose second axis is not divided.
        Flat = "flat",
        /// Sorts particles by cell and stores no array over cells.
        Sparse = "sparse",
    }
}

type Corners<const D: usize> = ([f64; D], [f64; D]);

/// Returns the axes of a box sorted by length, the longest last, or [`Refusal::Extent`].
pub(super) fn axes<const D: usize>((low, high): Corners<D>) -> Result<[usize; D], Refusal> {
    for axis in 0..D {
        if !(high[axis] - low[axis]).is_finite() {
            let name = ["x", "y", "z"][axis.min(2)];
            return Err(Refusal::Extent { axis: name, low: low[axis], high: high[axis] });
        }
    }
    Ok(axes_by_length(fill(|k| high[k] - low[k])))
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Domain<const D: usize> {
    axes: [usize; D],
    low: [f64; D],
    high: [f64; D],
    lengths: [f64; D],
    reach: f64,
    particles: usize,
}

impl<const D: usize> Domain<D> {
    /// Creates a domain for this many particles; a pair farther apart than `reach` does not touch.
    /// Fails with [`Refusal::Extent`] if the box is too large.
    pub fn new(corners: Corners<D>, reach: f64, particles: usize) -> Result<Domain<D>, Refusal> {
        Ok(Domain::along(axes(corners)?, corners, reach, particles))
    }

    /// Does the same as [`Domain::new`] with the axes in a given order.
    pub fn along(
        axes: [usize; D],
        (low, high): Corners<D>,
        reach: f64,
        particles: usize,
    ) -> Domain<D> {
        Domain {
            axes,
            low: axes.map(|k| low[k]),
            high: axes.map(|k| high[k]),
            lengths: axes.map(|k| high[k] - low[k]),
            reach: reach.clamp(f64::MIN_POSITIVE * 4.0, f64::MAX),
            particles,
        }
    }

    fn grid(&self, edge: f64, bits: u32) -> Grid<D> {
        let scale = (1.0 - 4.0 / (1u64 << bits) as f64) / edge;
        // The cast saturates, so an overflow still counts as too many cells.
        let count = self.lengths.map(|length| ((length * scale) as u64).saturating_add(2));
        Grid { axes: self.axes, low: self.low, scale, bits, count, flat: false }
    }

    /// Returns the grid for the dense form, if its cells can be numbered, and whether particles may
    /// crowd in it because its cells are wider than the reach.
    pub fn dense(&self) -> Option<(Grid<D>, bool)> {
        let edge = edge_for(self.lengths, self.reach, self.particles);
        let wide = self.grid(edge, FRACTION);
        // The lowest 32 bits of the coordinates must determine x and the row of a particle. Bundles
        // of layers have lists, so their number is limited.
        let bits = bits_for(&wide.count[..D - 1]);
        if bits < FEWEST || wide.count[D - 1] >= 1 << 31 {
            return None;
        }
        Some((self.grid(edge, bits), edge != self.reach && self.particles > FEW))
    }

    /// Returns a grid that is flat along the shortest axis, or `None` if this form does not pay. It
    /// pays for few particles, so far apart that a column holds few of them: there are fewer ranges
    /// than in the dense form, and cells are as narrow as the reach. In 2D all particles are in one
    /// layer. If this form is `asked` for, only the number of columns is limited.
    fn flat(&self, asked: bool) -> Option<Grid<D>> {
        let order = |k: usize| [1, 0, 2][k];
        let turned = Domain {
            axes: fill(|k| self.axes[order(k)]),
            low: fill(|k| self.low[order(k)]),
            high: fill(|k| self.high[order(k)]),
            lengths: fill(|k| self.lengths[order(k)]),
            ..*self
        };
        let count = turned.grid(self.reach, FRACTION).count;
        let columns = count[0] as f64 * if D == 2 { 1.0 } else { count[D - 1] as f64 };
        let (n, bits) = (self.particles as f64, bits_for(&count[..2]));
        let few =
            columns <= COLUMNS_PER_BODY * n.max(64.0) && bits >= FEWEST && count[D - 1] < 1 << 31;
        let pays = self.particles <= FEW && n <= COLUMN[D - 2] * columns;
        (few && (pays || asked)).then(|| Grid { flat: true, ..turned.grid(self.reach, bits) })
    }

    fn sparse(&self, points: bool) -> Result<Grid<D>, Refusal> {
        // Points touch only where they coincide (or underflow), so larger cells are safe.
        let points = if points {
            self.lengths.iter().copied().fold(0.0, f64::max)
                / libm::pow(self.particles.max(1) as f64, 1.0 / D as f64)
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
    /// Returns a grid, and its form: the one that is asked for, or one that suits the scene. The
    /// bounding box is computed on `threads` threads.
    pub fn new<T: Real>(
        particles: &impl Particles<T, D>,
        asked: Option<Form>,
        threads: usize,
    ) -> Result<(Grid<D>, Form), Refusal> {
        let reach = reach_of(particles);
        let domain = Domain::new(bounds_by(particles, threads), reach, particles.len())?;
        if let None | Some(Form::Flat) = asked
            && let Some(grid) = domain.flat(asked.is_some())
            && (asked.is_some() || !crowded(&grid, particles))
        {
            return Ok((grid, Form::Flat));
        }
        if asked != Some(Form::Sparse)
            && let Some((grid, may_crowd)) = domain.dense()
            && (asked.is_some() || !may_crowd || !crowded(&grid, particles))
        {
            return Ok((grid, Form::Dense));
        }
        Ok((domain.sparse(reach <= particles.underflow())?, Form::Sparse))
    }

    /// Returns the coordinates of a particle in integer steps, in the order of the grid's axes.
    #[inline(always)]
    pub fn steps(&self, position: [f64; D]) -> [u64; D] {
        fill(|k| self.along(k, position[self.axes[k]]))
    }

    #[inline(always)]
    pub fn along(&self, k: usize, x: f64) -> u64 {
        // Not negative, because the box contains all particles.
        let cells = (x - self.low[k]) * self.scale;
        (cells * (1u64 << self.bits) as f64 + WHOLE).to_bits() & ((1 << 52) - 1)
    }

    pub fn axis(&self, k: usize) -> usize {
        self.axes[k]
    }

    /// Returns the length of one step of another grid, in steps of this grid.
    pub fn finer_than(&self, other: &Grid<D>) -> f64 {
        let bits = (1u64 << self.bits) as f64 / (1u64 << other.bits) as f64;
        self.scale / other.scale * bits
    }

    /// Returns the origin of another grid with the same order of axes, in steps of this grid.
    pub fn origin_of(&self, other: &Grid<D>) -> [f64; D] {
        fill(|k| self.length(other.low[k] - self.low[k]))
    }

    pub fn length(&self, length: f64) -> f64 {
        length * self.scale * (1u64 << self.bits) as f64
    }

    /// Returns a number for the cell or column of a point that few other cells share.
    pub fn cell(&self, position: [f64; D]) -> u64 {
        let mut steps = self.steps(position);
        if self.flat {
            steps[1] = 0;
        }
        steps.iter().fold(0, |key, q| splitmix64(key ^ q >> self.bits))
    }
}

fn crowded<T: Real, const D: usize>(grid: &Grid<D>, particles: &impl Particles<T, D>) -> bool {
    let cell = |id| (0, grid.cell(particles.position(id)));
    company(particles.len(), cell, |_| particles.len())[0] > CROWD
}

/// Returns the reach of the contact test. For textbook margins it is the reach of the safe test,
/// because integer steps have no textbook form.
pub(super) fn reach_of<T: Real, const D: usize>(particles: &impl Particles<T, D>) -> f64 {
    match particles.margin() {
        Margin::Safe => particles.reach(),
        Margin::Textbook => {
            let half = 0.5 * particles.reach();
            particles.slack().reach(half, half)
        }
    }
}

/// Returns the fraction bits with which coordinates on axes of these cell counts fit in 32 bits.
fn bits_for(count: &[u64]) -> u32 {
    let most = count.iter().fold(1, |most, &count| most.max(count));
    FRACTION.min(most.leading_zeros().saturating_sub(32))
}

/// Returns the smallest edge, at least `reach`, with at most `CELLS_PER_PARTICLE · n` cells.
fn edge_for<const D: usize>(lengths: [f64; D], reach: f64, n: usize) -> f64 {
    let most = CELLS_PER_PARTICLE * n.max(64) as f64;
    let cells = |edge: f64| lengths.iter().map(|length| length / edge + 2.0).product::<f64>();
    if cells(reach) <= most {
        return reach;
    }
    // Bisect between the reach and the longest axis; an axis shorter than the edge has one cell.
    let (mut small, mut large) = (reach, lengths.iter().copied().fold(reach, f64::max));
    while large / small > 1.02 {
        let middle = small.sqrt() * large.sqrt();
        if cells(middle) <= most { large = middle } else { small = middle }
    }
    large
}
