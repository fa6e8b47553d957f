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
