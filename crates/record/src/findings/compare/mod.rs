//! Compares two records cell by cell: exact values (pairs, counts, bytes, outcomes), and times.

pub mod comparison;
pub mod records;
mod summary;
mod timing;
mod twins;

use std::collections::{BTreeMap, BTreeSet, HashMap};

pub use summary::Summary;
use timing::timing;
pub use timing::{Judgement, PLACEMENT, Timing};
pub use twins::{SEEN, pooled};

use crate::cells::label::{place, varying};
use crate::cells::series::preference;
use crate::cells::{Cell, cells, ids};
use crate::findings::trust::noise::{Noise, nine_in_ten};
use crate::record::column::Column;
use crate::record::id::{CellId, Projection};
use crate::record::origin::machines::Machine;
use crate::record::row::{Outcome, Pass, Row};

#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Times that differ by at most this fraction count as equal.
    pub band: f64,
    /// Noise of equal code for each experiment, if both builds were timed in the same blocks.
    pub side_by_side: Option<BTreeMap<String, Noise>>,
    pub against: Option<Against>,
    /// The machines of the records, if they differ; times are then not judged.
    pub machines: Option<[Machine; 2]>,
    /// Whether to judge times across machines nevertheless, as multiples of the reference.
    pub across: bool,
    /// The kinds of builds, if they differ; times are then not judged.
    pub builds: Option<[String; 2]>,
}

impl Options {
    /// Whether times of separate runs are judged.
    fn judges(&self) -> bool {
        let same = self.builds.is_none() && (self.machines.is_none() || self.across);
        same && self.against.is_some()
    }
}

#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Against {
    pub detector: String,
    /// In nine of ten cells, the times of this detector in the two records differ by at most this
    /// factor. Smaller changes of other detectors may come from the machine. `None` if a record
    /// lacks times of this detector.
    pub drift: Option<f64>,
}

fn only(a: bool, b: bool) -> Option<&'static str> {
    (a != b).then_some(if a { "A" } else { "B" })
}

#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Change {
    /// Name of the value, such as `digest`, `list_push`, `peak_bytes` or `outcome (time)`.
    pub what: String,
    pub a: String,
    pub b: String,
}

#[derive(Clone, Debug, serde::Serialize)]
pub struct Compared {
    /// Everything that distinguishes the cell from others, such as `nbs, packed, 3D, n = 1000`.
    #[serde(rename = "cell")]
    pub place: String,
    #[serde(rename = "key")]
    pub id: CellId,
    pub changes: Vec<Change>,
    pub absent: Option<String>,
    /// Values that only one record has because a run was interrupted, one line each.
    pub lacks: Vec<String>,
    #[serde(rename = "time")]
    pub timing: Option<Timing>,
}

/// Returns the control that both records have, with its drift: the `named` detector, otherwise one
/// with a twin in both.
pub fn control(a: &[Row], b: &[Row], named: Option<&str>) -> Option<Against> {
    let [a, b] = [a, b].map(Record::new);
    let known = || a.originals().intersection(&b.originals()).next().cloned();
    let detector = named.map(String::from).or_else(known)?;
    let apart = a.cells.values().filter(|cell| cell.id.subject() == detector).filter_map(|in_a| {
        let in_b = b.cells.get(&in_a.id)?;
        Some((in_b.time()?.median / in_a.time()?.median).ln().abs())
    });
    let apart: Vec<f64> = apart.collect();
    let drift = (!apart.is_empty()).then(|| nine_in_ten(&apart));
    Some(Against { detector, drift })
}

pub fn floors(cells: &[Cell]) -> BTreeMap<String, Noise> {
    let mut experiments: BTreeMap<String, Vec<&Cell>> = BTreeMap::new();
    for cell in cells {
        experiments.entry(cell.id.experiment.clone()).or_default().push(cell);
    }
    experiments.into_iter().map(|(name, cells)| (name, Noise::new(&cells))).collect()
}

struct Record {
    cells: BTreeMap<CellId, Cell>,
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

    fn originals(&self) -> BTreeSet<String> {
        let original = |cell: &Cell| Some(cell.role.twin_of()?.to_string());
        let id = |cell: &Cell| Some(CellId { detector: original(cell)?, ..cell.id.clone() });
        self.cells.values().filter_map(|cell| Some(id(cell)?.subject())).collect()
    }

