//! `nbs:levels=auto`: NBS within each size class, then between each class and all smaller
//! particles. The book assumes particles of one size (Munjiza 2004, section 3.1).
//!
//! ```text
//!   a class of large particles:  A  A  .  A      found by NBS, in cells of their size
//!   all smaller ones near it:    f f  fff  f     on further lists of the same cells: each cell
//!                                                with an A is checked against 3^D of these
//! ```
//!
//! 1. Radii are divided into at most 32 classes at the largest radius, half of it, and so on.
//!    Particles are ordered by class. If there is one class only, plain [`super::nbs`] is used.
//! 2. Plain NBS detects the contacts within each class.
//! 3. For each class but the last, its particles (A) and all smaller ones inside its box (F) are
//!    put on two sets of layer lists, in cells as wide as the reach between an A and an F. A loop
//!    over A finds each of its layers once. The A of this layer, and the F of it and of the two
//!    layers beside it, are put on row lists. Rows are divided into cells in the same way. Each A
//!    of a cell is checked against the F of three cell lists (left, central, right). They hold the
//!    F of 3^D cells.
//! 4. Lists are emptied by walking over particles. The code has no loop over cells: a giant covers
//!    more cells of the smaller particles than there are particles. `hgrid` does search the cells
//!    of the smaller ones, with fewer tests.
//!
//! * Cost: proportional to N for each class. For each larger class, a smaller particle is put on at
//!   most 4 lists in 2D and 13 in 3D.
//! * Memory: `4(ny + 2nx + 2M) + 4(2cy + 2cx + 2N) + 4N` bytes in 2D, `4(nz + 2ny + 2nx + 3M) +
//!   4(2cz + 2cy + 2cx + 3N) + 4N` in 3D, for N particles and M in the largest class. nx, ny and nz
//!   are the largest numbers of cells per axis for a class alone; cx, cy and cz are those for a
//!   class with smaller particles.
//! * Refuses more than 2^31 - 1 particles, and scenes over the memory limit.
//! * Deviations from the book: those of [`super::nbs`]. A class has at most about as many cells
//!   along an axis as particles, but at least 64, so memory is proportional to N in any domain.

use std::ops::Range;

use super::list::{EMPTY, Heads, Links, numbered};
use crate::contact::{Bodies, Margin, Slack};
use crate::detect::{Declare, Detector, Options, Refusal, within};
use crate::filter::{Cells, bounds};
use crate::probe::{Op, Probe};
use crate::refusal::at_least;
use crate::scene::Real;
use crate::sink::Sink;
use crate::wide::fill;

/// Number of size classes; the last one holds all smaller particles.
const CLASSES: usize = 32;
/// Number of cells along an axis that a class may always have, even with few particles.
const CELLS: usize = 64;

/// NBS by size classes; `A` is plain NBS.
pub struct NbsLevels<A, const D: usize> {
    options: Options,
    plain: A,
    /// Particle numbers, class by class, the largest class first.
    order: Vec<u32>,
    /// Heads of the lists of layers, rows and cells (axis 2, 1, 0): for the current class and for
    /// smaller particles.
    heads: [[Heads; 2]; D],
    links: Links<D>,
    formula: u64,
}

impl<A: Declare, const D: usize> Declare for NbsLevels<A, D> {
    fn with(options: Options) -> NbsLevels<A, D> {
        NbsLevels {
            options,
            plain: A::with(options),
            order: Vec::new(),
            heads: std::array::from_fn(|_| Default::default()),
            links: Links::default(),
            formula: 0,
        }
    }

    fn formula_bytes(&self) -> u64 {
        self.formula
    }
}

struct Classes {
    largest: f64,
    /// Index in the order where each class begins, then the end of the last class.
    ends: [usize; CLASSES + 1],
}

#[derive(Clone, Copy)]
struct Grids<const D: usize> {
    /// Edge of the cells in which plain NBS searches the class.
    reach: f64,
    own: Cells<D>,
    /// Cells shared with smaller particles, if there are any.
    cross: Option<Cross<D>>,
}

