//! Compares two records, or the two builds of one, from their folders.

use std::path::Path;

use anyhow::{bail, ensure};

use super::{Compared, Options as How, Summary, compare as cell_by_cell, control, floors, records};
use crate::cells::cells;
use crate::record::id::CellId;
use crate::record::merge::Part;
use crate::record::row::Row;

/// The choice of machines and of the differences that count.
#[derive(Clone, Debug)]
pub struct Terms {
    /// The detector that is the unit of time; `None` chooses one with a twin.
    pub against: Option<String>,
    /// Ignored difference of times, in percent.
    pub band: f64,
    /// Whether both folders are of one machine, although its name differs.
    pub same_machine: bool,
    /// Whether times of two machines are judged, in units of a control.
    pub across_machines: bool,
}

pub struct Comparison {
    /// The folders; one, if it has two builds.
    pub parts: Vec<Part>,
    pub how: How,
    pub cells: Vec<Compared>,
    pub summary: Summary,
}

impl Comparison {
    /// Reads and compares two folders, or the builds of one. Fails if they have no cell in common.
    /// `note` receives what is doubtful about the records.
    pub fn read<'a>(
        folders: impl Iterator<Item = &'a Path>,
        terms: &Terms,
        note: &mut dyn FnMut(&str),
    ) -> anyhow::Result<Comparison> {
        let parts = folders.map(Part::read).collect::<anyhow::Result<Vec<_>>>()?;
        for part in &parts {
            let folder = part.folder.display();
            ensure!(!part.rows.is_empty(), "the record in {folder} has no rows");
            if let Some(name) = &terms.against {
                let known = records::detectors(part);
                ensure!(
                    known.contains(name),
                    "--against {name}: {folder} has no rows of this detector; it has {}",
                    known.into_iter().collect::<Vec<_>>().join(", ")
                );
            }
            part.warnings.iter().for_each(|warning| note(warning));
        }
        let (how, [a, b]) = match &*parts {
            [both] => builds(both, terms)?,
            [a, b] => folders_apart([a, b], terms)?,
            _ => bail!("compare takes one folder or two"),
        };
        let (cells, summary) = cell_by_cell(&a, &b, &how);
        let folders = parts.iter().map(|part| part.folder.display().to_string());
        ensure!(
            summary.absent < summary.cells,
            "nothing to compare in {}: each of the {} cells has results on one side only; name \
             results of the same experiment",
            folders.collect::<Vec<_>>().join(" and "),
            cells.len()
        );
        Ok(Comparison { parts, how, cells, summary })
    }
}

/// Splits a record of two builds into the rows of the base and of this build.
pub fn by_build(rows: &[Row]) -> [Vec<Row>; 2] {
    let (mut base, mut this) = (Vec::new(), Vec::new());
    for row in rows {
        match row.role.base_of() {
            Some(original) => {
                let id = CellId { detector: original.into(), ..row.id.clone() };
                base.push(Row { id, ..row.clone() });
            }
            None if !row.role.is_control() => this.push(row.clone()),
            None => {}
        }
    }
    [base, this]
}

fn builds(part: &Part, terms: &Terms) -> anyhow::Result<(How, [Vec<Row>; 2])> {
    let both = by_build(&part.rows);
    ensure!(
        !both[0].is_empty(),
        "the record in {} has one build; name a second folder, or time another build with \
         contactbench run --against PROGRAM",
        part.folder.display()
    );
    let floors = floors(&cells(&part.rows));
    let how = How { band: terms.band / 100.0, side_by_side: Some(floors), ..How::default() };
    Ok((how, both))
}

fn folders_apart(both: [&Part; 2], terms: &Terms) -> anyhow::Result<(How, [Vec<Row>; 2])> {
    let [a, b] = records::common(both)?;
    let how = How {
        band: terms.band / 100.0,
        side_by_side: None,
        against: control(&a, &b, terms.against.as_deref()),
        machines: records::two_machines(both).filter(|_| !terms.same_machine),
        across: terms.across_machines,
        builds: records::two_builds(both),
    };
    Ok((how, [a, b]))
}
