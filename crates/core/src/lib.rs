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
//! [`contacts()`] takes plain slices and uses the detector `streamed-nbs`. The modules offer all
//! detectors of [`table`], in every arithmetic, with operation counts:
//!
//! * [`scene`]: centres and radii, always valid, and boxes.
//! * [`contact`]: the contact test.
//! * [`detect`]: the interface of a detector, to write one.
//! * [`table`]: all detectors, by name.
//! * [`probe`] counts operations; [`sink`] turns contacts into a count or a digest.
//! * [`periodic`]: scenes in periodic boxes.
//! * [`searcher`]: any detector, in boxes or in open space.
//! * [`track`]: frames of moving particles, and lists that are kept between them.
//!
//! The crate `contactbench` measures the detectors. The crates below this one are its parts; they
//! may change at any time.
#![deny(missing_docs)]

mod contacts;

pub use contactbench_ground::limits::refusal::Refusal;
pub use contacts::{Contacts, Error, contacts};

/// Centres and radii, always valid, and boxes.
pub mod scene {
    pub use contactbench_ground::scene::{
        AnyScene, Lattice, LatticeError, Radii, Real, Scene, SceneError, Storage, Stored, points,
    };
}

/// The contact test, and how a scene is stored.
pub mod contact {
    pub use contactbench_ground::contact::{Arithmetic, Margin, Particles, Slack, Test};
}

/// The interface of a detector.
pub mod detect {
    pub use contactbench_ground::detect::any::{AnyDetector, Both, Params};
    pub use contactbench_ground::detect::{Declare, Detector, Options, within};
}

/// All detectors, by name.
pub mod table {
    pub use contactbench_detectors::table::{
        DEFAULT, DetectorSpec, Entry, Group, Parameter, Role, SpecError, Speed, TABLE, find, parse,
    };
}

/// Counters of operations.
pub mod probe {
    pub use contactbench_ground::probe::{Op, Probe, Silent, Tally};
}

/// Receivers of contacts.
pub mod sink {
    pub use contactbench_ground::pairs::sink::{Count, Digest, Sink, Visit};
}

/// Scenes in periodic boxes.
///
/// ```
/// use contactbench_core::contact::Arithmetic;
/// use contactbench_core::detect::Options;
/// use contactbench_core::periodic::{self, Periodic};
/// use contactbench_core::scene::{Lattice, Radii, Scene, points};
/// use contactbench_core::table;
///
/// // One sphere in a unit cube touches six images of itself: three contacts, seen from both sides.
/// let x = [[0.2, 0.3, 0.4]];
/// let scene = Scene::new(points(&x), Radii::Uniform(0.5))?;
/// let cube = Lattice::along_axes([1.0; 3], [true; 3])?;
/// let scene = Periodic::new(scene.into(), cube)?;
/// let mut detector = table::parse("nbs")?.make(Options::default());
/// let found = periodic::contacts(&scene, &mut *detector, Arithmetic::Exact, 1 << 20)?;
/// assert_eq!(found.iter().map(|pair| pair.image).collect::<Vec<_>>(), [
///     [0, 0, 1],
///     [0, 1, 0],
///     [1, 0, 0],
/// ]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub mod periodic {
    pub use contactbench_ground::periodic::{ContactList, ImagePair, Periodic, PeriodicError};
    pub use contactbench_lists::periodic::contacts;
}

/// Any detector, in boxes or in open space, with its buffers.
pub mod searcher {
    pub use contactbench_ground::periodic::{LoadError, Loaded, Searchable};
    pub use contactbench_lists::searcher::Searcher;
}

/// Frames of moving particles, and neighbour lists that are kept between them.
pub mod track {
    pub use contactbench_detectors::tracker::{TrackerError, TrackerSpec, parse};
    pub use contactbench_lists::track::{Rule, Skin, Step, Tracker};
}
