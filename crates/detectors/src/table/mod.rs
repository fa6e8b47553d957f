//! The table of all detectors. Each entry is available on the command line and is part of every
//! experiment and test.

use super::book::{binary_tree, direct, kept_tree, nbs, screening, sorting};
use super::control;
pub use super::entry::{Entry, Group, Parameter, Role, Speed};
use super::modern::{bvh, cell_grid, hash_grid, kd_tree, sweep};
pub use super::spec::{DetectorSpec, SpecError, parse};
use contactbench_ground::detect::Options;
pub use contactbench_ground::detect::any::Params;
use contactbench_ground::detect::any::{AnyDetector, Both};
use contactbench_streamed::Form;

/// A detector of the usual speed with one thread and no parameters, from which entries begin.
pub const PLAIN: Entry = Entry {
    name: "",
    role: Role::Detector,
    group: Group::Book,
    summary: "",
    cost: "",
    memory: "",
    limits: "",
    threads: false,
    speed: Speed::Usual,
    judge: 0,
    parameters: &[],
    // The default constructor finds no contacts, which every test notices.
    constructor: Both::<control::Nothing, control::Nothing>::boxed,
};

/// All detectors and controls.
pub static TABLE: &[Entry] = &[
    Entry {
        name: "direct",
        group: Group::Book,
        summary: "tests every pair",
        cost: "N(N-1)/2 contact tests",
        memory: "0",
        limits: "time: hopeless at scale",
        threads: true,
        speed: Speed::Slow,
        constructor: Both::<direct::Direct, direct::Direct>::boxed,
        ..PLAIN
    },
    Entry {
        name: "binary-tree",
        group: Group::Book,
        summary: "halves space in turn along the axes, lists in the leaves",
        cost: "N log N",
        memory: "4N + 8 nodes",
        limits: "cells per axis < 2^31; the memory limit",
        speed: Speed::Slow,
        parameters: &[Parameter {
            name: "tree",
            values: &["new", "kept"],
            meaning: "built for each detection, or kept: particles that left their leaf move",
        }],
        constructor: binary_tree,
        ..PLAIN
    },
    Entry {
        name: "screening",
        group: Group::Book,
        summary: "one list head for every cell of the domain",
        cost: "N",
        memory: "4(nx ny [nz] + N)",
        limits: "memory: loose packs and far-away particles are refused",
        constructor: Both::<screening::Screening, screening::Screening>::boxed,
        ..PLAIN
    },
    Entry {
        name: "sorting",
        group: Group::Book,
        summary: "sorts integerised coordinates, finds mask cells by binary search",
        cost: "N log N",
        memory: "12N in 2D, 16N in 3D",
        limits: "cells per axis < 2^31; the memory limit",
        constructor: Both::<sorting::Sorting<2>, sorting::Sorting<3>>::boxed,
        ..PLAIN
    },
    Entry {
        name: "nbs",
        group: Group::Book,
        summary: "Munjiza-NBS: lists of layers, of rows, of cells; no binary search",
        cost: "N",
        memory: "4(ny + 2nx + 2N) in 2D, 4(nz + 2ny + 2nx + 3N) in 3D",
        limits: "memory: a particle so far away that nx + ny + nz exceeds the limit",
        judge: 4,
        constructor: Both::<nbs::Nbs<2>, nbs::Nbs<3>>::boxed,
        ..PLAIN
    },
    Entry {
        name: "streamed-nbs",
        group: Group::Streamed,
        summary: "NBS for caches and vector registers: layers sorted by cell, two at a time, \
                  sixteen tests in one go; in classes where sizes differ",
        cost: "N; N log N where particles crowd in a large domain",
        memory: "about 16N in 2D, 20N in 3D, and two bundles of layers",
        limits: "cells per axis < 2^31 where particles crowd; the memory limit",
        threads: true,
        speed: Speed::Fast,
        judge: 1,
        parameters: &[
            Parameter {
                name: "form",
                values: &["auto", "dense", "flat", "sparse"],
                meaning: "layers by all cells, by columns of them, or by occupied cells only; \
                          auto: as the scene is crowded",
            },
            Parameter {
                name: "level",
                values: &["best", "portable", "neon", "avx2", "avx512"],
                meaning: "vector instructions; best: the widest that the processor has",
            },
        ],
        constructor: streamed,
        ..PLAIN
    },
    Entry {
        name: "cell-grid",
        group: Group::Modern,
        summary: "copies sorted by cell, rows of cells side by side",
        cost: "N + cells",
        memory: "4(nx ny [nz] + 1) + 24N in 2D, 32N in 3D",
        limits: "memory: loose packs and far-away particles are refused",
        threads: true,
        constructor: Both::<cell_grid::CellGrid<2>, cell_grid::CellGrid<3>>::boxed,
        ..PLAIN
    },
    Entry {
        name: "hash-grid",
        group: Group::Modern,
        summary: "copies sorted by a hash of their cell, bricks of cells side by side",
        cost: "N",
        memory: "4(B + 513) + 24N in 2D, 4(B + 1025) + 32N in 3D; B the power of two from N up",
        limits: "cells per axis < 2^31; the memory limit",
        constructor: Both::<hash_grid::HashGrid<2>, hash_grid::HashGrid<3>>::boxed,
        ..PLAIN
    },
    Entry {
        name: "hgrid",
        group: Group::Modern,
        summary: "a hashed grid for every class of sizes, large particles searched in the fine grids",
        cost: "N in each level, whatever the ratio of sizes",
        memory: "4(C + N) + 44S + 24N in 2D, 48S + 32N in 3D; S strips of 8 cells, C slots",
        limits: "cells per axis < 2^31 where particles crowd; the memory limit",
        parameters: &[Parameter {
            name: "ratio",
            values: &["2", "1.25", "1.5", "1.6", "2.5", "3", "4", "8", "one-level"],
            meaning: "from the largest radius of a level to that of the next",
        }],
        constructor: hgrid,
        ..PLAIN
    },
    Entry {
        name: "sweep",
        group: Group::Modern,
        summary: "sorts along the longest axis, compares what overlaps along a second",
        cost: "N log N key comparisons, N^(2 - 1/D) of bounds in a box",
        memory: "32N in 2D, 40N in 3D",
        limits: "time: many particles in 3D; the memory limit",
        speed: Speed::Slow,
        constructor: Both::<sweep::Sweep<2>, sweep::Sweep<3>>::boxed,
        ..PLAIN
    },
    Entry {
        name: "kd-tree",
        group: Group::Modern,
        summary: "halves the particles in turn at medians, boxes around halves",
        cost: "N log N",
        memory: "24N + 64L in 2D, 32N + 96L in 3D; L the power of two from N/16 upwards",
        limits: "the memory limit",
        judge: 2,
        constructor: Both::<kd_tree::KdTree<2>, kd_tree::KdTree<3>>::boxed,
        ..PLAIN
    },
    Entry {
        name: "bvh",
        group: Group::Modern,
        summary: "sorts along a Morton curve, boxes around neighbours on it",
        cost: "N log N",
        memory: "40N + 64L in 2D, 48N + 96L in 3D; L the power of two from N/16 upwards",
        limits: "the memory limit; clumps far from the rest are slow",
        judge: 3,
        constructor: Both::<bvh::Bvh<2>, bvh::Bvh<3>>::boxed,
        ..PLAIN
    },
    Entry {
        name: "nothing",
        role: Role::Nothing,
        group: Group::Controls,
        summary: "control: does nothing, the floor of every measurement",
        cost: "0",
        memory: "0",
        limits: "finds nothing",
        ..PLAIN
    },
    Entry {
        name: "nbs-twin",
        role: Role::Twin("nbs"),
        group: Group::Controls,
        summary: "control: the same code as nbs, for the noise between equal things",
        cost: "N",
        memory: "as nbs",
        limits: "as nbs",
        constructor: Both::<nbs::Nbs<2>, nbs::Nbs<3>>::boxed,
        ..PLAIN
    },
    Entry {
        name: "cell-grid-twin",
        role: Role::Twin("cell-grid"),
        group: Group::Twins,
        summary: "control: the same code as cell-grid",
        cost: "N + cells",
        memory: "as cell-grid",
        limits: "as cell-grid",
        threads: true,
        constructor: Both::<cell_grid::CellGrid<2>, cell_grid::CellGrid<3>>::boxed,
        ..PLAIN
    },
    Entry {
        name: "streamed-nbs-twin",
        role: Role::Twin("streamed-nbs"),
        group: Group::Twins,
        summary: "control: the same code as streamed-nbs",
        cost: "as streamed-nbs",
        memory: "as streamed-nbs",
        limits: "as streamed-nbs",
        threads: true,
        constructor: streamed,
        ..PLAIN
    },
];

