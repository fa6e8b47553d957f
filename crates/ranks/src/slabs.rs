//! The slabs that ranks own, and the ranks that need copies of a particle.
//!
//! A slab is a range of *places*. A place is a coordinate in open space, and a fraction along a
//! vector of a periodic box, modulo 1. Slab k is \[c(k), c(k + 1)), so every particle has one owner
//! in spite of rounding. The borders c(k) are places of particles: quantiles of a sample that is
//! the same in all ranks.
//!
//! **In open space** particles touch if |xi - xj| <= ri + rj. Let i be in a slab above that of j,
//! whose upper border is c. Then xj < c, so a contact implies xi - c < ri + rj. If R is the largest
//! radius in the slab of j, this is at most ri + R. Rounding is monotone, so the rounded difference
//! is at most the rounded sum. A particle that fails this comparison touches none in that slab.
//!
//! **In a box** let g be the computed dual of vector a. By (1) of
//! [`frame`](contactbench_lists::periodic::frame), a contact through S vectors implies |Ta -
//! g·(xi - xj)| <= |g| (ri + rj) + the coupling of the other vectors, for a whole number Ta. So the
//! exact places are at most that far apart on a circle of length 1. A computed place differs from
//! the exact one by at most 4u times the sum of |g| |x|, and by another u from the modulo. The
//! slack is twice the largest of these errors, plus an allowance for the sums here. On the circle,
//! i reaches the slab of j downwards from its own place, or upwards through the face.

use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::scene::Lattice;
use contactbench_lists::periodic::frame::{ReducedBox, U};
use contactbench_terms::mix::splitmix64;

use crate::particles::Numbered;
use crate::rank::Failure;
use crate::world::World;

/// Number of places that each rank adds to the sample.
const SAMPLE: usize = 512;

/// The borders of all slabs, and the largest radius in each.
#[derive(Clone, Debug)]
pub struct Slabs<const D: usize> {
    along: Along<D>,
    /// Borders c(1), c(2), ... between slabs.
    borders: Vec<f64>,
    /// The largest radius in each slab; minus infinity if it is empty.
    largest: Vec<f64>,
    largest_of_all: f64,
}

#[derive(Clone, Debug)]
enum Along<const D: usize> {
    Axis(usize),
    Vector { frame: Box<ReducedBox<D>>, vector: usize, slack: f64 },
}

impl<const D: usize> Slabs<D> {
    /// Makes slabs that hold about equally many of the particles of all ranks.
    pub fn new(
        world: &impl World,
        particles: &Numbered<D>,
        largest_radius: f64,
        lattice: Option<&Lattice>,
    ) -> Result<Slabs<D>, Failure> {
        let along = match lattice {
            None => Along::axis(world, particles),
            // The box is the same in all ranks, so either all ranks refuse it or none.
            Some(lattice) => Along::vector(world, particles, largest_radius, lattice)?,
        };
        // One random particle is taken from each interval, because regular steps might always hit
        // the same row of a lattice.
        let step = particles.len().div_ceil(SAMPLE).max(1);
        let drawn = |begin: usize| {
            let some = step.min(particles.len() - begin) as u64;
            begin + (splitmix64((begin as u64) << 8 ^ world.rank() as u64) % some) as usize
        };
        let begins = (0..particles.len()).step_by(step);
        let sampled = begins.map(|begin| along.place(particles.at(drawn(begin))));
        let letter: Vec<u8> = sampled.flat_map(f64::to_le_bytes).collect();
        let mut letters = vec![letter; world.size()];
        world.exchange(&mut letters)?;
        let numbers = letters.iter().flat_map(|letter| letter.as_chunks::<8>().0);
        let mut sample: Vec<f64> = numbers.map(|bytes| f64::from_le_bytes(*bytes)).collect();
        sample.sort_unstable_by(f64::total_cmp);
        let quantile = |k: usize| sample.get(k * sample.len() / world.size()).copied();
        let borders = (1..world.size()).map(|k| quantile(k).unwrap_or(0.0)).collect();
        Ok(Slabs { along, borders, largest: Vec::new(), largest_of_all: largest_radius })
    }

    /// Stores the largest radius of each slab; `largest` is that of this rank's slab.
    pub fn settle(&mut self, world: &impl World, largest: f64) {
        self.largest = vec![f64::NEG_INFINITY; world.size()];
        self.largest[world.rank()] = largest;
        world.largest(&mut self.largest);
    }

    pub fn owner(&self, x: &[f64; D]) -> usize {
        let place = self.along.place(x);
        self.borders.partition_point(|&border| border <= place)
    }

