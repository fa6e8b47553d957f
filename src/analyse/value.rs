//! Cells: all passes and blocks of one measurement, with the variables that expressions and filters see.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use super::errors;
pub use super::expression::{Expression, Reading};
use super::interval::{Interval, interval};
use super::keyed::keyed;
use crate::harness::record::{Causes, Errors, Outcome, Pass, Row, Stats};
use crate::probe::Op;

/// A number that can be ordered, for keys.
#[derive(Clone, Copy, Debug)]
pub struct Num(pub f64);

impl PartialEq for Num {
    fn eq(&self, other: &Num) -> bool {
        self.cmp(other).is_eq()
    }
}
impl Eq for Num {}
impl PartialOrd for Num {
    fn partial_cmp(&self, other: &Num) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Num {
    fn cmp(&self, other: &Num) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

/// The value of a field or parameter.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Param {
    /// A number.
    Number(Num),
    /// Anything else.
    Text(String),
}

impl Param {
    fn of(value: &serde_json::Value) -> Param {
        match (value.as_f64(), value.as_str()) {
            (Some(number), _) => Param::Number(Num(number)),
            (_, Some(text)) => Param::Text(text.into()),
            _ => Param::Text(value.to_string()),
        }
    }
}

impl Param {
    /// As JSON.
    pub fn json(&self) -> serde_json::Value {
        match self {
            Param::Number(Num(number)) if number.fract() == 0.0 && number.abs() < 2f64.powi(53) => (*number as i64).into(),
            Param::Number(Num(number)) => (*number).into(),
            Param::Text(text) => text.as_str().into(),
        }
    }
}

impl fmt::Display for Param {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Param::Number(Num(number)) => write!(f, "{number}"),
            Param::Text(text) => f.write_str(text),
        }
    }
}

/// What makes a cell this cell. The order of the fields is the order of reports.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Key {
    /// The experiment's name.
    pub experiment: String,
    /// The generator.
    pub scene: String,
    /// 2 or 3.
    pub dim: u32,
    /// The generator's parameters, by name.
    pub params: Vec<(String, Param)>,
    /// Order of the elements.
    pub order: String,
    /// Elements.
    pub n: u64,
    /// Seed.
    pub seed: u64,
    /// Arithmetic.
    pub arithmetic: String,
    /// Threads.
    pub threads: u32,
    /// The detector's name.
    pub detector: String,
}

impl Key {
    pub(super) fn of(row: &Row) -> Key {
        Key {
            experiment: row.experiment.clone(),
            scene: row.scene.clone(),
            dim: row.dim,
            params: row.params.iter().map(|(name, value)| (name.replace('-', "_"), Param::of(value))).collect(),
            order: row.order.clone(),
            n: row.n,
            seed: row.seed,
            arithmetic: row.arithmetic.clone(),
            threads: row.threads,
            detector: row.detector.clone(),
        }
    }

    /// A field or parameter by name.
    pub fn field(&self, name: &str) -> Option<Param> {
        let number = |value: u64| Some(Param::Number(Num(value as f64)));
        let text = |value: &str| Some(Param::Text(value.into()));
        match name {
            "experiment" => text(&self.experiment),
            "scene" => text(&self.scene),
            "order" => text(&self.order),
            "arithmetic" => text(&self.arithmetic),
            "detector" => text(&self.detector),
            "dim" => number(self.dim.into()),
            "n" => number(self.n),
            "seed" => number(self.seed),
            "threads" => number(self.threads.into()),
            _ => self.params.iter().find(|(known, _)| known == name).map(|(_, value)| value.clone()),
        }
    }

    /// The names of all fields and parameters.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        FIELDS.into_iter().chain(self.params.iter().map(|(name, _)| name.as_str()))
    }

    /// The same key with one field or parameter blanked out, for grouping over it.
    pub fn without(mut self, name: &str) -> Key {
        match name {
            "experiment" => self.experiment.clear(),
            "scene" => self.scene.clear(),
            "order" => self.order.clear(),
            "arithmetic" => self.arithmetic.clear(),
            "detector" => self.detector.clear(),
            "dim" => self.dim = 0,
            "n" => self.n = 0,
            "seed" => self.seed = 0,
            "threads" => self.threads = 0,
            _ => self.params.retain(|(known, _)| known != name),
        }
        self
    }
}

/// The fields of a key, besides parameters.
pub const FIELDS: [&str; 9] = ["experiment", "scene", "dim", "order", "n", "seed", "arithmetic", "threads", "detector"];

/// Variables measured, besides operations and errors.
const MEASURED: [&str; 11] = [
    "time_ns",
    "contacts",
    "peak_bytes",
    "live_bytes",
    "allocations",
    "warm_allocations",
    "formula_bytes",
    "packing_fraction",
    "coordination",
    "radius_ratio",
    "true_contacts",
];

