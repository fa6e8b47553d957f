//! Copies of the particles and images of a periodic scene in f32.

use nalgebra::Point;

use super::made::Made;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::limits::refusal::{Refusal, reserve};
use contactbench_ground::scene::{AnyScene, Radii, Real, Scene, SceneError, Storage, Stored};
use contactbench_ground::wide::fill;

/// Buffers for a copy in f32.
#[derive(Default)]
pub struct Copies<const D: usize> {
    centres: Vec<Point<f32, D>>,
    radii: Vec<f32>,
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
        if arithmetic.storage() == Storage::F64 {
            return Ok(None);
        }
        let place = |x: &[f64; D]| Point::from(fill(|k| f32::nearest(x[k])));
        fit(&mut self.centres, made.places().map(place))?;
        let radii = match &made.radii {
            Radii::Uniform(r) => Radii::Uniform(f32::nearest(*r)),
            Radii::Each(radii) => {
                fit(&mut self.radii, radii.iter().map(|&r| f32::nearest(r)))?;
                Radii::Each(self.radii.as_slice().into())
            }
        };
        let scene = Scene::new(self.centres.as_slice(), radii);
        Ok(Some(Stored::F32(scene.map_err(|error| refused(arithmetic, error))?)))
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
pub fn stored(open: &AnyScene<'_>, arithmetic: Arithmetic) -> Result<AnyScene<'static>, Refusal> {
    open.stored(arithmetic).map_err(|error| refused(arithmetic, error))
}
