//! Two records compared cell by cell: what must be the same (pairs, counts, bytes, outcomes), and
//! how the times differ.

mod builds;
pub mod records;
mod summary;
mod timing;
mod twins;

use std::collections::{BTreeMap, BTreeSet, HashMap};

pub use builds::Builds;
pub use summary::Summary;
use timing::timing;
pub use timing::{Judgement, Note, PLACEMENT, Timing};
pub use twins::{SEEN, pooled};

use crate::cells::label::place;
use crate::cells::{AxisValue, Cell, cells, ids};
use crate::findings::noise::{Noise, nine_in_ten};
use crate::record::column::Column;
use crate::record::id::{CellId, FIELDS, MACHINE, Projection};
use crate::record::machines::Machine;
use crate::record::row::{Outcome, Pass, Row};
use contactbench_terms::arithmetic::Arithmetic;

#[derive(Clone, Debug, Default)]
pub struct Options {
    /// A difference within this share is none.
    pub band: f64,
    /// Both took turns in the same blocks, and this is what equal code differed by there, by
    /// experiment.
    pub side_by_side: Option<BTreeMap<String, Noise>>,
    /// Times are taken as multiples of this detector's in the same block.
    pub against: Option<Against>,
    /// The machines of the two records where they differ: no time is judged.
    pub machines: Option<[Machine; 2]>,
    /// Times are judged across machines nevertheless, as multiples of the reference.
    pub across: bool,
    /// The kinds of builds where they differ: no time is judged.
    pub builds: Option<[String; 2]>,
}

/// A control: a detector whose code has not changed.
#[derive(Clone, Debug, PartialEq)]
pub struct Against {
    pub detector: String,
    /// Its own times in the two records are within this factor of each other in nine of ten cells;
    /// what is within it may have changed between the runs and not in the code. None if it has no
    /// times in both.
    pub drift: Option<f64>,
}

/// Returns the name of the record that alone has something; `None` if both have it, or neither.
fn only(a: bool, b: bool) -> Option<&'static str> {
    (a != b).then_some(if a { "A" } else { "B" })
}

/// Something that must be the same and is not.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Change {
    /// `digest`, `list_push`, `peak_bytes`, `outcome (time)`, ...
    pub what: String,
    pub a: String,
    pub b: String,
}

#[derive(Clone, Debug)]
pub struct Compared {
    /// `nbs, packed, 3D, n = 1000, ...`: all that tells it from other cells.
    pub place: String,
    pub id: CellId,
    /// What must be the same and is not.
    pub changes: Vec<Change>,
    pub absent: Option<String>,
    /// Whether the cell is in both records.
    pub in_both: bool,
    /// Values that cannot be compared although the cell is in both records, one line each: a run
    /// was cut short.
    pub lacks: Vec<String>,
    /// The times, where both have some.
    pub timing: Option<Timing>,
}

/// A control that both records have, if there is one, and how far its own times are apart: the
/// detector that is named, or else one that has a twin in both.
pub fn control(a: &[Row], b: &[Row], named: Option<&str>) -> Option<Against> {
    let [a, b] = [a, b].map(Record::new);
    let known = || a.originals().intersection(&b.originals()).next().cloned();
    let detector = named.map(String::from).or_else(known)?;
    let apart =
        a.cells.values().filter(|cell| cell.id.contender() == detector).filter_map(|in_a| {
            let in_b = b.cells.get(&in_a.id)?;
            Some((in_b.time()?.median / in_a.time()?.median).ln().abs())
        });
    let apart: Vec<f64> = apart.collect();
    let drift = (!apart.is_empty()).then(|| nine_in_ten(&apart));
    Some(Against { detector, drift })
}

/// What equal code differed by in each experiment of a record in which builds took turns.
pub fn floors(cells: &[Cell]) -> BTreeMap<String, Noise> {
    let mut experiments: BTreeMap<String, Vec<&Cell>> = BTreeMap::new();
    for cell in cells {
        experiments.entry(cell.id.experiment.clone()).or_default().push(cell);
    }
    experiments.into_iter().map(|(name, cells)| (name, Noise::new(&cells))).collect()
}

