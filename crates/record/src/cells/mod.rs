//! Cells: all passes and blocks of one measurement.

pub mod errors;
pub mod expression;
pub mod label;
pub mod select;
pub mod series;
pub mod state;
#[doc(hidden)]
pub mod testing;

use std::collections::BTreeMap;

pub use crate::cells::expression::{Expression, Reading};
use crate::cells::state::States;
use crate::record::column::{COLUMNS, Column, FIRST, TIME};
pub use crate::record::id::{CellId, FIELDS};
use crate::record::role::Role;
use crate::record::row::{Measurement, Outcome, Pass, Row};
pub use crate::record::value::AxisValue;
use crate::stats::interval::{
    Block, Blocks, COVERAGE, Interval, interval, median, ratio, typical_ratio_at,
};
use contactbench_terms::errors::{Causes, Errors};
use contactbench_terms::scene::Stats;

#[derive(Clone, Debug, Default)]
pub struct Cell {
    pub id: CellId,
    pub role: Role,
    pub passes: BTreeMap<Pass, (Outcome, String)>,
    /// Whether a sample reached a limit or crashed, so that later samples are missing.
    pub ended: bool,
    /// Time per detection in nanoseconds, by block.
    pub times: Blocks,
    /// Whether the machine was slow in each block; empty if its speed was not measured.
    pub slow: BTreeMap<Block, bool>,
    /// Nanoseconds by time column (except `time_ns`) and block.
    pub others_ns: BTreeMap<&'static str, Blocks>,
    /// Nanoseconds per detection, by round and block, if builds were timed in turns.
    pub rounds: Vec<Blocks>,
    /// Nanoseconds per detection of single-threaded copies that run at the same time; empty if not
    /// measured.
    pub copies_ns: Blocks,
    /// Nanoseconds per detection of these copies when they run one after the other.
    pub alone_ns: Blocks,
    /// Why times of copies are missing in some or all blocks.
    pub copies_failure: Option<(Outcome, String)>,
    pub values: BTreeMap<&'static str, f64>,
    pub errors: Option<Errors>,
    pub causes: Option<Causes>,
    pub stats: Stats,
}

/// Returns the cell of each row. If the rows are from several machines, the machine is an axis,
/// because their times are not comparable.
pub fn ids(rows: &[Row]) -> impl Iterator<Item = (CellId, &Row)> {
    let several = rows.iter().any(|row| row.id.machine != rows[0].id.machine);
    rows.iter().map(move |row| {
        let id = row.id.clone();
        (if several { id } else { id.anywhere() }, row)
    })
}

/// Groups rows into cells, in the order of ids. If a measurement occurs twice (in a resumed run),
/// the later row counts.
pub fn cells(rows: &[Row]) -> Vec<Cell> {
    let mut latest: BTreeMap<Measurement, &Row> = BTreeMap::new();
    for (id, row) in ids(rows) {
        latest.insert(Measurement { id, ..row.measurement() }, row);
    }
    let states = States::new(rows);
    let mut cells: BTreeMap<CellId, Cell> = BTreeMap::new();
    for (Measurement { id, .. }, row) in latest {
        let cell = cells.entry(id.clone()).or_insert_with(|| Cell {
            id,
            role: row.role.clone(),
            stats: row.stats.clone(),
            ..Cell::default()
        });
        cell.add(row);
        cell.slow.extend(states.is_slow(row).map(|slow| (row.timed_in(), slow)));
    }
    cells.into_values().collect()
}

pub fn by_machine<'a>(cells: &[&'a Cell]) -> Vec<(Option<String>, Vec<&'a Cell>)> {
    let mut machines: BTreeMap<Option<String>, Vec<&Cell>> = BTreeMap::new();
    for &cell in cells {
        machines.entry(cell.id.machine.clone()).or_default().push(cell);
    }
    machines.into_iter().collect()
}

