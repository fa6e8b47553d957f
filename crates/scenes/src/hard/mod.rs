//! The catalogue of hard cases: small named scenes on which detectors have been, or can be, wrong.
//!
//! Every case has a reason, a source and an expected number of contacts, known by construction or
//! from testing every pair in exact arithmetic. A case is a list of *steps*: scenes that one
//! detector gets in turn. Only the answer to the last step is judged. Earlier steps leave state in
//! the detector (group `state`), and may be refused.
//!
//! The table of all cases is `cases.md`. Each module makes the scenes of a group, except that
//! `signs` makes two, and `sizes` and `levels` share one. `build` holds their common parts.
//!
//! If ties matter, coordinates are dyadic. They use only + - * / and square roots, so that they
//! have the same bits on every machine.

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
use contactbench_terms::nearest::hint;

/// The name of a case, and the function that makes its steps in 2 or 3 dimensions.
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

/// The rows of the table that have a maker; a test checks that every row has one.
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

pub fn cases() -> impl Iterator<Item = &'static Case> {
    CASES.iter()
}

/// A scene, or a sequence of scenes, on which detectors may be wrong.
pub struct Case {
    pub name: &'static str,
    /// Heading in `cases.md`.
    pub group: &'static str,
    pub dims: &'static [u32],
    /// The error that this case provokes, and its cause.
    pub reason: &'static str,
    /// Source: project#issue, a publication, a file of a project, or "own" for this project.
    pub source: &'static str,
    pub expect: Expect,
    /// Refusals of the last step accepted in exact arithmetic with the default memory limit.
    pub allows: &'static [Allowed],
    make: fn(u32) -> Steps,
}

/// The expected answer to the last step, in exact arithmetic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expect {
    /// Number of contacts in 2D and in 3D, known by construction.
    Contacts([u64; 2]),
    /// The answer of `contactbench_detectors::oracle::truth`, or in a box
    /// `contactbench_detectors::oracle::boxes::truth`.
    Oracle,
    /// The scene is invalid: making it fails with a [`contactbench_ground::scene::SceneError`] that
    /// names the particle.
    Invalid,
}

/// A kind of [`contactbench_ground::limits::refusal::Refusal`] that is accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Allowed {
    /// [`contactbench_ground::limits::refusal::Refusal::Domain`] or
    /// [`contactbench_ground::limits::refusal::Refusal::Extent`].
    Domain,
    Memory,
}

impl Case {
    /// Parses a row of the table: name, contacts in 2D and 3D, refusals, source, reason. Returns
    /// `None` for any other line.
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

    /// Returns the scenes that one detector gets in turn, at least one. For an invalid case, the
    /// error holds the [`contactbench_ground::scene::SceneError`].
    pub fn steps(&self, dim: u32) -> anyhow::Result<Vec<Given>> {
        let (name, dims) = (self.name, self.dims);
        ensure!(
            dims.contains(&dim),
            "the hard case '{name}': dim = {dim}; it must be one of {dims:?}"
        );
        (self.make)(dim)
    }
}

/// Returns the case; the error for an unknown name has the nearest one.
pub fn find(name: &str) -> anyhow::Result<&'static Case> {
    cases().find(|case| case.name == name).ok_or_else(|| {
        let hint = hint(name, cases().map(|case| case.name));
        anyhow!("there is no hard case '{name}'{hint}; contactbench list hard-cases has all names")
    })
}

#[cfg(test)]
mod tests;
