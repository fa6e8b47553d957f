//! Compares a record with the plan of its experiment: which cells are missing or short of blocks.
//!
//! A planned cell is a subject on a scene. It is *there* if all its passes are, or if it ended
//! early. A subject that could not be started is not there.

use std::collections::{BTreeSet, HashMap};
use std::path::Path;

use crate::cells::label::{place, varying};
use crate::cells::select::may_match;
use crate::cells::{Cell, CellId};
use crate::experiment::{Claim, ClaimKind, Experiment, Planned};
use crate::findings::claim::every;
use crate::record::folder::done::FILE;
use crate::record::id::Projection;
use crate::record::role::Role;
use crate::record::row::{Outcome, Pass};

struct PlannedCell<'a> {
    id: CellId,
    control: bool,
    cell: Option<&'a Cell>,
}

pub struct Coverage<'a> {
    experiment: &'a Experiment,
    planned: Vec<PlannedCell<'a>>,
    /// Number of planned scenes.
    pub scenes: usize,
    /// Number of measured scenes that are not in the plan.
    pub outside: usize,
    /// Number of cells of twins, which every run adds to measure the noise.
    pub twins: usize,
}

/// The planned cells that a record or a claim lacks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gaps {
    pub of: usize,
    /// The place of each missing cell.
    pub missing: Vec<String>,
    /// Number of other cells with fewer blocks than any time budget allows.
    pub cut: usize,
    /// Number of cells with fewer blocks than planned.
    pub short: usize,
}

impl Gaps {
    pub fn is_none(&self) -> bool {
        self.missing.is_empty() && self.cut == 0
    }
}

impl<'a> Coverage<'a> {
    pub fn new(experiment: &'a Experiment, own: &[&'a Cell]) -> Coverage<'a> {
        let plan = &experiment.planned;
        let mut known: HashMap<CellId, Vec<&Cell>> = HashMap::new();
        for cell in own {
            for open in [false, true] {
                known.entry(key(plan, &cell.id, open)).or_default().push(cell);
            }
        }
        let beside = own.iter().any(|cell| matches!(cell.role, Role::Base(_)));
        let (mut planned, mut met, mut scenes) = (Vec::new(), BTreeSet::new(), BTreeSet::new());
        for scene in &plan.scenes {
            let subjects = plan.subjects.iter();
            for subject in subjects.filter(|subject| !beside || subject.is_of_builds()) {
                let (id, open) = (subject.cell(scene), subject.arithmetic.is_none());
                scenes.insert(every::key(&id));
                let cells = known.get(&key(plan, &id, open)).into_iter().flatten();
                // If there are several machines, a measurement on one of them is enough.
                let same = cells.filter(|cell| same_file(&id, &cell.id));
                let cell = same.max_by_key(|cell| cell.times.len()).copied();
                let id = cell.map_or(id, |cell| cell.id.clone());
                met.insert(scene_of(plan, &id));
                planned.push(PlannedCell { id, control: subject.role.is_control(), cell });
            }
        }
        let there: BTreeSet<&CellId> = planned.iter().map(|planned| &planned.id).collect();
        let measured: BTreeSet<Projection> =
            own.iter().map(|cell| scene_of(plan, &cell.id)).collect();
        let extra = |cell: &&&Cell| {
            let of_plan = !there.contains(&cell.id) && met.contains(&scene_of(plan, &cell.id));
            matches!(cell.role, Role::Twin(_)) && of_plan
        };
        let (twins, outside) =
            (own.iter().filter(extra).count(), measured.difference(&met).count());
        Coverage { experiment, planned, scenes: scenes.len(), outside, twins }
    }

    /// Returns what the record lacks of the plan.
    pub fn gaps(&self) -> Gaps {
        let all: Vec<&PlannedCell> = self.planned.iter().collect();
        self.lacking(&all, &[Pass::Count, Pass::Memory], true)
    }

    /// Returns what a claim lacks; `None` if all its cells are there.
    pub fn uncovered(&self, claim: &Claim) -> Option<Gaps> {
        let passes = match &claim.kind {
            ClaimKind::Faster { .. } => vec![Pass::Time],
            kind => kind.sides().iter().flat_map(|side| side.passes()).collect(),
        };
        let found = self.lacking(&self.about(claim), &passes, passes.contains(&Pass::Time));
        Some(found).filter(|found| !found.is_none())
    }

    fn lacking(&self, cells: &[&PlannedCell<'_>], passes: &[Pass], timed: bool) -> Gaps {
        let ids: Vec<Cell> =
            cells.iter().map(|it| Cell { id: it.id.clone(), ..Cell::default() }).collect();
        let fields = varying(&ids.iter().collect::<Vec<_>>());
        let mut gaps = Gaps { of: cells.len(), ..Gaps::default() };
        for planned in cells {
            let (plan, enough) = (self.experiment.blocks, self.experiment.enough_blocks(false));
            match planned.cell.filter(|cell| is_there(cell, passes)) {
                None => gaps.missing.push(place(&planned.id, &fields)),
                Some(cell) if timed && !cell.ended && !cell.overall().0.is_final() => {
                    gaps.short += usize::from(cell.times.len() < plan as usize);
                    gaps.cut += usize::from(cell.times.len() < enough as usize);
                }
                Some(_) => {}
            }
        }
        gaps
    }

    fn about(&self, claim: &Claim) -> Vec<&PlannedCell<'a>> {
        let named = claim.filter.contains_key("detector");
        let meant = |planned: &&PlannedCell<'_>| {
            may_match(&planned.id, &claim.filter) && (named || !planned.control)
        };
        let place = |id: &CellId| id.clone().anywhere().without(&["detector"]);
        let places: BTreeSet<Projection> =
            self.planned.iter().filter(meant).map(|planned| place(&planned.id)).collect();
        let than = claim.kind.than();
        let flat = |id: &CellId| {
            (id.scene.clone(), id.n, id.seed, than.map_or_else(|| id.subject(), String::from))
        };
        let flats: BTreeSet<_> =
            self.planned.iter().filter(meant).map(|planned| flat(&planned.id)).collect();
        let other = |id: &CellId| match claim.kind.than_dim() {
            Some(dim) => {
                let of = than.is_none_or(|than| id.subject() == than);
                id.dim == dim && of && flats.contains(&flat(id))
            }
            None => than == Some(&*id.subject()) && places.contains(&place(id)),
        };
        self.planned.iter().filter(|planned| meant(planned) || other(&planned.id)).collect()
    }
}

