//! What is kept between frames: particles in spatial order, and the list of near pairs.

use nalgebra::Point;

use super::rule::{Looks, Rule, Ways};
use super::travel::{TopTwo, at_most, square};
use crate::contact::{Bodies, Test};
use crate::detect::any::AnyDetector;
use crate::filter::Near;
use crate::pair_list::{PAIR_BYTES, PairList};
use crate::probe::{Op, Probe, Tally};
use crate::refusal::{Refusal, reserve};
use crate::scene::{AnyScene, Radii, Real, Scene, array};
use crate::sink::Sink;

/// Particles stand in places, so that those near one another are side by side in memory; listed
/// pairs are of places.
#[derive(Default)]
pub(super) struct Kept<const D: usize> {
    /// The particle in each place.
    order: Vec<u32>,
    /// Where it was when the list was built.
    then: Vec<Point<f64, D>>,
    /// Where it was in the last frame.
    now: Vec<Point<f64, D>>,
    radii: KeptRadii,
    listed: Vec<[u32; 2]>,
    /// Half of the skin of the list.
    half: f64,
    /// What the contact test may round beyond the sum of two radii: the list allows for it.
    rounding: f64,
    /// Frames since the list was built; none if there is no list.
    age: Option<u32>,
    /// The longest way in each of them, added up.
    summed: f64,
    cells: Cells,
}

enum KeptRadii {
    Uniform(f64),
    Each {
        /// By particle.
        given: Vec<f64>,
        /// By place.
        placed: Vec<f64>,
    },
}

impl Default for KeptRadii {
    fn default() -> KeptRadii {
        KeptRadii::Uniform(0.0)
    }
}

impl<const D: usize> Kept<D> {
    /// The list is of no use any more.
    pub fn forget(&mut self) {
        self.age = None;
    }

    /// Bytes of the arrays, where the list has room for as many pairs as it holds.
    pub fn bytes(&self) -> u64 {
        let n = self.order.len() as u64;
        let radii = match self.radii {
            KeptRadii::Each { .. } => 16 * n,
            KeptRadii::Uniform(_) => 0,
        };
        n * (4 + 16 * D as u64) + radii + self.listed.len() as u64 * PAIR_BYTES + self.cells.bytes()
    }

    /// Brings the particles to their places in this frame, and says how far they have gone and how
    /// many frames ago the list was built. None if there is no list, or it is of other particles,
    /// or for a test that rounds less.
    pub fn follow<T: Real>(
        &mut self,
        scene: &Scene<'_, T, D>,
        rule: Rule,
        rounding: f64,
    ) -> Option<(u32, Ways)> {
        let age = self.age?.saturating_add(1);
        let centres = scene.centres();
        let same = centres.len() == self.order.len() && self.radii.are(scene);
        if !same || rounding > self.rounding {
            return None;
        }
        let (mut top, mut step) = (TopTwo::default(), 0.0f64);
        let places = self.order.iter().zip(&mut self.now).zip(&self.then);
        match rule.looks(age) {
            Looks::Nowhere => places.for_each(|((&particle, now), _)| {
                *now = wide(&centres[particle as usize]);
            }),
            Looks::SinceBuilt => places.for_each(|((&particle, now), then)| {
                *now = wide(&centres[particle as usize]);
                top.take(square(array(now), array(then)));
            }),
            Looks::SinceFrame => places.for_each(|((&particle, now), then)| {
                let at = wide(&centres[particle as usize]);
                top.take(square(array(&at), array(then)));
                step = step.max(square(array(&at), array(now)));
                *now = at;
            }),
        }
        let (first, second) = (at_most(top.first), at_most(top.second));
        // No less than the longest way, as in real numbers.
        self.summed = (self.summed + at_most(step)).next_up().max(first);
        self.age = Some(age);
        Some((age, Ways { square: top.first, first, second, summed: self.summed }))
    }

