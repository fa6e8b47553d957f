//! The search for contacts in [periodic boxes](contactbench_ground::periodic).
//!
//! * **The test** is exact for the given numbers: the sign of |xi - xj - S·H|² - (ri + rj)² is
//!   computed by exact arithmetic ([`contactbench_ground::contact::image`]). It never uses a
//!   coordinate of an image, which may not fit a double. So the contacts do not depend on which
//!   image of a particle or which vectors of the lattice a file contains.
//! * **The search:** every image that can matter becomes another body of an open scene
//!   ([`images`]). A [`Finder`] searches it with any detector, keeps its buffers, and is what is
//!   timed. Boxes may be smaller than the reach, skewed, tilted by many box lengths, and open along
//!   some vectors; particles may lie far outside. In boxes smaller than the reach each particle is
//!   compared with all particles and images instead (`crowded.rs`).
//!
//! **Rounded arithmetic** decides from the coordinates of images, like a simulation code that
//! copies particles across its borders: wrapped coordinates and those of images are rounded to f64
//! and then to the storage of the arithmetic. So a rounded result depends on which image of a
//! particle is given and where the box begins; an exact result does not.

mod contacts;
pub mod crowded;
mod finder;
pub mod frame;
pub mod images;
pub mod made;
mod near;
pub mod stored;
mod survey;

pub use contacts::contacts;
pub use finder::Finder;
