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
//! Where bodies move little from step to step, as in the discrete element method, a list of near
//! pairs is kept and looked at, until it has to be built again ([`track`]):
//!
//! ```
//! use contactbench_core::contact::Test;
//! use contactbench_core::detect::Options;
//! use contactbench_core::scene::{AnyScene, Radii, Scene, points};
//! use contactbench_core::track;
//!
//! // Two discs of mass 1 fly at each other, and push each other away where they overlap.
//! let (mut x, mut v) = ([[0.0, 0.0], [1.25, 0.0]], [[0.5, 0.0], [-0.5, 0.0]]);
//! let (radius, stiffness, dt) = (0.5, 100.0, 0.01);
//! let mut tracker = track::parse("verlet(streamed-nbs,skin=0.2)")?.make(Options::default());
//! let (mut pairs, mut built) = (Vec::new(), 0);
//! for _ in 0..100 {
//!     let frame: AnyScene<'_> = Scene::new(points(&x), Radii::Uniform(radius))?.into();
//!     pairs.clear();
//!     built += u32::from(tracker.step(&frame, Test::Exact, None, &mut pairs)?.built);
//!     for [i, j] in pairs.iter().map(|pair| pair.map(|k| k as usize)) {
//!         let away: [f64; 2] = std::array::from_fn(|k| x[i][k] - x[j][k]);
//!         let distance = away[0].hypot(away[1]);
//!         let push = stiffness * (2.0 * radius - distance) / distance * dt;
//!         for k in 0..2 {
//!             v[i][k] += push * away[k];
//!             v[j][k] -= push * away[k];
//!         }
//!     }
//!     for (x, v) in x.iter_mut().zip(&v) {
//!         (0..2).for_each(|k| x[k] += v[k] * dt);
//!     }
//! }
//! assert!(v[0][0] < 0.0 && v[1][0] > 0.0, "they have met");
//! assert!(built < 20, "in most steps the list was looked at, and nothing else");
//! # Ok::<(), Box<dyn std::error::Error>>(())
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
//! 4. [`probe`] counts operations, or compiles to nothing; [`event`] reports them one by one;
//!    [`sink`] makes the contacts a list, a count or a digest; a [`pair_list`] has a limit.
//! 5. [`refusal`]: why a detector will not work on a scene; [`crowd`] knows it before it is tried;
//!    [`memory`] says what limit fits the machine.
//! 6. [`oracle`]: the true contacts, by testing all pairs, and what an answer got wrong.
//! 7. [`periodic`]: scenes that repeat, found by the same detectors, and their truth.
//! 8. [`searcher`]: any detector, in boxes or without.
//! 9. [`track`]: frames of bodies that move, and lists that are kept between them.
//! 10. [`wide`]: sixteen floats at a time.
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
pub mod searcher;
pub mod sink;
pub mod track;
pub mod wide;

pub use contacts::{Contacts, Error, contacts};
pub use refusal::Refusal;
