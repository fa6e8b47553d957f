//! Detection in scenes of very different sizes: each size class is swept in its own grid, and
//! larger particles visit the grids of smaller ones.

mod ball;
mod visits;

use super::bounds::Bounds;
use super::classes::{Class, Classes, MOST};
use super::dense::{Bundles, grow};
use super::grid::{Domain, FEW, Grid, axes};
use super::lists::{Lists, Record};
use super::output::Output;
use super::plan::Plan;
use super::slab::Slab;
use super::{Deliver, NAME, Streamed, Worker, numbered};
use contactbench_ground::contact::Particles;
use contactbench_ground::detect::company::{CROWD, company};
use contactbench_ground::detect::{Declare, Detector, within};
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::Sink;
use contactbench_ground::probe::{Op, Probe};
use contactbench_ground::scene::Real;
use visits::{Host, Visit};

/// Two grids must differ by less than this factor in their steps: squares of distances, up to 2^124
/// at this limit, must fit in f32.
const FINEST: f64 = (1u64 << 40) as f64;

#[derive(Clone, Copy)]
struct Level<const D: usize> {
    class: Class<D>,
    grid: Grid<D>,
    plan: Plan,
    bounds: Bounds,
    may_crowd: bool,
}

type Levels<const D: usize> = [Option<Level<D>>; MOST];

impl<const D: usize> Streamed<D> {
    pub(super) fn by_class<T: Real, B: Particles<T, D>, P: Probe, S: Sink>(
        &mut self,
        classes: &Classes<D>,
        particles: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        let n = particles.len();
        numbered(NAME, n)?;
        let Some(levels) = self.levels(classes, &particles)? else {
            let result = self.crowded.detect(particles, probe, sink);
            self.formula = Declare::formula_bytes(&self.crowded);
            return result.map_err(|refusal| refusal.of(NAME));
        };
        if classes.all().len() == 1 {
            return self.sweep(particles, probe, sink);
        }
        let Streamed { options, level, workers, each, formula, .. } = self;
        let count = classes.all().len();
        let all = || levels.iter().flatten();
        let shape = || format!("{n} particles in {count} classes of sizes");
        let mean = all().map(|of| of.class.particles.div_ceil(of.plan.slabs)).max().unwrap_or(0);
        within(options, NAME, needed(&levels, mean), shape)?;
        grow(&mut each.lists, count);
        grow(workers, 1);
        let (lists, worker) = (&mut each.lists[..count], &mut workers[0]);
        fill(&particles, classes, &levels, lists);
        probe.add(Op::Integerise, (D * n) as u64);
        probe.add(Op::ListPush, n as u64);
        let lists = &*lists;
        let lengths = |(of, lists): (&Level<D>, &Lists<D, f32>)| {
            (0..of.plan.slabs).map(|slab| lists.len(slab)).max().unwrap_or(0)
        };
        let most = all().zip(lists).map(lengths).max().unwrap_or(0);
        *formula = needed(&levels, most);
        within(options, NAME, *formula, shape)?;
        worker.slabs.iter_mut().for_each(|slab| slab.prepare(most, cells(&levels), true));
        Record::<D, f32>::prepare(&mut worker.room, most);
        let touch = |i, j, probe: &mut P| particles.touch(i, j, probe);
        let mut deliver = Deliver::new(&touch, probe, sink);
        let slack = particles.slack();
        let hosts = hosts(&levels, lists);
        for (k, of) in all().enumerate() {
            let (plan, bounds) = (of.plan, of.bounds);
            let bundles = Bundles { lists: &lists[k..=k], plan, bounds, level: *level };
            let slabs = 0..plan.slabs;
            bundles.sweep::<true>(
                worker,
                slabs,
                &mut deliver,
                &mut |number, slab, scratch, sink| {
                    let (larger, Some(host)) = (&hosts[..k], hosts[k]) else { return };
                    let output = Output::new(&mut scratch.pairs, sink);
                    level.run(Visit { larger, host, slack, number, slab, output });
                },
            );
        }
        deliver.finish();
        Ok(())
    }