/// Whether a cell has these passes, or ended early. Times are counted by blocks instead.
fn is_there(cell: &Cell, passes: &[Pass]) -> bool {
    match cell.overall().0 {
        Outcome::Unavailable => false,
        outcome if outcome.is_final() => true,
        _ => passes.iter().all(|pass| *pass == Pass::Time || cell.passes.contains_key(pass)),
    }
}

/// The common key of a planned cell and its measurement. Files and hard cases determine their own
/// n; if `open`, the arithmetic is not known in advance.
fn key(plan: &Planned, id: &CellId, open: bool) -> CellId {
    let mut key = id.clone().anywhere();
    if open {
        key.arithmetic.clear();
    }
    if plan.own_n.contains(&id.scene) {
        key.n = 0;
    }
    if id.scene == FILE {
        key.dim = 0;
    }
    for name in FILES {
        if let Some(path) = key.params.get(name).map(ToString::to_string) {
            let file = Path::new(&path).file_name().unwrap_or_default().to_string_lossy();
            key.params.insert(name.into(), (&*file).into());
        }
    }
    key
}

const FILES: [&str; 2] = ["path", "grading"];

/// Compares a path relative to the experiment with the path that was opened.
fn same_file(planned: &CellId, measured: &CellId) -> bool {
    FILES.iter().all(|&name| {
        let path = |id: &CellId| id.params.get(name).map(ToString::to_string).unwrap_or_default();
        let (planned, measured) = (path(planned), path(measured));
        Path::new(&measured).ends_with(planned.trim_start_matches("./"))
    })
}

fn scene_of(plan: &Planned, id: &CellId) -> Projection {
    key(plan, id, false).scene_id()
}
