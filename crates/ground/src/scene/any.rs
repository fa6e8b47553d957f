//! A scene whose dimension or storage is chosen at run time.

use std::borrow::Cow;

pub use contactbench_terms::arithmetic::Storage;

use super::{Radii, Real, Scene, SceneError};

/// A scene whose dimension is fixed at compile time and whose storage is chosen at run time.
#[derive(Clone, Debug, PartialEq)]
pub enum Stored<'a, const D: usize> {
    /// Coordinates and radii in f32.
    F32(Scene<'a, f32, D>),
    /// Coordinates and radii in f64, as generators and readers return them.
    F64(Scene<'a, f64, D>),
}

/// A scene whose dimension and storage are chosen at run time.
#[derive(Clone, Debug, PartialEq)]
pub enum AnyScene<'a> {
    /// Discs in two dimensions.
    Plane(Stored<'a, 2>),
    /// Spheres in three dimensions.
    Space(Stored<'a, 3>),
}

/// Evaluates an expression for the [`Scene`] inside a [`Stored`], whatever its storage.
#[macro_export]
macro_rules! with_stored {
    ($stored:expr, $scene:ident => $body:expr) => {
        match $stored {
            $crate::scene::Stored::F32($scene) => $body,
            $crate::scene::Stored::F64($scene) => $body,
        }
    };
}

/// Evaluates an expression for the [`Scene`] inside an [`AnyScene`], whatever its type.
#[macro_export]
macro_rules! with_scene {
    ($any:expr, $scene:ident => $body:expr) => {
        match $any {
            $crate::scene::AnyScene::Plane(stored) => {
                $crate::with_stored!(stored, $scene => $body)
            }
            $crate::scene::AnyScene::Space(stored) => {
                $crate::with_stored!(stored, $scene => $body)
            }
        }
    };
}

impl<'a> From<Scene<'a, f64, 2>> for AnyScene<'a> {
    fn from(scene: Scene<'a, f64, 2>) -> Self {
        AnyScene::Plane(Stored::F64(scene))
    }
}

impl<'a> From<Scene<'a, f64, 3>> for AnyScene<'a> {
    fn from(scene: Scene<'a, f64, 3>) -> Self {
        AnyScene::Space(Stored::F64(scene))
    }
}

impl<'a> From<Stored<'a, 2>> for AnyScene<'a> {
    fn from(scene: Stored<'a, 2>) -> Self {
        AnyScene::Plane(scene)
    }
}

impl<'a> From<Stored<'a, 3>> for AnyScene<'a> {
    fn from(scene: Stored<'a, 3>) -> Self {
        AnyScene::Space(scene)
    }
}

impl<'a, const D: usize> Stored<'a, D> {
    /// Returns the scene in f64, without rounding. It is copied unless it is stored in f64.
    pub fn widened(&self) -> Cow<'_, Scene<'a, f64, D>> {
        match self {
            Stored::F64(scene) => Cow::Borrowed(scene),
            Stored::F32(scene) => Cow::Owned(scene.widened()),
        }
    }

    fn convert(&self, storage: Storage) -> Result<Stored<'static, D>, SceneError> {
        with_stored!(self, scene => Ok(match storage {
            Storage::F32 => Stored::F32(scene.convert()?),
            Storage::F64 => Stored::F64(scene.widened()),
        }))
    }

    fn reordered(&self, order: &[u32]) -> Stored<'static, D> {
        match self {
            Stored::F32(scene) => Stored::F32(scene.reordered(order)),
            Stored::F64(scene) => Stored::F64(scene.reordered(order)),
        }
    }
}

impl AnyScene<'static> {
    /// Creates a scene in f64 from rows of two or three coordinates, and one radius or a list of
    /// radii.
    ///
    /// # Errors
    /// Fails as [`Scene::new`] does.
    pub fn at<const D: usize>(
        rows: impl IntoIterator<Item = [f64; D]>,
        radii: impl Into<Radii<'static, f64>>,
    ) -> Result<AnyScene<'static>, SceneError> {
        const { assert!(D == 2 || D == 3) };
        let rows = rows.into_iter();
        Ok(match D {
            2 => Scene::at(rows.map(|row| [row[0], row[1]]), radii)?.into(),
            _ => Scene::at(rows.map(|row| [row[0], row[1], row[2]]), radii)?.into(),
        })
    }
}

impl<'a> AnyScene<'a> {
    /// Returns the dimension: 2 for discs and 3 for spheres.
    pub fn dim(&self) -> usize {
        match self {
            AnyScene::Plane(_) => 2,
            AnyScene::Space(_) => 3,
        }
    }

    /// Returns whether the scene is stored in f64.
    pub fn is_f64(&self) -> bool {
        matches!(self, AnyScene::Plane(Stored::F64(_)) | AnyScene::Space(Stored::F64(_)))
    }

    /// Returns the number of particles.
    pub fn len(&self) -> usize {
        with_scene!(self, scene => scene.len())
    }

    /// Returns whether the scene has no particles.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns whether all particles share one stored radius.
    pub fn uniform(&self) -> bool {
        with_scene!(self, scene => matches!(scene.radii(), Radii::Uniform(_)))
    }

    /// Returns the largest radius, without rounding; 0 if the list of radii is empty.
    pub fn largest_radius(&self) -> f64 {
        with_scene!(self, scene => scene.largest_radius().wide())
    }

    /// Returns a copy of the scene in this storage, or in that of an
    /// [`Arithmetic`](crate::contact::Arithmetic).
    ///
    /// # Errors
    /// Fails if a number overflows f32 ([`SceneError::Coordinate`], [`SceneError::Radius`]).
    pub fn stored(&self, storage: impl Into<Storage>) -> Result<AnyScene<'static>, SceneError> {
        let storage = storage.into();
        Ok(match self {
            AnyScene::Plane(scene) => AnyScene::Plane(scene.convert(storage)?),
            AnyScene::Space(scene) => AnyScene::Space(scene.convert(storage)?),
        })
    }

    /// Returns the scene in this storage. It is borrowed instead of copied if it is in f64 already
    /// and stays so. Fails as [`AnyScene::stored`].
    pub fn as_stored(
        &self,
        storage: impl Into<Storage>,
    ) -> Result<Cow<'_, AnyScene<'a>>, SceneError> {
        let storage = storage.into();
        match storage == Storage::F64 && self.is_f64() {
            true => Ok(Cow::Borrowed(self)),
            false => self.stored(storage).map(Cow::Owned),
        }
    }

    /// Returns a copy with reordered particles: particle k of the copy is particle `order[k]`.
    pub fn reordered(&self, order: &[u32]) -> AnyScene<'static> {
        match self {
            AnyScene::Plane(scene) => AnyScene::Plane(scene.reordered(order)),
            AnyScene::Space(scene) => AnyScene::Space(scene.reordered(order)),
        }
    }
}
