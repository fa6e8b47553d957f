//! The dense form, for most scenes. Each bundle of layers has an array over its cells; each thread
//! holds two bundles at a time.

use std::ops::Range;

use super::bounds::Bounds;
use super::kernel::{Scratch, Sweep};
use super::lists::{Lists, Record, Size};
use super::output::Output;
use super::plan::Plan;
use super::ranges::ByCells;
use super::slab::Slab;
use super::{Deliver, NAME, PairSink, Run, Worker};
use contactbench_ground::detect::within;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::pair_list::{self, Allowance, PAIR_BYTES, PairList};
use contactbench_ground::pairs::sink::Sink;
use contactbench_ground::parallel;
use contactbench_ground::parallel::share;
use contactbench_ground::probe::{Op, Probe, Silent};
use contactbench_ground::wide::Level;

type Fill<'a, R, const D: usize> = &'a (dyn Fn(&mut Lists<D, R>, Range<usize>, &Plan) + Sync);

impl<P: Probe, const D: usize> Run<'_, P, D> {
    pub fn dense<S: Sink, R: Size, const EACH: bool>(
        &mut self,
        lists: &mut Vec<Lists<D, R>>,
        fill: Fill<'_, R, D>,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        const { assert!(R::EACH == EACH) };
        let (n, threads) = (self.n, self.threads);
        let plan = Plan::new(&self.grid, n);
        let shape = || format!("{n} particles, {} cells in a bundle of layers", plan.cells());
        let records: u64 = (0..threads)
            .map(|k| Lists::<D, R>::bytes(share(n, threads, k).len(), plan.slabs))
            .sum();
        let of_threads = threads * (size_of::<Worker<D>>() + size_of::<Lists<D, R>>());
        let needed = |most: usize| {
            records
                + 2 * threads as u64 * Slab::<D>::bytes(most, plan.cells(), EACH)
                + (threads * most * size_of::<Record<D, R>>()) as u64
                + of_threads as u64
        };
        // An estimate, as most bundles have about equal length; the longest is known after filling.
        within(self.options, NAME, needed(n.div_ceil(plan.slabs)), shape)?;
        grow(lists, threads);
        grow(self.workers, threads);
        let (lists, workers) = (&mut lists[..threads], &mut self.workers[..threads]);
        parallel::for_each(lists, |k, lists| fill(lists, share(n, threads, k), &plan));
        probe.add(Op::Integerise, (D * n) as u64);
        probe.add(Op::ListPush, n as u64);
        let lists = &*lists;
        let bundles = Bundles { lists, plan, bounds: self.bounds, level: self.level };
        let most = (0..plan.slabs).map(|slab| bundles.len(slab)).max().unwrap_or(0);
        *self.formula = needed(most);
        within(self.options, NAME, *self.formula, shape)?;
        for worker in workers.iter_mut() {
            worker.slabs.iter_mut().for_each(|slab| slab.prepare(most, plan.cells(), EACH));
            Record::<D, R>::prepare(&mut worker.room, most);
        }
        if let [worker] = workers {
            let mut deliver = Deliver::new(self.touch, probe, sink);
            bundles.sweep::<EACH>(worker, 0..plan.slabs, &mut deliver, &mut |_, _, _, _| {});
            deliver.finish();
            return Ok(());
        }
        self.by_threads::<_, _, EACH>(bundles, sink)
    }

    /// Sweeps the bundles by all threads.
    fn by_threads<S: Sink, R: Size, const EACH: bool>(
        &mut self,
        bundles: Bundles<'_, R, D>,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        let (n, threads) = (self.n, self.threads);
        // Divide bundles into one share per thread, with about equal numbers of particles.
        let (mut shares, mut before, mut from) = (Vec::new(), 0, 0);
        for slab in 0..bundles.plan.slabs {
            before += bundles.len(slab);
            if before * threads >= n * (shares.len() + 1) && shares.len() + 1 < threads {
                shares.push(from..slab + 1);
                from = slab + 1;
            }
        }
        shares.push(from..bundles.plan.slabs);
        let touch = self.touch_silent;
        let allowance = Allowance::new(self.options.memory_limit - *self.formula);
        let mut tasks: Vec<_> = self.workers[..threads]
            .iter_mut()
            .map(|worker| {
                // Moved out of the worker while it runs, so that both can be borrowed mutably.
                let mut pairs = std::mem::take(&mut worker.pairs);
                pairs.clear();
                (worker, PairList::behind(pairs, &allowance))
            })
            .collect();
        parallel::for_each(&mut tasks, |k, (worker, pairs)| {
            // There may be fewer shares than workers.
            let Some(share) = shares.get(k) else { return };
            let mut probe = Silent;
            let mut deliver = Deliver::new(touch, &mut probe, pairs);
            bundles.sweep::<EACH>(worker, share.clone(), &mut deliver, &mut |_, _, _, _| {});
        });
        let (workers, found): (Vec<_>, Vec<_>) = tasks.into_iter().unzip();
        for (worker, pairs) in workers.into_iter().zip(pair_list::lists(found, n)?) {
            worker.pairs = pairs;
            *self.formula += worker.pairs.capacity() as u64 * PAIR_BYTES;
        }
        let workers = &self.workers[..threads];
        sink.gather(&workers.iter().map(|worker| &worker.pairs[..]).collect::<Vec<_>>());
        Ok(())
    }
}

