//! `streamed-nbs`: Munjiza-NBS adapted to today's hardware.
//!
//! NBS processes a scene layer by layer, visits only occupied cells, and keeps two layers at a time
//! (Munjiza 2004, sections 3.8 to 3.11). In 1998 that saved memory. Today two layers stay in the
//! processor's cache, and sorted cells form ranges that vector registers test sixteen at a time.
//!
//! 1. One pass over the scene finds its bounding box. A second one appends a record of each
//!    particle (coordinates in integer steps of a millionth of a cell, number: 16 bytes in 3D) to
//!    the list of its bundle of layers. Both passes access memory in order.
//! 2. Each bundle is sorted by cell, by counting, into one array per coordinate.
//! 3. Each particle is tested against the rest of its cell and the cell beside it, the three cells
//!    in the next row, and the nine in the next layer. The particles of these cells form five
//!    contiguous ranges (two in 2D). They are tested sixteen at a time in f32, or each range
//!    alone on narrow registers (`single.rs`). If it pays, cells are divided along x
//!    (`plan.rs`). Candidates in full cells are first copied side by side (`together.rs`).
//! 4. The contact test decides what f32 cannot, a few pairs in ten thousand contacts; `kernel.rs`
//!    derives the bounds.
//!
//! Loose scenes get larger cells, about three cells per particle. Scenes whose particles crowd in
//! few of these cells use the sparse form (`sparse.rs`). Scenes of a few thousand particles that
//! are far apart get columns instead of cells: one axis is not divided, which leaves two ranges per
//! particle, or one in 2D. In scenes of at most 48 particles all pairs are tested.
//!
//! If no single cell width suits all sizes, particles are divided into size classes (`classes.rs`),
//! each with its own grid and sweep (`levels`). While a bundle is in cache, larger particles visit
//! it (`levels/visits.rs`), row by row of the cells within reach. If a class crowds, [`HGrid`]
//! detects the whole scene.
//!
//! * Cost: proportional to N, independent of the packing density. In the sparse form N is
//!   multiplied by the number of digits of cell numbers; size classes add N for each class of
//!   larger particles that visits.
//! * Memory, for lists (blocks of b records, L lists): `(16 + 4/b)(N + bL) + 4L` bytes in 3D, with
//!   12 instead of 16 in 2D, and 4 more with a radius per particle; a single list has space for one
//!   record more than N. From 1 MiB on, records take whole pages of 2 MiB. Two bundles of n
//!   particles and c cells: `2(4(D + 2)(n + 16) + 4(c + 2))`, and the records of one. A bundle has
//!   2,000 to 4,000 particles, or one layer if that is more. Classes need the lists of each and two
//!   bundles that hold the largest of any. The sparse form needs 24N, or 32N with radii, and two
//!   layers. Each thread has 32 KiB of working space. Several threads have two bundles each
//!   and collect contacts, 8 bytes each, in lists of at most twice the length needed; a repeated
//!   call allocates only what distributes the work.
//! * Refuses extents that overflow (from 49 particles on), more than 2^31 - 1 particles, and in
//!   the sparse form 2^31 or more cells along an axis.
//! * Threads are used in the dense form, from 30,000 particles on, and not with size classes.
//! * In `textbook` arithmetic the filters are as safe as in f64, except in scenes left to
//!   [`HGrid`]: the book prints no filters for this detector.

mod bounds;
pub mod classes;
mod dense;
mod grid;
pub mod hgrid;
mod kernel;
mod levels;
mod lists;
mod output;
mod plan;
mod ranges;
mod single;
mod slab;
mod sparse;
mod together;
mod unchecked;

use bounds::Bounds;
use classes::Classes;
pub use grid::Form;
use grid::Grid;
use kernel::Scratch;
use lists::{Lists, Room};
use output::Space;
use slab::Slab;
use sparse::Sparse;

