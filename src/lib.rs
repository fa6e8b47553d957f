//! contactbench measures and checks contact detectors for discs (2D) and spheres (3D).
//!
//! Which algorithm suits which scene: how fast is it, how much memory does it need, how many
//! operations does it count, and how wrong is it? All detectors get the same input. Each
//! measurement is one row with time, exact operation counts, bytes, a verified result and its
//! error.
//!
//! Modules in the order of the data flow, which is the same everywhere and never runs backwards:
//!
//! 1. [`scene`]: a generator or a file ([`io`]) makes centres and radii.
//! 2. The crate `contactbench-core` finds and counts contacts: [`contact`], [`filter`], [`detect`],
//!    [`probe`], [`sink`], [`wide`]. [`oracle`] computes the exact truth; [`periodic`] handles
//!    periodic boxes; [`track`] keeps neighbour lists while particles move, and [`moving`]
//!    compares those with the truth.
//! 3. [`mod@check`] compares every detector with the truth on many small scenes.
//! 4. [`experiment`] reads an experiment from TOML. [`run`] measures every detector in its own
//!    process and appends rows to the [`record`].
//! 5. [`cells`] and [`stats`] combine the rows of each measurement into medians and intervals.
//!    [`findings`] draws conclusions, and [`present`] shows them. [`views`] makes pictures of
//!    scenes, films and traces. [`recommend`] runs all of this for one scene.
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
