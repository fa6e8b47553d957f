//! Made-up rows for the tests of everything right of the record, with a clock that says what it is told.

use crate::harness::experiment::Experiment;
use crate::harness::record::{Causes, Errors, Outcome, Pass, Row, Stats};

/// Writes rows for one cell after another; the setters change the cell that the next rows belong to.
pub struct Lab {
    base: Row,
    rows: Vec<Row>,
}

impl Lab {
    /// A 2D scene with 100 elements, seed 1, and the detector `nbs`.
    pub fn new(experiment: &str, scene: &str) -> Lab {
        let base = Row {
            machine: String::new(),
            experiment: experiment.into(),
            scene: scene.into(),
            params: Default::default(),
            dim: 2,
            n: 100,
            seed: 1,
            order: "shuffled".into(),
            detector: "nbs".into(),
            arithmetic: "exact".into(),
            threads: 1,
            pass: Pass::Time,
            block: 0,
            time_ns: None,
            calls: None,
            elapsed_ns: None,
            outcome: Outcome::Ok,
            reason: String::new(),
            contacts: Some(250),
            digest: Some("0x00".into()),
            counts: Default::default(),
            peak_bytes: None,
            live_bytes: None,
            allocations: None,
            warm_allocations: None,
            formula_bytes: None,
            errors: None,
            causes: None,
            stats: Stats { packing_fraction: 0.9, coordination: 5.0, ..Stats::default() },
        };
        Lab { base, rows: Vec::new() }
    }
    pub fn rows(&self) -> Vec<Row> {
        self.rows.clone()
    }
    pub fn scene(&mut self, scene: &str, dim: u32) -> &mut Lab {
        (self.base.scene, self.base.dim) = (scene.into(), dim);
        self
    }
    pub fn detector(&mut self, name: &str) -> &mut Lab {
        self.base.detector = name.into();
        self
    }
    pub fn arithmetic(&mut self, name: &str) -> &mut Lab {
        self.base.arithmetic = name.into();
        self
    }
    pub fn machine(&mut self, name: &str) -> &mut Lab {
        self.base.machine = name.into();
        self
    }
    pub fn n(&mut self, n: u64) -> &mut Lab {
        self.base.n = n;
        self
    }
    pub fn threads(&mut self, threads: u32) -> &mut Lab {
        self.base.threads = threads;
        self
    }
    pub fn seed(&mut self, seed: u64) -> &mut Lab {
        self.base.seed = seed;
        self
    }
    pub fn param(&mut self, name: &str, value: impl Into<serde_json::Value>) -> &mut Lab {
        self.base.params.insert(name.into(), value.into());
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
    /// Times of copies beside each other.
    pub fn beside(&mut self, blocks: &[u64]) -> &mut Lab {
        for (block, &time) in blocks.iter().enumerate() {
            self.push(Pass::Ceiling, |row| (row.block, row.time_ns) = (block as u32, Some(time)));
        }
        self
    }
    pub fn count(&mut self, counts: &[(&str, u64)]) -> &mut Lab {
        let counts = counts.iter().map(|&(name, count)| (name.into(), count)).collect();
        self.push(Pass::Count, |row| row.counts = counts)
    }
    pub fn memory(&mut self, peak: u64, formula: u64) -> &mut Lab {
        self.push(Pass::Memory, |row| (row.peak_bytes, row.formula_bytes) = (Some(peak), Some(formula)))
    }
    pub fn fail(&mut self, pass: Pass, outcome: Outcome, reason: &str) -> &mut Lab {
        self.push(pass, |row| (row.outcome, row.reason, row.contacts) = (outcome, reason.into(), None))
    }
    /// Errors of the last row.
    pub fn errors(&mut self, errors: Errors, causes: Causes) -> &mut Lab {
        self.edit(|row| (row.errors, row.causes) = (Some(errors), Some(causes)))
    }
    pub fn edit(&mut self, change: impl FnOnce(&mut Row)) -> &mut Lab {
        self.rows.last_mut().map(change);
        self
    }
}

/// An experiment with these claims and figures, in TOML.
pub fn experiment(rest: &str) -> Experiment {
    let head = "name = 'e'\ntitle = 'A title'\nquestion = 'Which is fastest?'\nreading = 'Lower is better.'\ndetectors = []\nscene = []\n";
    toml::from_str(&format!("{head}{rest}")).unwrap()
}
