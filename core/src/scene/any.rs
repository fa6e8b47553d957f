//! A scene of any dimension and precision.

use super::{Radii, Scene, SceneError};
use crate::contact::{Arithmetic, CellF32, Real};

/// A scene whose dimension and precision are known at run time.
#[derive(Clone, Debug, PartialEq)]
pub enum AnyScene<'a> {
    /// Discs in f32.
    PlaneF32(Scene<'a, f32, 2>),
    /// Discs in f64: what generators and readers give.
    PlaneF64(Scene<'a, f64, 2>),
    /// Discs by cells, in units of the cell.
    PlaneCell(Scene<'a, CellF32, 2>),
    /// Spheres in f32.
    SpaceF32(Scene<'a, f32, 3>),
    /// Spheres in f64: what generators and readers give.
    SpaceF64(Scene<'a, f64, 3>),
    /// Spheres by cells, in units of the cell.
    SpaceCell(Scene<'a, CellF32, 3>),
}

/// Runs an expression on the scene inside an [`AnyScene`], whatever its type.
#[macro_export]
macro_rules! with_scene {
    ($any:expr, $scene:ident => $body:expr) => {
        match $any {
            $crate::scene::AnyScene::PlaneF32($scene) => $body,
            $crate::scene::AnyScene::PlaneF64($scene) => $body,
            $crate::scene::AnyScene::PlaneCell($scene) => $body,
            $crate::scene::AnyScene::SpaceF32($scene) => $body,
            $crate::scene::AnyScene::SpaceF64($scene) => $body,
            $crate::scene::AnyScene::SpaceCell($scene) => $body,
        }
    };
}

impl<'a> From<Scene<'a, f64, 2>> for AnyScene<'a> {
    fn from(scene: Scene<'a, f64, 2>) -> Self {
        AnyScene::PlaneF64(scene)
    }
}

impl<'a> From<Scene<'a, f64, 3>> for AnyScene<'a> {
    fn from(scene: Scene<'a, f64, 3>) -> Self {
        AnyScene::SpaceF64(scene)
    }
}

impl AnyScene<'_> {
    /// 2 for discs, 3 for spheres.
    pub fn dim(&self) -> usize {
        match self {
            AnyScene::PlaneF32(_) | AnyScene::PlaneF64(_) | AnyScene::PlaneCell(_) => 2,
            AnyScene::SpaceF32(_) | AnyScene::SpaceF64(_) | AnyScene::SpaceCell(_) => 3,
        }
    }

    /// Is it stored in f64?
    pub fn is_f64(&self) -> bool {
        matches!(self, AnyScene::PlaneF64(_) | AnyScene::SpaceF64(_))
    }

    /// The number of elements.
    pub fn len(&self) -> usize {
        with_scene!(self, scene => scene.len())
    }

    /// True if there are no elements.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Has one radius for all elements?
    pub fn uniform(&self) -> bool {
        with_scene!(self, scene => matches!(scene.radii(), Radii::Uniform(_)))
    }

    /// The largest radius.
    pub fn largest_radius(&self) -> f64 {
        with_scene!(self, scene => scene.largest_radius().wide())
    }

    /// The scene as the arithmetic stores it: rounded to f32, by cells, or in f64. Fails where a number overflows f32, or there are too
    /// many cells.
    pub fn stored(&self, arithmetic: Arithmetic) -> Result<AnyScene<'static>, SceneError> {
        Ok(match (self.dim(), arithmetic) {
            (2, Arithmetic::F32) => AnyScene::PlaneF32(with_plane(self)?),
            (2, Arithmetic::F32Cell) => AnyScene::PlaneCell(with_plane::<f64>(self)?.by_cells()?),
            (2, _) => AnyScene::PlaneF64(with_plane(self)?),
            (_, Arithmetic::F32) => AnyScene::SpaceF32(with_space(self)?),
            (_, Arithmetic::F32Cell) => AnyScene::SpaceCell(with_space::<f64>(self)?.by_cells()?),
            (_, _) => AnyScene::SpaceF64(with_space(self)?),
        })
    }

    /// The scene with its elements in another order: element k of the result is element `order[k]`.
    pub fn reordered(&self, order: &[u32]) -> AnyScene<'static> {
        match self {
            AnyScene::PlaneF32(scene) => AnyScene::PlaneF32(scene.reordered(order)),
            AnyScene::PlaneF64(scene) => AnyScene::PlaneF64(scene.reordered(order)),
            AnyScene::PlaneCell(scene) => AnyScene::PlaneCell(scene.reordered(order)),
            AnyScene::SpaceF32(scene) => AnyScene::SpaceF32(scene.reordered(order)),
            AnyScene::SpaceF64(scene) => AnyScene::SpaceF64(scene.reordered(order)),
            AnyScene::SpaceCell(scene) => AnyScene::SpaceCell(scene.reordered(order)),
        }
    }
}

fn with_plane<U: Real>(scene: &AnyScene<'_>) -> Result<Scene<'static, U, 2>, SceneError> {
    match scene {
        AnyScene::PlaneF32(scene) => scene.convert(),
        AnyScene::PlaneF64(scene) => scene.convert(),
        AnyScene::PlaneCell(scene) => scene.convert(),
        AnyScene::SpaceF32(_) | AnyScene::SpaceF64(_) | AnyScene::SpaceCell(_) => unreachable!("called for plane scenes only"),
    }
}

fn with_space<U: Real>(scene: &AnyScene<'_>) -> Result<Scene<'static, U, 3>, SceneError> {
    match scene {
        AnyScene::SpaceF32(scene) => scene.convert(),
        AnyScene::SpaceF64(scene) => scene.convert(),
        AnyScene::SpaceCell(scene) => scene.convert(),
        AnyScene::PlaneF32(_) | AnyScene::PlaneF64(_) | AnyScene::PlaneCell(_) => unreachable!("called for space scenes only"),
    }
}
