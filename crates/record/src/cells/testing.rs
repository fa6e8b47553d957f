//! Made-up rows with chosen times, for tests of claims and reports.

use std::collections::BTreeMap;

use contactbench_terms::arithmetic::Arithmetic;
use contactbench_terms::errors::{Causes, Errors};
use contactbench_terms::scene::Stats;

use crate::cells::{Cell, cells};
use crate::experiment::{Document, Experiment, Planned, PlannedSubject, Where};
use crate::record::id::CellId;
use crate::record::role::Role;
use crate::record::row::{Outcome, Pass, Row};
use crate::record::value::AxisValue;

pub struct Lab {
    base: Row,
    rows: Vec<Row>,
}

impl Lab {
    /// A 2D scene with 100 particles, seed 1, and the detector `nbs`.
    pub fn new(experiment: &str, scene: &str) -> Lab {
        let id = CellId {
            experiment: experiment.into(),
            scene: scene.into(),
            dim: 2,
            order: "shuffled".into(),
            n: 100,
            seed: 1,
            arithmetic: "exact".into(),
            ..CellId::default()
        };
        let base = Row {
            id: id.with_subject("nbs").with_threads(1),
            contacts: Some(250),
            digest: Some("0x00".into()),
            stats: Stats { packing_fraction: 0.9, coordination: 5.0, ..Stats::default() },
            ..Row::default()
        };
        Lab { base, rows: Vec::new() }
    }
    pub fn rows(&self) -> Vec<Row> {
        self.rows.clone()
    }
    pub fn find<T>(&self, finding: impl FnOnce(&[&Cell]) -> T) -> T {
        finding(&cells(&self.rows).iter().collect::<Vec<_>>())
    }
    pub fn scene(&mut self, scene: &str, dim: u32) -> &mut Lab {
        self.base.id.scene = scene.into();
        self.base.id.dim = dim;
        self
    }
    pub fn detector(&mut self, spec: &str) -> &mut Lab {
        self.base.id = self.base.id.clone().with_subject(spec);
        self.base.role = role_of(&self.base.id.detector);
        self
    }
    pub fn arithmetic(&mut self, name: &str) -> &mut Lab {
        self.base.id.arithmetic = name.into();
        self
    }
    pub fn machine(&mut self, name: &str) -> &mut Lab {
        self.base.id.machine = Some(name.into());
        self
    }
    pub fn n(&mut self, n: u64) -> &mut Lab {
        self.base.id.n = n;
        self
    }
    pub fn threads(&mut self, threads: u32) -> &mut Lab {
        self.base.id = self.base.id.clone().with_threads(threads);
        self
    }
    pub fn seed(&mut self, seed: u64) -> &mut Lab {
        self.base.id.seed = seed;
        self
    }
    pub fn param(&mut self, name: &str, value: impl Into<serde_json::Value>) -> &mut Lab {
        self.base.id.params.insert(name.into(), AxisValue::from(value.into()));
        self
    }
    fn push(&mut self, pass: Pass, change: impl FnOnce(&mut Row)) -> &mut Lab {
        let mut row = Row { pass, ..self.base.clone() };
        change(&mut row);
        self.rows.push(row);
        self
    }
    pub fn time(&mut self, blocks: &[u64]) -> &mut Lab {
        for (block, &time) in blocks.iter().enumerate() {
            self.push(Pass::Time, |row| (row.block, row.time_ns) = (block as u32, Some(time)));
        }
        self
    }
    pub fn copies(&mut self, alone: &[u64], together: &[u64]) -> &mut Lab {
        for (block, (&alone, &time)) in alone.iter().zip(together).enumerate() {
            self.push(Pass::Ceiling, |row| {
                (row.block, row.time_ns, row.alone_ns) = (block as u32, Some(time), Some(alone))
            });
        }
        self
    }
    pub fn count(&mut self, counts: &[(&str, u64)]) -> &mut Lab {
        let counts = counts.iter().map(|&(name, count)| (name.into(), count)).collect();
        self.push(Pass::Count, |row| row.counts = counts)
    }
    pub fn memory(&mut self, peak: u64, formula: u64) -> &mut Lab {
        self.push(Pass::Memory, |row| {
            (row.peak_bytes, row.formula_bytes) = (Some(peak), Some(formula))
        })
    }
    pub fn fail(&mut self, pass: Pass, outcome: Outcome, reason: &str) -> &mut Lab {
        self.push(pass, |row| {
            (row.outcome, row.reason, row.contacts) = (outcome, reason.into(), None)
        })
    }
    pub fn errors(&mut self, errors: Errors, causes: Causes) -> &mut Lab {
        self.edit(|row| (row.errors, row.causes) = (Some(errors), Some(causes)))
    }
    pub fn edit(&mut self, change: impl FnOnce(&mut Row)) -> &mut Lab {
        self.rows.last_mut().map(change);
        self
    }
}

