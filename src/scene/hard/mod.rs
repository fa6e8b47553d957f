//! The hard-case catalogue: small named scenes on which detectors have been, or can be, wrong.
//!
//! Every case says what breaks on it and why, where it comes from, and what the right answer is:
//! the number of contacts where the construction tells it, else what testing every pair in exact
//! arithmetic gives. A case is a list of *steps*: scenes that one detector is given one after the
//! other. The last step is judged; those before it leave something behind (group `state`), and may
//! be refused. One file per group, but `signs` holds two, and sizes fill `sizes` and `levels`;
//! `build` has what they share.
//!
//! Coordinates are dyadic wherever ties matter, and made with + - * / and square roots only: the
//! same bits on every machine.

mod borders;
mod boxes;
mod build;
mod clusters;
mod crowds;
mod degenerate;
mod edges;
mod extremes;
mod keys;
mod levels;
mod signs;
mod sizes;
mod state;
mod tangent;

use anyhow::{anyhow, ensure};
use build::Steps;

use crate::scene::Given;

/// The cases of each file, in the order of the groups.
static FILES: [&[Case]; 13] = [
    borders::CASES,
    tangent::CASES,
    signs::CASES,
    edges::CASES,
    extremes::CASES,
    keys::CASES,
    degenerate::CASES,
    sizes::CASES,
    levels::CASES,
    crowds::CASES,
    clusters::CASES,
    state::CASES,
    boxes::CASES,
];

/// All cases, group by group.
pub fn cases() -> impl Iterator<Item = &'static Case> {
    FILES.into_iter().flatten()
}

/// A scene, or a history of scenes, on which detectors go wrong.
pub struct Case {
    /// The name, in words joined by `-`.
    pub name: &'static str,
    /// What kind of difficulty it is.
    pub group: Group,
    /// The dimensions in which it is made.
    pub dims: &'static [u32],
    /// What breaks here, and why.
    pub reason: &'static str,
    /// Where it comes from: project#issue, a publication, a file here, or "own".
    pub source: &'static str,
    /// The right answer.
    pub expect: Expect,
    /// How a detector may refuse the last step in exact arithmetic, with the default memory limit.
    pub allows: &'static [Allowed],
    make: fn(u32) -> Steps,
}

/// The right answer to the last step, in exact arithmetic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expect {
    /// This number of contacts in 2D and in 3D, known by construction.
    Contacts([u64; 2]),
    /// What [`crate::oracle::truth`] says, or in a box [`crate::periodic::truth()`].
    Oracle,
    /// There is no scene: it is refused with a [`crate::scene::SceneError`] that names the
    /// particle.
    Invalid,
}

/// A kind of [`crate::detect::Refusal`] that is no fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Allowed {
    /// [`crate::detect::Refusal::Domain`] or [`crate::detect::Refusal::Extent`].
    Domain,
    /// [`crate::detect::Refusal::Memory`].
    Memory,
}

/// The kinds of difficulty.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Group {
    /// Centres on cell borders, couples across them.
    Borders,
    /// Bodies that exactly touch, and one step to either side.
    Tangent,
    /// Negative coordinates.
    Signs,
    /// Zeros of both signs, and numbers that are nearly zero.
    Zeros,
    /// The edge of the domain.
    Edges,
    /// Very large and very small numbers, large offsets.
    Extremes,
    /// Cell numbers that overflow or collide.
    Keys,
    /// Invalid numbers; none, one and two particles; points, lines and planes.
    Degenerate,
    /// Very different radii.
    Sizes,
    /// Very many particles in one cell.
    Crowds,
    /// Uneven distributions and input orders.
    Clusters,
    /// What an earlier detection left behind.
    State,
    /// Boxes that repeat.
    Boxes,
}

impl Group {
    /// All groups, in the order of the catalogue.
    pub const ALL: [Group; 13] = [
        Group::Borders,
        Group::Tangent,
        Group::Signs,
        Group::Zeros,
        Group::Edges,
        Group::Extremes,
        Group::Keys,
        Group::Degenerate,
        Group::Sizes,
        Group::Crowds,
        Group::Clusters,
        Group::State,
        Group::Boxes,
    ];

    /// The name in lists.
    pub fn name(self) -> &'static str {
        match self {
            Group::Borders => "borders",
            Group::Tangent => "tangent",
            Group::Signs => "signs",
            Group::Zeros => "zeros",
            Group::Edges => "edges",
            Group::Extremes => "extremes",
            Group::Keys => "keys",
            Group::Degenerate => "degenerate",
            Group::Sizes => "sizes",
            Group::Crowds => "crowds",
            Group::Clusters => "clusters",
            Group::State => "state",
            Group::Boxes => "boxes",
        }
    }
}

impl Case {
    /// A case of the group with what most cases have; name, reason and maker are missing.
    const fn in_group(group: Group) -> Case {
        Case {
            name: "",
            group,
            dims: &[2, 3],
            reason: "",
            source: "own",
            expect: Expect::Oracle,
            allows: &[],
            make: |dim| build::uniform(dim, &[], 0.5),
        }
    }

    /// The scenes that one detector is given one after the other: at least one. An invalid case
    /// gives an error that holds the [`crate::scene::SceneError`].
    pub fn steps(&self, dim: u32) -> anyhow::Result<Vec<Given>> {
        let dims = || {
            self.dims
                .iter()
                .map(|dim| format!("{dim} dimensions"))
                .collect::<Vec<_>>()
                .join(" and ")
        };
        ensure!(
            self.dims.contains(&dim),
            "the hard case '{}' is made in {} only, not in {dim}",
            self.name,
            dims()
        );
        (self.make)(dim)
    }
}

/// The case of that name; the error names the nearest ones.
pub fn find(name: &str) -> anyhow::Result<&'static Case> {
    cases().find(|case| case.name == name).ok_or_else(|| {
        let mut near: Vec<_> = cases()
            .map(|case| {
                (!case.name.contains(name), strsim::levenshtein(case.name, name), case.name)
            })
            .collect();
        near.sort_unstable();
        let near: Vec<&str> = near.iter().take(3).map(|(.., name)| *name).collect();
        anyhow!(
            "there is no hard case '{name}'; the nearest names are {} (contactbench list \
             hard-cases)",
            near.join(", ")
        )
    })
}

#[cfg(test)]
mod tests;