/// All that was measured of one detector on one scene.
#[derive(Clone, Debug)]
pub struct Cell {
    /// Which cell.
    pub key: Key,
    /// How each pass ended, with the reason.
    pub passes: BTreeMap<Pass, (Outcome, String)>,
    /// Nanoseconds per detection, by block.
    pub times: BTreeMap<u32, u64>,
    /// The same of as many copies with one thread each, at work beside each other; empty where that was not measured.
    pub beside: BTreeMap<u32, u64>,
    /// Why there are no copies, or not in all blocks.
    pub alone: Option<(Outcome, String)>,
    /// Pairs reported.
    pub contacts: Option<u64>,
    /// Operation counts, if they were taken.
    pub counts: Option<BTreeMap<String, u64>>,
    /// The numbers of the memory pass, by their names in the record.
    pub memory: BTreeMap<&'static str, u64>,
    /// Against exact decisions on the scene as given.
    pub errors: Option<Errors>,
    /// The same by cause.
    pub causes: Option<Causes>,
    /// The scene as realised.
    pub stats: Stats,
}

/// Puts the rows of each cell together, in the order of the keys. Of rows measured twice (a resumed run), the later counts.
pub fn cells(rows: &[Row]) -> Vec<Cell> {
    let mut latest: BTreeMap<(Key, Pass, u32), &Row> = BTreeMap::new();
    for (key, row) in keyed(rows) {
        latest.insert((key, row.pass, row.block), row);
    }
    let mut cells: BTreeMap<Key, Cell> = BTreeMap::new();
    for ((key, ..), row) in latest {
        let cell = cells.entry(key.clone()).or_insert_with(|| Cell::empty(key, &row.stats));
        cell.add(row);
    }
    cells.into_values().collect()
}

impl Cell {
    fn empty(key: Key, stats: &Stats) -> Cell {
        let (passes, times, beside, memory) = Default::default();
        let (alone, contacts, counts, errors, causes) = Default::default();
        Cell { key, passes, times, beside, alone, contacts, counts, memory, errors, causes, stats: stats.clone() }
    }

    fn add(&mut self, row: &Row) {
        if row.pass == Pass::Ceiling && row.outcome != Outcome::Wrong {
            match row.time_ns {
                Some(time) => drop(self.beside.insert(row.block, time)),
                None => self.alone = Some((row.outcome, row.reason.clone())),
            }
            return;
        }
        let pass = self.passes.entry(row.pass).or_insert((row.outcome, row.reason.clone()));
        if severity(row.outcome) > severity(pass.0) {
            *pass = (row.outcome, row.reason.clone());
        }
        if let (Pass::Time, Some(time)) = (row.pass, row.time_ns) {
            self.times.insert(row.block, time);
        }
        if row.pass == Pass::Count && row.outcome.is_good() {
            self.counts = Some(row.counts.clone());
        }
        self.contacts = row.contacts.or(self.contacts);
        self.errors = row.errors.or(self.errors);
        self.causes = row.causes.or(self.causes);
        for (name, value) in [
            ("peak_bytes", row.peak_bytes),
            ("live_bytes", row.live_bytes),
            ("allocations", row.allocations),
            ("warm_allocations", row.warm_allocations),
            ("formula_bytes", row.formula_bytes),
        ] {
            if let Some(value) = value {
                self.memory.insert(name, value);
            }
        }
    }

    /// How the cell ended, as far as these passes go. A wrong answer in any pass makes the whole cell wrong; a pass that was never
    /// reached shares the fate of the pass that failed before it.
    pub fn outcome(&self, needed: &[Pass]) -> (Outcome, &str) {
        let worst = |passes: &mut dyn Iterator<Item = &'_ (Outcome, String)>| {
            passes.max_by_key(|pass| severity(pass.0)).map(|pass| (pass.0, pass.1.clone()))
        };
        let find = |outcome: Outcome| self.passes.values().find(|pass| pass.0 == outcome).map_or("", |pass| pass.1.as_str());
        let over_all = worst(&mut self.passes.values()).map_or(Outcome::Ok, |pass| pass.0);
        let absent = needed.is_empty() || needed.iter().any(|pass| !self.passes.contains_key(pass));
        if over_all == Outcome::Wrong || absent {
            return (over_all, find(over_all));
        }
        let outcome = worst(&mut needed.iter().filter_map(|pass| self.passes.get(pass))).map_or(Outcome::Ok, |pass| pass.0);
        (outcome, find(outcome))
    }

    /// How the cell ended in all.
    pub fn overall(&self) -> (Outcome, &str) {
        self.outcome(&[])
    }

    /// The median time with its interval over the blocks; none unless all blocks ended well.
    pub fn time(&self) -> Option<Interval> {
        self.blocks().filter(|_| self.outcome(&[Pass::Time]).0.is_good())
    }

    /// The median time of a wrong answer: never compared with anything, but shown, marked.
    pub fn wrong_time(&self) -> Option<f64> {
        self.blocks().filter(|_| self.overall().0 == Outcome::Wrong).map(|time| time.median)
    }

    fn blocks(&self) -> Option<Interval> {
        interval(&self.times.values().map(|&t| t as f64).collect::<Vec<_>>())
    }

    /// A variable, with this time in place of the median where one is given.
    pub fn variable(&self, name: &str, time_ns: Option<f64>) -> Option<f64> {
        match name {
            "time_ns" => time_ns.or_else(|| Some(self.time()?.median)),
            "contacts" => self.contacts.map(|v| v as f64),
            "packing_fraction" => Some(self.stats.packing_fraction),
            "coordination" => Some(self.stats.coordination),
            "radius_ratio" => self.stats.radius_ratio,
            "true_contacts" => Some(errors::true_contacts(self)),
            _ if is_operation(name) => self.counts.as_ref().map(|counts| counts.get(name).copied().unwrap_or(0) as f64),
            _ => match (self.memory.get(name), self.key.field(name)) {
                (Some(&bytes), _) => Some(bytes as f64),
                (None, Some(Param::Number(Num(number)))) => Some(number),
                _ => errors::variable(self, name),
            },
        }
    }
}

