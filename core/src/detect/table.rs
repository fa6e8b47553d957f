//! The table of all detectors. An algorithm that has a line here is in the command line, every experiment and every test.

use super::any::{AnyDetector, Both};
use super::{Options, binary_tree, bvh, cell_grid, control, direct, hash_grid, kd_tree, nbs2d, nbs3d, screening, sorting, streamed, sweep};
#[cfg(feature = "peers")]
use super::{peers, peers::Peer};

/// What a detector is there for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Finds all contacts.
    Detector,
    /// Reports nothing, on purpose: what is left of a measurement without a detector.
    Nothing,
    /// The same code as another detector: what two measurements of the same thing differ by.
    Twin(&'static str),
    /// A library that people use: finds all contacts, but is not held to our rules about memory and refusals.
    Peer,
}

/// One line of the table.
pub struct Entry {
    /// The name in records, experiments and on the command line.
    pub name: &'static str,
    /// Detector or control.
    pub role: Role,
    /// What it does, in a few words.
    pub summary: &'static str,
    /// Cost for N elements.
    pub cost: &'static str,
    /// Memory in bytes: n.. are cells per axis (borders included), N elements.
    pub memory: &'static str,
    /// What it refuses or does badly.
    pub limits: &'static str,
    /// Can use more than one thread.
    pub threads: bool,
    /// How it is made; see [`Entry::make`].
    pub constructor: fn(Options) -> Box<dyn AnyDetector>,
}

impl Entry {
    /// A detector with empty buffers.
    pub fn make(&self, options: Options) -> Box<dyn AnyDetector> {
        (self.constructor)(options)
    }

    /// True for detectors, whose answers must be right; false for the control that reports nothing.
    pub fn must_be_right(&self) -> bool {
        self.role != Role::Nothing
    }

    /// True for the code of this project, which allocates and refuses as its documentation says; false for peers.
    pub fn is_ours(&self) -> bool {
        self.role != Role::Peer
    }
}

#[cfg(feature = "peers")]
const fn peer(peer: &Peer, constructor: fn(Options) -> Box<dyn AnyDetector>) -> Entry {
    let Peer { name, summary, cost, limits } = *peer;
    Entry { name, role: Role::Peer, summary, cost, memory: "the library's own", limits, threads: false, constructor }
}

