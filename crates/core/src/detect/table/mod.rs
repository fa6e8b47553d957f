//! The table of all detectors. An algorithm that has a line here is in the command line, every
//! experiment and every test.

use std::collections::BTreeMap;

use super::any::{AnyDetector, Both, Refuses};
use super::book::nbs_levels::NbsLevels;
use super::book::{binary_tree, direct, nbs2d, nbs3d, screening, sorting};
use super::modern::{bvh, cell_grid, hash_grid, hgrid, kd_tree, sweep};
pub use super::parameter::{Beside, Parameter};
#[cfg(feature = "peers")]
use super::peers::Peer;
pub use super::spec::{DetectorSpec, SpecError, parse};
use super::streamed::{Form, Streamed};
use super::{Options, Refusal, control, peers};
use crate::wide::Level;

/// What a detector is there for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Finds all contacts.
    Detector,
    /// Reports nothing, on purpose: what is left of a measurement without a detector.
    Nothing,
    /// The same code as another detector: what two measurements of the same thing differ by.
    Twin(&'static str),
    /// A library that people use: finds all contacts, but is not held to our rules about memory and
    /// refusals.
    Peer,
}

/// Detectors that experiments name together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// Of Munjiza's book.
    Book,
    /// Grids, trees and sweeps as they are used today.
    Modern,
    /// NBS for caches and vector registers.
    Streamed,
    /// Controls of the measurement.
    Controls,
    /// More twins of detectors, where the noise is to be known well.
    Twins,
    /// Libraries that people use.
    Peers,
}

impl Group {
    /// All groups, in the order of the table.
    pub const ALL: [Group; 6] =
        [Group::Book, Group::Modern, Group::Streamed, Group::Controls, Group::Twins, Group::Peers];

    /// The name in experiments.
    pub fn name(self) -> &'static str {
        match self {
            Group::Book => "@book",
            Group::Modern => "@modern",
            Group::Streamed => "@streamed",
            Group::Controls => "@controls",
            Group::Twins => "@twins",
            Group::Peers => "@peers",
        }
    }
}

/// How the times of a detector usually compare with those of the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Speed {
    /// About as fast as looking at a list of pairs twenty times.
    Fast,
    /// Some times as long.
    Usual,
    /// So long that it is asked last.
    Slow,
}

/// The places of a detector among those that are asked for the truth, from 1; 0: it is not asked.
/// Judges that are asked together are of different families, the fast ones first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Judge {
    /// Where sizes are alike.
    pub alike: u8,
    /// Where sizes differ: cells as large as the largest particle hold nearly all others.
    pub differ: u8,
    /// Among the images of a periodic box.
    pub boxed: u8,
}

impl Judge {
    /// A detector that is not asked.
    pub const NOT: Judge = Judge { alike: 0, differ: 0, boxed: 0 };
}

/// Values given to a detector's parameters, by name; those left at their defaults are absent.
pub type Params = BTreeMap<String, String>;

/// One line of the table.
pub struct Entry {
    /// The name in records, experiments and on the command line.
    pub name: &'static str,
    /// Detector or control.
    pub role: Role,
    /// Which group it belongs to.
    pub group: Group,
    /// What it does, in a few words.
    pub summary: &'static str,
    /// Cost for N particles.
    pub cost: &'static str,
    /// Memory in bytes: n.. are cells per axis (borders included), N particles.
    pub memory: &'static str,
    /// What it refuses or does badly.
    pub limits: &'static str,
    /// Can use more than one thread.
    pub threads: bool,
    /// How the detector's times usually compare with those of other detectors.
    pub speed: Speed,
    /// Where the truth of a scene is asked of it.
    pub judge: Judge,
    /// What its user may choose.
    pub parameters: &'static [Parameter],
    /// How it is made; see [`Entry::make`] and [`DetectorSpec::make`].
    pub constructor: fn(&Params, Options) -> Box<dyn AnyDetector>,
}