use contactbench_ground::contact::Particles;
use contactbench_ground::detect::any::{AnyDetector, Both, Refuses};
use contactbench_ground::detect::copies::{self, Touch};
use contactbench_ground::detect::numbered;
use contactbench_ground::detect::{Declare, Detector, Options};
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::Sink;
use contactbench_ground::probe::{Op, Probe, Silent};
use contactbench_ground::scene::Real;
use contactbench_ground::wide::Level;
use hgrid::HGrid;

/// Returns a detector that uses the vector instructions of a [`Level`] with this name, by default
/// the best, and this form for all scenes, by default the one that suits each. Compiled here, once.
pub fn streamed(level: Option<&str>, form: Option<Form>, options: Options) -> Box<dyn AnyDetector> {
    let named = |name: &str| Level::all().into_iter().find(|level| level.name() == name);
    let Some(level) = level.map_or(Some(Level::best()), named) else {
        let has = Level::all().iter().map(|level| level.name()).collect();
        let level = level.unwrap_or_default().into();
        return Box::new(Refuses(Refusal::Instructions { level, has }));
    };
    let plane = Streamed::<2>::on(level, form, options);
    Both::join(plane, Streamed::<3>::on(level, form, options), options)
}

const NAME: &str = "streamed-nbs";
/// Minimum number of particles for more than one thread.
pub const FEWEST_FOR_THREADS: usize = 30_000;

/// The `streamed-nbs` detector, in `D` dimensions.
pub struct Streamed<const D: usize> {
    options: Options,
    level: Level,
    form: Option<Form>,
    workers: Vec<Worker<D>>,
    /// Buffers for scenes in which all radii are equal.
    uniform: Buffers<D, ()>,
    each: Buffers<D, f32>,
    /// Detector for scenes with a crowded size class.
    crowded: HGrid<D>,
    formula: u64,
}

/// State of one thread; adjacent workers share no cache line.
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
    /// Creates a detector that uses the vector instructions of `level`, and this form for all
    /// scenes, if given. If there are too many columns, cells are used; if there are too many
    /// cells, the sparse form. If there are size classes, columns become cells.
    pub fn on(level: Level, form: Option<Form>, options: Options) -> Streamed<D> {
        Streamed {
            options,
            level,
            form,
            workers: Vec::new(),
            uniform: Buffers::default(),
            each: Buffers::default(),
            crowded: HGrid::with(options),
            formula: 0,
        }
    }
}

impl<const D: usize> Declare for Streamed<D> {
    const DECIDES_FROM_COPIES: bool = true;

    fn with(options: Options) -> Streamed<D> {
        Streamed::on(Level::best(), None, options)
    }

    fn formula_bytes(&self) -> u64 {
        self.formula
    }
}

impl<T: Real, const D: usize> Detector<T, D> for Streamed<D> {
    fn detect<B: Particles<T, D>, P: Probe, S: Sink>(
        &mut self,
        particles: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        if self.form.is_none() && particles.len() <= copies::FEW {
            self.formula = 0;
            copies::all_pairs(&particles, probe, sink);
            return Ok(());
        }
        let classes = if self.form == Some(Form::Sparse) { None } else { Classes::of(&particles) };
        match classes {
            Some(classes) => self.by_class(&classes, particles, probe, sink),
            None => self.sweep(particles, probe, sink),
        }
    }
}

