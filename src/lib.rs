//! contactbench measures and checks contact detectors for discs (2D) and spheres (3D).
//!
//! It shows which algorithm suits which scene: its time, memory, operations and errors. Every
//! detector gets exactly the same input, and every measurement becomes one row with time, operation
//! counts, bytes, a verified result and its error.
//!
//! The modules, in the order in which data pass through them; no module imports a later one:
//!
//! 1. [`scene`]: generators, and files ([`io`]), give centres and radii.
//! 2. The crate `contactbench-core` finds and counts contacts: [`contact`], [`filter`], [`detect`],
//!    [`probe`], [`sink`], [`wide`]. [`oracle`] has the exact truth, [`periodic`] boxes, and
//!    [`track`] neighbour lists of moving particles, which [`moving`] compares with the truth.
//! 3. [`mod@check`] compares every detector with the truth on many small scenes.
//! 4. [`experiment`] reads a TOML file; [`run`] measures each detector in a process of its own and
//!    appends rows to the [`record`].
//! 5. [`cells`] and [`stats`] summarise rows, [`findings`] judges claims, [`present`] writes the
//!    report, [`views`] draws scenes, films and traces. [`recommend`] measures one scene.
//! 6. [`cli`]: the verbs of the program `contactbench`.
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
//! let direct = table::find("direct").expect("direct is in the table");
//! let mut direct = direct.make(Options::default());
//! let mut count = contactbench::sink::Count::default();
//! direct.visit(&scene, Test::Exact, &mut count)?;
//! assert_eq!(count.0, pairs.len() as u64);
//! # Ok::<(), anyhow::Error>(())
//! ```

pub use contactbench_core::{
    contact, crowd, detect, event, filter, memory, oracle, pair_list, periodic, probe, searcher,
    sink, track, wide, with_scene,
};
pub use contactbench_io as io;
pub use contactbench_record::{cells, experiment, findings, record, stats};
pub use contactbench_report as present;
pub use contactbench_run::{check, moving, plan, recommend, run};
pub use contactbench_scenes as scene;
pub use contactbench_terms::{grammar, nearest, number, text};
pub use contactbench_views as views;

pub mod cli;