    /// Returns the grid of each class. Returns `None` if the cells of a class cannot be numbered,
    /// if its particles crowd, or if two grids differ too much to compare distances.
    fn levels<T: Real>(
        &self,
        classes: &Classes<D>,
        particles: &impl Particles<T, D>,
    ) -> Result<Option<Levels<D>>, Refusal> {
        let mut levels = [None; MOST];
        let mut may_crowd = false;
        let all = classes.all().iter().fold(classes.all()[0], |all, class| all.with(class));
        let axes = axes((all.low, all.high))?;
        for (level, class) in levels.iter_mut().zip(classes.all()) {
            let reach = particles.slack().reach(class.largest, class.largest);
            let domain = Domain::along(axes, (class.low, class.high), reach, class.particles);
            let Some((grid, crowd)) = domain.dense() else { return Ok(None) };
            // Cells as wide as the reach are crowded only if few particles have that reach.
            let crowd = crowd || class.is_wide() && class.particles > FEW;
            may_crowd |= crowd;
            let bounds = Bounds::of(particles.slack(), reach, &grid, None);
            let plan = Plan::new(&grid, class.particles);
            *level = Some(Level { class: *class, grid, plan, bounds, may_crowd: crowd });
        }
        let all = || levels.iter().flatten();
        let too_far = |(k, host): (usize, &Level<D>)| {
            all().take(k).any(|larger| {
                let shift = host.grid.origin_of(&larger.grid);
                let finite = shift.iter().all(|x| x.is_finite());
                // The negation makes NaN count as too far.
                !(finite && host.grid.finer_than(&larger.grid) < FINEST)
            })
        };
        if all().enumerate().any(too_far) {
            return Ok(None);
        }
        if may_crowd && self.form.is_none() {
            let place = |id| {
                let number = classes.number(particles.radius(id));
                (number, levels[number].map_or(0, |of| of.grid.cell(particles.position(id))))
            };
            let company = company(particles.len(), place, |number| classes.all()[number].particles);
            let crowded = |(of, &company): (&Level<D>, _)| of.may_crowd && company > CROWD;
            if all().zip(&company).any(crowded) {
                return Ok(None);
            }
        }
        Ok(Some(levels))
    }
}

/// Returns the largest number of cells in a bundle of layers of any class.
fn cells<const D: usize>(levels: &Levels<D>) -> usize {
    levels.iter().flatten().map(|of| of.plan.cells()).max().unwrap_or(0)
}

/// Returns the bytes of all arrays if the longest bundle has `most` particles.
fn needed<const D: usize>(levels: &Levels<D>, most: usize) -> u64 {
    let all = || levels.iter().flatten();
    let records: u64 =
        all().map(|of| Lists::<D, f32>::bytes(of.class.particles, of.plan.slabs)).sum();
    let structs = size_of::<Worker<D>>() + all().count() * size_of::<Lists<D, f32>>();
    let room = most * size_of::<Record<D, f32>>();
    records + 2 * Slab::<D>::bytes(most, cells(levels), true) + (room + structs) as u64
}

fn hosts<'a, const D: usize>(
    levels: &'a Levels<D>,
    lists: &'a [Lists<D, f32>],
) -> [Option<Host<'a, D>>; MOST] {
    let mut hosts = [None; MOST];
    for ((host, of), lists) in hosts.iter_mut().zip(levels.iter().flatten()).zip(lists) {
        let largest = of.class.largest;
        *host = Some(Host { grid: &of.grid, plan: &of.plan, largest, lists });
    }
    hosts
}

fn fill<T: Real, const D: usize>(
    particles: &impl Particles<T, D>,
    classes: &Classes<D>,
    levels: &Levels<D>,
    lists: &mut [Lists<D, f32>],
) {
    let mut filling = [None; MOST];
    for ((filling, level), lists) in
        filling.iter_mut().zip(levels.iter().flatten()).zip(&mut *lists)
    {
        *filling = Some(lists.begin(level.class.particles, &level.plan));
    }
    for id in 0..particles.len() as u32 {
        let radius = particles.radius(id);
        let class = classes.number(radius);
        if let (Some(filling), Some(level)) = (&mut filling[class], &levels[class]) {
            lists[class].push(filling, &level.grid, particles.position(id), radius, id);
        }
    }
    for (filling, level) in filling.into_iter().flatten().zip(levels.iter().flatten()) {
        filling.end(&level.grid);
    }
}
