//! Bounds on the distances that the sweep computes: which pairs certainly touch, which certainly do
//! not, and which need the contact test.
//!
//! Let D be the true distance of two particles in steps and d the one computed here.
//! Coordinate differences are off by at most [`STEPS_OFF`] along each axis. Each x is rounded to 24
//! bits, and their difference once more. The other coordinates are exact (integers below 2^22:
//! fractions, plus or minus one cell). The sum of squares, fused or not, has at most four
//! roundings, a relative error below 2^-21. So |d - D| <= √3·2.1 + 2·(steps along x)·2^-24 + 1,
//! apart from that relative error. Radii have relative errors of 2^-23.
//!
//! `grow` is the sum of these bounds and of the test's slack, with relative errors (2^-19 in total)
//! times the largest sum of radii. For the sum s of a pair's radii, the contact test is certain to
//! refuse d > s + grow and to accept d <= s - grow. The test itself decides all other pairs, a few
//! in ten thousand contacts.
//!
//! In the flat form the second axis is rounded like x: its steps are added to the steps along x.

use super::grid::{Grid, STEPS_OFF, reach_of};
use contactbench_ground::contact::{Particles, Slack};
use contactbench_ground::scene::Real;

/// Limits in steps that decide a contact from the distance of a pair.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    /// Sum of two radii if all radii are equal.
    pub sum: f32,
    pub grow: f32,
    /// Edge of a cell in steps.
    pub one: f32,
    /// Index of the first image, or `u32::MAX` if none is known. The test rejects two images.
    pub first_image: u32,
}

impl Bounds {
    /// Computes the bounds for particles in this grid; x wraps around after `turn` steps, if given.
    pub fn new<T: Real, const D: usize>(
        particles: &impl Particles<T, D>,
        grid: &Grid<D>,
        turn: Option<f32>,
    ) -> Bounds {
        let bounds = Bounds::of(particles.slack(), reach_of(particles), grid, turn);
        // Twice the radius in steps; the diameter itself could overflow.
        let sum = 2.0 * grid.length(particles.uniform().unwrap_or(0.0));
        Bounds { sum: sum as f32, first_image: particles.first_image(), ..bounds }
    }

    /// Computes the bounds for individual radii; pairs farther apart than `reach` do not touch.
    pub fn of<const D: usize>(
        slack: Slack,
        reach: f64,
        grid: &Grid<D>,
        turn: Option<f32>,
    ) -> Bounds {
        let from_origin = grid.count[0] + if grid.flat { grid.count[1] } else { 0 };
        let steps = turn.map_or((from_origin << grid.bits) as f64, f64::from);
        let reach = grid.length(reach.min(f64::MAX));
        let relative = slack.relative + 1.0 / f64::from(1 << 19);
        let grow = 2.0 * STEPS_OFF
            + steps / f64::from(1 << 23)
            + 2.0
            + grid.length(slack.absolute)
            + reach * relative;
        let one = (1u64 << grid.bits) as f32;
        Bounds { sum: 0.0, grow: grow as f32, one, first_image: u32::MAX }
    }
}