pub(super) fn is_operation(name: &str) -> bool {
    Op::ALL.iter().any(|op| op.name() == name)
}

/// Which outcome speaks for a cell whose rows differ.
fn severity(outcome: Outcome) -> u8 {
    match outcome {
        Outcome::Ok => 0,
        Outcome::Lossy | Outcome::Control => 1,
        Outcome::Unavailable => 2,
        Outcome::Refused => 3,
        Outcome::Timeout => 4,
        Outcome::OutOfMemory => 5,
        Outcome::Crashed => 6,
        Outcome::Wrong => 7,
    }
}

/// The names that expressions over these cells may use.
pub fn variables(cells: &[Cell]) -> BTreeSet<String> {
    let fixed = ["n", "dim", "seed", "threads"].into_iter().chain(MEASURED).chain(Op::ALL.iter().map(|op| op.name()));
    let params = cells.iter().flat_map(|cell| &cell.key.params);
    let numbers = params.filter(|(_, value)| matches!(value, Param::Number(_))).map(|(name, _)| name.clone());
    fixed.map(String::from).chain(errors::names()).chain(numbers).collect()
}

#[cfg(test)]
mod tests {
    use super::super::fake::Lab;
    use super::*;

    #[test]
    fn passes_are_merged_and_expressions_see_them() {
        let mut lab = Lab::new("e", "packed");
        lab.param("per-cluster", 8).time(&[300, 100, 200]).count(&[("list_push", 40), ("contact_test", 60)]).memory(1024, 1000);
        let cells = cells(&lab.rows());
        assert_eq!(cells.len(), 1);
        let value = |text: &str| Expression::parse_for(text, &cells).map(|e| e.read(&cells[0]));
        assert_eq!(value("(list_push + contact_test + list_step) / n").unwrap(), Reading::Value(1.0));
        assert_eq!(value("time_ns").unwrap(), Reading::Value(200.0));
        assert_eq!(value("peak_bytes - formula_bytes + per_cluster").unwrap(), Reading::Value(32.0));
        assert_eq!(value("n * (n - 1) / 2").unwrap(), Reading::Value(4950.0));
        assert_eq!(value("100 - 10 + 1 - 2 * 3 ^ 2 / 3").unwrap(), Reading::Value(85.0));
        assert_eq!(value("log2(8) * sqrt(4)").unwrap(), Reading::Value(6.0));
        assert_eq!(value("1 / (n - 100)").unwrap(), Reading::Missing);
        let error = value("list_pushes / n").unwrap_err().to_string();
        assert!(error.contains("list_pushes") && error.contains("per_cluster") && error.contains("list_push,"), "{error}");
        for broken in ["", "n +", "((n)", "n n", ")", "^", "log2", "{", "n / / 2", "1e999999999999", "µ§"] {
            assert!(value(broken).is_err(), "{broken:?}");
        }
    }

    #[test]
    fn outcomes_concern_the_passes_that_are_needed() {
        let mut lab = Lab::new("e", "packed");
        lab.count(&[("contact_test", 10)]).fail(Pass::Time, Outcome::Timeout, "30 s");
        let cells = cells(&lab.rows());
        let read = |text: &str| Expression::parse(text).unwrap().read(&cells[0]);
        assert_eq!(read("contact_test"), Reading::Value(10.0));
        assert_eq!(read("time_ns"), Reading::Not(Outcome::Timeout));
        assert_eq!(read("peak_bytes"), Reading::Not(Outcome::Timeout));
        lab.fail(Pass::Memory, Outcome::Wrong, "digest");
        assert_eq!(Expression::parse("contact_test").unwrap().read(&super::cells(&lab.rows())[0]), Reading::Not(Outcome::Wrong));
    }

    #[test]
    fn a_row_measured_again_replaces_the_first() {
        let mut lab = Lab::new("e", "packed");
        lab.time(&[100]).time(&[700]);
        assert_eq!(cells(&lab.rows())[0].time().map(|t| t.median), Some(700.0));
    }
}
