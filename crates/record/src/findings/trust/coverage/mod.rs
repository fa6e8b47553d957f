//! Compares a record with the plan of its experiment: which cells are missing or short, and why.
//!
//! A planned cell is a subject on a scene. It is *there* if all its passes are, or if it ended
//! early. It is *short* if it has fewer blocks than planned. A subject that could not be started is
//! not there.

mod same;

use std::collections::{BTreeMap, BTreeSet, HashMap};

use same::{key, same_file, scene};
use serde_json::Value;

use crate::cells::label::varying;
use crate::cells::select::may_match;
use crate::cells::{AxisValue, Cell, CellId};
use crate::experiment::shard::Shard;
use crate::experiment::{Claim, ClaimKind, Experiment};
use crate::findings::claim::every;
use crate::record::id::Projection;
use crate::record::role::Role;
use crate::record::row::{Outcome, Pass};

contactbench_terms::named! {
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
    pub enum Why {
        Stopped = "run in part",
        Quick = "quick run",
        Shard = "other shard",
        NotMerged = "not merged",
        Budget = "budget",
        Unavailable = "unavailable",
    }
}

/// The part of the plan that a run covered, from its provenance.
#[derive(Default)]
pub struct Scope<'a> {
    quick: bool,
    shard: bool,
    merged: bool,
    taken: BTreeSet<(&'a str, usize)>,
}

impl<'a> Scope<'a> {
    /// The `experiments` must be in the order in which they were run.
    pub fn new(provenance: Option<&Value>, experiments: &'a [Experiment]) -> Scope<'a> {
        let field = |name: &str| provenance.and_then(|fields| fields.get(name));
        let quick = field("quick").and_then(Value::as_bool).unwrap_or(false);
        let shard = field("shard").and_then(Value::as_str).and_then(|text| text.parse().ok());
        let scenes = || {
            experiments.iter().flat_map(|experiment| {
                let plan = experiment.planned.scenes(quick).iter().enumerate();
                plan.map(|(k, scene)| (&*experiment.name, k, scene.n))
            })
        };
        let taken = shard.map(|shard: Shard| {
            let takes = shard.takes(&scenes().map(|scene| scene.2).collect::<Vec<_>>());
            let taken = scenes().zip(takes).filter(|(_, taken)| *taken);
            taken.map(|((name, k, _), _)| (name, k)).collect()
        });
        Scope {
            quick,
            shard: shard.is_some(),
            merged: field("merged_from").is_some(),
            taken: taken.unwrap_or_default(),
        }
    }

    fn why(&self, experiment: &Experiment, scene: &CellId, begun: bool) -> Why {
        let run = experiment.planned.scenes(self.quick);
        let place = run.iter().position(|known| known == scene);
        match place {
            None if self.quick => Why::Quick,
            Some(k) if self.shard && !self.taken.contains(&(&*experiment.name, k)) => Why::Shard,
            _ if self.merged && !begun => Why::NotMerged,
            _ => Why::Stopped,
        }
    }
}

struct Planned<'a> {
    id: CellId,
    control: bool,
    scene: usize,
    cell: Option<&'a Cell>,
    why: Why,
}

