//! The table of all measurements, the table of one detector, and its history.

use std::collections::{BTreeMap, BTreeSet};

use super::{About, Record, stem};
use crate::page::{measured, operations};
use crate::table::{Cell as Entry, Table};
use contactbench_record::cells::{Cell, ids, label};
use contactbench_record::record::folder::ledger::Ledger;
use contactbench_record::record::id::{CellId, Projection};
use contactbench_record::record::row::Pass;

/// One subject on one scene and machine.
pub struct Line<'a> {
    pub record: &'a Record<'a>,
    pub cell: &'a Cell,
    scene: String,
    version: String,
    ours: bool,
    /// Whether a later record is of another version of this detector.
    pub old: bool,
}

impl Line<'_> {
    /// Returns the name without parameters; a tracker has that of the detector below it.
    pub fn detector(&self) -> &str {
        &self.cell.id.detector
    }

    fn date(&self) -> String {
        self.record.day.clone() + if self.old { " (old)" } else { "" }
    }

    /// The identity of exact counts, which are the same in every record.
    fn key(&self) -> Projection {
        self.cell.id.without(&["experiment", "machine"])
    }

    /// Returns operations and bytes, which two programs share if they compute in the same way.
    fn counted(&self) -> [Option<u64>; 2] {
        let bytes = self.cell.variable("peak_bytes", None);
        [Some(operations(self.cell)), bytes].map(|value| value.map(|value| value as u64))
    }
}

/// Returns a line for each cell that was timed or that failed, without controls.
pub fn lines<'a>(
    records: &'a [Record<'a>],
    about: &dyn Fn(&str) -> Option<About>,
) -> Vec<Line<'a>> {
    let mut lines = Vec::new();
    for record in records {
        let cells: Vec<&Cell> = record.facts.cells.iter().collect();
        let (swept, versions) = (label::swept(&cells), versions(record));
        let seeds: BTreeSet<u64> = cells.iter().map(|cell| cell.id.seed).collect();
        let timed = cells.into_iter().filter(|cell| !cell.role.is_control());
        for cell in timed.filter(|cell| cell.passes.contains_key(&Pass::Time)) {
            let known = about(&cell.id.detector);
            let ours = known.map_or_else(|| cell.role.is_ours(), |about| about.ours);
            let version = match ours {
                true => record.revision.clone(),
                false => versions.get(&cell.id).cloned().unwrap_or_default(),
            };
            let mut scene = label::title(cell.id.scene_id(), &swept);
            if seeds.len() > 1 {
                scene += &format!(", seed {}", cell.id.seed);
            }
            lines.push(Line { record, cell, scene, version, ours, old: ours && record.older });
        }
    }
    lines
}

/// Returns the version of the program or library behind each cell.
fn versions(record: &Record<'_>) -> BTreeMap<CellId, String> {
    let ledger: &Ledger = &record.facts.origin.ledger;
    let version =
        |process: &Option<String>| Some(ledger.processes.get(process.as_ref()?)?.version.clone());
    ids(record.rows).filter_map(|(id, row)| Some((id, version(&row.process)?))).collect()
}

/// Returns the table of these measurements. `root` is the way from its page to the front page.
pub fn table(lines: &[&Line<'_>], root: &str) -> Table {
    let page = |line: &Line<'_>| format!("{root}detectors/{}.html", stem(line.detector()));
    let rows = Table::of("", lines.iter().copied())
        .left("scene", |it| &*it.scene)
        .left("detector", |it| Entry::Link(it.cell.id.subject(), page(it)))
        .left("kind", |it| if it.ours { "ours" } else { "library" });
    measured(rows, |it| it.cell)
        .left("machine", |it| &*it.record.cpu)
        .left("version", |it| &*it.version)
        .left("record", |it| Entry::Link(it.date(), format!("{root}{}", it.record.page())))
        .into()
}

/// Returns the exact counts of scenes for which they changed from one program to another; `None` if
/// there are none.
pub fn history(lines: &[&Line<'_>]) -> Option<Table> {
    let mut groups: BTreeMap<Projection, Vec<&Line<'_>>> = BTreeMap::new();
    for line in lines.iter().filter(|line| line.ours && operations(line.cell) > 0.0) {
        groups.entry(line.key()).or_default().push(line);
    }
    // Another record may describe the same scene in other words.
    let mut rows: Vec<(&str, &Line<'_>)> = Vec::new();
    for lines in groups.values_mut() {
        lines.sort_by_key(|line| &line.record.day);
        lines.dedup_by_key(|line| line.counted());
        if lines.len() > 1 {
            rows.extend(lines.iter().map(|line| (&*lines[0].scene, *line)));
        }
    }
    let per = |cell: &Cell, name| Some(cell.variable(name, None)? / cell.id.n.max(1) as f64);
    let table: Table = Table::of("", rows.iter().copied())
        .left("scene", |it| it.0)
        .left("settings", |it| it.1.cell.id.subject())
        .left("program", |it| format!("{} ({})", it.1.record.day, it.1.record.revision))
        .right("contact tests / N", |it| per(it.1.cell, "contact_test"))
        .right("operations / N", |it| operations(it.1.cell) / it.1.cell.id.n.max(1) as f64)
        .right("bytes / N", |it| per(it.1.cell, "peak_bytes"))
        .into();
    (!table.rows.is_empty()).then_some(table)
}