#[derive(Clone, Copy)]
struct Cross<const D: usize> {
    cells: Cells<D>,
    /// Box outside which smaller particles cannot touch the class.
    low: [f64; D],
    high: [f64; D],
}

impl<T: Real, A: Detector<T, D> + Declare, const D: usize> Detector<T, D> for NbsLevels<A, D> {
    fn detect<B: Bodies<T, D>, P: Probe, S: Sink>(
        &mut self,
        bodies: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        numbered("nbs", bodies.len())?;
        if B::RADII_DIFFER
            && let Some(classes) = Classes::new(&bodies)
        {
            return self.by_class(bodies, &classes, probe, sink);
        }
        let result = self.plain.detect(bodies, probe, sink);
        self.formula = self.plain.formula_bytes();
        result
    }
}

impl<A, const D: usize> NbsLevels<A, D> {
    fn by_class<T: Real, B: Bodies<T, D>, P: Probe, S: Sink>(
        &mut self,
        bodies: B,
        classes: &Classes,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal>
    where
        A: Detector<T, D>,
    {
        let order = 4 * bodies.len() as u64;
        within(&self.options, "nbs", order, || format!("{} particles", bodies.len()))?;
        self.sort(&bodies, classes, probe);
        let grids = self.grids(&bodies, classes)?;
        self.prepare(classes, &grids)?;
        for (k, grids) in grids.iter().enumerate() {
            let Some(grids) = grids else { continue };
            let ids = classes.range(k);
            let part = Part { bodies, ids: &self.order[ids.clone()], reach: grids.reach };
            // `prepare` has checked that plain NBS stays within the memory limit.
            self.plain.detect(part, probe, &mut Named { ids: part.ids, sink })?;
            if let Some(cross) = &grids.cross {
                self.between(&bodies, cross, ids, probe, sink);
            }
        }
        Ok(())
    }

    fn sort<T: Real>(
        &mut self,
        bodies: &impl Bodies<T, D>,
        classes: &Classes,
        probe: &mut impl Probe,
    ) {
        let n = bodies.len();
        self.order.clear();
        at_least(&mut self.order, n, 0);
        let mut next = classes.ends;
        for id in 0..n as u32 {
            let place = &mut next[classes.of(bodies.radius(id))];
            probe.count(Op::Move);
            self.order[*place] = id;
            *place += 1;
        }
    }

    fn grids<T: Real>(
        &self,
        bodies: &impl Bodies<T, D>,
        classes: &Classes,
    ) -> Result<[Option<Grids<D>>; CLASSES], Refusal> {
        let mut grids = [None; CLASSES];
        let (whole_low, whole_high) = bounds(bodies);
        let largest = |range: Range<usize>| {
            self.order[range].iter().map(|&id| bodies.radius(id)).fold(0.0, f64::max)
        };
        for (k, grids) in grids.iter_mut().enumerate() {
            let ids = classes.range(k);
            if ids.is_empty() {
                continue;
            }
            let smaller = ids.end..bodies.len();
            let (own, below) = (largest(ids.clone()), largest(smaller.clone()));
            let reach = bodies.class_reach(own, own);
            let part = Part { bodies: *bodies, ids: &self.order[ids.clone()], reach };
            let (low, high) = bounds(&part);
            let wide = |low: &[f64; D], high: &[f64; D]| {
                let edges = (0..D).map(|k| high[k] - low[k]);
                edges.fold(0.0, f64::max) / ids.len().max(CELLS) as f64
            };
            let part = Part { reach: reach.max(wide(&low, &high)), ..part };
            let cross = if smaller.is_empty() {
                None
            } else {
                let reach = bodies.class_reach(own, below);
                // Subtraction is monotone: every point within reach of a particle is in the rounded
                // box.
                let low = fill(|k| (low[k] - reach).max(whole_low[k]));
                let high = fill(|k| (high[k] + reach).min(whole_high[k]));
                let reach = reach.max(wide(&low, &high));
                let cells = Cells::spanning(low, high, reach, bodies.margin())?;
                Some(Cross { cells, low, high })
            };
            *grids = Some(Grids { reach: part.reach, own: Cells::new(&part)?, cross });
        }
        Ok(grids)
    }

    fn prepare(
        &mut self,
        classes: &Classes,
        grids: &[Option<Grids<D>>; CLASSES],
    ) -> Result<(), Refusal> {
        let n = self.order.len();
        let most_of = |cells: &dyn Fn(&Grids<D>) -> Option<Cells<D>>, k: usize| {
            let count = |cells: Cells<D>| u64::from(cells.count[k]);
            grids.iter().flatten().filter_map(cells).map(count).max().unwrap_or(0)
        };
        let own: [u64; D] = fill(|k| most_of(&|grids| Some(grids.own), k));
        let cross: [u64; D] = fill(|k| most_of(&|grids| Some(grids.cross?.cells), k));
        let most = (0..CLASSES).map(|k| classes.range(k).len()).max().unwrap_or(0);
        // Plain NBS has one set of lists along the last axis and two along each other axis.
        let plain = 2 * own.iter().sum::<u64>() - own[D - 1] + (D * most) as u64;
        let needed = 4 * (plain + 2 * cross.iter().sum::<u64>() + (D * n) as u64 + n as u64);
        let shape = || format!("{n} particles in classes of sizes, cells {own:?} and {cross:?}");
        within(&self.options, "nbs", needed, shape)?;
        self.formula = needed;
        self.links.prepare(n);
        for (heads, count) in self.heads.iter_mut().zip(cross) {
            heads.iter_mut().for_each(|heads| heads.prepare(count as usize));
        }
        Ok(())
    }

    fn between<T: Real, P: Probe, S: Sink>(
        &mut self,
        bodies: &impl Bodies<T, D>,
        cross: &Cross<D>,
        ids: Range<usize>,
        probe: &mut P,
        sink: &mut S,
    ) {
        let (cells, layer) = (&cross.cells, D - 1);
        let index = |id: u32, probe: &mut P| cells.index(bodies.position(id)[layer], layer, probe);
        let smaller = ids.end..self.order.len();
        for (set, range) in [ids.clone(), smaller.clone()].into_iter().enumerate() {
            for &id in &self.order[range] {
                if set == 0 || cross.holds(bodies.position(id), probe) {
                    let list = index(id, probe);
                    self.heads[layer][set].push(list, id, &mut self.links, layer, probe);
                }
            }
        }
        for k in ids.clone() {
            self.around(bodies, cells, layer, self.order[k], probe, sink);
        }
        for (set, range) in [ids, smaller].into_iter().enumerate() {
            for &id in &self.order[range] {
                if set == 0 || cross.holds(bodies.position(id), probe) {
                    let list = index(id, probe);
                    self.heads[layer][set].reset(list, probe);
                }
            }
        }
    }

    /// Checks a particle's layer, row or cell against smaller particles in it and beside it, unless
    /// this was done for an earlier particle.
    fn around<T: Real, P: Probe, S: Sink>(
        &mut self,
        bodies: &impl Bodies<T, D>,
        cells: &Cells<D>,
        axis: usize,
        id: u32,
        probe: &mut P,
        sink: &mut S,
    ) {
        let at = cells.index(bodies.position(id)[axis], axis, probe);
        let Some(first) = self.heads[axis][0].take_new(at, probe) else { return };
        let smaller = [at - 1, at, at + 1].map(|at| self.heads[axis][1].first_smaller(at, probe));
        if smaller == [EMPTY; 3] {
            return;
        }
        let Some(next) = axis.checked_sub(1) else {
            return self.links.check_across(axis, bodies, first, smaller, probe, sink);
        };
        let index = |id: u32, probe: &mut P| cells.index(bodies.position(id)[next], next, probe);
        for (set, list) in std::iter::once((0, first)).chain(smaller.map(|list| (1, list))) {
            let mut id = list;
            while id != EMPTY {
                let at = index(id, probe);
                self.heads[next][set].push(at, id, &mut self.links, next, probe);
                id = self.links.next(id, axis, probe);
            }
        }
        let mut id = first;
        while id != EMPTY {
            self.around(bodies, cells, next, id, probe, sink);
            id = self.links.next(id, axis, probe);
        }
        for (set, list) in std::iter::once((0, first)).chain(smaller.map(|list| (1, list))) {
            let mut id = list;
            while id != EMPTY {
                let at = index(id, probe);
                self.heads[next][set].reset(at, probe);
                id = self.links.next(id, axis, probe);
            }
        }
    }
}

impl Classes {
    /// Counts the particles of each class; returns `None` if all are in one class.
    fn new<T: Real, const D: usize>(bodies: &impl Bodies<T, D>) -> Option<Classes> {
        if bodies.uniform().is_some() {
            return None;
        }
        let ids = || 0..bodies.len() as u32;
        let largest = ids().map(|id| bodies.radius(id)).fold(0.0, f64::max);
        let mut classes = Classes { largest, ends: [0; CLASSES + 1] };
        ids().for_each(|id| classes.ends[classes.of(bodies.radius(id)) + 1] += 1);
        if classes.ends.contains(&bodies.len()) {
            return None;
        }
        for k in 0..CLASSES {
            classes.ends[k + 1] += classes.ends[k];
        }
        Some(classes)
    }

