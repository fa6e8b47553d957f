//! The ground of contact detectors for discs and spheres, for the crates of contactbench. Programs
//! use `contactbench-core`.
//!
//! 1. [`scene`]: centres and radii, always valid.
//! 2. [`contact`]: the contact test, shared by all detectors. [`filter`] proves that no detector
//!    loses a pair to rounding.
//! 3. [`detect`]: the interface of detectors, and what several of them need.
//! 4. [`probe`] counts operations, or compiles to nothing. [`pairs`] turns contacts into a list, a
//!    count or a digest.
//! 5. [`limits`]: memory, numbers of pairs, and why a detector does not work on a scene.
//! 6. [`periodic`]: scenes in periodic boxes, and lists of their contacts.
//! 7. [`wide`]: vector instructions, sixteen floats at a time.

pub mod contact;
pub mod detect;
pub mod filter;
pub mod limits;
pub mod pairs;
pub mod parallel;
pub mod periodic;
pub mod probe;
pub mod radix;
pub mod scene;
pub mod wide;