fn role_of(name: &str) -> Role {
    const PEERS: &str = "kiddo kd-tree-crate rstar parry zelll";
    const DETECTORS: &str = "direct binary-tree screening sorting nbs streamed-nbs cell-grid \
                             hash-grid hgrid sweep kd-tree bvh";
    let is_one = |names: &str| names.split(' ').any(|known| known == name);
    match name.strip_suffix("-twin") {
        Some(original) => Role::Twin(original.into()),
        None if name == "nothing" => Role::Nothing,
        None if is_one(PEERS) => Role::Peer,
        None if is_one(DETECTORS) => Role::Detector,
        None => Role::Runner,
    }
}

pub fn experiment(rest: &str) -> Experiment {
    let head = "name = 'e'\ntitle = 'A title'\nquestion = 'Which is fastest?'\nreading = 'Lower \
                is better.'\ndetectors = []\nscene = []\n";
    read(&format!("{head}{rest}"))
}

pub fn read(text: &str) -> Experiment {
    Document::read(text, false).unwrap_or_else(|error| panic!("{error:#}")).0
}

pub fn planned(scene: &str, detectors: &[&str], params: &[Params]) -> Planned {
    let subject = |name: &&str| PlannedSubject {
        name: name.to_string(),
        role: role_of(name),
        arithmetic: (role_of(name) != Role::Runner).then(Arithmetic::default),
        threads: 1,
    };
    let base = Lab::new("e", scene).base.id;
    let scene = |params: &Params| CellId {
        params: params.clone(),
        arithmetic: String::new(),
        ..base.clone()
    };
    let scenes: Vec<CellId> = params.iter().map(scene).collect();
    let subjects = detectors.iter().map(subject).collect();
    Planned { quick: scenes.clone(), scenes, subjects, ..Planned::default() }
}

type Params = BTreeMap<String, AxisValue>;

pub fn filter(text: &str) -> Where {
    let claim =
        format!("[[claim]]\nname = 'x'\nkind = 'constant'\nvalue = 'n'\nwhere = {{ {text} }}");
    experiment(&claim).claims[0].filter.clone()
}

/// Three cases: right everywhere; wrong in f32 and lossy in textbook; refused by all but
/// direct.
pub fn hard_lab() -> Lab {
    let mut lab = Lab::new("e", "hard");
    for (case, dims) in [("calm", vec![2, 3]), ("tangent", vec![2]), ("far", vec![2, 3])] {
        for dim in dims {
            lab.scene("hard", dim).param("case", case);
            for arithmetic in ["exact", "f32", "textbook"] {
                for detector in ["direct", "nbs", "sorting", "nothing"] {
                    lab.arithmetic(arithmetic).detector(detector);
                    if case == "far" && detector != "direct" {
                        let reason = format!("{detector} would need 5.{dim}e11 cells; use direct");
                        lab.fail(Pass::Count, Outcome::Refused, &reason);
                        continue;
                    }
                    let (missed, outcome) = match (case, arithmetic, detector) {
                        ("tangent", "f32", _) => (3, Outcome::Ok),
                        ("tangent", "textbook", "nbs" | "sorting") => (2, Outcome::Lossy),
                        _ => (0, Outcome::Ok),
                    };
                    let errors = Errors { missed, ..Errors::default() };
                    lab.count(&[])
                        .errors(errors, Causes::default())
                        .edit(|row| row.outcome = outcome);
                }
            }
        }
    }
    lab
}