    /// Returns how often the largest radius is halved until it is at most `radius`: the exponent of
    /// the quotient. Rounding is monotone, so a smaller radius never has a lower class.
    fn of(&self, radius: f64) -> usize {
        let exponent = (self.largest / radius).to_bits() >> 52 & 0x7ff;
        // The quotient is at least 1, infinite for points, and NaN if all particles are points.
        (exponent as usize).saturating_sub(1023).min(CLASSES - 1)
    }

    fn range(&self, k: usize) -> Range<usize> {
        self.ends[k]..self.ends[k + 1]
    }
}

impl<const D: usize> Cross<D> {
    fn holds(&self, position: [f64; D], probe: &mut impl Probe) -> bool {
        probe.count(Op::BoundTest);
        (0..D).all(|k| self.low[k] <= position[k] && position[k] <= self.high[k])
    }
}

#[derive(Clone, Copy)]
struct Part<'a, B> {
    bodies: B,
    ids: &'a [u32],
    reach: f64,
}

impl<T: Real, B: Bodies<T, D>, const D: usize> Bodies<T, D> for Part<'_, B> {
    fn len(&self) -> usize {
        self.ids.len()
    }

    #[inline(always)]
    fn position(&self, i: u32) -> [f64; D] {
        self.bodies.position(self.ids[i as usize])
    }

    #[inline(always)]
    fn touch<P: Probe>(&self, i: u32, j: u32, probe: &mut P) -> bool {
        self.bodies.touch(self.ids[i as usize], self.ids[j as usize], probe)
    }

    fn reach(&self) -> f64 {
        self.reach
    }

    fn radius(&self, i: u32) -> f64 {
        self.bodies.radius(self.ids[i as usize])
    }

    fn uniform(&self) -> Option<f64> {
        self.bodies.uniform()
    }

    fn slack(&self) -> Slack {
        self.bodies.slack()
    }

    fn underflow(&self) -> f64 {
        self.bodies.underflow()
    }

    fn margin(&self) -> Margin {
        self.bodies.margin()
    }
}

struct Named<'a, S> {
    ids: &'a [u32],
    sink: &'a mut S,
}

impl<S: Sink> Sink for Named<'_, S> {
    #[inline(always)]
    fn contact(&mut self, i: u32, j: u32) {
        self.sink.contact(self.ids[i as usize], self.ids[j as usize]);
    }
}
