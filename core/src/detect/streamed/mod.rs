//! `streamed-nbs`: the idea of Munjiza-NBS on the hardware of today.
//!
//! NBS goes through a scene layer by layer, looks at occupied cells only, and keeps two layers at a time (Munjiza 2004, sections 3.8 to 3.11). In
//! 1998 that saved memory. Today it is what a processor wants: two layers stay in its cache, and cells in order make ranges that its vector
//! registers test sixteen at a time.
//!
//! 1. One pass over the scene finds its box, one more puts a record of each element (coordinates in whole steps of a millionth of a
//!    cell, number: 16 bytes in 3D) on the list of its bundle of layers. Both read and write memory in order.
//! 2. Bundle after bundle is sorted by cell, by counting, into one array per coordinate.
//! 3. Each element is tested against the rest of its cell and the cell beside it, the three cells in front in the next row, and the nine in the next layer: five
//!    contiguous ranges (two in 2D), sixteen elements in one go, in f32.
//! 4. What f32 cannot decide, some pairs in ten thousand contacts, is left to the contact test; see `kernel.rs` for the bounds.
//!
//! Loose scenes get larger cells, about three cells per element, scenes whose elements crowd in few of those cells the form by occupied cells (`occupied.rs`).
//!
//! * Cost: proportional to N, independent of the packing density; N log N by occupied cells.
//! * Memory, for lists (blocks of b records, L lists): `(16 + 4/b)(N + bL) + 4L` bytes in 3D, 12 instead of 16 in 2D, 4 more with a radius per element; two bundles of n
//!   elements and c cells: `2(4(D + 2)(n + 16) + 4(c + 2))`. A bundle has 2,000 to 4,000 elements, or one layer if that is more. By occupied cells: 24N, 32N with radii, and two layers.
//!   Some 9 KiB of working space per thread. With several threads: two bundles each, and the contacts, which the memory limit does not know; then a warm call
//!   allocates the list of shares.
//! * Refuses scenes of 2^31 cells and more along an axis in the form by occupied cells, extents that overflow, and more than 2^31 - 1 elements.
//! * Threads: by cells, from 20,000 elements on.
//! * In `textbook` arithmetic its filters are as safe as in f64: the book prints none for it.

mod access;
mod grid;
mod kernel;
mod lists;
mod occupied;
mod slab;

use std::marker::PhantomData;
use std::ops::Range;

use rayon::prelude::*;

use super::list::numbered;
use super::{Declare, Detector, Options, Refusal, within};
use crate::contact::{Bodies, Real};
use crate::probe::{Op, Probe, Silent};
use crate::sink::Sink;
use crate::wide::Level;
pub use grid::Form;
use grid::Grid;
use kernel::{Bounds, ByCells, Scratch, Sweep, Take};
use lists::{Lists, Size};
use occupied::Occupied;
use slab::{Plan, Slab};

const NAME: &str = "streamed-nbs";
/// Fewer elements are not worth a second thread.
const FEWEST_FOR_THREADS: usize = 20_000;

/// The modern NBS, in `D` dimensions.
pub struct Streamed<const D: usize> {
    options: Options,
    level: Level,
    form: Option<Form>,
    workers: Vec<Worker<D>>,
    /// Buffers for scenes with one radius, and with one per element.
    uniform: Buffers<D, ()>,
    each: Buffers<D, f32>,
    formula: u64,
}

/// What one thread works with.
#[derive(Default)]
struct Worker<const D: usize> {
    slabs: [Slab<D>; 2],
    scratch: Scratch,
    pairs: Vec<[u32; 2]>,
}

struct Buffers<const D: usize, R> {
    lists: Vec<Lists<D, R>>,
    occupied: Occupied<D, R>,
}

impl<const D: usize, R> Default for Buffers<D, R> {
    fn default() -> Self {
        Buffers { lists: Vec::new(), occupied: Occupied::default() }
    }
}

impl<const D: usize> Streamed<D> {
    /// A detector that uses these instructions.
    pub fn on(level: Level, options: Options) -> Streamed<D> {
        Streamed { options, level, form: None, workers: Vec::new(), uniform: Buffers::default(), each: Buffers::default(), formula: 0 }
    }

    /// In this form, whatever the scene; not by cells where there are too many of them.
    pub fn in_form(self, form: Form) -> Streamed<D> {
        Streamed { form: Some(form), ..self }
    }
}

impl<const D: usize> Declare for Streamed<D> {
    fn with(options: Options) -> Streamed<D> {
        Streamed::on(Level::best(), options)
    }

    fn formula_bytes(&self) -> u64 {
        self.formula
    }
}

