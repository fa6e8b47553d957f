//! A scene of any dimension, in any storage.

use std::borrow::Cow;

pub use contactbench_terms::arithmetic::Storage;

use super::{CellF32, Radii, Real, Scene, SceneError};

/// A scene of known dimension, in a storage that is known at run time.
#[derive(Clone, Debug, PartialEq)]
pub enum Stored<'a, const D: usize> {
    /// In f32.
    F32(Scene<'a, f32, D>),
    /// In f64: what generators and readers give.
    F64(Scene<'a, f64, D>),
    /// By cells, in units of the cell.
    Cell(Scene<'a, CellF32, D>),
}

/// A scene whose dimension and storage are known at run time.
#[derive(Clone, Debug, PartialEq)]
pub enum AnyScene<'a> {
    /// Discs.
    Plane(Stored<'a, 2>),
    /// Spheres.
    Space(Stored<'a, 3>),
}

/// Runs an expression on the [`Scene`] inside a [`Stored`], whatever its storage.
#[macro_export]
macro_rules! with_stored {
    ($stored:expr, $scene:ident => $body:expr) => {
        match $stored {
            $crate::scene::Stored::F32($scene) => $body,
            $crate::scene::Stored::F64($scene) => $body,
            $crate::scene::Stored::Cell($scene) => $body,
        }
    };
}

/// Runs an expression on the [`Scene`] inside an [`AnyScene`], whatever its type.
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
    /// The scene in f64, without error.
    pub fn widened(&self) -> Cow<'_, Scene<'a, f64, D>> {
        match self {
            Stored::F64(scene) => Cow::Borrowed(scene),
            Stored::F32(scene) => Cow::Owned(scene.widened()),
            Stored::Cell(scene) => Cow::Owned(scene.widened()),
        }
    }

    fn convert(&self, storage: Storage) -> Result<Stored<'static, D>, SceneError> {
        with_stored!(self, scene => Ok(match storage {
            Storage::F32 => Stored::F32(scene.convert()?),
            Storage::F64 => Stored::F64(scene.widened()),
            Storage::Cell => Stored::Cell(scene.widened().by_cells()?),
        }))
    }

    fn reordered(&self, order: &[u32]) -> Stored<'static, D> {
        match self {
            Stored::F32(scene) => Stored::F32(scene.reordered(order)),
            Stored::F64(scene) => Stored::F64(scene.reordered(order)),
            Stored::Cell(scene) => Stored::Cell(scene.reordered(order)),
        }
    }
}

impl<'a> AnyScene<'a> {
    /// 2 for discs, 3 for spheres.
    pub fn dim(&self) -> usize {
        match self {
            AnyScene::Plane(_) => 2,
            AnyScene::Space(_) => 3,
        }
    }

    /// Is it stored in f64?
    pub fn is_f64(&self) -> bool {
        matches!(self, AnyScene::Plane(Stored::F64(_)) | AnyScene::Space(Stored::F64(_)))
    }

    /// The number of particles.
    pub fn len(&self) -> usize {
        with_scene!(self, scene => scene.len())
    }

    /// True if there are no particles.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Has one radius for all particles?
    pub fn uniform(&self) -> bool {
        with_scene!(self, scene => matches!(scene.radii(), Radii::Uniform(_)))
    }

    /// The largest radius.
    pub fn largest_radius(&self) -> f64 {
        with_scene!(self, scene => scene.largest_radius().wide())
    }

    /// A copy of the scene in a storage, or in that of an
    /// [`Arithmetic`](crate::contact::Arithmetic).
    ///
    /// # Errors
    /// A number overflows f32 ([`SceneError::Coordinate`], [`SceneError::Radius`]), or there are
    /// too many cells ([`SceneError::Cells`]).
    pub fn stored(&self, storage: impl Into<Storage>) -> Result<AnyScene<'static>, SceneError> {
        let storage = storage.into();
        Ok(match self {
            AnyScene::Plane(scene) => AnyScene::Plane(scene.convert(storage)?),
            AnyScene::Space(scene) => AnyScene::Space(scene.convert(storage)?),
        })
    }

    /// As [`AnyScene::stored`], but the scene itself where it is stored so already.
    ///
    /// # Errors
    /// The same.
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

    /// The scene with its particles in another order: particle k of the result is `order[k]`.
    pub fn reordered(&self, order: &[u32]) -> AnyScene<'static> {
        match self {
            AnyScene::Plane(scene) => AnyScene::Plane(scene.reordered(order)),
            AnyScene::Space(scene) => AnyScene::Space(scene.reordered(order)),
        }
    }
}