impl Cell {
    fn add(&mut self, row: &Row) {
        let block = row.timed_in();
        if row.pass == Pass::Ceiling && row.outcome != Outcome::Wrong {
            match row.time_ns {
                Some(time) => {
                    self.copies_ns.insert(block, time);
                    self.alone_ns.extend(row.alone_ns.map(|alone| (block, alone)));
                }
                None => self.copies_failure = Some((row.outcome, row.reason.clone())),
            }
            return;
        }
        let pass = self.passes.entry(row.pass).or_insert((row.outcome, row.reason.clone()));
        if severity(row.outcome) > severity(pass.0) {
            *pass = (row.outcome, row.reason.clone());
        }
        self.ended |= row.pass == Pass::Time && row.outcome.is_final();
        if let (Pass::Time, Some(time)) = (row.pass, row.time_ns) {
            self.times.insert(block, time);
            let timed = Column::measured_by(Pass::Time).filter(|column| column.name != TIME);
            for (column, ns) in timed.filter_map(|column| Some((column, column.read(row)?))) {
                self.others_ns.entry(&column.name).or_default().insert(block, ns as u64);
            }
            for (round, &time) in row.rounds_ns.iter().enumerate() {
                if self.rounds.len() <= round {
                    self.rounds.push(Blocks::new());
                }
                self.rounds[round].insert(block, time);
            }
        }
        self.errors = row.errors.or(self.errors);
        self.causes = row.causes.or(self.causes);
        let repeating = COLUMNS.iter().filter(|column| column.repeats());
        self.values.extend(repeating.filter_map(|column| Some((&*column.name, column.read(row)?))));
    }

    /// Returns the outcome of the `needed` passes. A wrong answer in any pass makes the whole cell
    /// wrong. A pass that never ran has the outcome of the pass that failed before it.
    pub fn outcome(&self, needed: &[Pass]) -> (Outcome, &str) {
        let worst = |is_needed: &dyn Fn(&Pass) -> bool| {
            let passes = self.passes.iter().filter(|(pass, _)| is_needed(pass)).rev();
            let worst = passes.max_by_key(|(_, (outcome, _))| severity(*outcome));
            worst.map_or((Outcome::Ok, ""), |(_, (outcome, reason))| (*outcome, &**reason))
        };
        let overall = worst(&|_| true);
        let absent = needed.is_empty() || needed.iter().any(|pass| !self.passes.contains_key(pass));
        match overall.0 == Outcome::Wrong || absent {
            true => overall,
            false => worst(&|pass| needed.contains(pass)),
        }
    }

    pub fn overall(&self) -> (Outcome, &str) {
        self.outcome(&[])
    }

    /// The median time over blocks; `None` unless all blocks ended well.
    pub fn time(&self) -> Option<Interval> {
        self.blocks().filter(|_| self.outcome(&[Pass::Time]).0.is_good())
    }

    /// The median time of the blocks in which the machine was not slow; `None` if there are none.
    pub fn quiet_time(&self) -> Option<f64> {
        self.time()?;
        let quiet = self.times.iter().filter(|&(block, _)| self.slow.get(block) == Some(&false));
        median(&quiet.map(|(_, &time)| time as f64).collect::<Vec<_>>())
    }

    /// The ratio of this cell's time to the other's, paired by block, and by round if both were
    /// timed in turns.
    pub fn ratio(&self, to: &Cell) -> Option<Interval> {
        self.ratio_at(to, COVERAGE)
    }

    pub fn ratio_at(&self, to: &Cell, coverage: f64) -> Option<Interval> {
        let rounds: Vec<_> = self.rounds.iter().zip(&to.rounds).collect();
        let whole = [(&self.times, &to.times)];
        typical_ratio_at(if rounds.is_empty() { &whole } else { &rounds }, coverage)
    }

    pub fn cold_ratio(&self, to: &Cell) -> Option<Interval> {
        ratio(self.first_times(), to.first_times())
    }

    /// Number of frames over which counts and contacts are summed; 1 for a scene at rest.
    pub fn frames(&self) -> f64 {
        let moves = self.values.contains_key("mean_way");
        let frames = self.id.axis("frames").filter(|_| moves).and_then(|frames| frames.number());
        frames.unwrap_or(1.0).max(1.0)
    }

    /// Returns `value` over the true contacts of a frame, counted once; `None` without contacts.
    pub fn per_pair(&self, value: f64) -> Option<f64> {
        let pairs = errors::true_contacts(self) / self.frames();
        (pairs > 0.0).then(|| value / pairs)
    }

    /// Whether the cell is a tracker that misses contacts because its rule allows late builds.
    pub fn misses_by_rule(&self) -> bool {
        self.id.detector_params.contains_key("rule") && self.overall().0 == Outcome::Lossy
    }