    /// Calls `send` once for each rank whose particles may touch a particle at `x` with radius `r`,
    /// which `rank` owns. Ranks above `rank` are left out.
    pub fn reached(&self, rank: usize, x: &[f64; D], r: f64, send: &mut dyn FnMut(usize)) {
        let place = self.along.place(x);
        // A comparison with NaN counts as near.
        let apart = |gap: f64, radius: f64| gap > self.along.reach(r + radius);
        let mut lowest = rank;
        for below in (0..rank).rev() {
            let gap = place - self.borders[below];
            if apart(gap, self.largest_of_all) {
                break;
            }
            lowest = below;
            if !apart(gap, self.largest[below]) {
                send(below);
            }
        }
        if let Along::Axis(_) = self.along {
            return;
        }
        for above in 0..rank {
            let begin = if above == 0 { 0.0 } else { self.borders[above - 1] };
            let gap = (1.0 - place) + begin;
            if apart(gap, self.largest_of_all) {
                break;
            }
            let sent = above >= lowest && !apart(place - self.borders[above], self.largest[above]);
            if !sent && !apart(gap, self.largest[above]) {
                send(above);
            }
        }
    }

    /// Returns the index (0, 1 or 2) of the axis or the box vector along which slabs lie, and
    /// whether it is a vector.
    pub fn direction(&self) -> (usize, bool) {
        match self.along {
            Along::Axis(axis) => (axis, false),
            Along::Vector { vector, .. } => (vector, true),
        }
    }
}

impl<const D: usize> Along<D> {
    /// Returns the axis along which the scene is longest.
    fn axis(world: &impl World, particles: &Numbered<D>) -> Along<D> {
        let mut ends = [[f64::NEG_INFINITY; 2]; D];
        for x in particles.places() {
            for (end, &x) in ends.iter_mut().zip(x) {
                *end = [end[0].max(x), end[1].max(-x)];
            }
        }
        world.largest(ends.as_flattened_mut());
        // Values are halved, so that the extent does not overflow.
        let extent = |axis: usize| 0.5 * ends[axis][0] + 0.5 * ends[axis][1];
        let longest = (0..D).rev().max_by(|&a, &b| extent(a).total_cmp(&extent(b)));
        Along::Axis(longest.unwrap_or(0))
    }

    /// Returns the box vector whose two faces are farthest apart.
    fn vector(
        world: &impl World,
        particles: &Numbered<D>,
        largest_radius: f64,
        lattice: &Lattice,
    ) -> Result<Along<D>, Refusal> {
        let frame = ReducedBox::new(lattice)?;
        let periodic = (0..3).filter(|&a| frame.periodic[a]);
        let vector = periodic.min_by(|&a, &b| frame.lengths[a].total_cmp(&frame.lengths[b]));
        let vector = vector.unwrap_or(0);
        // Each vector has three maxima: of the fraction, of the negated fraction, and of the sum.
        let mut most = [[f64::NEG_INFINITY; 3]; 3];
        for x in particles.places() {
            for a in (0..3).filter(|&a| frame.periodic[a]) {
                let fraction = frame.fraction(a, x);
                let found = [fraction, -fraction, frame.most(a, x)];
                most[a] = std::array::from_fn(|k| most[a][k].max(found[k]));
            }
        }
        world.largest(most.as_flattened_mut());
        let error = |a: usize| 4.0 * U * most[a][2].max(0.0) * (1.0 + 64.0 * U) + 2.0 * U;
        let spread = std::array::from_fn(|a| {
            ((most[a][0] + most[a][1]).max(0.0) * (1.0 + 4.0 * U)) + 2.0 * error(a)
        });
        let (coupled, _) = frame.coupling(spread, 2.0 * largest_radius);
        let slack = (coupled[vector] + 2.0 * error(vector)) * (1.0 + 64.0 * U) + 64.0 * U;
        Ok(Along::Vector { frame: Box::new(frame), vector, slack })
    }

    fn place(&self, x: &[f64; D]) -> f64 {
        match self {
            Along::Axis(axis) => x[*axis],
            Along::Vector { frame, vector, .. } => {
                let fraction = frame.fraction(*vector, x);
                fraction - fraction.floor()
            }
        }
    }

    /// Returns the largest distance of two places in contact; `sum` is the sum of both radii.
    fn reach(&self, sum: f64) -> f64 {
        match self {
            Along::Axis(_) => sum,
            Along::Vector { frame, vector, slack } => {
                frame.lengths[*vector] * sum * (1.0 + 64.0 * U) + slack
            }
        }
    }
}
