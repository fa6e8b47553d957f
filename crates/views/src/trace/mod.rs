//! The detectors of the book (Munjiza 2004) step by step, on small 2D scenes, for lectures.
//!
//! ```
//! use contactbench_views::trace::{Algorithm, example, trace};
//!
//! let trace = trace(Algorithm::Nbs, None)?;
//! assert_eq!(trace.contacts.len(), 6);
//! let page = contactbench_views::trace::page::html(&trace, "ten particles");
//! assert!(page.starts_with("<!doctype html>"));
//! # Ok::<(), anyhow::Error>(())
//! ```
//!
//! The detectors report their steps as events ([`contactbench_ground::probe::event`]) to a
//! [`recorder`], a probe that also counts their operations.
//!
//! * [`state`]: contents of the arrays; `words`: a sentence for each step.
//! * [`page`]: all steps as one HTML page, whose script draws scene and arrays.

pub mod example;
pub mod page;
pub mod recorder;
pub mod state;
mod words;

use anyhow::{Context, ensure};
use recorder::{Names, Recorder, Step};

use contactbench_detectors::book::binary_tree::BinaryTree;
use contactbench_detectors::book::nbs::Nbs;
use contactbench_detectors::book::screening::Screening;
use contactbench_detectors::book::sorting::Sorting;
use contactbench_ground::contact::{Arithmetic, Particles, any_particles};
use contactbench_ground::detect::{Declare, Detector, Options};
use contactbench_ground::filter::Cells;
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::probe::{Op, Silent, Tally};
use contactbench_ground::scene::{AnyScene, Stored, array};

pub const MOST_PARTICLES: usize = 60;
/// Maximum number of cells along an axis, borders included.
pub const MOST_CELLS: u32 = 40;
pub const MOST_STEPS: usize = 3000;

contactbench_terms::named! {
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum Algorithm {
        #[default]
        Nbs = "nbs",
        Sorting = "sorting",
        Screening = "screening",
        BinaryTree = "binary-tree",
    }
}

#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Disc {
    pub at: [f64; 2],
    pub r: f64,
    /// Column and row of the cell, in the numbering of the detector.
    pub cell: [u32; 2],
}

#[derive(Clone, Debug)]
pub struct Trace {
    pub algorithm: Algorithm,
    pub discs: Vec<Disc>,
    pub cells: Cells<2>,
    pub names: Names,
    /// All steps: the first shows the initial state, the last the end.
    pub steps: Vec<Step>,
    pub parts: Vec<String>,
    /// The pairs in the order in which the detector reported them.
    pub contacts: Vec<[u32; 2]>,
    pub tally: Tally,
}

impl Trace {
    pub fn title(&self, name: &str) -> String {
        format!("{}: {name}", self.algorithm.name())
    }

    pub fn ops(&self) -> Vec<(Op, String)> {
        let used = self.tally.iter().filter(|&(_, count)| count > 0);
        used.map(|(op, _)| (op, op.name().replace('_', " "))).collect()
    }
}

/// Runs a detector on a scene, or by default on its example from the book, and records its steps.
/// Contacts are decided exactly. Refuses spheres, more than [`MOST_PARTICLES`] particles,
/// [`MOST_CELLS`] cells along an axis or [`MOST_STEPS`] steps, and scenes that the detector
/// refuses.
pub fn trace(algorithm: Algorithm, scene: Option<&AnyScene<'_>>) -> anyhow::Result<Trace> {
    let example = example::example(algorithm);
    let (scene, names) = match scene {
        None => (example.scene(), Names { first: 1, shift: example.shift, book: true }),
        Some(scene) => {
            (scene.stored(Arithmetic::F64)?, Names { first: 0, shift: [0, 0], book: false })
        }
    };
    let AnyScene::Plane(Stored::F64(scene)) = &scene else {
        anyhow::bail!("steps are shown of discs, and this scene is of spheres; take one with dim=2")
    };
    let n = scene.len();
    ensure!(n > 0, "the scene has no particles; there is nothing to show");
    ensure!(
        n <= MOST_PARTICLES,
        "the scene has {n} particles; the steps of at most {MOST_PARTICLES} can be followed: take \
         part, or a smaller n"
    );
    let particles = any_particles(scene, Arithmetic::Exact.test())?;
    let cells = Cells::new(&particles)?;
    let [nx, ny] = cells.count;
    ensure!(
        nx.max(ny) <= MOST_CELLS,
        "the scene has {nx} x {ny} cells; at most {MOST_CELLS} along each axis can be shown: take \
         a denser scene, or remove particles that are far away"
    );
    let discs: Vec<Disc> = (0..n)
        .map(|k| {
            let at = *array(&scene.centres()[k]);
            Disc {
                at,
                r: scene.radius(k),
                cell: [0, 1].map(|axis| cells.index(at[axis], axis, &mut Silent)),
            }
        })
        .collect();
    let mut recorder = Recorder::new(algorithm, names, cells.count, &discs);
    let mut contacts: Vec<[u32; 2]> = Vec::new();
    detect(algorithm, particles, &mut recorder, &mut contacts)
        .with_context(|| format!("{} refuses the scene", algorithm.name()))?;
    recorder.end();
    let Recorder { steps, parts, tally, all, .. } = recorder;
    ensure!(
        all <= MOST_STEPS,
        "{} takes {all} steps for this scene; at most {MOST_STEPS} can be shown: take fewer \
         particles, or a looser scene",
        algorithm.name()
    );
    Ok(Trace { algorithm, discs, cells, names, steps, parts, contacts, tally })
}

fn detect<B: Particles<f64, 2>>(
    algorithm: Algorithm,
    particles: B,
    probe: &mut Recorder,
    sink: &mut Vec<[u32; 2]>,
) -> Result<(), Refusal> {
    fn with<D: Declare>() -> D {
        D::with(Options::default())
    }
    match algorithm {
        Algorithm::Nbs => with::<Nbs<2>>().detect(particles, probe, sink),
        Algorithm::Sorting => with::<Sorting<2>>().detect(particles, probe, sink),
        Algorithm::Screening => with::<Screening>().detect(particles, probe, sink),
        Algorithm::BinaryTree => with::<BinaryTree>().detect(particles, probe, sink),
    }
}
