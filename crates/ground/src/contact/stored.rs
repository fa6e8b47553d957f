//! A view of a scene in any storage.

use super::bodies::{AnyBodies, any_bodies};
use super::{Bodies, Corners, Margin, Slack, Test};
use crate::limits::refusal::Refusal;
use crate::probe::Probe;
use crate::scene::Stored;

/// A scene in any storage whose contact test is chosen at run time, for each pair. Code that works
/// on it is compiled once, for all storages and tests. If it is `TIMED`, positions are read inline.
#[derive(Clone, Copy)]
pub enum StoredBodies<'a, const D: usize, const TIMED: bool> {
    /// A scene in f32.
    F32(AnyBodies<'a, f32, D>),
    /// A scene in f64, which may have images.
    F64(AnyBodies<'a, f64, D>),
}

macro_rules! any {
    ($stored:expr, $bodies:ident => $value:expr) => {
        match $stored {
            StoredBodies::F32($bodies) => $value,
            StoredBodies::F64($bodies) => $value,
        }
    };
}

impl<'a, const D: usize, const TIMED: bool> StoredBodies<'a, D, TIMED> {
    /// Returns the scene with this test. Fails with [`Refusal::Overflow`] for a rounded test.
    pub fn new(scene: &'a Stored<'_, D>, test: Test) -> Result<Self, Refusal> {
        Ok(match scene {
            Stored::F32(scene) => StoredBodies::F32(any_bodies(scene, test)?),
            Stored::F64(scene) => StoredBodies::F64(any_bodies(scene, test)?),
        })
    }

    #[inline(never)]
    fn at(&self, i: u32) -> [f64; D] {
        any!(self, bodies => bodies.position(i))
    }
}

impl<const D: usize, const TIMED: bool> Bodies<f64, D> for StoredBodies<'_, D, TIMED> {
    fn len(&self) -> usize {
        any!(self, bodies => bodies.len())
    }

    #[inline(always)]
    fn position(&self, i: u32) -> [f64; D] {
        if TIMED { any!(self, bodies => bodies.position(i)) } else { self.at(i) }
    }

    // All tests of all storages, inlined, would be most of the code of a detector.
    #[inline(never)]
    fn touch<P: Probe>(&self, i: u32, j: u32, probe: &mut P) -> bool {
        any!(self, bodies => bodies.touch(i, j, probe))
    }

    fn reach(&self) -> f64 {
        any!(self, bodies => bodies.reach())
    }

    #[inline(always)]
    fn radius(&self, i: u32) -> f64 {
        any!(self, bodies => bodies.radius(i))
    }

    fn uniform(&self) -> Option<f64> {
        any!(self, bodies => bodies.uniform())
    }

    fn slack(&self) -> Slack {
        any!(self, bodies => bodies.slack())
    }

    fn underflow(&self) -> f64 {
        any!(self, bodies => bodies.underflow())
    }

    fn margin(&self) -> Margin {
        any!(self, bodies => bodies.margin())
    }

    fn corners(&self) -> Option<Corners<D>> {
        any!(self, bodies => bodies.corners())
    }
}
