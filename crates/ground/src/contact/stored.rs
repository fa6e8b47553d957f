//! A view of a scene in any storage.

use super::particles::{AnyParticles, any_particles};
use super::{Corners, Margin, Particles, Slack, Test};
use crate::limits::refusal::Refusal;
use crate::probe::Probe;
use crate::scene::Stored;

/// A scene in any storage whose contact test is chosen at run time, for each pair. Code that works
/// on it is compiled once, for all storages and tests. If it is `TIMED`, positions are read inline.
#[derive(Clone, Copy)]
pub enum StoredParticles<'a, const D: usize, const TIMED: bool> {
    /// A scene in f32.
    F32(AnyParticles<'a, f32, D>),
    /// A scene in f64, which may have images.
    F64(AnyParticles<'a, f64, D>),
}

macro_rules! any {
    ($stored:expr, $particles:ident => $value:expr) => {
        match $stored {
            StoredParticles::F32($particles) => $value,
            StoredParticles::F64($particles) => $value,
        }
    };
}

impl<'a, const D: usize, const TIMED: bool> StoredParticles<'a, D, TIMED> {
    /// Returns the scene with this test. Fails with [`Refusal::Overflow`] for a rounded test.
    pub fn new(scene: &'a Stored<'_, D>, test: Test) -> Result<Self, Refusal> {
        Ok(match scene {
            Stored::F32(scene) => StoredParticles::F32(any_particles(scene, test)?),
            Stored::F64(scene) => StoredParticles::F64(any_particles(scene, test)?),
        })
    }

    #[inline(never)]
    fn at(&self, i: u32) -> [f64; D] {
        any!(self, particles => particles.position(i))
    }
}

impl<const D: usize, const TIMED: bool> Particles<f64, D> for StoredParticles<'_, D, TIMED> {
    fn len(&self) -> usize {
        any!(self, particles => particles.len())
    }

    #[inline(always)]
    fn position(&self, i: u32) -> [f64; D] {
        if TIMED { any!(self, particles => particles.position(i)) } else { self.at(i) }
    }

    // All tests of all storages, inlined, would be most of the code of a detector.
    #[inline(never)]
    fn touch<P: Probe>(&self, i: u32, j: u32, probe: &mut P) -> bool {
        any!(self, particles => particles.touch(i, j, probe))
    }

    fn reach(&self) -> f64 {
        any!(self, particles => particles.reach())
    }

    #[inline(always)]
    fn radius(&self, i: u32) -> f64 {
        any!(self, particles => particles.radius(i))
    }

    fn uniform(&self) -> Option<f64> {
        any!(self, particles => particles.uniform())
    }

    fn slack(&self) -> Slack {
        any!(self, particles => particles.slack())
    }

    fn underflow(&self) -> f64 {
        any!(self, particles => particles.underflow())
    }

    fn margin(&self) -> Margin {
        any!(self, particles => particles.margin())
    }

    fn corners(&self) -> Option<Corners<D>> {
        any!(self, particles => particles.corners())
    }
}
