//! `zelll`: the cell lists of the crate [zelll](https://docs.rs/zelll).
//!
//! Particles are sorted into cells as wide as the reach, hashed by a 32-bit number. The crate
//! enumerates all pairs in equal and neighbouring cells.
//!
//! * A new grid is made for every detection. The crate can rebuild one in place, but then reuses
//!   the previous cells if no particle has left its cell, which would make the measurement unfair.
//!   It also fails to notice a changed number of particles.
//! * Cells are wider than the reach by the margin of [`contactbench_ground::filter::cells`], whose proof holds
//!   here: fewer than 2^31 cells per axis, found by one subtraction and one division. Cells are
//!   doubled until their numbers fit in 32 bits.

use ::zelll::{CellGrid, ParticleLike};

use super::ZELLL;
use super::library::{Library, bounds};
use contactbench_ground::contact::Bodies;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::scene::Real;

/// The library of this module.
pub struct Zelll;

#[derive(Clone, Copy)]
struct Particle<const D: usize>(u32, [f64; D]);

impl<const D: usize> Default for Particle<D> {
    fn default() -> Particle<D> {
        Particle(0, [0.0; D])
    }
}

impl<const D: usize> ParticleLike<[f64; D]> for Particle<D> {
    #[inline]
    fn coords(&self) -> [f64; D] {
        self.1
    }
}

impl<const D: usize> Library<D> for Zelll {
    fn pairs<T: Real>(
        points: &[[f64; D]],
        bodies: &impl Bodies<T, D>,
        mut near: impl FnMut(u32, u32),
    ) -> Result<(), Refusal> {
        let edge = edge(points, bodies.reach())?;
        let particles = points.iter().zip(0u32..).map(|(&point, i)| Particle(i, point));
        let grid = CellGrid::new(particles, edge);
        for (Particle(i, _), Particle(j, _)) in grid.particle_pairs() {
            near(*i, *j);
        }
        Ok(())
    }
}

fn edge<const D: usize>(points: &[[f64; D]], reach: f64) -> Result<f64, Refusal> {
    // Leaves room: the crate numbers four more cells per axis, and adds offsets of neighbours.
    const MOST: f64 = (1u64 << 30) as f64;
    let [low, high] = bounds(points);
    let extent: [f64; D] = std::array::from_fn(|k| high[k] - low[k]);
    let longest = extent.iter().copied().fold(0.0, f64::max);
    let mut edge = reach.max(f64::MIN_POSITIVE * 4.0) * (1.0 + 1.0 / (1u64 << 17) as f64);
    if !longest.is_finite() || !edge.is_finite() {
        let reason =
            "its cells or their distances overflow; scale the scene down, or use direct".into();
        return Err(Refusal::Library { detector: ZELLL.name, reason });
    }
    // If all particles are points, cells are wide enough for about one particle each.
    if reach == 0.0 {
        edge = edge.max(longest / libm::pow(points.len().max(1) as f64, 1.0 / D as f64));
    }
    while extent.iter().map(|x| x / edge + 6.0).product::<f64>() > MOST {
        edge *= 2.0;
    }
    Ok(edge)
}