impl<T: Real, const D: usize> Detector<T, D> for Streamed<D> {
    fn detect<B: Bodies<T, D>, P: Probe, S: Sink>(&mut self, bodies: B, probe: &mut P, sink: &mut S) -> Result<(), Refusal> {
        numbered(NAME, bodies.len())?;
        let threads = if P::SILENT && bodies.len() >= FEWEST_FOR_THREADS { self.options.threads.max(1) } else { 1 };
        let (grid, form) = Grid::new(&bodies, self.form, threads)?;
        let Streamed { options, level, workers, uniform, each, formula, .. } = self;
        let mut run = Run { options, threads, level: *level, workers, formula, bodies, grid };
        match (form, bodies.uniform().is_some()) {
            (Form::Cells, true) => run.by_cells::<_, P, S, (), false>(uniform, probe, sink),
            (Form::Cells, false) => run.by_cells::<_, P, S, f32, true>(each, probe, sink),
            (Form::Occupied, true) => run.occupied::<_, P, S, (), false>(&mut uniform.occupied, probe, sink),
            (Form::Occupied, false) => run.occupied::<_, P, S, f32, true>(&mut each.occupied, probe, sink),
        }
    }
}

/// One detection.
struct Run<'a, B, const D: usize> {
    options: &'a Options,
    threads: usize,
    level: Level,
    workers: &'a mut Vec<Worker<D>>,
    formula: &'a mut u64,
    bodies: B,
    grid: Grid<D>,
}

impl<B: Copy + Sync, const D: usize> Run<'_, B, D> {
    fn by_cells<T: Real, P: Probe, S: Sink, R: Size, const EACH: bool>(
        &mut self,
        buffers: &mut Buffers<D, R>,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal>
    where
        B: Bodies<T, D>,
    {
        const { assert!(R::EACH == EACH) };
        let (bodies, grid) = (self.bodies, self.grid);
        let n = bodies.len();
        let plan = Plan::new(&grid, n);
        let threads = self.threads;
        let share = |k: usize| (k * n / threads) as u32..((k + 1) * n / threads) as u32;
        let shape = || format!("{n} elements, {} cells in a bundle of layers", plan.cells());
        let records: u64 = (0..threads).map(|k| Lists::<D, R>::bytes(share(k).len(), plan.slabs)).sum();
        let of_threads = threads * (size_of::<Worker<D>>() + size_of::<Lists<D, R>>());
        let needed = |most: usize| records + 2 * threads as u64 * Slab::<D>::bytes(most, plan.cells(), EACH) + of_threads as u64;
        // Bundles are about equal in most scenes; how long the longest is will be known when the lists are.
        within(self.options, NAME, needed(n.div_ceil(plan.slabs)), shape)?;
        grow(&mut buffers.lists, threads);
        grow(self.workers, threads);
        let (lists, workers) = (&mut buffers.lists[..threads], &mut self.workers[..threads]);
        if threads == 1 {
            lists[0].fill(&bodies, share(0), &grid, plan.layers, plan.slabs, probe);
        } else {
            let fill = |(k, lists): (usize, &mut Lists<D, R>)| lists.fill(&bodies, share(k), &grid, plan.layers, plan.slabs, &mut Silent);
            lists.par_iter_mut().enumerate().for_each(fill);
        }
        let lists = &*lists;
        let length = |slab: usize| lists.iter().map(|lists| lists.len(slab)).sum::<usize>();
        let most = (0..plan.slabs).map(length).max().unwrap_or(0);
        *self.formula = needed(most);
        within(self.options, NAME, *self.formula, shape)?;
        for slab in workers.iter_mut().flat_map(|worker| &mut worker.slabs) {
            slab.prepare(most, plan.cells(), EACH);
        }
        let bundles = Bundles { lists, plan, bounds: Bounds::new(&bodies, &grid, None), level: self.level };
        if threads == 1 {
            let mut deliver = Deliver::new(bodies, probe, sink);
            bundles.sweep::<EACH>(&mut workers[0], 0..plan.slabs, &mut deliver);
            deliver.finish();
            return Ok(());
        }
        // Shares of about equal numbers of elements, one per thread.
        let (mut shares, mut before, mut from) = (Vec::new(), 0, 0);
        for slab in 0..plan.slabs {
            before += length(slab);
            if before * threads >= n * (shares.len() + 1) && shares.len() + 1 < threads {
                shares.push(from..slab + 1);
                from = slab + 1;
            }
        }
        shares.push(from..plan.slabs);
        // There may be fewer shares than workers, who then have found nothing.
        workers.iter_mut().for_each(|worker| worker.pairs.clear());
        workers.par_iter_mut().zip(shares).for_each(|(worker, share)| {
            // Out of the worker while it works, so that both can be changed.
            let mut pairs = std::mem::take(&mut worker.pairs);
            bundles.sweep::<EACH>(worker, share, &mut Deliver::new(bodies, &mut Silent, &mut pairs));
            worker.pairs = pairs;
        });
        sink.gather(&workers.iter().map(|worker| &worker.pairs[..]).collect::<Vec<_>>());
        Ok(())
    }

    fn occupied<T: Real, P: Probe, S: Sink, R: Size, const EACH: bool>(
        &mut self,
        occupied: &mut Occupied<D, R>,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal>
    where
        B: Bodies<T, D>,
    {
        const { assert!(R::EACH == EACH) };
        let (bodies, grid) = (self.bodies, self.grid);
        let n = bodies.len();
        let shape = || format!("{n} elements, by occupied cells");
        let places = Occupied::<D, R>::bytes(n);
        within(self.options, NAME, places, shape)?;
        let most = occupied.sort(&bodies, &grid, probe);
        *self.formula = places + Occupied::<D, R>::bytes_of_layers(most);
        within(self.options, NAME, *self.formula, shape)?;
        let bounds = Bounds::new(&bodies, &grid, occupied::TURN);
        let mut deliver = Deliver::new(bodies, probe, sink);
        occupied.sweep::<EACH>(self.level, bounds, most, &mut deliver);
        deliver.finish();
        Ok(())
    }
}

/// All bundles of layers of a scene.
struct Bundles<'a, R, const D: usize> {
    lists: &'a [Lists<D, R>],
    plan: Plan,
    bounds: Bounds,
    level: Level,
}

