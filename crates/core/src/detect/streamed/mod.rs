//! `streamed-nbs`: the idea of Munjiza-NBS on the hardware of today.
//!
//! NBS goes through a scene layer by layer, looks at occupied cells only, and keeps two layers at a
//! time (Munjiza 2004, sections 3.8 to 3.11). In 1998 that saved memory. Today it is what a
//! processor wants: two layers stay in its cache, and cells in order make ranges that its vector
//! registers test sixteen at a time.
//!
//! 1. One pass over the scene finds its box, one more puts a record of each particle (coordinates
//!    in whole steps of a millionth of a cell, number: 16 bytes in 3D) on the list of its bundle of
//!    layers. Both read and write memory in order.
//! 2. Bundle after bundle is sorted by cell, by counting, into one array per coordinate.
//! 3. Each particle is tested against the rest of its cell and the cell beside it, the three cells
//!    in front in the next row, and the nine in the next layer: five contiguous ranges (two in 2D),
//!    sixteen particles in one go, in f32; one by one where registers are narrow (`single.rs`).
//! 4. What f32 cannot decide, some pairs in ten thousand contacts, is left to the contact test; see
//!    `kernel.rs` for the bounds.
//!
//! Loose scenes get larger cells, about three cells per particle, scenes whose particles crowd in
//! few of those cells the sparse form (`sparse.rs`). A few thousand particles that are far apart
//! get columns instead of cells, one axis being left to the distances: two ranges, and one in 2D.
//!
//! Where sizes differ so much that one width of cells does not suit all, bodies are parted into
//! classes of sizes (`classes.rs`), each with its own grid and sweep (`levels.rs`); while a bundle
//! is in cache, larger bodies visit it (`visits.rs`), row by row of the cells within reach. A class
//! that crowds is left to [`HGrid`], and all others with it.
//!
//! * Cost: proportional to N, independent of the packing density; in the sparse form to N and the
//!   digits of its cells' numbers; with classes, to N in each class that they are visited by.
//! * Memory, for lists (blocks of b records, L lists): `(16 + 4/b)(N + bL) + 4L` bytes in 3D, 12
//!   instead of 16 in 2D, 4 more with a radius per particle; one list alone has room for one record
//!   more than N. Two bundles of n particles and c cells: `2(4(D + 2)(n + 16) + 4(c + 2))`, and the
//!   records of one. A bundle has 2,000 to 4,000 particles, or one layer if that is more. With
//!   classes of sizes: the lists of each, and two bundles that hold the largest of any. In the
//!   sparse form: 24N, 32N with radii, and two layers. Some 9 KiB of working space per thread. With
//!   several threads: bundles for each, and the contacts, 8 bytes each in lists of twice the length
//!   at most; then a warm call allocates what shares the work.
//! * Refuses scenes of 2^31 cells and more along an axis in the sparse form, extents
//!   that overflow, and more than 2^31 - 1 particles.
//! * Threads: in the dense form, from 30,000 particles on; one where there are classes of sizes.
//! * In `textbook` arithmetic its filters are as safe as in f64, but for classes that are left to
//!   [`HGrid`]: the book prints none for it.

mod classes;
mod dense;
mod grid;
mod kernel;
mod levels;
mod lists;
mod near;
mod pair_sink;
mod plan;
mod ranges;
mod single;
mod slab;
mod sparse;
mod unchecked;
mod visits;

use classes::Classes;
pub use grid::Form;
use grid::Grid;
use kernel::{Bounds, Scratch};
use lists::{Lists, Room};
use slab::Slab;
use sparse::Sparse;

use super::book::list::numbered;
use super::modern::copies::Touch;
use super::modern::hgrid::HGrid;
use super::{Declare, Detector, Options, Refusal};
use crate::contact::Bodies;
use crate::probe::{Probe, Silent};
use crate::scene::Real;
use crate::sink::Sink;
use crate::wide::Level;

const NAME: &str = "streamed-nbs";
/// Fewer particles are not worth a second thread.
pub const FEWEST_FOR_THREADS: usize = 30_000;

/// The modern NBS, in `D` dimensions.
pub struct Streamed<const D: usize> {
    options: Options,
    level: Level,
    form: Option<Form>,
    workers: Vec<Worker<D>>,
    /// Buffers for scenes with one radius, and with one per particle.
    uniform: Buffers<D, ()>,
    each: Buffers<D, f32>,
    /// For classes of sizes that crowd.
    crowded: HGrid<D>,
    formula: u64,
}

