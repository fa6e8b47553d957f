//! Periodic boxes: contacts between particles and images of others, or of themselves.
//!
//! A [`Periodic`] scene is a scene with a [`Lattice`]. It has its own type, so that no code takes
//! it for an open scene. A contact is an [`ImagePair`]: particle i touches the image of j that is
//! shifted by S·H, integers times the vectors of the box. One pair may have several contacts, and a
//! particle may touch an image of itself.

mod list;
mod loaded;

pub use list::{ContactList, List};
pub use loaded::{LoadError, Loaded, Searchable};

use crate::contact::depth::depth_of_image;
use crate::contact::image::Shift;
use crate::scene::{AnyScene, Lattice, LatticeError, Scene, SceneError, array};
use crate::wide::fill;

/// Particles and the box in which they repeat.
#[derive(Clone, Debug, PartialEq)]
pub struct Periodic<'a> {
    scene: AnyScene<'a>,
    lattice: Lattice,
}

/// Why a scene and a box do not form a periodic scene.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PeriodicError {
    /// The scene is not stored in f64, which is the precision of the box.
    #[error("a periodic scene must be stored in f64; widen the scene first")]
    Storage,
    /// The box does not fit the scene's dimension.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
}

impl<'a> Periodic<'a> {
    /// Combines a scene with a box. For discs the box must be flat ([`Lattice::flat`]). A box that
    /// repeats along no vector is allowed and adds no contacts.
    ///
    /// # Errors
    /// Fails if the scene is not stored in f64, or if the box of discs is not in their plane.
    pub fn new(scene: AnyScene<'a>, lattice: Lattice) -> Result<Periodic<'a>, PeriodicError> {
        if !scene.is_f64() {
            return Err(PeriodicError::Storage);
        }
        let lattice = if scene.dim() == 2 { lattice.flat()? } else { lattice };
        Ok(Periodic { scene, lattice })
    }

    /// Returns the particles in their given positions.
    pub fn scene(&self) -> &AnyScene<'a> {
        &self.scene
    }

    /// Returns the box.
    pub fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    /// Returns the scene with other radii, in the same box.
    ///
    /// # Errors
    /// Fails if a radius is negative or not finite.
    pub fn resized(&self, radius: impl Fn(f64) -> f64) -> Result<Periodic<'static>, SceneError> {
        fn of<const D: usize>(
            scene: &Scene<'_, f64, D>,
            radius: impl Fn(f64) -> f64,
        ) -> Result<Scene<'static, f64, D>, SceneError> {
            Scene::new(scene.centres().to_vec(), scene.radii().map(radius))
        }
        let scene: AnyScene<'static> = match &self.scene {
            AnyScene::Plane(scene) => of(&scene.widened(), radius)?.into(),
            AnyScene::Space(scene) => of(&scene.widened(), radius)?.into(),
        };
        Ok(Periodic { scene, lattice: self.lattice })
    }

    /// Returns the particles and the box.
    pub fn into_parts(self) -> (AnyScene<'a>, Lattice) {
        (self.scene, self.lattice)
    }
}

/// A contact of particle `i` with the image of particle `j` at xj + S·H. Seen from `j`, this
/// contact is with the image of `i` at xi - S·H; [`ImagePair::new`] accepts either form.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ImagePair {
    /// The smaller particle number.
    pub i: u32,
    /// The larger particle number; equal to `i` if a particle touches an image of itself.
    pub j: u32,
    /// Shift S, one number per vector of the box, 0 if the box is open along the vector. If `i`
    /// equals `j`, the first nonzero number is positive.
    pub image: [i32; 3],
}

/// Writes `3,7` for a contact without a shift, or `3,7 (0,-1,0)` for a contact through a face.
impl std::fmt::Display for ImagePair {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let ImagePair { i, j, image: [x, y, z] } = self;
        match self.image {
            [0, 0, 0] => write!(f, "{i},{j}"),
            _ => write!(f, "{i},{j} ({x},{y},{z})"),
        }
    }
}

/// Converts pairs of an open scene to contacts with the shift 0.
pub fn without_shift(pairs: &[[u32; 2]]) -> impl Iterator<Item = ImagePair> {
    pairs.iter().map(|&[i, j]| ImagePair::new(i, j, [0; 3]))
}

/// Size of a contact in bytes.
pub const IMAGE_PAIR_BYTES: u64 = size_of::<ImagePair>() as u64;

impl ImagePair {
    /// Creates the canonical form of the contact of `i` with the image of `j` shifted by `image`.
    pub fn new(i: u32, j: u32, image: [i32; 3]) -> ImagePair {
        let reverse = image.map(i32::wrapping_neg);
        let reversed = j < i || (i == j && image < reverse);
        ImagePair { i: i.min(j), j: i.max(j), image: if reversed { reverse } else { image } }
    }
}

/// Returns the depth of a contact (see [`depth_of_image`]), clamped to finite doubles, or 0 if a
/// particle is not in the scene.
pub fn depth(periodic: &Periodic<'_>, pair: ImagePair) -> f64 {
    match periodic.scene() {
        AnyScene::Plane(scene) => depth_in(&scene.widened(), periodic, pair),
        AnyScene::Space(scene) => depth_in(&scene.widened(), periodic, pair),
    }
}

fn depth_in<const D: usize>(
    scene: &Scene<'_, f64, D>,
    periodic: &Periodic<'_>,
    ImagePair { i, j, image }: ImagePair,
) -> f64 {
    let (i, j) = (i as usize, j as usize);
    let centres = scene.centres();
    let (Some(a), Some(b)) = (centres.get(i), centres.get(j)) else { return 0.0 };
    let (flags, rows) = (periodic.lattice().periodic(), periodic.lattice().vectors());
    let vectors: [[f64; D]; 3] = std::array::from_fn(|v| std::array::from_fn(|k| rows[v][k]));
    let image = fill(|v| if flags[v] { image[v] } else { 0 });
    let shift = Shift { image, vectors: &vectors };
    depth_of_image(array(a), array(b), scene.radius(i), scene.radius(j), shift)
        .clamp(-f64::MAX, f64::MAX)
}