struct Record {
    cells: BTreeMap<CellId, Cell>,
    /// Numbers of pairs and their fingerprints: one, unless answers differ.
    answers: BTreeMap<CellId, BTreeSet<String>>,
    scenes: HashMap<Projection, Vec<CellId>>,
}

impl Record {
    fn new(rows: &[Row]) -> Record {
        let mut answers: BTreeMap<CellId, BTreeSet<String>> = BTreeMap::new();
        for (key, row) in ids(rows) {
            if let (Some(contacts), Some(digest)) = (row.contacts, &row.digest) {
                answers.entry(key).or_default().insert(format!("{contacts} pairs, {digest}"));
            }
        }
        let cells: BTreeMap<CellId, Cell> =
            cells(rows).into_iter().map(|cell| (cell.id.clone(), cell)).collect();
        let mut scenes: HashMap<Projection, Vec<CellId>> = HashMap::new();
        for id in cells.keys() {
            scenes.entry(id.scene_id()).or_default().push(id.clone());
        }
        Record { cells, answers, scenes }
    }

    /// The detectors that have twins, with the parameters, which a twin has, too.
    fn originals(&self) -> BTreeSet<String> {
        let original = |cell: &Cell| Some(cell.role.twin_of()?.to_string());
        let id = |cell: &Cell| Some(CellId { detector: original(cell)?, ..cell.id.clone() });
        self.cells.values().filter_map(|cell| Some(id(cell)?.contender())).collect()
    }

    /// The detector that a cell's times are divided by: on the same scene, in the same arithmetic
    /// if it can be, with as few threads as there are.
    fn reference(&self, id: &CellId, name: &str) -> Option<&Cell> {
        let known = self.scenes.get(&id.scene_id()).into_iter().flatten();
        let known = known.filter_map(|id| self.cells.get(id));
        let known = known.filter(|cell| cell.id.contender() == name && cell.time().is_some());
        known.min_by_key(|cell| {
            (
                cell.id.arithmetic != id.arithmetic,
                cell.id.arithmetic != Arithmetic::Exact.name(),
                cell.id.threads(),
            )
        })
    }
}

/// Compares two records of the same machine each, or of the same several. Cells come in the order
/// of keys, those of one record only included.
pub fn compare(a: &[Row], b: &[Row], options: &Options) -> Vec<Compared> {
    let (a, b) = (Record::new(a), Record::new(b));
    let keys: BTreeSet<&CellId> = a.cells.keys().chain(b.cells.keys()).collect();
    let swept = swept(&keys);
    let compared = |key: &CellId| {
        let mut cell = Compared {
            place: place(key, &swept),
            id: key.clone(),
            changes: Vec::new(),
            absent: None,
            in_both: a.cells.contains_key(key) && b.cells.contains_key(key),
            lacks: Vec::new(),
            timing: None,
        };
        match (a.cells.get(key), b.cells.get(key)) {
            (Some(in_a), Some(in_b)) => fill(&mut cell, (&a, in_a), (&b, in_b), options),
            (in_a, in_b) => {
                let side = only(in_a.is_some(), in_b.is_some());
                cell.absent = side.map(|side| format!("only in {side}"));
            }
        }
        cell
    };
    let mut found = keys.into_iter().map(compared).collect::<Vec<_>>();
    if options.side_by_side.is_none() {
        twins::void(&mut found, &b);
    }
    found
}

fn fill(
    cell: &mut Compared,
    (a, in_a): (&Record, &Cell),
    (b, in_b): (&Record, &Cell),
    options: &Options,
) {
    let gone = |cell: &Cell| cell.overall().0 == Outcome::Unavailable;
    // Of what was available in neither, nothing is missing.
    if let Some(side) = only(gone(in_a), gone(in_b)) {
        let (_, reason) = if gone(in_a) { in_a.overall() } else { in_b.overall() };
        cell.absent = Some(format!("unavailable in {side}: {reason}"));
        return;
    }
    let mut note = |what: &str, a: &str, b: &str| {
        if a != b {
            cell.changes.push(Change { what: what.into(), a: a.into(), b: b.into() });
        }
    };
    note("scene", &in_a.stats.scene_hash, &in_b.stats.scene_hash);
    if !cell.changes.is_empty() {
        // All else follows from that.
        return;
    }
    cell.changes = changes(in_a, in_b, options.machines.is_some());
    if let (Some(in_a), Some(in_b)) = (a.answers.get(&cell.id), b.answers.get(&cell.id))
        && in_a != in_b
    {
        let text = |answers: &BTreeSet<String>| {
            answers.iter().map(String::as_str).collect::<Vec<_>>().join(" and ")
        };
        cell.changes.push(Change { what: "answer".into(), a: text(in_a), b: text(in_b) });
    }
    cell.timing = timing((a, in_a), (b, in_b), options);
    // What an outcome explains is said by the outcome.
    if cell.changes.is_empty() {
        cell.lacks = lacks(in_a, in_b, cell.timing.is_some());
    }
}