    /// The median time of a wrong answer. Reports mark it and never compare it.
    pub fn wrong_time(&self) -> Option<f64> {
        self.blocks().filter(|_| self.overall().0 == Outcome::Wrong).map(|time| time.median)
    }

    pub fn first_times(&self) -> &Blocks {
        static NONE: Blocks = Blocks::new();
        self.others_ns.get(FIRST).unwrap_or(&NONE)
    }

    fn blocks(&self) -> Option<Interval> {
        interval(&self.times.values().map(|&t| t as f64).collect::<Vec<_>>())
    }

    pub fn variable(&self, name: &str, time_ns: Option<f64>) -> Option<f64> {
        match Column::find(name) {
            Some(column) if column.name == TIME => time_ns.or_else(|| Some(self.time()?.median)),
            Some(column) if column.pass == Some(Pass::Time) => {
                let all = self.others_ns.get(&*column.name)?.values();
                median(&all.map(|&ns| ns as f64).collect::<Vec<_>>())
                    .filter(|_| self.time().is_some())
            }
            Some(column) => self.values.get(&*column.name).copied(),
            None => self.id.axis(name)?.number(),
        }
    }
}

fn severity(outcome: Outcome) -> Option<usize> {
    use Outcome::{Control, Crashed, Lossy, Ok, OutOfMemory, Refused, Timeout, Unavailable, Wrong};
    [Ok, Control, Lossy, Unavailable, Refused, Timeout, OutOfMemory, Crashed, Wrong]
        .iter()
        .position(|known| *known == outcome)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells::testing::Lab;

    fn read(cell: &Cell, text: &str) -> Reading {
        Expression::parse(text).unwrap().read(cell)
    }

    #[test]
    fn passes_are_merged_and_expressions_see_them() {
        let mut lab = Lab::new("e", "packed");
        lab.param("per-cluster", 8)
            .time(&[300, 100, 200])
            .count(&[("list_push", 40), ("contact_test", 60)])
            .memory(1024, 1000);
        let cells = cells(&lab.rows());
        assert_eq!(cells.len(), 1);
        for (text, value) in [
            ("(list_push + contact_test + list_step) / n", Reading::Value(1.0)),
            ("time_ns", Reading::Value(200.0)),
            ("peak_bytes - formula_bytes + per_cluster", Reading::Value(32.0)),
            ("n * (n - 1) / 2", Reading::Value(4950.0)),
            ("1 / (n - 100)", Reading::Missing),
        ] {
            assert_eq!(read(&cells[0], text), value, "{text}");
        }
    }

    #[test]
    fn outcomes_concern_the_passes_that_are_needed() {
        let mut lab = Lab::new("e", "packed");
        lab.count(&[("contact_test", 10)]).fail(Pass::Time, Outcome::Timeout, "30 s");
        let of = |lab: &Lab, text: &str| lab.find(|cells| read(cells[0], text));
        assert_eq!(of(&lab, "contact_test"), Reading::Value(10.0));
        assert_eq!(of(&lab, "time_ns"), Reading::Not(Outcome::Timeout));
        assert_eq!(of(&lab, "peak_bytes"), Reading::Not(Outcome::Timeout));
        lab.fail(Pass::Memory, Outcome::Wrong, "digest");
        assert_eq!(of(&lab, "contact_test"), Reading::Not(Outcome::Wrong));
        let mut lab = Lab::new("e", "packed");
        lab.time(&[100]).time(&[700]);
        assert_eq!(of(&lab, "time_ns"), Reading::Value(700.0));
    }

    #[test]
    fn times_of_several_machines_are_not_one_median() {
        let mut lab = Lab::new("e", "packed");
        lab.param("spacing", 1).machine("a").time(&[100, 100]).machine("b").time(&[300, 300]);
        let apart = lab.find(|cells| {
            let apart = by_machine(cells).into_iter();
            apart
                .map(|(name, own)| (name.unwrap(), own[0].time().unwrap().median))
                .collect::<Vec<_>>()
        });
        assert_eq!(apart, [("a".into(), 100.0), ("b".into(), 300.0)]);
        assert_eq!(cells(&lab.rows()[..2])[0].id.axis("machine"), None);
    }
}
