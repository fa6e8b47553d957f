//! The table of all measurements, and of one detector.

use std::collections::{BTreeMap, BTreeSet};

use super::{About, Record};
use crate::page::measured;
use crate::table::{Cell as Entry, Table};
use contactbench_record::cells::{Cell, ids, label};
use contactbench_record::record::folder::ledger::Ledger;
use contactbench_record::record::id::CellId;
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
        let old = if self.old { " (old)" } else { "" };
        let disturbed = if self.record.sound() { "" } else { " (disturbed)" };
        format!("{}{old}{disturbed}", self.record.day)
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
    let rows = Table::of("", lines.iter().copied())
        .left("scene", |it| &*it.scene)
        .left("detector", |it| it.cell.id.subject())
        .left("kind", |it| if it.ours { "ours" } else { "library" });
    measured(rows, |it| it.cell)
        .left("machine", |it| &*it.record.cpu)
        .left("version", |it| &*it.version)
        .left("record", |it| Entry::Link(it.date(), format!("{root}{}", it.record.page())))
        .into()
}