pub struct Coverage<'a> {
    experiment: &'a Experiment,
    planned: Vec<Planned<'a>>,
    quick: bool,
    /// Number of measured scenes that are not in the plan.
    outside: usize,
    twins: usize,
    unavailable: BTreeMap<String, String>,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Summary {
    pub experiment: String,
    /// Number of complete planned scenes, ignoring unavailable subjects, and of all planned scenes.
    pub scenes: [usize; 2],
    /// Number of planned cells that are there, and of all planned cells.
    pub cells: [usize; 2],
    pub missing: BTreeMap<Why, usize>,
    pub short: BTreeMap<Why, Short>,
    pub blocks: u32,
    pub outside: usize,
    /// Number of cells of twins, which every run adds to measure the noise.
    pub twins: usize,
    /// Subjects that could not be started: name and reason.
    pub unavailable: BTreeMap<String, String>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Short {
    pub cells: usize,
    pub blocks: [usize; 2],
}

#[derive(Clone, Debug, PartialEq)]
pub struct Uncovered {
    /// Number of missing cells; for claims about times, short cells are included.
    pub cells: usize,
    pub of: usize,
    /// The axes that distinguish the missing cells from others.
    pub gaps: Vec<Gap>,
    pub why: BTreeMap<Why, usize>,
    pub unavailable: BTreeSet<String>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Gap {
    pub name: String,
    /// Values of this axis for which a cell is missing, ascending.
    pub missing: Vec<AxisValue>,
    pub planned: Vec<AxisValue>,
}

impl<'a> Coverage<'a> {
    pub fn new(experiment: &'a Experiment, own: &[&'a Cell], scope: &Scope<'_>) -> Coverage<'a> {
        let plan = &experiment.planned;
        let mut known: HashMap<CellId, Vec<&Cell>> = HashMap::new();
        for cell in own {
            for open in [false, true] {
                known.entry(key(plan, &cell.id, open)).or_default().push(cell);
            }
        }
        let beside = own.iter().any(|cell| matches!(cell.role, Role::Base(_)));
        let scenes: BTreeSet<Projection> = own.iter().map(|cell| scene(plan, &cell.id)).collect();
        let (mut planned, mut met) = (Vec::new(), BTreeSet::new());
        let mut numbers: HashMap<Projection, usize> = HashMap::new();
        for place in &plan.scenes {
            let subjects = plan.subjects.iter();
            for subject in subjects.filter(|subject| !beside || subject.is_of_builds()) {
                let (id, open) = (subject.cell(place), subject.arithmetic.is_none());
                let next = numbers.len();
                let number = *numbers.entry(every::key(&id)).or_insert(next);
                let same = |cell: &&&Cell| same_file(&id, &cell.id);
                let cells = known.get(&key(plan, &id, open)).into_iter().flatten();
                // If there are several machines, a measurement on one of them is enough.
                let cell = cells.filter(same).max_by_key(|cell| cell.times.len()).copied();
                let found = scene(plan, cell.map_or(&id, |cell| &cell.id));
                let begun = scenes.contains(&found);
                met.insert(found);
                let why = scope.why(experiment, place, begun);
                let id = cell.map_or(id, |cell| cell.id.clone());
                let control = subject.role.is_control();
                planned.push(Planned { id, control, scene: number, cell, why });
            }
        }
        let outside = scenes.difference(&met).count();
        let unavailable = unavailable(own);
        for planned in planned.iter_mut().filter(|planned: &&mut Planned| planned.cell.is_none()) {
            // A subject that could not start in other scenes is reported as unavailable in scenes
            // that were not run, too.
            if unavailable.contains_key(&planned.id.subject()) {
                planned.why = Why::Unavailable;
            }
        }
        let there: BTreeSet<&CellId> =
            planned.iter().filter_map(|planned| Some(&planned.cell?.id)).collect();
        let extra = |cell: &&&Cell| {
            matches!(cell.role, Role::Twin(_))
                && !there.contains(&cell.id)
                && met.contains(&scene(plan, &cell.id))
        };
        let twins = own.iter().filter(extra).count();
        Coverage { experiment, planned, quick: scope.quick, outside, twins, unavailable }
    }

    pub fn summary(&self) -> Summary {
        let (mut missing, mut short) = (BTreeMap::new(), BTreeMap::<Why, Short>::new());
        let mut broken = BTreeSet::new();
        for planned in &self.planned {
            if let Some(why) = self.missing(planned, &[Pass::Count, Pass::Memory]) {
                *missing.entry(why).or_default() += 1;
                if why != Why::Unavailable {
                    broken.insert(planned.scene);
                }
            } else if let Some((why, blocks)) = self.short(planned, self.experiment.blocks) {
                let known = short.entry(why).or_insert(Short { cells: 0, blocks: [blocks; 2] });
                let [low, high] = known.blocks;
                known.blocks = [low.min(blocks), high.max(blocks)];
                known.cells += 1;
            }
        }
        let scenes: BTreeSet<usize> = self.planned.iter().map(|planned| planned.scene).collect();
        let (all, gone) = (self.planned.len(), missing.values().sum::<usize>());
        Summary {
            experiment: self.experiment.name.clone(),
            scenes: [scenes.len() - broken.len(), scenes.len()],
            cells: [all - gone, all],
            missing,
            short,
            blocks: self.experiment.blocks,
            outside: self.outside,
            twins: self.twins,
            unavailable: self.unavailable.clone(),
        }
    }

    pub fn uncovered(&self, claim: &Claim) -> Option<Uncovered> {
        let about = self.about(claim);
        let passes = passes(claim);
        let lacks = |planned: &&Planned<'_>| -> Option<Why> {
            let timed = passes.contains(&Pass::Time);
            let enough = self.experiment.enough_blocks(false);
            let short = || Some(self.short(planned, enough)?.0).filter(|_| timed);
            self.missing(planned, &passes).or_else(short)
        };
        let (mut why, mut unavailable) = (BTreeMap::new(), BTreeSet::new());
        let mut gone = Vec::new();
        for planned in &about {
            if let Some(reason) = lacks(planned) {
                *why.entry(reason).or_default() += 1;
                if reason == Why::Unavailable {
                    unavailable.insert(planned.id.subject());
                }
                gone.push(*planned);
            }
        }
        if gone.is_empty() {
            return None;
        }
        let cells = |all: &[&Planned<'_>]| -> Vec<Cell> {
            let cell = |planned: &&Planned<'_>| Cell { id: planned.id.clone(), ..Cell::default() };
            all.iter().map(cell).collect()
        };
        let (all, gone) = (cells(&about), cells(&gone));
        let values = |cells: &[Cell], name: &str| -> Vec<AxisValue> {
            let values: BTreeSet<AxisValue> = cells
                .iter()
                .filter_map(|cell| match name {
                    "detector" => Some(cell.id.subject().as_str().into()),
                    _ => cell.id.axis(name),
                })
                .collect();
            values.into_iter().collect()
        };
        let gap = |name: String| {
            let (missing, planned) = (values(&gone, &name), values(&all, &name));
            (missing.len() < planned.len()).then_some(Gap { name, missing, planned })
        };
        let gaps = varying(&all.iter().collect::<Vec<_>>()).into_iter().filter_map(gap).collect();
        Some(Uncovered { cells: gone.len(), of: all.len(), gaps, why, unavailable })
    }

    fn about(&self, claim: &Claim) -> Vec<&Planned<'a>> {
        let named = claim.filter.contains_key("detector");
        let meant = |planned: &&Planned<'_>| {
            may_match(&planned.id, &claim.filter) && (named || !planned.control)
        };
        let place = |id: &CellId| id.clone().anywhere().without(&["detector"]);
        let places: BTreeSet<Projection> =
            self.planned.iter().filter(meant).map(|planned| place(&planned.id)).collect();
        let than = claim.kind.than();
        let other = |id: &CellId| than == Some(&*id.subject()) && places.contains(&place(id));
        self.planned.iter().filter(|planned| meant(planned) || other(&planned.id)).collect()
    }

    /// Returns why a cell lacks one of these passes; `None` if it has them.
    fn missing(&self, planned: &Planned<'_>, needed: &[Pass]) -> Option<Why> {
        let Some(cell) = planned.cell else { return Some(planned.why) };
        match cell.overall().0 {
            Outcome::Unavailable => Some(Why::Unavailable),
            outcome if outcome.is_final() => None,
            _ => {
                let mut others = needed.iter().filter(|pass| **pass != Pass::Time);
                let absent = others.any(|pass| !cell.passes.contains_key(pass));
                absent.then_some(planned.why)
            }
        }
    }

    fn short(&self, planned: &Planned<'_>, blocks: u32) -> Option<(Why, usize)> {
        let cell = planned.cell.filter(|cell| !cell.ended && !cell.overall().0.is_final())?;
        let found = cell.times.len();
        if found >= blocks as usize {
            return None;
        }
        let run = |blocks: u32| found >= blocks as usize;
        Some(match planned.why {
            _ if self.quick && run(self.experiment.all_blocks(true)) => (Why::Quick, found),
            _ if run(self.experiment.enough_blocks(false)) => (Why::Budget, found),
            Why::NotMerged | Why::Quick | Why::Shard => (Why::Stopped, found),
            why => (why, found),
        })
    }
}

fn unavailable(own: &[&Cell]) -> BTreeMap<String, String> {
    let started = |cell: &&&Cell| cell.overall().0 != Outcome::Unavailable;
    let known: BTreeSet<String> = own.iter().filter(started).map(|it| it.id.subject()).collect();
    let mut found = BTreeMap::new();
    for cell in own.iter().filter(|cell| !known.contains(&cell.id.subject())) {
        found.entry(cell.id.subject()).or_insert_with(|| cell.overall().1.to_string());
    }
    found
}

fn passes(claim: &Claim) -> Vec<Pass> {
    match &claim.kind {
        ClaimKind::Faster { .. } => vec![Pass::Time],
        kind => kind.sides().iter().flat_map(|side| side.passes()).collect(),
    }
}