/// All detectors and controls.
pub static TABLE: &[Entry] = &[
    Entry {
        name: "direct",
        role: Role::Detector,
        summary: "tests every pair",
        cost: "N(N-1)/2 contact tests",
        memory: "0",
        limits: "time: hopeless at scale",
        threads: true,
        constructor: Both::<direct::Direct, direct::Direct>::boxed,
    },
    Entry {
        name: "binary-tree",
        role: Role::Detector,
        summary: "halves space in turn along the axes, lists in the leaves",
        cost: "N log N",
        memory: "4N + 8 nodes",
        limits: "cells per axis < 2^31; the memory limit",
        threads: false,
        constructor: Both::<binary_tree::BinaryTree, binary_tree::BinaryTree>::boxed,
    },
    Entry {
        name: "screening",
        role: Role::Detector,
        summary: "one list head for every cell of the domain",
        cost: "N",
        memory: "4(nx ny [nz] + N)",
        limits: "memory: loose packs and far-away elements are refused",
        threads: false,
        constructor: Both::<screening::Screening, screening::Screening>::boxed,
    },
    Entry {
        name: "sorting",
        role: Role::Detector,
        summary: "sorts integerised coordinates, finds mask cells by binary search",
        cost: "N log N",
        memory: "12N in 2D, 16N in 3D",
        limits: "cells per axis < 2^31; the memory limit",
        threads: false,
        constructor: Both::<sorting::Sorting<2>, sorting::Sorting<3>>::boxed,
    },
    Entry {
        name: "nbs",
        role: Role::Detector,
        summary: "Munjiza-NBS: lists of layers, of rows, of cells; no binary search",
        cost: "N",
        memory: "4(ny + 2nx + 2N) in 2D, 4(nz + 2ny + 2nx + 3N) in 3D",
        limits: "memory: an element so far away that nx + ny + nz exceeds the limit",
        threads: false,
        constructor: Both::<nbs2d::Nbs2d, nbs3d::Nbs3d>::boxed,
    },
    Entry {
        name: "streamed-nbs",
        role: Role::Detector,
        summary: "NBS for caches and vector registers: layers sorted by cell, two at a time, sixteen tests in one go",
        cost: "N; N log N where elements crowd in a large domain",
        memory: "about 16N in 2D, 20N in 3D, and two bundles of layers",
        limits: "cells per axis < 2^31 where elements crowd; the memory limit",
        threads: true,
        constructor: Both::<streamed::Streamed<2>, streamed::Streamed<3>>::boxed,
    },
    Entry {
        name: "cell-grid",
        role: Role::Detector,
        summary: "copies sorted by cell, rows of cells side by side",
        cost: "N + cells",
        memory: "4(nx ny [nz] + 1) + 24N in 2D, 32N in 3D",
        limits: "memory: loose packs and far-away elements are refused",
        threads: true,
        constructor: Both::<cell_grid::CellGrid<2>, cell_grid::CellGrid<3>>::boxed,
    },
    Entry {
        name: "hash-grid",
        role: Role::Detector,
        summary: "copies sorted by a hash of their cell, strips of cells side by side",
        cost: "N",
        memory: "4(B + 17) + 24N in 2D, 32N in 3D; B the power of two from N upwards",
        limits: "cells per axis < 2^31; the memory limit",
        threads: false,
        constructor: Both::<hash_grid::HashGrid<2>, hash_grid::HashGrid<3>>::boxed,
    },
    Entry {
        name: "sweep",
        role: Role::Detector,
        summary: "sorts along the longest axis, compares what overlaps along a second",
        cost: "N log N key comparisons, N^(2 - 1/D) of bounds in a box",
        memory: "32N in 2D, 40N in 3D",
        limits: "time: many elements in 3D; the memory limit",
        threads: false,
        constructor: Both::<sweep::Sweep<2>, sweep::Sweep<3>>::boxed,
    },
    Entry {
        name: "kd-tree",
        role: Role::Detector,
        summary: "halves the elements in turn at medians, boxes around halves",
        cost: "N log N",
        memory: "24N + 64L in 2D, 32N + 96L in 3D; L the power of two from N/16 upwards",
        limits: "the memory limit",
        threads: false,
        constructor: Both::<kd_tree::KdTree<2>, kd_tree::KdTree<3>>::boxed,
    },
    Entry {
        name: "bvh",
        role: Role::Detector,
        summary: "sorts along a Morton curve, boxes around neighbours on it",
        cost: "N log N",
        memory: "40N + 64L in 2D, 48N + 96L in 3D; L the power of two from N/16 upwards",
        limits: "the memory limit; clumps far from the rest are slow",
        threads: false,
        constructor: Both::<bvh::Bvh<2>, bvh::Bvh<3>>::boxed,
    },
    Entry {
        name: "nothing",
        role: Role::Nothing,
        summary: "control: does nothing, the floor of every measurement",
        cost: "0",
        memory: "0",
        limits: "finds nothing",
        threads: false,
        constructor: Both::<control::Nothing, control::Nothing>::boxed,
    },
    Entry {
        name: "nbs-twin",
        role: Role::Twin("nbs"),
        summary: "control: the same code as nbs, for the noise between equal things",
        cost: "N",
        memory: "as nbs",
        limits: "as nbs",
        threads: false,
        constructor: Both::<nbs2d::Nbs2d, nbs3d::Nbs3d>::boxed,
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

/// The line of a detector.
pub fn find(name: &str) -> Option<&'static Entry> {
    TABLE.iter().find(|entry| entry.name == name)
}

/// The names of all detectors and controls, for messages.
pub fn names() -> String {
    TABLE.iter().map(|entry| entry.name).collect::<Vec<_>>().join(", ")
}
