//! Scenes: sets of discs (2D) or spheres (3D).
//!
//! A scene holds centres and radii. Its type states the dimension and the precision, and one radius
//! for all particles is stored once, so simple scenes cost nothing extra. A [`Scene`] is always
//! valid: coordinates are finite, radii finite and not negative, and there are at most 2^32 - 1
//! particles.

pub mod any;
pub mod lattice;
mod scalar;

use std::borrow::Cow;

use crate::wide::fill;
pub use any::{AnyScene, Storage, Stored};
pub use lattice::{Lattice, LatticeError};
use nalgebra::Point;
pub use scalar::Real;

/// Returns the coordinates of a point as an array.
#[inline(always)]
pub fn array<T: nalgebra::Scalar, const D: usize>(p: &Point<T, D>) -> &[T; D] {
    &p.coords.data.0[0]
}

/// Returns rows of coordinates as points, without copying.
pub fn points<const D: usize>(rows: &[[f64; D]]) -> &[Point<f64, D>] {
    const { assert!(size_of::<Point<f64, D>>() == size_of::<[f64; D]>()) };
    const { assert!(align_of::<Point<f64, D>>() == align_of::<[f64; D]>()) };
    // SAFETY: a point is `repr(C)` around one array of its coordinates and a zero-sized marker. So
    // it has the size and the alignment of that array, as asserted, and any doubles are a valid
    // point.
    unsafe { std::slice::from_raw_parts(rows.as_ptr().cast(), rows.len()) }
}

/// A scene of discs (`D` = 2) or spheres (`D` = 3), borrowed or owned.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene<'a, T: Real, const D: usize> {
    centres: Cow<'a, [Point<T, D>]>,
    radii: Radii<'a, T>,
}

/// One radius for all particles, or one radius for each.
#[derive(Clone, Debug, PartialEq)]
pub enum Radii<'a, T: Clone> {
    /// All particles have this radius.
    Uniform(T),
    /// Particle k has radius k of this list.
    Each(Cow<'a, [T]>),
}

impl<T: Copy> Radii<'_, T> {
    /// Returns the radius of particle `k`.
    #[inline(always)]
    pub fn get(&self, k: usize) -> T {
        match self {
            Radii::Uniform(r) => *r,
            Radii::Each(radii) => radii[k],
        }
    }

    /// Returns radii of the same form, each changed by `change`.
    pub fn map<U: Clone>(&self, change: impl Fn(T) -> U) -> Radii<'static, U> {
        match self {
            Radii::Uniform(r) => Radii::Uniform(change(*r)),
            Radii::Each(radii) => Radii::Each(radii.iter().map(|&r| change(r)).collect()),
        }
    }
}

impl<T: Clone> From<T> for Radii<'_, T> {
    fn from(radius: T) -> Self {
        Radii::Uniform(radius)
    }
}

impl<T: Clone> From<Vec<T>> for Radii<'_, T> {
    fn from(radii: Vec<T>) -> Self {
        Radii::Each(radii.into())
    }
}

/// Returns the smallest and the largest of `n` numbers without NaN, or `None` if `n` is 0. Eight
/// accumulators are used in turn, so that a comparison need not wait for the one before.
pub fn extremes<T: Copy + PartialOrd>(n: usize, at: impl Fn(usize) -> T) -> Option<(T, T)> {
    const TURNS: usize = 8;
    let smaller = |a: T, b: T| if b < a { b } else { a };
    let larger = |a: T, b: T| if b > a { b } else { a };
    let first = (n > 0).then(|| at(0))?;
    let (mut least, mut largest) = ([first; TURNS], [first; TURNS]);
    let whole = n - n % TURNS;
    for k in (0..whole).step_by(TURNS) {
        for turn in 0..TURNS {
            let x = at(k + turn);
            (least[turn], largest[turn]) = (smaller(least[turn], x), larger(largest[turn], x));
        }
    }
    let rest = (whole..n).map(&at);
    Some((rest.clone().chain(least).fold(first, smaller), rest.chain(largest).fold(first, larger)))
}

/// Why centres and radii do not form a scene. Particle numbers start at 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs)] // the fields are explained by the messages
pub enum SceneError {
    /// A coordinate is NaN or infinite.
    #[error(
        "particle {index}: {axis} is {value}; coordinates must be finite numbers: remove or fix \
         the particle"
    )]
    Coordinate { index: usize, axis: &'static str, value: f64 },
    /// A radius is NaN, infinite or negative.
    #[error(
        "particle {index}: the radius is {value}; radii must be finite and not negative: remove \
         or fix the particle"
    )]
    Radius { index: usize, value: f64 },
    /// The radius that all particles share is NaN, infinite or negative.
    #[error("the radius of all particles is {value}; it must be finite and not negative")]
    UniformRadius { value: f64 },
    /// The numbers of centres and radii differ.
    #[error("{centres} centres but {radii} radii; give one radius per particle, or one for all")]
    Lengths { centres: usize, radii: usize },
    /// There are more particles than can be numbered.
    #[error("{n} particles; at most 2^32 - 1 = 4294967295 can be numbered: split the scene")]
    TooMany { n: usize },
}