    /// Lists all pairs whose bodies are at most twice `half` apart in this frame, and further by
    /// what the contact test may round. The arrays may take `limit` bytes.
    pub fn build<T: Real>(
        &mut self,
        scene: &Scene<'_, T, D>,
        half: f64,
        rounding: f64,
        limit: u64,
        detector: &mut dyn AnyDetector,
        mut tally: Option<&mut Tally>,
    ) -> Result<(), Refusal>
    where
        for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
    {
        self.age = None;
        let (n, skin) = (scene.len(), 2.0 * half);
        let largest = scene.largest_radius().wide();
        let margin = if rounding == 0.0 { half } else { (half + 0.5 * rounding).next_up() };
        let larger = |r: f64| (r + margin).next_up();
        if !(2.0 * larger(largest)).is_finite() {
            return Err(Refusal::Skin { skin, diameter: 2.0 * largest });
        }
        let each = match scene.radii() {
            // By particle, by place, and larger while the list is built.
            Radii::Each(_) => 24,
            Radii::Uniform(_) => 0,
        };
        let needed = n as u64 * (12 + 16 * D as u64 + each);
        if needed > limit {
            let shape = format!("{n} particles, without the list");
            return Err(Refusal::Memory { detector: "verlet", needed, limit, shape });
        }
        for points in [&mut self.then, &mut self.now] {
            points.clear();
            reserve(points, n)?;
        }
        self.then.extend(scene.centres().iter().map(wide));
        self.cells.order(&self.then, &mut self.order)?;
        if let Some(tally) = tally.as_deref_mut() {
            tally.add(Op::Integerise, (n * D) as u64);
            tally.add(Op::Move, n as u64);
        }
        self.now.extend(self.order.iter().map(|&particle| self.then[particle as usize]));
        self.then.copy_from_slice(&self.now);
        self.radii.take(scene, &self.order)?;
        let wider = match &self.radii {
            KeptRadii::Each { placed, .. } => {
                let mut radii = Vec::new();
                reserve(&mut radii, n)?;
                radii.extend(placed.iter().map(|&r| larger(r)));
                Radii::Each(radii.into())
            }
            KeptRadii::Uniform(r) => Radii::Uniform(larger(*r)),
        };
        let wider = Scene::new(&self.now[..], wider)
            .map_err(|_| Refusal::Skin { skin, diameter: 2.0 * largest })?;
        self.listed.clear();
        let wider = wider.into();
        super::list(detector, &wider, Test::Exact, limit, tally, &mut self.listed).map_err(
            |refusal| match refusal {
                Refusal::Pairs { found, particles, room } if skin > 0.0 => {
                    Refusal::Listed { found, particles, room, skin }
                }
                other => other,
            },
        )?;
        (self.age, self.summed) = (Some(0), 0.0);
        (self.half, self.rounding) = (half, rounding);
        Ok(())
    }

    /// Of the list.
    pub fn skin(&self) -> f64 {
        2.0 * self.half
    }

    /// Pairs in the list.
    pub fn listed(&self) -> u64 {
        self.listed.len() as u64
    }

    /// Hands the listed pairs that touch in this frame to `pairs`. Tells how many took exact
    /// arithmetic.
    pub fn pass<T: Real, B: Bodies<T, D>>(&self, bodies: B, pairs: &mut PairList<'_>) -> u64 {
        match &self.radii {
            KeptRadii::Each { placed, .. } => {
                let slack = bodies.slack();
                let near =
                    |[a, b]: [u32; 2]| Near::new(placed[a as usize] + placed[b as usize], slack);
                self.pass_by(bodies, near, pairs)
            }
            KeptRadii::Uniform(r) => {
                let near = Near::new(r + r, bodies.slack());
                self.pass_by(bodies, |_| near, pairs)
            }
        }
    }

    fn pass_by<T: Real, B: Bodies<T, D>>(
        &self,
        bodies: B,
        near: impl Fn([u32; 2]) -> Near,
        pairs: &mut PairList<'_>,
    ) -> u64 {
        const BLOCK: usize = 256;
        let (now, order) = (&self.now[..], &self.order[..]);
        let (mut touching, mut exact) = ([[0; 2]; BLOCK], 0);
        for block in self.listed.chunks(BLOCK) {
            let (mut len, mut open) = (0, false);
            for &[a, b] in block {
                let near = near([a, b]);
                let square = square(array(&now[a as usize]), array(&now[b as usize]));
                touching[len % BLOCK] = [order[a as usize], order[b as usize]];
                // Without a branch: nobody can foresee which of the listed pairs touch.
                len += usize::from(square <= near.inner);
                open |= (square > near.inner) & (square <= near.outer);
            }
            pairs.contacts(&touching[..len]);
            if open {
                exact += self.pass_open(bodies, block, &near, pairs);
            }
        }
        exact
    }

