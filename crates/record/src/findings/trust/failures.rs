//! Cells without a correct answer.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

use crate::cells::series::Line;
use crate::cells::{Cell, CellId, label, series};
use crate::experiment::Experiment;
use crate::record::row::Outcome;

/// The cells of one detector on one scene that ended alike: n and reason of each.
pub type Failure<'a> = ((String, String, Outcome), Vec<(u64, &'a str)>);

#[derive(Clone, Debug, PartialEq)]
pub struct Culprit {
    pub name: String,
    pub outcome: Outcome,
    pub id: CellId,
    pub cells: usize,
    pub of: usize,
    /// Wrong pairs in the worst cell; 0 if they were not counted.
    pub wrong_pairs: u64,
    pub worst: String,
    pub reason: String,
}

/// Subjects that gave a wrong answer, crashed (foreign code: in all cells) or could not be started.
/// Optional runners that could not be started are in `absent`, all others in `all`.
#[derive(Debug, Default)]
pub struct Culprits {
    pub all: Vec<Culprit>,
    pub absent: Vec<Culprit>,
}

impl Culprits {
    pub fn new(cells: &[&Cell], experiments: &[Experiment]) -> Culprits {
        let runner = |culprit: &Culprit| {
            let own = experiments.iter().filter(|it| it.name == culprit.id.experiment);
            own.flat_map(|it| &it.runners).find(|it| it.name == culprit.id.subject())
        };
        let ours = |culprit: &Culprit| {
            cells.iter().any(|cell| cell.id == culprit.id && cell.role.is_ours())
        };
        let (mut all, mut absent) = (Vec::new(), Vec::new());
        for culprit in culprits(cells) {
            match runner(&culprit) {
                _ if culprit.outcome != Outcome::Unavailable => all.push(culprit),
                Some(known) if known.is_optional() => absent.push(culprit),
                Some(_) => all.push(culprit),
                None if ours(&culprit) => all.push(culprit),
                None => {}
            }
        }
        Culprits { all, absent }
    }
}

fn culprits(cells: &[&Cell]) -> Vec<Culprit> {
    let line = |cell: &Cell| (cell.id.experiment.clone(), cell.id.subject(), cell.id.threads());
    let mut ends: BTreeMap<(String, String, u32), BTreeSet<Outcome>> = BTreeMap::new();
    for cell in cells {
        ends.entry(line(cell)).or_default().insert(cell.overall().0);
    }
    let everywhere = |cell: &Cell| ends.get(&line(cell)).is_some_and(|ends| ends.len() == 1);
    let mut found: BTreeMap<(u8, String), Culprit> = BTreeMap::new();
    for cell in cells {
        let (outcome, reason) = cell.overall();
        let rank = match outcome {
            Outcome::Wrong => 0,
            Outcome::Crashed if cell.role.is_ours() || everywhere(cell) => 1,
            Outcome::Unavailable if everywhere(cell) => 2,
            _ => continue,
        };
        let name = cell.id.subject();
        let fields = ["experiment", "arithmetic", "scene", "dim", "n", "seed"].map(String::from);
        let wrong_pairs = cell.errors.map_or(0, |errors| errors.wrong());
        let new = || Culprit {
            name: name.clone(),
            id: cell.id.clone(),
            outcome,
            cells: 0,
            of: cells.iter().filter(|other| other.id.subject() == name).count(),
            wrong_pairs,
            worst: label::place(&cell.id, &fields),
            reason: reason.to_string(),
        };
        let known = found.entry((rank, name.clone())).or_insert_with(new);
        known.cells += 1;
        if wrong_pairs > known.wrong_pairs {
            known.wrong_pairs = wrong_pairs;
            known.worst = label::place(&cell.id, &fields);
            known.reason = reason.to_string();
        }
    }
    let mut found: Vec<((u8, String), Culprit)> = found.into_iter().collect();
    found.sort_by_key(|((rank, _), culprit)| (*rank, Reverse(culprit.wrong_pairs)));
    found.into_iter().map(|(_, culprit)| culprit).collect()
}

pub fn failures<'a>(cells: &[&'a Cell]) -> Vec<Failure<'a>> {
    let mut found: BTreeMap<_, Vec<_>> = BTreeMap::new();
    let called = series::labels(cells);
    for cell in cells {
        let (outcome, reason) = cell.overall();
        if !outcome.is_good() {
            let scene = format!("{} {}D", label::scene(&cell.id), cell.id.dim);
            let name = called(&Line::new(cell));
            found.entry((name, scene, outcome)).or_default().push((cell.id.n, reason));
        }
    }
    Vec::from_iter(found)
}