impl<'a, T: Real, const D: usize> Scene<'a, T, D> {
    /// Creates a scene from centres and radii in the same unit of length.
    ///
    /// # Errors
    /// Fails if a number is not finite, a radius is negative, the numbers of centres and radii
    /// differ, or there are more than 2^32 - 1 particles.
    pub fn new(
        centres: impl Into<Cow<'a, [Point<T, D>]>>,
        radii: Radii<'a, T>,
    ) -> Result<Scene<'a, T, D>, SceneError> {
        let centres = centres.into();
        if centres.len() as u64 > u64::from(u32::MAX) {
            return Err(SceneError::TooMany { n: centres.len() });
        }
        for (index, centre) in centres.iter().enumerate() {
            for (k, x) in array(centre).iter().enumerate() {
                if !x.finite() {
                    return Err(SceneError::Coordinate {
                        index,
                        axis: ["x", "y", "z"][k.min(2)],
                        value: x.wide(),
                    });
                }
            }
        }
        let bad = |r: &T| !(r.finite() && *r >= T::default());
        match &radii {
            Radii::Uniform(r) if bad(r) => {
                return Err(SceneError::UniformRadius { value: r.wide() });
            }
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

    /// Creates a scene from rows of coordinates, and one radius or a list of radii.
    ///
    /// # Errors
    /// Fails as [`Scene::new`] does.
    pub fn at(
        rows: impl IntoIterator<Item = [T; D]>,
        radii: impl Into<Radii<'a, T>>,
    ) -> Result<Scene<'a, T, D>, SceneError> {
        Scene::new(rows.into_iter().map(Point::from).collect::<Vec<_>>(), radii.into())
    }

    /// Returns the centres, in their given order.
    pub fn centres(&self) -> &[Point<T, D>] {
        &self.centres
    }

    /// Returns the radius that all particles share, or one radius per particle.
    pub fn radii(&self) -> &Radii<'a, T> {
        &self.radii
    }

    /// Returns the radius of particle `k`.
    pub fn radius(&self, k: usize) -> T {
        self.radii.get(k)
    }

    /// Returns the number of particles.
    pub fn len(&self) -> usize {
        self.centres.len()
    }

    /// Returns whether the scene has no particles.
    pub fn is_empty(&self) -> bool {
        self.centres.is_empty()
    }

    /// Returns the largest radius; 0 if the list of radii is empty.
    pub fn largest_radius(&self) -> T {
        match &self.radii {
            Radii::Uniform(r) => *r,
            Radii::Each(radii) => {
                extremes(radii.len(), |k| radii[k]).map_or(T::default(), |(_, largest)| largest)
            }
        }
    }

    /// Returns a copy with reordered particles: particle k of the copy is particle `order[k]`.
    pub fn reordered(&self, order: &[u32]) -> Scene<'static, T, D> {
        let radii = match &self.radii {
            Radii::Uniform(r) => Radii::Uniform(*r),
            Radii::Each(radii) => Radii::Each(order.iter().map(|&k| radii[k as usize]).collect()),
        };
        Scene { centres: order.iter().map(|&k| self.centres[k as usize]).collect(), radii }
    }

    /// Returns a copy of the scene, rounded to another precision.
    ///
    /// # Errors
    /// Returns [`SceneError::Coordinate`] or [`SceneError::Radius`] if a number overflows.
    pub fn convert<U: Real>(&self) -> Result<Scene<'static, U, D>, SceneError> {
        let place = |p: &Point<T, D>| Point::from(fill(|k| U::nearest(array(p)[k].wide())));
        let centres: Vec<_> = self.centres.iter().map(place).collect();
        Scene::new(centres, self.radii.map(|r| U::nearest(r.wide())))
    }

    /// Returns the scene in f64. This cannot fail, because every storage widens to f64 exactly.
    pub fn widened(&self) -> Scene<'static, f64, D> {
        let wide = |p: &Point<T, D>| Point::from(array(p).map(|x| x.wide()));
        let centres = self.centres.iter().map(wide).collect();
        Scene { centres, radii: self.radii.map(Real::wide) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_points_in_place() {
        let rows = [[1.0, 2.0, 3.0], [4.0, -0.0, f64::NAN]];
        let same = |(point, row): (&Point<f64, 3>, &[f64; 3])| {
            array(point).map(f64::to_bits) == row.map(f64::to_bits)
        };
        assert!(points(&rows).len() == 2 && points(&rows).iter().zip(&rows).all(same));
        assert_eq!(points::<2>(&[]).len(), 0);
    }

    #[test]
    fn extremes_are_the_smallest_and_the_largest() {
        assert_eq!(extremes(0, |_| 1.0), None);
        for n in 1..20 {
            for (least, largest) in (0..n).flat_map(|a| (0..n).map(move |b| (a, b))) {
                let at = |k: usize| match k {
                    k if k == largest => 9.0,
                    k if k == least => 1.0,
                    _ => 5.0,
                };
                let least = if n == 1 || least == largest { at((largest + 1) % n) } else { 1.0 };
                assert_eq!(extremes(n, at), Some((least, 9.0)), "{n}");
            }
        }
    }
}