impl Entry {
    /// A detector with empty buffers and all parameters at their defaults.
    pub fn make(&self, options: Options) -> Box<dyn AnyDetector> {
        (self.constructor)(&Params::new(), options)
    }

    /// True for detectors, whose answers must be right; false for the control that reports nothing.
    pub fn must_be_right(&self) -> bool {
        self.role != Role::Nothing
    }

    /// True for the code of this project, which allocates and refuses as its documentation says;
    /// false for peers.
    pub fn is_ours(&self) -> bool {
        self.role != Role::Peer
    }
}

#[cfg(feature = "peers")]
const fn peer(peer: &Peer, constructor: fn(&Params, Options) -> Box<dyn AnyDetector>) -> Entry {
    let Peer { name, summary, cost, limits } = *peer;
    Entry {
        name,
        role: Role::Peer,
        group: Group::Peers,
        summary,
        cost,
        memory: "the library's own",
        limits,
        threads: false,
        speed: Speed::Slow,
        judge: Judge::NOT,
        parameters: &[],
        constructor,
    }
}

/// All detectors and controls.
pub static TABLE: &[Entry] = &[
    Entry {
        name: "direct",
        role: Role::Detector,
        group: Group::Book,
        summary: "tests every pair",
        cost: "N(N-1)/2 contact tests",
        memory: "0",
        limits: "time: hopeless at scale",
        threads: true,
        speed: Speed::Slow,
        judge: Judge::NOT,
        parameters: &[],
        constructor: Both::<direct::Direct, direct::Direct>::boxed,
    },
    Entry {
        name: "binary-tree",
        role: Role::Detector,
        group: Group::Book,
        summary: "halves space in turn along the axes, lists in the leaves",
        cost: "N log N",
        memory: "4N + 8 nodes",
        limits: "cells per axis < 2^31; the memory limit",
        threads: false,
        speed: Speed::Slow,
        judge: Judge { alike: 3, differ: 0, boxed: 0 },
        parameters: &[],
        constructor: Both::<binary_tree::BinaryTree, binary_tree::BinaryTree>::boxed,
    },
    Entry {
        name: "screening",
        role: Role::Detector,
        group: Group::Book,
        summary: "one list head for every cell of the domain",
        cost: "N",
        memory: "4(nx ny [nz] + N)",
        limits: "memory: loose packs and far-away particles are refused",
        threads: false,
        speed: Speed::Usual,
        judge: Judge { alike: 4, differ: 0, boxed: 0 },
        parameters: &[],
        constructor: Both::<screening::Screening, screening::Screening>::boxed,
    },
    Entry {
        name: "sorting",
        role: Role::Detector,
        group: Group::Book,
        summary: "sorts integerised coordinates, finds mask cells by binary search",
        cost: "N log N",
        memory: "12N in 2D, 16N in 3D",
        limits: "cells per axis < 2^31; the memory limit",
        threads: false,
        speed: Speed::Usual,
        judge: Judge { alike: 2, differ: 4, boxed: 4 },
        parameters: &[],
        constructor: Both::<sorting::Sorting<2>, sorting::Sorting<3>>::boxed,
    },
    Entry {
        name: "nbs",
        role: Role::Detector,
        group: Group::Book,
        summary: "Munjiza-NBS: lists of layers, of rows, of cells; no binary search",
        cost: "N",
        memory: "4(ny + 2nx + 2N) in 2D, 4(nz + 2ny + 2nx + 3N) in 3D; with levels \
                 about twice that",
        limits: "memory: a particle so far away that nx + ny + nz exceeds the limit",
        threads: false,
        speed: Speed::Usual,
        judge: Judge { alike: 1, differ: 3, boxed: 3 },
        parameters: &[Parameter {
            name: "levels",
            values: &["none", "auto"],
            beside: None,
            instead_of: None,
            meaning: "none: cells for the largest body; auto: by octaves of radii, each with all \
                      smaller ones",
        }],
        constructor: nbs,
    },
    Entry {
        name: "streamed-nbs",
        role: Role::Detector,
        group: Group::Streamed,
        summary: "NBS for caches and vector registers: layers sorted by cell, two at a time, \
                  sixteen tests in one go; in classes where sizes differ",
        cost: "N; N log N where particles crowd in a large domain",
        memory: "about 16N in 2D, 20N in 3D, and two bundles of layers",
        limits: "cells per axis < 2^31 where particles crowd; the memory limit",
        threads: true,
        speed: Speed::Fast,
        judge: Judge { alike: 0, differ: 0, boxed: 2 },
        parameters: &[
            Parameter {
                name: "form",
                values: &["auto", "dense", "flat", "sparse"],
                beside: None,
                instead_of: None,
                meaning: "layers by all cells, by columns of them, or by occupied cells only; \
                          auto: as the scene is crowded",
            },
            Parameter {
                name: "level",
                values: &["best", "portable", "avx2", "avx512"],
                beside: None,
                instead_of: None,
                meaning: "vector instructions; best: the widest that the processor has",
            },
        ],
        constructor: streamed,
    },
    Entry {
        name: "cell-grid",
        role: Role::Detector,
        group: Group::Modern,
        summary: "copies sorted by cell, rows of cells side by side",
        cost: "N + cells",
        memory: "4(nx ny [nz] + 1) + 24N in 2D, 32N in 3D",
        limits: "memory: loose packs and far-away particles are refused",
        threads: true,
        speed: Speed::Usual,
        judge: Judge::NOT,
        parameters: &[],
        constructor: Both::<cell_grid::CellGrid<2>, cell_grid::CellGrid<3>>::boxed,
    },
    Entry {
        name: "hash-grid",
        role: Role::Detector,
        group: Group::Modern,
        summary: "copies sorted by a hash of their cell, bricks of cells side by side",
        cost: "N",
        memory: "4(B + 513) + 24N in 2D, 4(B + 1025) + 32N in 3D; B the power of two from N up",
        limits: "cells per axis < 2^31; the memory limit",
        threads: false,
        speed: Speed::Usual,
        judge: Judge::NOT,
        parameters: &[],
        constructor: Both::<hash_grid::HashGrid<2>, hash_grid::HashGrid<3>>::boxed,
    },
    Entry {
        name: "hgrid",
        role: Role::Detector,
        group: Group::Modern,
        summary: "a hashed grid for every class of sizes, large bodies searched in the fine grids",
        cost: "N in each level, whatever the ratio of sizes",
        memory: "4(C + N) + 44S + 24N in 2D, 48S + 32N in 3D; S strips of 8 cells, C slots",
        limits: "cells per axis < 2^31 where particles crowd; the memory limit",
        threads: false,
        speed: Speed::Usual,
        judge: Judge { alike: 0, differ: 2, boxed: 0 },
        parameters: &[
            Parameter {
                name: "ratio",
                values: &["2", "1.25", "1.5", "1.6", "2.5", "3", "4", "8", "one-level"],
                beside: None,
                instead_of: None,
                meaning: "from the largest radius of a level to that of the next",
            },
            Parameter {
                name: "levels",
                values: &["ratio", "optimal"],
                beside: Some(Beside {
                    normal: |text| Some(hgrid::Borders::parse(text)?.to_string()),
                    form: "the largest radii of all levels but the coarsest, rising, at most 31, \
                           as in 0.1/0.3/1",
                }),
                instead_of: Some("ratio"),
                meaning: "levels by the ratio, where a model of the work is least, or by largest \
                          radii in units of length, as in 0.1/0.3/1",
            },
        ],
        constructor: hgrid,
    },
    Entry {
        name: "sweep",
        role: Role::Detector,
        group: Group::Modern,
        summary: "sorts along the longest axis, compares what overlaps along a second",
        cost: "N log N key comparisons, N^(2 - 1/D) of bounds in a box",
        memory: "32N in 2D, 40N in 3D",
        limits: "time: many particles in 3D; the memory limit",
        threads: false,
        speed: Speed::Slow,
        judge: Judge::NOT,
        parameters: &[],
        constructor: Both::<sweep::Sweep<2>, sweep::Sweep<3>>::boxed,
    },
    Entry {
        name: "kd-tree",
        role: Role::Detector,
        group: Group::Modern,
        summary: "halves the particles in turn at medians, boxes around halves",
        cost: "N log N",
        memory: "24N + 64L in 2D, 32N + 96L in 3D; L the power of two from N/16 upwards",
        limits: "the memory limit",
        threads: false,
        speed: Speed::Usual,
        judge: Judge { alike: 0, differ: 1, boxed: 0 },
        parameters: &[],
        constructor: Both::<kd_tree::KdTree<2>, kd_tree::KdTree<3>>::boxed,
    },
    Entry {
        name: "bvh",
        role: Role::Detector,
        group: Group::Modern,
        summary: "sorts along a Morton curve, boxes around neighbours on it",
        cost: "N log N",
        memory: "40N + 64L in 2D, 48N + 96L in 3D; L the power of two from N/16 upwards",
        limits: "the memory limit; clumps far from the rest are slow",
        threads: false,
        speed: Speed::Usual,
        judge: Judge { alike: 0, differ: 0, boxed: 1 },
        parameters: &[],
        constructor: Both::<bvh::Bvh<2>, bvh::Bvh<3>>::boxed,
    },
    Entry {
        name: "nothing",
        role: Role::Nothing,
        group: Group::Controls,
        summary: "control: does nothing, the floor of every measurement",
        cost: "0",
        memory: "0",
        limits: "finds nothing",
        threads: false,
        speed: Speed::Usual,
        judge: Judge::NOT,
        parameters: &[],
        constructor: Both::<control::Nothing, control::Nothing>::boxed,
    },
    Entry {
        name: "nbs-twin",
        role: Role::Twin("nbs"),
        group: Group::Controls,
        summary: "control: the same code as nbs, for the noise between equal things",
        cost: "N",
        memory: "as nbs",
        limits: "as nbs",
        threads: false,
        speed: Speed::Usual,
        judge: Judge::NOT,
        parameters: &[],
        constructor: Both::<nbs2d::Nbs2d, nbs3d::Nbs3d>::boxed,
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
        speed: Speed::Usual,
        judge: Judge::NOT,
        parameters: &[],
        constructor: Both::<cell_grid::CellGrid<2>, cell_grid::CellGrid<3>>::boxed,
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
        speed: Speed::Usual,
        judge: Judge::NOT,
        parameters: &[],
        constructor: streamed,
    },
    #[cfg(feature = "peers")]
    peer(&peers::KIDDO, Both::<peers::kiddo::Kiddo<2>, peers::kiddo::Kiddo<3>>::boxed),
    #[cfg(feature = "peers")]
    peer(&peers::KD_TREE, Both::<peers::kd_tree::KdTree<2>, peers::kd_tree::KdTree<3>>::boxed),
    #[cfg(feature = "peers")]
    peer(&peers::RSTAR, Both::<peers::rstar::Rstar<2>, peers::rstar::Rstar<3>>::boxed),
    #[cfg(feature = "peers")]
    peer(&peers::PARRY, Both::<peers::parry::Parry<2>, peers::parry::Parry<3>>::boxed),
    #[cfg(feature = "peers")]
    peer(&peers::ZELLL, Both::<peers::zelll::Zelll<2>, peers::zelll::Zelll<3>>::boxed),
];

