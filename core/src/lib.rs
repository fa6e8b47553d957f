//! Which discs (2D) or spheres (3D) touch? Contact detectors, decided exactly, with counters.
//!
//! ```
//! use contactbench_core::{Contacts, contacts};
//!
//! // Three discs of radius 1/2; the first two touch in one point.
//! let mut centres = vec![[0.0, 0.0], [1.0, 0.0], [5.0, 0.0]];
//! assert_eq!(contacts(&centres, &[0.5])?, [[0, 1]]);
//!
//! // Again and again, as a simulation does: the buffers are kept.
//! let mut detector = Contacts::default();
//! centres[2] = [2.0, 0.0];
//! assert_eq!(detector.find(&centres, &[0.5])?.len(), 2);
//! # Ok::<(), contactbench_core::Error>(())
//! ```
//!
//! [`contacts()`] takes plain slices and finds the pairs by `streamed-nbs`.
//! Behind it are all detectors of [`detect::table`], in every arithmetic, with counts of what they
//! do:
//!
//! 1. [`scene`]: centres and radii, always valid.
//! 2. [`contact`]: radii and arithmetic become one contact test, shared by all detectors;
//!    [`filter`] derives how none of them loses a pair to rounding.
//! 3. [`detect`]: a detector finds the touching pairs; one file per algorithm, one line each in
//!    [`detect::table`].
//! 4. [`probe`] counts operations, or costs nothing when nobody listens; [`event`] tells them one
//!    by one; [`sink`] makes the contacts a list, a count or a digest; a [`pair_list`] has a limit.
//! 5. [`refusal`]: why a detector will not work on a scene; [`crowd`] knows it before it is tried;
//!    [`memory`] says what limit fits the machine.
//! 6. [`oracle`]: the true contacts, by testing all pairs, and what an answer got wrong.
//! 7. [`periodic`]: scenes that repeat, found by the same detectors, and their truth.
//! 8. [`track`]: frames of bodies that move, and lists that are kept between them.
//! 9. [`wide`]: sixteen floats at a time.
//!
//! Each imports only those before it (detectors use [`wide`], the oracle uses detectors). There is
//! no file (but for the system's word on its memory), process, figure or command line here; those
//! are in the crate `contactbench`, which measures these detectors.
#![deny(missing_docs)]

pub mod contact;
mod contacts;
pub mod crowd;
pub mod detect;
pub mod event;
pub mod filter;
pub mod memory;
mod normalise;
pub mod oracle;
pub mod pair_list;
mod parallel;
pub mod periodic;
pub mod probe;
mod radix;
pub mod refusal;
pub mod scene;
pub mod sink;
pub mod track;
pub mod wide;

pub use contacts::{Contacts, Error, contacts};
pub use refusal::Refusal;