/// Name of the default detector.
pub const DEFAULT: &str = "streamed-nbs";

/// Creates the detector named [`DEFAULT`].
pub fn fast(options: Options) -> Box<dyn AnyDetector> {
    streamed(&Params::new(), options)
}

/// Creates the `bvh` detector, which handles all size distributions and positions.
pub fn robust(options: Options) -> Box<dyn AnyDetector> {
    Both::<bvh::Bvh<2>, bvh::Bvh<3>>::boxed(&Params::new(), options)
}

/// Returns the detectors that may establish the truth, sorted by rank.
pub fn judges() -> Vec<&'static Entry> {
    let mut judges: Vec<&Entry> = TABLE.iter().filter(|it| it.judge > 0).collect();
    judges.sort_by_key(|entry| entry.judge);
    judges
}

fn binary_tree(params: &Params, options: Options) -> Box<dyn AnyDetector> {
    match params.get("tree") {
        None => Both::<binary_tree::BinaryTree, binary_tree::BinaryTree>::boxed(params, options),
        Some(_) => Both::<kept_tree::KeptTree<2>, kept_tree::KeptTree<3>>::boxed(params, options),
    }
}

fn streamed(params: &Params, options: Options) -> Box<dyn AnyDetector> {
    let form =
        params.get("form").and_then(|name| Form::ALL.into_iter().find(|it| it.name() == name));
    contactbench_streamed::streamed(params.get("level").map(String::as_str), form, options)
}

fn hgrid(params: &Params, options: Options) -> Box<dyn AnyDetector> {
    let ratio = match params.get("ratio").map(|text| text.parse()) {
        None => Some(2.0),
        // A ratio that is not a number puts all sizes in one level.
        Some(number) => number.ok(),
    };
    contactbench_streamed::hgrid::hgrid(ratio, options)
}

/// Returns the entry with this name, if any; [`super::spec::parse`] also accepts parameters.
pub fn find(name: &str) -> Option<&'static Entry> {
    TABLE.iter().find(|entry| entry.name == name)
}

impl Entry {
    /// Returns whether the entry serves measurements only: `nothing` and the twins.
    pub fn is_control(&self) -> bool {
        matches!(self.role, Role::Nothing | Role::Twin(_))
    }
}

/// Lists the names of all detectors, without controls, for messages.
pub fn names() -> String {
    let detectors = TABLE.iter().filter(|entry| !entry.is_control());
    detectors.map(|entry| entry.name).collect::<Vec<_>>().join(", ")
}

/// Returns the names of all detectors and controls.
pub fn all_names() -> impl Iterator<Item = &'static str> {
    TABLE.iter().map(|entry| entry.name)
}