/// The name of the detector to take without a reason for another.
pub const DEFAULT: &str = "streamed-nbs";

/// Makes the detector named [`DEFAULT`].
pub fn fast(options: Options) -> Box<dyn AnyDetector> {
    streamed(&Params::new(), options)
}

/// Makes the detector that copes with sizes and places of every kind.
pub fn robust(options: Options) -> Box<dyn AnyDetector> {
    Both::<bvh::Bvh<2>, bvh::Bvh<3>>::boxed(&Params::new(), options)
}

/// The detectors that have a place among the judges, in the order of their places.
pub fn judges(place: fn(&Judge) -> u8) -> Vec<&'static Entry> {
    let mut judges: Vec<&Entry> = TABLE.iter().filter(|it| place(&it.judge) > 0).collect();
    judges.sort_by_key(|entry| place(&entry.judge));
    judges
}

/// `nbs` with its parameter.
fn nbs(params: &Params, options: Options) -> Box<dyn AnyDetector> {
    if params.contains_key("levels") {
        Both::<NbsLevels<nbs2d::Nbs2d, 2>, NbsLevels<nbs3d::Nbs3d, 3>>::boxed(params, options)
    } else {
        Both::<nbs2d::Nbs2d, nbs3d::Nbs3d>::boxed(params, options)
    }
}