impl<const D: usize> Streamed<D> {
    /// Finds the contacts of particles that form one size class.
    fn sweep<T: Real, B: Particles<T, D>, P: Probe, S: Sink>(
        &mut self,
        particles: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        let n = particles.len();
        numbered(NAME, n)?;
        let threads = if P::SILENT && n >= FEWEST_FOR_THREADS { self.options.threads } else { 1 };
        let (grid, form) = Grid::new(&particles, self.form, threads)?;
        let turn = if form == Form::Sparse { sparse::TURN } else { None };
        let bounds = Bounds::new(&particles, &grid, turn);
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
            touch: &|i, j, probe: &mut P| particles.touch(i, j, probe),
            touch_silent: &|i, j, probe: &mut Silent| particles.touch(i, j, probe),
        };
        match (form, particles.uniform().is_some()) {
            (Form::Dense | Form::Flat, true) => run.dense::<_, _, false>(
                &mut uniform.lists,
                &|lists, share, plan| lists.fill(&particles, share, &grid, plan, *level),
                probe,
                sink,
            ),
            (Form::Dense | Form::Flat, false) => run.dense::<_, _, true>(
                &mut each.lists,
                &|lists, share, plan| lists.fill(&particles, share, &grid, plan, *level),
                probe,
                sink,
            ),
            (Form::Sparse, true) => run.sparse::<_, _, false>(
                &mut uniform.sparse,
                &|sparse| sparse.fill(&particles, &grid),
                probe,
                sink,
            ),
            (Form::Sparse, false) => run.sparse::<_, _, true>(
                &mut each.sparse,
                &|sparse| sparse.fill(&particles, &grid),
                probe,
                sink,
            ),
        }
    }
}

/// State of one detection. It calls the contact test by reference, and only for pairs that the
/// kernel cannot decide, so the code is compiled once for all kinds of particles.
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
    /// Contact test for other threads, which cannot share a probe.
    touch_silent: Touch<'a, Silent>,
}

/// Receives the kernel's pairs, and decides those that the kernel cannot.
trait PairSink {
    fn sure(&mut self, pairs: &[[u32; 2]]);
    /// Returns space for contacts in the list that receives them, if there is one.
    fn space(&mut self) -> Option<&mut Space>;
    /// Adds the first `many` pairs of the space.
    ///
    /// # Safety
    /// They must have been written since [`PairSink::space`] returned the space, without a call of
    /// [`PairSink::sure`] or [`PairSink::swept`] meanwhile.
    unsafe fn written(&mut self, many: usize);
    /// Returns whether two particles touch, for pairs that only the contact test can decide.
    fn touches(&mut self, i: u32, j: u32) -> bool;
    fn counts(&self) -> bool;
    /// Receives the share of the bundles of layers swept so far, from 0 to 1.
    fn swept(&mut self, share: f64);
    /// Counts `n` operations, including the contact tests of uncertain pairs, made later.
    fn count(&mut self, op: Op, n: u64);
}

/// Passes contacts to a sink, and operations to a probe.
struct Deliver<'a, P, S> {
    touch: Touch<'a, P>,
    probe: &'a mut P,
    sink: &'a mut S,
    /// Contact tests counted by the kernel; `unsure` counts those that `touch` counts again.
    tests: u64,
    unsure: u64,
}

impl<'a, P: Probe, S: Sink> Deliver<'a, P, S> {
    fn new(touch: Touch<'a, P>, probe: &'a mut P, sink: &'a mut S) -> Self {
        Deliver { touch, probe, sink, tests: 0, unsure: 0 }
    }

    /// Counts the kernel's contact tests, without those that `touch` has counted.
    fn finish(self) {
        self.probe.add(Op::ContactTest, self.tests.saturating_sub(self.unsure));
    }
}

impl<P: Probe, S: Sink> PairSink for Deliver<'_, P, S> {
    fn sure(&mut self, pairs: &[[u32; 2]]) {
        self.sink.contacts(pairs);
    }

    fn space(&mut self) -> Option<&mut Space> {
        self.sink.space(output::ROOM).and_then(|space| space.first_chunk_mut())
    }

    unsafe fn written(&mut self, many: usize) {
        // SAFETY: the caller ensures it.
        unsafe { self.sink.written(many) }
    }

    fn touches(&mut self, i: u32, j: u32) -> bool {
        self.unsure += 1;
        (self.touch)(i, j, self.probe)
    }

    fn counts(&self) -> bool {
        !P::SILENT
    }

    fn swept(&mut self, share: f64) {
        self.sink.progress(share);
    }

    fn count(&mut self, op: Op, n: u64) {
        if op == Op::ContactTest { self.tests += n } else { self.probe.add(op, n) }
    }
}
