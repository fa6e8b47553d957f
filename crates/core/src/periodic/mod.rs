//! Periodic boxes: contacts between particles and images of others, or of themselves.
//!
//! A [`Periodic`] scene is a scene with a [`Lattice`]. It has its own type, so that no code takes
//! it for an open scene. A contact is an [`ImagePair`]: particle i touches the image of j that is
//! shifted by S·H, integers times the vectors of the box. One pair may have several contacts, and a
//! particle may touch an image of itself.
//!
//! * **The test** is exact for the given numbers: the sign of |xi - xj - S·H|² - (ri + rj)² is
//!   computed by exact arithmetic ([`crate::contact::image`]). It never uses a coordinate of an
//!   image, which may not fit a double. So the contacts do not depend on which image of a particle
//!   or which vectors of the lattice a file contains.
//! * **The search:** every image that can matter becomes another body of an open scene
//!   ([`images`]). A [`Finder`] searches it with any detector, keeps its buffers, and is what is
//!   timed. Boxes may be smaller than the reach, skewed, tilted by many box lengths, and open along
//!   some vectors; particles may lie far outside. In boxes smaller than the reach each particle is
//!   compared with all particles and images instead (`crowded.rs`).
//! * **The truth** comes from all pairs and all their images ([`truth()`]).
//!
//! **Rounded arithmetic** decides from the coordinates of images, like a simulation code that
//! copies particles across its borders: wrapped coordinates and those of images are rounded to f64
//! and then to the storage of the arithmetic. So a rounded result depends on which image of a
//! particle is given and where the box begins; an exact result does not.
//!
//! ```
//! use contactbench_core::contact::Arithmetic;
//! use contactbench_core::detect::{Options, table};
//! use contactbench_core::periodic::{self, Periodic};
//! use contactbench_core::scene::{Lattice, Radii, Scene, points};
//!
//! // One sphere in a unit cube touches six images of itself: three contacts, seen from both sides.
//! let x = [[0.2, 0.3, 0.4]];
//! let scene = Scene::new(points(&x), Radii::Uniform(0.5))?;
//! let cube = Lattice::along_axes([1.0; 3], [true; 3])?;
//! let scene = Periodic::new(scene.into(), cube)?;
//! let mut detector = table::find("nbs").expect("it is there").make(Options::default());
//! let found = periodic::contacts(&scene, &mut *detector, Arithmetic::Exact, 1 << 20)?;
//! assert_eq!(found.iter().map(|pair| pair.image).collect::<Vec<_>>(), [
//!     [0, 0, 1],
//!     [0, 1, 0],
//!     [1, 0, 0],
//! ]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod contacts;
mod crowded;
mod finder;
pub mod frame;
pub mod images;
pub mod made;
mod near;
mod stored;
mod truth;

pub use contacts::{Contacts, List, contacts};
pub use finder::Finder;
pub use truth::{BRUTE_FORCE, Truth, depth, touching, truth, truth_as_stored};

use crate::scene::{AnyScene, Lattice, LatticeError};

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
