//! The hard-case catalogue: small named scenes on which detectors have been, or can be, wrong.
//!
//! Every case says what breaks on it and why, where it comes from, and what the right answer is:
//! the number of contacts where the construction tells it, else what testing every pair in exact
//! arithmetic gives. A case is a list of *steps*: scenes that one detector is given one after the
//! other. The last step is judged; those before it leave something behind (group `state`), and may
//! be refused.
//!
//! The table of all cases is `cases.md`; the modules make their scenes, one for each group, but
//! `signs` holds two, and sizes fill `sizes` and `levels`; `build` has what they share.
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

use std::sync::LazyLock;

use anyhow::{anyhow, ensure};
use build::Steps;

use contactbench_io::Given;

/// The name of a case, and what makes its steps in 2 or 3 dimensions.
type Maker = (&'static str, fn(u32) -> Steps);

static MAKERS: [&[Maker]; 13] = [
    borders::MAKERS,
    tangent::MAKERS,
    signs::MAKERS,
    edges::MAKERS,
    extremes::MAKERS,
    keys::MAKERS,
    degenerate::MAKERS,
    sizes::MAKERS,
    levels::MAKERS,
    crowds::MAKERS,
    clusters::MAKERS,
    state::MAKERS,
    boxes::MAKERS,
];

/// The table's rows that have a maker; a test holds that none lacks one.
static CASES: LazyLock<Vec<Case>> = LazyLock::new(|| {
    let mut group = None;
    let case = |line: &'static str| {
        if let Some(name) = line.strip_prefix("## ") {
            group = Some(name);
        }
        Case::of_row(group?, line)
    };
    include_str!("cases.md").lines().filter_map(case).collect()
});

/// All cases, group by group.
pub fn cases() -> impl Iterator<Item = &'static Case> {
    CASES.iter()
}

/// A scene, or a history of scenes, on which detectors go wrong.
pub struct Case {
    /// The name, in words joined by `-`.
    pub name: &'static str,
    /// Kind of difficulty, one of [`GROUPS`].
    pub group: &'static str,
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
    /// What [`contactbench_core::oracle::truth`] says, or in a box
    /// [`contactbench_core::periodic::truth()`].
    Oracle,
    /// There is no scene: it is refused with a [`contactbench_core::scene::SceneError`] that names
    /// the particle.
    Invalid,
}

/// A kind of [`contactbench_core::detect::Refusal`] that is no fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Allowed {
    /// [`contactbench_core::detect::Refusal::Domain`] or
    /// [`contactbench_core::detect::Refusal::Extent`].
    Domain,
    /// [`contactbench_core::detect::Refusal::Memory`].
    Memory,
}

/// The kinds of difficulty, in the order of the catalogue.
pub const GROUPS: [&str; 13] = [
    "borders",
    "tangent",
    "signs",
    "zeros",
    "edges",
    "extremes",
    "keys",
    "degenerate",
    "sizes",
    "crowds",
    "clusters",
    "state",
    "boxes",
];

impl Case {
    /// A row of the table: name, contacts in 2D and in 3D, refusals, source, reason. None of a line
    /// that is no such row.
    fn of_row(group: &'static str, line: &'static str) -> Option<Case> {
        let cells: Vec<&'static str> = line.split('|').map(str::trim).collect();
        let &["", name, plane, space, allows, source, reason, ""] = &cells[..] else { return None };
        let &(_, make) = MAKERS.into_iter().flatten().find(|(known, _)| *known == name)?;
        let dims: &[u32] = match (plane, space) {
            ("-", _) => &[3],
            (_, "-") => &[2],
            _ => &[2, 3],
        };
        let expect = match if plane == "-" { space } else { plane } {
            "invalid" => Expect::Invalid,
            "oracle" => Expect::Oracle,
            _ => Expect::Contacts([plane, space].map(|count| count.parse().unwrap_or(0))),
        };
        let allows: &[Allowed] = match allows {
            "domain" => &[Allowed::Domain],
            "memory" => &[Allowed::Memory],
            _ => &[],
        };
        let source = if source.is_empty() { "own" } else { source };
        Some(Case { name, group, dims, reason, source, expect, allows, make })
    }

    /// The scenes that one detector is given one after the other: at least one. An invalid case
    /// gives an error that holds the [`contactbench_core::scene::SceneError`].
    pub fn steps(&self, dim: u32) -> anyhow::Result<Vec<Given>> {
        ensure!(
            self.dims.contains(&dim),
            "the hard case '{}' is made in {} only, not in {dim}",
            self.name,
            self.dims
                .iter()
                .map(|dim| format!("{dim} dimensions"))
                .collect::<Vec<_>>()
                .join(" and ")
        );
        (self.make)(dim)
    }
}

/// The case of that name; the error names the nearest ones.
pub fn find(name: &str) -> anyhow::Result<&'static Case> {
    cases().find(|case| case.name == name).ok_or_else(|| {
        let far = |case: &str| (!case.contains(name), strsim::levenshtein(case, name));
        let mut near: Vec<&str> = cases().map(|case| case.name).collect();
        near.sort_unstable();
        near.sort_by_key(|case| far(case));
        near.truncate(3);
        anyhow!(
            "there is no hard case '{name}'; the nearest names are {} (contactbench list \
             hard-cases)",
            near.join(", ")
        )
    })
}

#[cfg(test)]
mod tests;