/// What one thread works with: workers lie side by side, and no two share a line of the caches.
#[derive(Default)]
#[repr(align(128))]
struct Worker<const D: usize> {
    slabs: [Slab<D>; 2],
    room: Room<D>,
    scratch: Scratch,
    pairs: Vec<[u32; 2]>,
}

struct Buffers<const D: usize, R> {
    lists: Vec<Lists<D, R>>,
    sparse: Sparse<D, R>,
}

impl<const D: usize, R> Default for Buffers<D, R> {
    fn default() -> Self {
        Buffers { lists: Vec::new(), sparse: Sparse::default() }
    }
}

impl<const D: usize> Streamed<D> {
    /// A detector that uses these instructions.
    pub fn on(level: Level, options: Options) -> Streamed<D> {
        Streamed {
            options,
            level,
            form: None,
            workers: Vec::new(),
            uniform: Buffers::default(),
            each: Buffers::default(),
            crowded: HGrid::with(options),
            formula: 0,
        }
    }

    /// In this form, whatever the scene; not by cells or columns where there are too many of them.
    /// Where sizes differ so much that there are classes, columns are cells.
    pub fn in_form(self, form: Form) -> Streamed<D> {
        Streamed { form: Some(form), ..self }
    }
}

impl<const D: usize> Declare for Streamed<D> {
    const DECIDES_FROM_COPIES: bool = true;

    fn with(options: Options) -> Streamed<D> {
        Streamed::on(Level::best(), options)
    }

    fn formula_bytes(&self) -> u64 {
        self.formula
    }
}

impl<T: Real, const D: usize> Detector<T, D> for Streamed<D> {
    fn detect<B: Bodies<T, D>, P: Probe, S: Sink>(
        &mut self,
        bodies: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        let classes = if self.form == Some(Form::Sparse) { None } else { Classes::of(&bodies) };
        match classes {
            Some(classes) => self.by_class(&classes, bodies, probe, sink),
            None => self.sweep(bodies, probe, sink),
        }
    }
}

impl<const D: usize> Streamed<D> {
    /// Finds the contacts of bodies whose sizes do not differ too much.
    fn sweep<T: Real, B: Bodies<T, D>, P: Probe, S: Sink>(
        &mut self,
        bodies: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        let n = bodies.len();
        numbered(NAME, n)?;
        let threads = if P::SILENT && n >= FEWEST_FOR_THREADS { self.options.threads } else { 1 };
        let (grid, form) = Grid::new(&bodies, self.form, threads)?;
        let turn = if form == Form::Sparse { sparse::TURN } else { None };
        let bounds = Bounds::new(&bodies, &grid, turn);
        let Streamed { options, level, workers, uniform, each, formula, .. } = self;
        let mut run = Run {
            options,
            threads: threads.max(1),
            level: *level,
            workers,
            formula,
            n,
            grid,
            bounds,
            touch: &|i, j, probe: &mut P| bodies.touch(i, j, probe),
            touch_silent: &|i, j, probe: &mut Silent| bodies.touch(i, j, probe),
        };
        match (form, bodies.uniform().is_some()) {
            (Form::Dense | Form::Flat, true) => run.dense::<_, _, false>(
                &mut uniform.lists,
                &|lists, share, plan| lists.fill(&bodies, share, &grid, plan, *level),
                probe,
                sink,
            ),
            (Form::Dense | Form::Flat, false) => run.dense::<_, _, true>(
                &mut each.lists,
                &|lists, share, plan| lists.fill(&bodies, share, &grid, plan, *level),
                probe,
                sink,
            ),
            (Form::Sparse, true) => run.sparse::<_, _, false>(
                &mut uniform.sparse,
                &|sparse| sparse.fill(&bodies, &grid),
                probe,
                sink,
            ),
            (Form::Sparse, false) => run.sparse::<_, _, true>(
                &mut each.sparse,
                &|sparse| sparse.fill(&bodies, &grid),
                probe,
                sink,
            ),
        }
    }
}

/// One detection. What it needs of the bodies is behind references, which are called once per
/// thread, or for pairs that the kernel cannot decide: so all is compiled once for all kinds of
/// bodies.
struct Run<'a, P, const D: usize> {
    options: &'a Options,
    threads: usize,
    level: Level,
    workers: &'a mut Vec<Worker<D>>,
    formula: &'a mut u64,
    n: usize,
    grid: Grid<D>,
    bounds: Bounds,
    touch: Touch<'a, P>,
    /// For threads beside this one, which cannot share a probe.
    touch_silent: Touch<'a, Silent>,
}