pub(super) struct Bundles<'a, R, const D: usize> {
    pub lists: &'a [Lists<D, R>],
    pub plan: Plan,
    pub bounds: Bounds,
    pub level: Level,
}

/// Function called with each bundle's number after its sweep, while the bundle is in cache.
pub(super) type Beside<'a, const D: usize> =
    &'a mut dyn FnMut(usize, &Slab<D>, &mut Scratch, &mut dyn PairSink);

impl<R: Size, const D: usize> Bundles<'_, R, D> {
    /// Returns the number of particles in a bundle.
    fn len(&self, bundle: usize) -> usize {
        self.lists.iter().map(|lists| lists.len(bundle)).sum()
    }

    /// Sweeps a range of bundles, each against itself and the first layer of the next bundle.
    pub fn sweep<const EACH: bool>(
        &self,
        worker: &mut Worker<D>,
        range: Range<usize>,
        sink: &mut dyn PairSink,
        beside: Beside<'_, D>,
    ) {
        let Worker { slabs: [slab, next], room, scratch, .. } = worker;
        let (plan, bounds, room) = (&self.plan, self.bounds, &mut R::room(room)[..]);
        if range.is_empty() {
            return;
        }
        let mut fill = |slab: &mut Slab<D>, list, sink: &mut dyn PairSink| {
            slab.fill(self.lists, list, plan, self.level, room, sink);
        };
        fill(slab, Some(range.start), sink);
        let (from, bundles) = (range.start, range.len());
        for number in range {
            fill(next, Some(number + 1).filter(|&next| next < plan.slabs), sink);
            // Begin of the bundle's last layer, the only one whose next layer is in another bundle.
            let last = ((1 << plan.layers) - 1) * plan.layer;
            let border = slab.begin[last] as usize;
            let mut sweep = |places: Range<usize>, next: &Slab<D>, to_next: isize| {
                let Scratch { pairs, work } = &mut *scratch;
                let output = Output::new(pairs, &mut *sink);
                if plan.flat {
                    let find = ByCells::<true>::new(plan, slab, next, to_next);
                    Sweep::<_, D, EACH> { slab, next, places, find, bounds, work, output }
                        .on(self.level);
                } else {
                    let find = ByCells::<false>::new(plan, slab, next, to_next);
                    Sweep::<_, D, EACH> { slab, next, places, find, bounds, work, output }
                        .on(self.level);
                }
            };
            sweep(0..border, slab, plan.layer as isize);
            sweep(border..slab.len, next, -(last as isize));
            beside(number, slab, scratch, sink);
            std::mem::swap(slab, next);
            sink.swept((number + 1 - from) as f64 / bundles as f64);
        }
    }
}

pub(super) fn grow<A: Default>(array: &mut Vec<A>, count: usize) {
    if count > array.len() {
        contactbench_ground::limits::refusal::must_reserve(array, count - array.len());
        array.resize_with(count, A::default);
    }
}