    /// Those pairs of a block that copies do not decide.
    #[cold]
    fn pass_open<T: Real, B: Bodies<T, D>>(
        &self,
        bodies: B,
        block: &[[u32; 2]],
        near: &impl Fn([u32; 2]) -> Near,
        pairs: &mut PairList<'_>,
    ) -> u64 {
        let mut tally = Tally::default();
        for &[a, b] in block {
            let (at_a, at_b) = (array(&self.now[a as usize]), array(&self.now[b as usize]));
            let open = near([a, b]).verdict(square(at_a, at_b)).is_none();
            let [i, j] = [self.order[a as usize], self.order[b as usize]];
            if open && bodies.touch(i, j, &mut tally) {
                pairs.contact(i, j);
            }
        }
        tally.get(Op::ExactTest)
    }
}

impl KeptRadii {
    /// Are these the radii of the scene?
    fn are<T: Real, const D: usize>(&self, scene: &Scene<'_, T, D>) -> bool {
        match (self, scene.radii()) {
            (KeptRadii::Uniform(kept), Radii::Uniform(r)) => *kept == r.wide(),
            (KeptRadii::Each { given, .. }, Radii::Each(radii)) => {
                given.len() == radii.len()
                    && given.iter().zip(&**radii).all(|(a, b)| *a == b.wide())
            }
            _ => false,
        }
    }

    fn take<T: Real, const D: usize>(
        &mut self,
        scene: &Scene<'_, T, D>,
        order: &[u32],
    ) -> Result<(), Refusal> {
        *self = match scene.radii() {
            Radii::Uniform(r) => KeptRadii::Uniform(r.wide()),
            Radii::Each(radii) => {
                let (mut given, mut placed) = match std::mem::take(self) {
                    KeptRadii::Each { given, placed } => (given, placed),
                    KeptRadii::Uniform(_) => Default::default(),
                };
                for list in [&mut given, &mut placed] {
                    list.clear();
                    reserve(list, radii.len())?;
                }
                given.extend(radii.iter().map(|r| r.wide()));
                placed.extend(order.iter().map(|&particle| given[particle as usize]));
                KeptRadii::Each { given, placed }
            }
        };
        Ok(())
    }
}

/// Cells in rows, by which particles are put in order; no answer depends on them.
#[derive(Default)]
struct Cells {
    /// Of each particle.
    cell: Vec<u32>,
    /// Where the particles of each cell begin.
    starts: Vec<u32>,
}

impl Cells {
    fn bytes(&self) -> u64 {
        4 * (self.cell.len() + self.starts.len()) as u64
    }

    /// Puts the particles into the order of their cells, of which there are at most as many.
    fn order<const D: usize>(
        &mut self,
        points: &[Point<f64, D>],
        order: &mut Vec<u32>,
    ) -> Result<(), Refusal> {
        let n = points.len();
        let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
        for point in points {
            for k in 0..D {
                (low[k], high[k]) = (low[k].min(point[k]), high[k].max(point[k]));
            }
        }
        // Where they overflow all particles are in the first cell, and stay as they are.
        let extent: [f64; D] = std::array::from_fn(|k| high[k] - low[k]);
        let count = |edge: f64| extent.map(|extent| (extent / edge).floor() + 1.0);
        let mut edge = 2.0 * extent.iter().fold(0.0f64, |most, &extent| most.max(extent));
        while edge > f64::MIN_POSITIVE && edge < f64::INFINITY {
            if count(0.5 * edge).iter().product::<f64>() > n as f64 {
                break;
            }
            edge *= 0.5;
        }
        let counts = match edge > 0.0 && edge < f64::INFINITY {
            true => count(edge).map(|count| count as usize),
            false => [1; D],
        };
        for (list, len) in [(&mut self.cell, n), (order, n)] {
            list.clear();
            reserve(list, len)?;
        }
        self.starts.clear();
        reserve(&mut self.starts, counts.iter().product::<usize>() + 1)?;
        self.starts.resize(counts.iter().product::<usize>() + 1, 0);
        for point in points {
            let cell = (0..D).rev().fold(0, |cell, k| {
                let along = ((point[k] - low[k]) / edge) as usize;
                cell * counts[k] + along.min(counts[k] - 1)
            });
            self.cell.push(cell as u32);
            self.starts[cell + 1] += 1;
        }
        for cell in 1..self.starts.len() {
            self.starts[cell] += self.starts[cell - 1];
        }
        order.resize(n, 0);
        for (particle, &cell) in self.cell.iter().enumerate() {
            let place = &mut self.starts[cell as usize];
            order[*place as usize] = particle as u32;
            *place += 1;
        }
        Ok(())
    }
}

fn wide<T: Real, const D: usize>(centre: &Point<T, D>) -> Point<f64, D> {
    Point::from(array(centre).map(Real::wide))
}
