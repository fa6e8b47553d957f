//! contactbench: an instrumented research testbed for contact detection among discs (2D) and spheres (3D).
//!
//! Which algorithm, for which scene: how fast, how much memory, how many operations, and how wrong? Every detector gets exactly the
//! same input, and every measurement becomes one row with time, exact operation counts, bytes, a verified result and its error.
//!
//! The flow, the same everywhere:
//!
//! 1. [`scene`]: a generator, or a file ([`read`]), makes a set of centres and radii.
//! 2. [`contact`]: radii and arithmetic become one contact test, shared by all; [`filter`] derives how none loses a pair to rounding.
//! 3. [`detect`]: a detector finds the touching pairs; one file per algorithm, one line each in [`detect::table`].
//! 4. [`probe`]: its operations are counted, or cost nothing when nobody listens; [`sink`]: its contacts become a list, a count, a digest.
//! 5. [`oracle`]: the truth, which every answer must meet; [`mod@check`]: the same on many small scenes.
//! 6. [`harness`]: experiments run every detector in a process of its own and append rows to a record.
//! 7. [`analyse`]: medians, intervals, fits, claims, from the record alone; [`figure`] and [`page`]: what they look like.
//!    [`recommend`] does both at once for one scene.
//! 8. [`cli`]: the verbs of the program `contactbench`.
//!
//! ```
//! use contactbench::contact::Test;
//! use contactbench::detect::{Options, table};
//! use contactbench::scene::spec::Spec;
//!
//! let scene = Spec::parse("packed:dim=3,n=1000,seed=1")?.make()?;
//! let mut nbs = table::find("nbs").expect("nbs is in the table").make(Options::default());
//! let mut pairs = Vec::new();
//! nbs.list(&scene, Test::Exact, &mut pairs)?;
//! assert!(pairs.len() > 2000, "a dense pack has several contacts per sphere");
//!
//! let mut direct = table::find("direct").expect("direct is in the table").make(Options::default());
//! let mut count = contactbench::sink::Count::default();
//! direct.visit(&scene, Test::Exact, &mut count)?;
//! assert_eq!(count.0, pairs.len() as u64);
//! # Ok::<(), anyhow::Error>(())
//! ```
#![warn(missing_docs)]

pub use contactbench_core::{contact, detect, event, filter, probe, sink, wide, with_scene};

pub mod analyse;
pub mod check;
pub mod cli;
pub mod draw;
pub mod figure;
pub mod harness;
pub mod oracle;
pub mod page;
pub mod read;
pub mod recommend;
pub mod scene;
pub mod trace;