/// `streamed-nbs` with its parameters.
fn streamed(params: &Params, options: Options) -> Box<dyn AnyDetector> {
    let level = match params.get("level") {
        None => Level::best(),
        Some(name) => match Level::all().into_iter().find(|level| level.name() == name) {
            Some(level) => level,
            None => {
                let has = Level::all().iter().map(|level| level.name()).collect();
                return Box::new(Refuses(Refusal::Instructions { level: name.clone(), has }));
            }
        },
    };
    let form = match params.get("form").map(String::as_str) {
        Some("dense") => Some(Form::Dense),
        Some("flat") => Some(Form::Flat),
        Some("sparse") => Some(Form::Sparse),
        _ => None,
    };
    let (plane, space) = (Streamed::<2>::on(level, options), Streamed::<3>::on(level, options));
    match form {
        None => Both::join(plane, space, options),
        Some(form) => Both::join(plane.in_form(form), space.in_form(form), options),
    }
}

/// `hgrid` with its parameters.
fn hgrid(params: &Params, options: Options) -> Box<dyn AnyDetector> {
    let ratio = match params.get("ratio").map(|text| text.parse()) {
        None => Some(2.0),
        // No number: one level.
        Some(number) => number.ok(),
    };
    let parting = match params.get("levels").map(String::as_str) {
        None => hgrid::Parting::Ratio(ratio),
        Some("optimal") => hgrid::Parting::Optimal,
        // The table lets nothing else pass.
        Some(text) => match hgrid::Borders::parse(text) {
            Some(borders) => hgrid::Parting::Borders(borders),
            None => hgrid::Parting::Ratio(ratio),
        },
    };
    let (plane, space) = (
        hgrid::HGrid::<2>::with_levels(parting.clone(), options),
        hgrid::HGrid::<3>::with_levels(parting, options),
    );
    Both::join(plane, space, options)
}

/// The line of a detector; [`super::spec::parse`] takes parameters, too.
pub fn find(name: &str) -> Option<&'static Entry> {
    TABLE.iter().find(|entry| entry.name == name)
}

impl Entry {
    /// Returns whether it serves measurements only: `nothing`, and the twins.
    pub fn is_control(&self) -> bool {
        matches!(self.role, Role::Nothing | Role::Twin(_))
    }
}

/// The names of all detectors, without controls, for messages.
pub fn names() -> String {
    let detectors = TABLE.iter().filter(|entry| !entry.is_control());
    detectors.map(|entry| entry.name).collect::<Vec<_>>().join(", ")
}

/// The names of all detectors and controls, libraries that were not compiled included.
pub fn all_names() -> impl Iterator<Item = &'static str> {
    let peers = peers::PEERS.iter().map(|peer| peer.name).filter(|name| find(name).is_none());
    TABLE.iter().map(|entry| entry.name).chain(peers)
}

#[cfg(test)]
mod tests;
