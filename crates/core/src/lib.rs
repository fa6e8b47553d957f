//! Contact detection for discs (2D) and spheres (3D): which pairs touch, decided exactly.
//!
//! ```
//! use contactbench_core::{Contacts, contacts};
//!
//! // Three discs of radius 1/2; the first two touch in one point.
//! let mut centres = vec![[0.0, 0.0], [1.0, 0.0], [5.0, 0.0]];
//! assert_eq!(contacts(&centres, &[0.5])?, [[0, 1]]);
//!
//! // For repeated calls, as in a simulation: the buffers are kept.
//! let mut detector = Contacts::default();
//! centres[2] = [2.0, 0.0];
//! assert_eq!(detector.find(&centres, &[0.5])?.len(), 2);
//! # Ok::<(), contactbench_core::Error>(())
//! ```
//!
//! If particles move little from step to step, as in the discrete element method, a tracker keeps a
//! list of near pairs and tests only those until the list must be rebuilt ([`track`]):
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
//! assert!(v[0][0] < 0.0 && v[1][0] > 0.0, "the discs have bounced");
//! assert!(built < 20, "most steps reuse the list");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`contacts()`] takes plain slices and uses the detector `streamed-nbs`. The modules below offer
//! all detectors of [`detect::table`], in every arithmetic, with operation counts:
//!
//! 1. [`scene`]: centres and radii, always valid.
//! 2. [`contact`]: the contact test, shared by all detectors. [`filter`] proves that no detector
//!    loses a pair to rounding.
//! 3. [`detect`]: the detectors, one file per algorithm and one entry in [`detect::table`].
//! 4. [`probe`] counts operations, or compiles to nothing; [`event`] reports single steps. [`sink`]
//!    turns contacts into a list, a count or a digest; a [`pair_list`] has a limit.
//! 5. [`refusal`]: why a detector does not work on a scene. [`crowd`] predicts too many pairs;
//!    [`memory`] has default limits.
//! 6. [`oracle`]: the true contacts, from tests of all pairs, and the errors of a detector.
//! 7. [`periodic`]: periodic boxes, searched by the same detectors, and their truth.
//! 8. [`searcher`]: any detector, in boxes or in open space.
//! 9. [`track`]: frames of moving particles, and lists that are kept between them.
//! 10. [`wide`]: vector instructions, sixteen floats at a time.
//!
//! Each module imports only modules above it (but detectors use [`wide`], and the oracle uses
//! detectors). The crate reads no files except the system's memory size, starts no processes and
//! draws no figures. The crate `contactbench` does all this, and measures the detectors.
#![deny(missing_docs)]

pub mod contact;
mod contacts;
pub mod detect;
pub mod filter;
mod limits;
pub mod oracle;
mod pairs;
mod parallel;
pub mod periodic;
pub mod probe;
mod radix;
pub mod scene;
pub mod searcher;
pub mod track;
pub mod wide;

pub use contacts::{Contacts, Error, contacts};
#[doc(hidden)]
pub use limits::pages::request as request_large_pages;
pub use limits::refusal::Refusal;
pub use limits::{crowd, memory, refusal};
use pairs::normalise;
pub use pairs::{pair_list, sink};
pub use probe::event;