    /// Finds the cell by whose times others are divided: on the same scene, preferably in the same
    /// arithmetic, and with the fewest threads.
    fn reference(&self, id: &CellId, name: &str) -> Option<&Cell> {
        let known = self.scenes.get(&id.scene_id()).into_iter().flatten();
        let known = known.filter_map(|id| self.cells.get(id));
        let known = known.filter(|cell| cell.id.subject() == name && cell.time().is_some());
        known
            .min_by_key(|cell| (preference(&cell.id.arithmetic, &id.arithmetic), cell.id.threads()))
    }
}

/// Compares two records of the same machines. Cells are in the order of keys, including cells of
/// one record only.
pub fn compare(a: &[Row], b: &[Row], options: &Options) -> (Vec<Compared>, Summary) {
    let (a, b) = (Record::new(a), Record::new(b));
    let keys: BTreeSet<&CellId> = a.cells.keys().chain(b.cells.keys()).collect();
    let fields = fields(&a, &b);
    let compared = |key: &CellId| {
        let mut cell = Compared {
            place: place(key, &fields),
            id: key.clone(),
            changes: Vec::new(),
            absent: None,
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
    let moved = match options.side_by_side {
        None => twins::void(&mut found, &b),
        Some(_) => None,
    };
    let summary = Summary::new(&found, moved);
    (found, summary)
}

fn fill(
    cell: &mut Compared,
    (a, in_a): (&Record, &Cell),
    (b, in_b): (&Record, &Cell),
    options: &Options,
) {
    let gone = |cell: &Cell| cell.overall().0 == Outcome::Unavailable;
    if let Some(side) = only(gone(in_a), gone(in_b)) {
        let (_, reason) = if gone(in_a) { in_a.overall() } else { in_b.overall() };
        cell.absent = Some(format!("unavailable in {side}: {reason}"));
        return;
    }
    let [a_hash, b_hash] = [in_a, in_b].map(|it| it.stats.scene_hash.clone());
    if a_hash != b_hash {
        cell.changes.push(Change { what: "scene".into(), a: a_hash, b: b_hash });
        return;
    }
    cell.changes = changes(in_a, in_b, options.machines.is_some());
    if let (Some(in_a), Some(in_b)) = (a.answers.get(&cell.id), b.answers.get(&cell.id))
        && in_a != in_b
    {
        let text = |all: &BTreeSet<String>| Vec::from_iter(all.iter().cloned()).join(" and ");
        cell.changes.push(Change { what: "answer".into(), a: text(in_a), b: text(in_b) });
    }
    cell.timing = timing((a, in_a), (b, in_b), options);
    // A different outcome already explains missing values.
    if cell.changes.is_empty() {
        cell.lacks = lacks(in_a, in_b, cell.timing.is_some());
    }
}

/// Returns the fields that name every cell, and all others that differ.
fn fields(a: &Record, b: &Record) -> Vec<String> {
    let first = ["detector", "arithmetic", "scene", "dim", "n"];
    let others = varying(&a.cells.values().chain(b.cells.values()).collect::<Vec<_>>());
    let others = others.into_iter().filter(|name| !first.contains(&name.as_str()));
    first.map(String::from).into_iter().chain(others).collect()
}

/// Lists outcomes, contacts, counts and bytes that differ. Values missing because of a different
/// outcome are not listed.
fn changes(a: &Cell, b: &Cell, two_machines: bool) -> Vec<Change> {
    let mut found = Vec::new();
    let mut note = |what: &str, a: String, b: String| {
        if a != b {
            found.push(Change { what: what.to_string(), a, b });
        }
    };
    for pass in Pass::ALL {
        if let (Some((in_a, _)), Some((in_b, _))) = (a.passes.get(&pass), b.passes.get(&pass)) {
            // Timeouts are not compared across machines, because they depend on the machine.
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

/// Columns that must be equal. Answers are compared as a whole, and scenes by their fingerprint.
fn exact() -> impl Iterator<Item = &'static str> {
    let measured = [Pass::Count, Pass::Memory].into_iter().flat_map(Column::measured_by);
    measured.map(|column| &*column.name)
}

fn lacks(a: &Cell, b: &Cell, timed: bool) -> Vec<String> {
    let mut found = Vec::new();
    let mut see = |what: &str, has: &dyn Fn(&Cell) -> bool| {
        found.extend(only(has(a), has(b)).map(|side| format!("{what} only in {side}")));
    };
    for pass in Pass::ALL {
        see(&format!("the {} pass", pass.name()), &|cell| cell.passes.contains_key(&pass));
    }
    see("times", &|cell| cell.time().is_some());
    if !timed && a.time().is_some() && b.time().is_some() {
        found.push("no times in blocks of both".into());
    }
    found
}

#[cfg(test)]
mod tests;
