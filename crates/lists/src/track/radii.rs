//! Radii kept between frames.

use contactbench_ground::limits::refusal::{Refusal, reserve};
use contactbench_ground::scene::{Radii, Real, Scene};
use contactbench_ground::wide::Spot;

pub(super) enum KeptRadii {
    Uniform(f64),
    Each { given: Vec<f64>, placed: Vec<f64> },
}

impl Default for KeptRadii {
    fn default() -> KeptRadii {
        KeptRadii::Uniform(0.0)
    }
}

impl KeptRadii {
    /// Returns the radii by place, each one changed by `change`.
    pub fn each(&self, change: impl Fn(f64) -> f64) -> Result<Radii<'static, f64>, Refusal> {
        Ok(match self {
            KeptRadii::Each { placed, .. } => {
                let mut radii = Vec::new();
                reserve(&mut radii, placed.len())?;
                radii.extend(placed.iter().map(|&r| change(r)));
                Radii::Each(radii.into())
            }
            KeptRadii::Uniform(r) => Radii::Uniform(change(*r)),
        })
    }

    /// Returns whether a scene has these radii.
    pub fn are<T: Real, const D: usize>(&self, scene: &Scene<'_, T, D>) -> bool {
        match (self, scene.radii()) {
            (KeptRadii::Uniform(kept), Radii::Uniform(r)) => *kept == r.wide(),
            (KeptRadii::Each { given, .. }, Radii::Each(radii)) => {
                given.len() == radii.len()
                    && given.iter().zip(&**radii).all(|(a, b)| *a == b.wide())
            }
            _ => false,
        }
    }

    /// Keeps the radii of a scene, and those of the particles in their places.
    pub fn take<T: Real, const D: usize>(
        &mut self,
        scene: &Scene<'_, T, D>,
        spots: &[Spot],
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
                placed.extend(spots.iter().map(|spot| given[spot.id as usize]));
                KeptRadii::Each { given, placed }
            }
        };
        Ok(())
    }
}
