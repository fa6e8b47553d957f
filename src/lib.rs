//! contactbench measures and checks contact detectors for discs (2D) and spheres (3D).
//!
//! It shows which algorithm suits which scene: its time, memory, operations and errors. Every
//! detector gets exactly the same input, and every measurement becomes one row with time, operation
//! counts, bytes, a verified result and its error.
//!
//! The modules, in the order in which data pass through them; no module imports a later one:
//!
//! 1. [`scene`]: generators, and files ([`io`]), give centres and radii.
//! 2. The crates `contactbench-ground`, `contactbench-streamed`, `contactbench-lists` and
//!    `contactbench-detectors` find and count contacts; [`tracking`] compares neighbour lists of
//!    moving particles with the truth. `contactbench-core` is the published face of the four.
//! 3. [`mod@check`] compares every detector with the truth on many small scenes.
//! 4. [`experiment`] reads a TOML file; [`run`] measures each detector in a process of its own and
//!    appends rows to the [`record`].
//! 5. [`cells`] and [`stats`] summarise rows, [`findings`] judges claims, [`present`] writes the
//!    report, [`views`] draws scenes and traces. [`recommend`] measures one scene.
//! 6. [`cli`]: the verbs of the program `contactbench`.
//!
//! ```
//! use contactbench_ground::contact::Test;
//! use contactbench_ground::detect::Options;
//! use contactbench_detectors::table;
//! use contactbench::scene::spec::Spec;
//!
//! let scene = Spec::parse("packed:dim=3,n=1000,seed=1")?.make()?;
//! let mut nbs = table::find("nbs").expect("nbs is in the table").make(Options::default());
//! let mut pairs = Vec::new();
//! nbs.list(&scene, Test::Exact, &mut pairs)?;
//! assert!(pairs.len() > 2000, "a dense pack has several contacts per sphere");
//!
//! let direct = table::find("direct").expect("direct is in the table");
//! let mut direct = direct.make(Options::default());
//! let mut count = contactbench_ground::pairs::sink::Count::default();
//! direct.visit(&scene, Test::Exact, &mut count)?;
//! assert_eq!(count.0, pairs.len() as u64);
//! # Ok::<(), anyhow::Error>(())
//! ```

pub use contactbench_io as io;
pub use contactbench_record::{cells, experiment, findings, record, stats};
pub use contactbench_report as present;
pub use contactbench_run::{check, plan, recommend, run, tracking};
pub use contactbench_scenes as scene;
pub use contactbench_terms::{grammar, nearest, number, text};
pub use contactbench_views as views;

pub mod cli;
