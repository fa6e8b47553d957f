//! What contactbench measures: contact detectors for discs (2D) and spheres (3D), and all that they stand on.
//!
//! 1. [`scene`]: centres and radii, always valid.
//! 2. [`contact`]: radii and arithmetic become one contact test, shared by all; [`filter`] derives how none loses a pair to rounding.
//! 3. [`detect`]: a detector finds the touching pairs; one file per algorithm, one line each in [`detect::table`].
//! 4. [`probe`]: its operations are counted, or cost nothing when nobody listens; [`event`]: or told one by one; [`sink`]: its contacts become a list, a count, a digest.
//! 5. [`wide`]: sixteen floats at a time.
//!
//! Here is no file, no process, no figure: those are in the crate `contactbench`, which hands these modules on. They are apart so that the detectors, of which each is
//! compiled for every kind of scene, are compiled once for all that is built on them.
#![warn(missing_docs)]

pub mod contact;
pub mod detect;
pub mod event;
pub mod filter;
pub mod probe;
pub mod scene;
pub mod sink;
pub mod wide;
