//! Scenes: sets of discs (2D) and spheres (3D).
//!
//! A scene is centres and radii, and says what it is: its dimension, its precision, and whether it has one radius or one per element.
//! Code for the simple case never pays for the rich one. A [`Scene`] is always valid: finite coordinates, finite radii that are not
//! negative, at most 2^32 - 1 elements.

pub mod any;
pub mod generate;
pub mod spec;
pub mod stats;

use std::borrow::Cow;

use nalgebra::Point;

use crate::contact::{Real, array};
pub use any::AnyScene;

/// Discs (`D` = 2) or spheres (`D` = 3), borrowed or owned.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene<'a, T: Real, const D: usize> {
    centres: Cow<'a, [Point<T, D>]>,
    radii: Radii<'a, T>,
}

/// One radius for all elements, or one for each.
#[derive(Clone, Debug, PartialEq)]
pub enum Radii<'a, T: Clone> {
    /// All elements have this radius.
    Uniform(T),
    /// Element k has the k-th radius.
    Each(Cow<'a, [T]>),
}

/// What is wrong with a set of centres and radii. Elements are numbered from 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs)] // the fields are explained by the messages
pub enum SceneError {
    /// NaN or infinite.
    #[error("particle {index}: {axis} is {value}; coordinates must be finite numbers: remove or mend the particle")]
    Coordinate { index: usize, axis: &'static str, value: f64 },
    /// NaN, infinite or negative.
    #[error("particle {index}: the radius is {value}; radii must be finite and not negative: remove or mend the particle")]
    Radius { index: usize, value: f64 },
    /// NaN, infinite or negative.
    #[error("the radius of all particles is {value}; it must be finite and not negative")]
    UniformRadius { value: f64 },
    /// Numbers of centres and radii differ.
    #[error("{centres} centres but {radii} radii; give one radius per particle, or one for all")]
    Lengths { centres: usize, radii: usize },
    /// More than can be numbered.
    #[error("{n} particles; at most 2^32 - 1 = 4294967295 can be numbered: split the scene")]
    TooMany { n: usize },
}

impl<'a, T: Real, const D: usize> Scene<'a, T, D> {
    /// A scene from centres and radii, which are checked.
    pub fn new(centres: impl Into<Cow<'a, [Point<T, D>]>>, radii: Radii<'a, T>) -> Result<Scene<'a, T, D>, SceneError> {
        let centres = centres.into();
        if centres.len() as u64 > u64::from(u32::MAX) {
            return Err(SceneError::TooMany { n: centres.len() });
        }
        for (index, centre) in centres.iter().enumerate() {
            for (k, x) in array(centre).iter().enumerate() {
                if !x.finite() {
                    return Err(SceneError::Coordinate { index, axis: ["x", "y", "z"][k.min(2)], value: x.wide() });
                }
            }
        }
        let bad = |r: &T| !(r.finite() && *r >= T::default());
        match &radii {
            Radii::Uniform(r) if bad(r) => return Err(SceneError::UniformRadius { value: r.wide() }),
            Radii::Each(radii) if radii.len() != centres.len() => {
                return Err(SceneError::Lengths { centres: centres.len(), radii: radii.len() });
            }
            Radii::Each(radii) => {
                if let Some(index) = radii.iter().position(bad) {
                    return Err(SceneError::Radius { index, value: radii[index].wide() });
                }
            }
            Radii::Uniform(_) => {}
        }
        Ok(Scene { centres, radii })
    }

    /// The centres, in file or generation order.
    pub fn centres(&self) -> &[Point<T, D>] {
        &self.centres
    }

    /// One radius, or one per element.
    pub fn radii(&self) -> &Radii<'a, T> {
        &self.radii
    }

    /// The radius of element `k`.
    pub fn radius(&self, k: usize) -> T {
        match &self.radii {
            Radii::Uniform(r) => *r,
            Radii::Each(radii) => radii[k],
        }
    }

    /// The number of elements.
    pub fn len(&self) -> usize {
        self.centres.len()
    }

    /// True if there are no elements.
    pub fn is_empty(&self) -> bool {
        self.centres.is_empty()
    }

    /// The largest radius; 0 for an empty scene with a radius per element.
    pub fn largest_radius(&self) -> T {
        match &self.radii {
            Radii::Uniform(r) => *r,
            Radii::Each(radii) => radii.iter().fold(T::default(), |most, &r| if r > most { r } else { most }),
        }
    }

    /// The scene with its elements in another order: element k of the result is element `order[k]`.
    pub fn reordered(&self, order: &[u32]) -> Scene<'static, T, D> {
        let radii = match &self.radii {
            Radii::Uniform(r) => Radii::Uniform(*r),
            Radii::Each(radii) => Radii::Each(order.iter().map(|&k| radii[k as usize]).collect()),
        };
        Scene { centres: order.iter().map(|&k| self.centres[k as usize]).collect(), radii }
    }

    /// The scene rounded to another precision. Fails where a number overflows.
    pub fn convert<U: Real>(&self) -> Result<Scene<'static, U, D>, SceneError> {
        let near = |x: T| U::nearest(x.wide());
        let radii = match &self.radii {
            Radii::Uniform(r) => Radii::Uniform(near(*r)),
            Radii::Each(radii) => Radii::Each(radii.iter().map(|&r| near(r)).collect()),
        };
        Scene::new(self.centres.iter().map(|p| Point::from(array(p).map(near))).collect::<Vec<_>>(), radii)
    }
}
