//! Periodic boxes: contacts of particles with images of each other, and of themselves.
//!
//! A [`Periodic`] scene is a scene and a [`Lattice`], a value of its own: it is never taken for an
//! open one, and open scenes know nothing of it. A contact is an [`ImagePair`]: particle i touches
//! the image of j that is shifted by S·H, whole numbers times the vectors of the box. There may be
//! several of one pair, and of a particle with itself.
//!
//! * **What touches** is decided for the numbers as given: the sign of |xi - xj - S·H|² - (ri +
//!   rj)² by exact arithmetic ([`crate::contact::image`]), never by a coordinate of an image, which
//!   no double need hold. So it does not matter which image of a particle a file names, nor which
//!   vectors of the lattice.
//! * **How it is found:** every image that can matter becomes a further body of an open scene
//!   ([`images`]), and any detector of the table searches that, by a [`Finder`], which keeps its
//!   buffers and is what is timed. Boxes may be smaller than the reach, skewed, tilted by many box
//!   lengths, and open along some vectors; particles may lie far outside. In boxes smaller than the
//!   reach each particle is compared with all bodies instead (`crowded.rs`).
//! * **The truth** goes over all pairs and all their images ([`truth()`]).
//!
//! **Rounded arithmetics** decide from the coordinates of images, as a simulation code does that
//! copies particles across its borders: wrapped coordinates and those of images are rounded to f64,
//! and then stored as the arithmetic asks. So a rounded answer depends on which image of a particle
//! is named and where the box begins; an exact one does not.
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
pub use truth::{BRUTE_FORCE, Truth, depth, truth, truth_as_stored};

use crate::scene::{AnyScene, Lattice, LatticeError};

/// A scene that repeats: particles, as given, and the box whose images they have.
#[derive(Clone, Debug, PartialEq)]
pub struct Periodic<'a> {
    scene: AnyScene<'a>,
    lattice: Lattice,
}

/// Why a scene and a box are no periodic scene.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PeriodicError {
    /// The box of a file is in f64, and so must be the particles.
    #[error("a periodic scene is made of numbers in f64; this one is stored otherwise: widen it")]
    Storage,
    /// The box does not suit the scene.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
}

impl<'a> Periodic<'a> {
    /// The scene and its images. For discs the box is that of the plane ([`Lattice::flat`]). A box
    /// that repeats along no vector is allowed, and adds nothing.
    ///
    /// # Errors
    /// A scene that is not stored in f64, a box of discs that leaves their plane.
    pub fn new(scene: AnyScene<'a>, lattice: Lattice) -> Result<Periodic<'a>, PeriodicError> {
        if !scene.is_f64() {
            return Err(PeriodicError::Storage);
        }
        let lattice = if scene.dim() == 2 { lattice.flat()? } else { lattice };
        Ok(Periodic { scene, lattice })
    }

    /// The particles, as given.
    pub fn scene(&self) -> &AnyScene<'a> {
        &self.scene
    }

    /// The box.
    pub fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    /// Both.
    pub fn into_parts(self) -> (AnyScene<'a>, Lattice) {
        (self.scene, self.lattice)
    }
}

/// Particle `i` touches the image of particle `j` at xj + S·H. Seen from the other side it is the
/// same contact: `j` touches the image of `i` at xi - S·H; [`ImagePair::new`] takes either.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ImagePair {
    /// The smaller number, or the same.
    pub i: u32,
    /// The larger number, or the same.
    pub j: u32,
    /// S, one number for each vector of the box, 0 where it is open. For a particle and its own
    /// image the first that is not 0 is positive.
    pub image: [i32; 3],
}

/// `3,7`, and `3,7 (0,-1,0)` through a face.
impl std::fmt::Display for ImagePair {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let ImagePair { i, j, image: [x, y, z] } = self;
        match self.image {
            [0, 0, 0] => write!(f, "{i},{j}"),
            _ => write!(f, "{i},{j} ({x},{y},{z})"),
        }
    }
}

/// Pairs of an open scene as contacts without a shift.
pub fn without_shift(pairs: &[[u32; 2]]) -> impl Iterator<Item = ImagePair> {
    pairs.iter().map(|&[i, j]| ImagePair::new(i, j, [0; 3]))
}

/// Bytes of one.
pub const IMAGE_PAIR_BYTES: u64 = size_of::<ImagePair>() as u64;

impl ImagePair {
    /// The one name of the contact of `i` with the image of `j` shifted by `image`.
    pub fn new(i: u32, j: u32, image: [i32; 3]) -> ImagePair {
        let reverse = image.map(i32::wrapping_neg);
        let reversed = j < i || (i == j && image < reverse);
        ImagePair { i: i.min(j), j: i.max(j), image: if reversed { reverse } else { image } }
    }
}

#[cfg(test)]
mod tests;