impl<R: Size, const D: usize> Bundles<'_, R, D> {
    /// Sweeps a range of bundles, each against itself and the first layer of the next.
    fn sweep<const EACH: bool>(&self, worker: &mut Worker<D>, range: Range<usize>, take: &mut dyn Take) {
        let Worker { slabs: [slab, next], scratch, .. } = worker;
        let (plan, bounds) = (&self.plan, self.bounds);
        if range.is_empty() {
            return;
        }
        slab.fill(self.lists, Some(range.start), plan, take);
        for number in range {
            next.fill(self.lists, Some(number + 1).filter(|&next| next < plan.slabs), plan, take);
            // The next layer is in the same bundle for all layers but the last.
            let last = ((1 << plan.layers) - 1) * plan.layer;
            let border = slab.begin[last] as usize;
            let mut sweep = |places: Range<usize>, next: &Slab<D>, to_next: isize| {
                let find = ByCells::new(plan, slab, next, to_next);
                Sweep::<_, D, EACH> { slab, next, places, find, bounds, scratch: &mut *scratch, take: &mut *take }.on(self.level);
            };
            sweep(0..border, slab, plan.layer as isize);
            sweep(border..slab.len, next, -(last as isize));
            std::mem::swap(slab, next);
        }
    }
}

/// Hands on what a kernel finds.
struct Deliver<'a, T, B, P, S, const D: usize> {
    bodies: B,
    probe: &'a mut P,
    sink: &'a mut S,
    /// Contact tests counted by the kernel, and those of them that `touch` has counted, too.
    tests: u64,
    unsure: u64,
    kind: PhantomData<[T; D]>,
}

impl<'a, T: Real, B: Bodies<T, D>, P: Probe, S: Sink, const D: usize> Deliver<'a, T, B, P, S, D> {
    fn new(bodies: B, probe: &'a mut P, sink: &'a mut S) -> Self {
        Deliver { bodies, probe, sink, tests: 0, unsure: 0, kind: PhantomData }
    }

    fn finish(self) {
        self.probe.add(Op::ContactTest, self.tests.saturating_sub(self.unsure));
    }
}

impl<T: Real, B: Bodies<T, D>, P: Probe, S: Sink, const D: usize> Take for Deliver<'_, T, B, P, S, D> {
    fn sure(&mut self, pairs: &[[u32; 2]]) {
        self.sink.contacts(pairs);
    }

    fn unsure(&mut self, i: u32, j: u32) {
        self.unsure += 1;
        if self.bodies.touch(i, j, self.probe) {
            self.sink.contact(i, j);
        }
    }

    fn counts(&self) -> bool {
        !P::SILENT
    }

    fn count(&mut self, op: Op, n: u64) {
        if op == Op::ContactTest { self.tests += n } else { self.probe.add(op, n) }
    }
}

/// At least `count` of them.
fn grow<A: Default>(array: &mut Vec<A>, count: usize) {
    if count > array.len() {
        array.reserve_exact(count - array.len());
        array.resize_with(count, A::default);
    }
}
