//! Cells without a right answer: who, where, how it ended, and why.

use std::collections::{BTreeMap, BTreeSet};

use crate::cells::series::Line;
use crate::cells::{Cell, label, series};
use crate::record::row::Outcome;

/// What a detector failed to do on a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// The contender.
    pub name: String,
    /// The scene and its dimension.
    pub scene: String,
    /// How it ended.
    pub outcome: Outcome,
    /// At these N.
    pub sizes: BTreeSet<u64>,
    /// The first reason.
    pub reason: String,
    /// How many other reasons there are.
    pub more: usize,
}

/// A contender that is wrong, or one of ours that crashed.
#[derive(Clone, Debug, PartialEq)]
pub struct Culprit {
    /// The contender.
    pub name: String,
    /// Wrong or crashed.
    pub outcome: Outcome,
    /// In so many cells.
    pub cells: usize,
    /// The first of them.
    pub first: String,
    /// Why, there.
    pub reason: String,
}

/// Each that gave a wrong answer, once, then each of ours that crashed.
pub fn culprits(cells: &[&Cell]) -> Vec<Culprit> {
    let mut found: BTreeMap<(bool, String), Culprit> = BTreeMap::new();
    for cell in cells {
        let (outcome, reason) = cell.overall();
        let wrong = outcome == Outcome::Wrong;
        if !(wrong || outcome == Outcome::Crashed && cell.role.is_ours()) {
            continue;
        }
        let name = series::label(&Line::new(cell), cells);
        let fields = ["experiment", "scene", "dim", "n", "seed"].map(String::from);
        let new = || Culprit {
            name: name.clone(),
            outcome,
            cells: 0,
            first: label::place(&cell.id, &fields),
            reason: reason.to_string(),
        };
        found.entry((!wrong, name.clone())).or_insert_with(new).cells += 1;
    }
    found.into_values().collect()
}

/// One per contender, scene and outcome.
pub fn failures(cells: &[&Cell]) -> Vec<Failure> {
    // name, scene, outcome: N and reason
    type Found<'a> = BTreeMap<(String, String, Outcome), Vec<(u64, &'a str)>>;
    let mut found: Found = BTreeMap::new();
    for cell in cells {
        let (outcome, reason) = cell.overall();
        if !outcome.is_good() {
            let scene = format!("{} {}D", label::scene(&cell.id), cell.id.dim);
            let name = series::label(&Line::new(cell), cells);
            found.entry((name, scene, outcome)).or_default().push((cell.id.n, reason));
        }
    }
    let failure = |((name, scene, outcome), found): (_, Vec<(u64, &str)>)| {
        let reasons: BTreeSet<&str> = found.iter().map(|(_, reason)| *reason).collect();
        Failure {
            name,
            scene,
            outcome,
            sizes: found.iter().map(|(n, _)| *n).collect(),
            reason: found.first().map_or("", |first| first.1).into(),
            more: reasons.len().saturating_sub(1),
        }
    };
    found.into_iter().map(failure).collect()
}
