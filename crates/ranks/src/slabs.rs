//! Which rank owns a particle, and which other ranks need it.
//!
//! A slab is a range of *places*: values of one coordinate in open space, or of the fraction along
//! one vector of a periodic box, taken modulo 1. Slab k is \[c(k), c(k + 1)), so every particle has
//! one owner, however inaccurate its place. The borders are quantiles of a sample of places, which
//! is the same in all ranks.
//!
//! **In open space** particles touch if |xi - xj| <= ri + rj. Let i be in a slab above that of j,
//! whose upper border is c. Then xj < c along the axis, and a contact means xi - c < ri + rj. With
//! R, the largest radius in the slab of j, this is at most ri + R. Rounding is monotone, so the
//! rounded difference is at most the rounded sum: a particle that fails this comparison touches
//! nothing in that slab.
//!
//! **In a box** a contact through S vectors means, with g the computed dual of vector a and (1) of
//! `periodic/frame.rs`: |Ta - g·(xi - xj)| <= |g| (ri + rj) plus the coupling of the other vectors,
//! for an integer Ta. So the two exact places are as near on the circle of length 1. A computed
//! place is within 4u times the sum of |g| |x| of the exact one, and another u for taking it modulo
//! 1. Twice the largest of these bounds, and a bit more for the sums here, is the slack. On the
//! circle the slab of j is reached from i downwards, from its own place, or upwards, through the
//! face.

use contactbench_core::periodic::frame::{Frame, U};
use contactbench_core::refusal::Refusal;
use contactbench_core::scene::Lattice;
use contactbench_core::sink::splitmix64;

use crate::bodies::Numbered;
use crate::rank::Failure;
use crate::world::World;

/// Number of places that each rank contributes to the sample.
const SAMPLE: usize = 512;

/// Division of the scene into slabs; see the module.
#[derive(Clone, Debug)]
pub struct Slabs<const D: usize> {
    along: Along<D>,
    /// c(1), c(2), ...
    borders: Vec<f64>,
    /// Largest radius in each slab; minus infinity if it is empty.
    largest: Vec<f64>,
    largest_of_all: f64,
}

#[derive(Clone, Debug)]
enum Along<const D: usize> {
    Axis(usize),
    Vector { frame: Box<Frame<D>>, vector: usize, slack: f64 },
}

impl<const D: usize> Slabs<D> {
    /// Creates slabs with about equal numbers of the particles in all ranks.
    pub fn new(
        world: &impl World,
        bodies: &Numbered<D>,
        largest_radius: f64,
        lattice: Option<&Lattice>,
    ) -> Result<Slabs<D>, Failure> {
        let along = match lattice {
            None => Along::axis(world, bodies),
            // The box is the same in all ranks, and so are its refusals.
            Some(lattice) => Along::vector(world, bodies, largest_radius, lattice)?,
        };
        // Random within each stride: equal strides could all fall on one row of a lattice.
        let step = bodies.len().div_ceil(SAMPLE).max(1);
        let drawn = |begin: usize| {
            let some = step.min(bodies.len() - begin) as u64;
            begin + (splitmix64((begin as u64) << 8 ^ world.rank() as u64) % some) as usize
        };
        let begins = (0..bodies.len()).step_by(step);
        let sampled = begins.map(|begin| along.place(bodies.at(drawn(begin))));
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

    /// Computes the largest radius in each slab from the particles that ranks own.
    pub fn settle(&mut self, world: &impl World, largest: f64) {
        self.largest = vec![f64::NEG_INFINITY; world.size()];
        self.largest[world.rank()] = largest;
        world.largest(&mut self.largest);
    }

    /// Returns the rank that owns a particle at `x`.
    pub fn owner(&self, x: &[f64; D]) -> usize {
        let place = self.along.place(x);
        self.borders.partition_point(|&border| border <= place)
    }

    /// Calls `send` once for each rank below `rank`, the owner, whose particles may touch a
    /// particle of radius `r` at `x`.
    pub fn reached(&self, rank: usize, x: &[f64; D], r: f64, send: &mut dyn FnMut(usize)) {
        let place = self.along.place(x);
        // NaN counts as near.
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

    /// Returns the axis or box vector along which slabs lie (0, 1 or 2), and whether it is a
    /// vector.
    pub fn direction(&self) -> (usize, bool) {
        match self.along {
            Along::Axis(axis) => (axis, false),
            Along::Vector { vector, .. } => (vector, true),
        }
    }
}

impl<const D: usize> Along<D> {
    /// Chooses the axis along which the scene is longest.
    fn axis(world: &impl World, bodies: &Numbered<D>) -> Along<D> {
        let mut ends = [[f64::NEG_INFINITY; 2]; D];
        for x in bodies.places() {
            for (end, &x) in ends.iter_mut().zip(x) {
                *end = [end[0].max(x), end[1].max(-x)];
            }
        }
        world.largest(ends.as_flattened_mut());
        // Halved, so that the extent does not overflow.
        let extent = |axis: usize| 0.5 * ends[axis][0] + 0.5 * ends[axis][1];
        let longest = (0..D).rev().max_by(|&a, &b| extent(a).total_cmp(&extent(b)));
        Along::Axis(longest.unwrap_or(0))
    }

    /// Chooses the vector whose faces are farthest apart.
    fn vector(
        world: &impl World,
        bodies: &Numbered<D>,
        largest_radius: f64,
        lattice: &Lattice,
    ) -> Result<Along<D>, Refusal> {
        let frame = Frame::new(lattice)?;
        let periodic = (0..3).filter(|&a| frame.periodic[a]);
        let vector = periodic.min_by(|&a, &b| frame.lengths[a].total_cmp(&frame.lengths[b]));
        let vector = vector.unwrap_or(0);
        // Along each vector: the largest fraction, the largest negative fraction, and the largest
        // sum of magnitudes.
        let mut most = [[f64::NEG_INFINITY; 3]; 3];
        for x in bodies.places() {
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

    /// Returns how far apart the places of touching particles with this sum of radii may be.
    fn reach(&self, sum: f64) -> f64 {
        match self {
            Along::Axis(_) => sum,
            Along::Vector { frame, vector, slack } => {
                frame.lengths[*vector] * sum * (1.0 + 64.0 * U) + slack
            }
        }
    }
}