/// All fields but the parameters that are the same wherever the scene is.
fn swept(keys: &BTreeSet<&CellId>) -> Vec<String> {
    let mut values: BTreeMap<(&str, u32, String), BTreeSet<AxisValue>> = BTreeMap::new();
    for key in keys {
        for (name, value) in key.parameters() {
            values.entry((&key.scene, key.dim, name)).or_default().insert(value);
        }
    }
    let params: BTreeSet<String> = values
        .into_iter()
        .filter(|(place, values)| values.len() > 1 || place.2 == MACHINE)
        .map(|((.., name), _)| name)
        .collect();
    let differs =
        |name: &str| keys.iter().map(|key| key.axis(name)).collect::<BTreeSet<_>>().len() > 1;
    let rarely = ["experiment", "order", "seed", "threads"];
    let first = ["detector", "arithmetic", "scene", "dim", "n"];
    let others = FIELDS.into_iter().filter(|name| rarely.contains(name) && differs(name));
    first.into_iter().map(String::from).chain(params).chain(others.map(String::from)).collect()
}

/// Outcomes, contacts, counts and bytes that differ. What one side did not measure, because it
/// ended otherwise, is said by the outcome.
fn changes(a: &Cell, b: &Cell, two_machines: bool) -> Vec<Change> {
    let mut found = Vec::new();
    let mut note = |what: &str, a: String, b: String| {
        if a != b {
            found.push(Change { what: what.to_string(), a, b });
        }
    };
    for pass in Pass::ALL {
        if let (Some((in_a, _)), Some((in_b, _))) = (a.passes.get(&pass), b.passes.get(&pass)) {
            // Whether a detector is done in time is a matter of the machine.
            let slow = [in_a, in_b].contains(&&Outcome::Timeout) && two_machines;
            if !slow {
                note(&format!("outcome ({})", pass.name()), in_a.name().into(), in_b.name().into());
            }
        }
    }
    for name in exact() {
        if let (Some(in_a), Some(in_b)) = (a.values.get(name), b.values.get(name)) {
            note(name, in_a.to_string(), in_b.to_string());
        }
    }
    found
}

/// What is compared as it is. (Answers are compared as a whole; errors follow from the pairs, and
/// what the scene is from its fingerprint.)
fn exact() -> impl Iterator<Item = &'static str> {
    let measured = [Pass::Count, Pass::Memory].into_iter().flat_map(Column::measured_by);
    measured.map(|column| &*column.name)
}

/// What one side has measured and the other has not.
fn lacks(a: &Cell, b: &Cell, timed: bool) -> Vec<String> {
    let mut found = Vec::new();
    let mut see = |what: &str, has: &dyn Fn(&Cell) -> bool| {
        found.extend(only(has(a), has(b)).map(|side| format!("{what} only in {side}")));
    };
    for pass in Pass::ALL {
        see(&format!("the {} pass", pass.name()), &|cell| cell.passes.contains_key(&pass));
    }
    see("times", &|cell| cell.time().is_some());
    see("counts", &|cell| cell.has(Pass::Count));
    let bytes = Column::measured_by(Pass::Memory).map(|column| &*column.name);
    for name in ["contacts"].into_iter().chain(bytes) {
        see(name, &|cell| cell.values.contains_key(name));
    }
    if !timed && a.time().is_some() && b.time().is_some() {
        found.push("no times in blocks of both".into());
    }
    found
}

#[cfg(test)]
mod tests;
