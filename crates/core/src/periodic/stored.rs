//! Copies of the particles and images of a periodic scene in storages other than f64.

use nalgebra::Point;

use super::made::Made;
use crate::contact::Arithmetic;
use crate::refusal::{Refusal, reserve};
use crate::scene::{AnyScene, ByCells, CellF32, Radii, Real, Scene, SceneError, Storage, Stored};
use crate::wide::fill;

/// Buffers for a copy in f32 or in cells.
#[derive(Default)]
pub struct Copies<const D: usize> {
    single: Copied<f32, D>,
    cells: Copied<CellF32, D>,
}

#[derive(Default)]
struct Copied<T: Real, const D: usize> {
    centres: Vec<Point<T, D>>,
    radii: Vec<T>,
}

impl<const D: usize> Copies<D> {
    /// Returns particles and images as the arithmetic stores them, or `None` if it stores f64.
    ///
    /// # Errors
    /// Returns [`Refusal::Stored`] if numbers do not fit, or [`Refusal::Exhausted`] if memory runs
    /// out.
    pub fn of(
        &mut self,
        made: &Made<'_, D>,
        arithmetic: Arithmetic,
    ) -> Result<Option<Stored<'_, D>>, Refusal> {
        let refused = |error| refused(arithmetic, error);
        match arithmetic.storage() {
            Storage::F64 => Ok(None),
            Storage::F32 => {
                let scene = self.single.fill(made, |x, _| f32::place(x), f32::nearest)?;
                Ok(Some(Stored::F32(scene.map_err(refused)?)))
            }
            Storage::Cell => {
                let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
                for place in made.places() {
                    for (k, &x) in place.iter().enumerate() {
                        (low[k], high[k]) = (low[k].min(x), high[k].max(x));
                    }
                }
                let empty = made.places().len() == 0;
                let cells =
                    ByCells::new((low, high), made.largest_radius, empty).map_err(refused)?;
                let length = |r| cells.length(r);
                let scene = self.cells.fill(made, |x, k| cells.coordinate(x, k), length)?;
                Ok(Some(Stored::Cell(scene.map_err(refused)?)))
            }
        }
    }
}

impl<T: Real, const D: usize> Copied<T, D> {
    fn fill(
        &mut self,
        made: &Made<'_, D>,
        coordinate: impl Fn(f64, usize) -> T,
        length: impl Fn(f64) -> T,
    ) -> Result<Result<Scene<'_, T, D>, SceneError>, Refusal> {
        let place = |x: &[f64; D]| Point::from(fill(|k| coordinate(x[k], k)));
        fit(&mut self.centres, made.places().map(place))?;
        let radii = match &made.radii {
            Radii::Uniform(r) => Radii::Uniform(length(*r)),
            Radii::Each(radii) => {
                fit(&mut self.radii, radii.iter().map(|&r| length(r)))?;
                Radii::Each(self.radii.as_slice().into())
            }
        };
        Ok(Scene::new(self.centres.as_slice(), radii))
    }
}

/// Replaces the contents of a buffer; one that is too small is freed before the allocation.
fn fit<A>(buffer: &mut Vec<A>, items: impl ExactSizeIterator<Item = A>) -> Result<(), Refusal> {
    buffer.clear();
    if items.len() > buffer.capacity() {
        *buffer = Vec::new();
        reserve(buffer, items.len())?;
    }
    buffer.extend(items);
    Ok(())
}

fn refused(arithmetic: Arithmetic, error: SceneError) -> Refusal {
    Refusal::Stored { arithmetic: arithmetic.name(), error }
}

/// Returns a copy of the scene and its images as a rounded arithmetic stores them.
pub(super) fn stored(
    open: &AnyScene<'_>,
    arithmetic: Arithmetic,
) -> Result<AnyScene<'static>, Refusal> {
    open.stored(arithmetic).map_err(|error| refused(arithmetic, error))
}
