//! The table of all measurements, the table of one detector, and its history.

use std::collections::BTreeMap;

use super::{About, Record, stem};
use crate::table::{Cell as Entry, Rows, Table};
use contactbench_record::cells::{Cell, ids, label};
use contactbench_record::record::column::Column;
use contactbench_record::record::folder::ledger::Ledger;
use contactbench_record::record::id::{CellId, Projection};
use contactbench_record::record::row::{Outcome, Pass};

/// Age from which the site shows a measurement in grey, in days.
const OLD_DAYS: i64 = 90;

/// One subject on one scene and machine.
#[derive(Clone)]
pub struct Line<'a> {
    pub record: &'a Record<'a>,
    cell: &'a Cell,
    scene: String,
    version: String,
    ours: bool,
    pub grey: bool,
}

impl Line<'_> {
    /// Returns the name without parameters; a tracker has that of the detector below it.
    pub fn detector(&self) -> &str {
        &self.cell.id.detector
    }

    fn per(&self, name: &str) -> Option<f64> {
        Some(self.cell.variable(name, None)? / self.cell.id.n.max(1) as f64 / self.cell.frames())
    }

    /// Returns the time per particle; that of a wrong answer is in brackets.
    fn time(&self) -> Entry {
        let wrong = self.cell.wrong_time().map(|time| time / self.cell.id.n.max(1) as f64);
        match wrong {
            Some(time) => Entry::Number(time).wrong(),
            None => self.per("time_ns").into(),
        }
    }

    fn answer(&self) -> &'static str {
        let (outcome, _) = self.cell.overall();
        match outcome {
            Outcome::Ok | Outcome::Lossy if self.wrong().is_some() => Outcome::Wrong.name(),
            Outcome::Ok => "right",
            outcome => outcome.name(),
        }
    }

    /// Returns the number of wrong pairs; `None` if there are none, or if they were not counted.
    fn wrong(&self) -> Option<u64> {
        self.cell.errors.map(|errors| errors.wrong()).filter(|&wrong| wrong > 0)
    }

    fn date(&self) -> String {
        self.record.day.clone() + if self.grey { " (old)" } else { "" }
    }

    /// The identity of exact counts, which are the same in every record.
    fn key(&self) -> Projection {
        self.cell.id.without(&["experiment", "machine"])
    }

    /// Returns operations and bytes, which two programs share if they compute in the same way.
    fn counted(&self) -> [Option<u64>; 2] {
        let bytes = self.cell.variable("peak_bytes", None);
        [Some(self.operations()), bytes].map(|value| value.map(|value| value as u64))
    }

    fn operations(&self) -> f64 {
        Column::measured_by(Pass::Count)
            .filter_map(|column| self.cell.variable(&column.name, None))
            .sum()
    }
}

/// Returns the number of days since a fixed day; `None` unless the text is YYYY-MM-DD.
fn days(day: &str) -> Option<i64> {
    let mut parts = day.split('-').map(|part| part.parse::<i64>().ok());
    let [year, month, day] = [parts.next()??, parts.next()??, parts.next()??];
    // The year begins in March, so that its last day is a possible 29 February.
    let (year, month) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
    let leap = year.div_euclid(4) - year.div_euclid(100) + year.div_euclid(400);
    Some(365 * year + leap + (153 * month + 2) / 5 + day - 1)
}

/// Returns a line for each cell that was timed or that failed, without controls.
pub fn lines<'a>(
    records: &'a [Record<'a>],
    today: &str,
    about: &dyn Fn(&str) -> Option<About>,
) -> Vec<Line<'a>> {
    let mut ours: BTreeMap<&str, bool> = BTreeMap::new();
    let mut lines = Vec::new();
    for record in records {
        let cells: Vec<&Cell> = record.facts.cells.iter().collect();
        let (swept, versions) = (label::swept(&cells), versions(record));
        let seed = |cell: &Cell| cell.id.axis("seed");
        let seeded = cells.iter().any(|cell| seed(cell) != seed(cells[0]));
        let old =
            days(today).zip(days(&record.day)).is_some_and(|(now, then)| now - then > OLD_DAYS);
        let timed = cells
            .into_iter()
            .filter(|cell| !cell.role.is_control() && cell.passes.contains_key(&Pass::Time));
        for cell in timed {
            let name = &*cell.id.detector;
            let ours = *ours.entry(name).or_insert_with(|| {
                about(name).map_or_else(|| cell.role.is_ours(), |about| about.ours)
            });
            let version = match ours {
                true => record.revision.clone(),
                false => versions.get(&cell.id).cloned().unwrap_or_default(),
            };
            let mut scene = label::title(cell.id.scene_id(), &swept);
            if let Some(seed) = seed(cell).filter(|_| seeded) {
                scene += &format!(", seed {seed}");
            }
            let grey = old || ours && record.older;
            lines.push(Line { record, cell, scene, version, ours, grey });
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

/// Adds the columns that all tables of measurements share.
fn measured<'a>(rows: Rows<&'a Line<'a>>) -> Rows<&'a Line<'a>> {
    rows.left("answer", |it| it.answer())
        .right("wrong pairs", |it| it.wrong())
        .unit("time / N", "ns", |it| it.time())
        .unit("time / pair", "ns", |it| it.cell.per_pair(it.cell.time()?.median))
        .unit("memory / N", "bytes", |it| it.per("peak_bytes"))
        .right("threads", |it| it.cell.id.threads())
}

pub fn table<'a>(lines: &'a [Line<'a>]) -> Table {
    let page = |line: &Line<'_>| format!("detectors/{}.html", stem(line.detector()));
    let rows = Table::of("", lines)
        .left("scene", |it| &*it.scene)
        .left("detector", |it| Entry::Link(it.cell.id.subject(), page(it)))
        .left("kind", |it| if it.ours { "ours" } else { "library" });
    measured(rows)
        .left("arithmetic", |it| &*it.cell.id.arithmetic)
        .left("machine", |it| &*it.record.cpu)
        .left("version", |it| &*it.version)
        .left("record", |it| Entry::Link(it.date(), it.record.page()))
        .into()
}

/// Returns the table of the lines of one detector in one record.
pub fn own<'a>(lines: &'a [Line<'a>]) -> Table {
    let rows = Table::of("", lines)
        .left("scene", |it| &*it.scene)
        .left("settings", |it| it.cell.id.subject());
    measured(rows).left("version", |it| &*it.version).into()
}

/// Returns markup for the first cell of each grey row; a style greys rows that have it.
pub fn greyed<'a>(lines: &'a [Line<'_>]) -> impl Fn(Option<usize>, usize) -> String + 'a {
    |row, column| match row {
        Some(row) if column == 0 && lines[row].grey => "<i class=\"old\"></i>".into(),
        _ => String::new(),
    }
}

/// Returns the exact counts of scenes for which they changed from one program to another; `None` if
/// there are none.
pub fn history(lines: &[&Line<'_>]) -> Option<Table> {
    let mut groups: BTreeMap<Projection, Vec<&Line<'_>>> = BTreeMap::new();
    for line in lines.iter().filter(|line| line.ours && line.operations() > 0.0) {
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
    let table: Table = Table::of("", rows.iter().copied())
        .left("scene", |it| it.0)
        .left("settings", |it| it.1.cell.id.subject())
        .left("program", |it| format!("{} ({})", it.1.record.day, it.1.record.revision))
        .right("contact tests / N", |it| it.1.per("contact_test"))
        .right("operations / N", |it| it.1.operations() / it.1.cell.id.n.max(1) as f64)
        .right("bytes / N", |it| it.1.per("peak_bytes"))
        .into();
    (!table.rows.is_empty()).then_some(table)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_counted_over_leap_years() {
        let between = |from: &str, to: &str| days(to).unwrap() - days(from).unwrap();
        assert_eq!(between("2026-11-27", "2026-11-28"), 1);
        assert_eq!(between("2028-02-28", "2028-03-01"), 2);
        assert_eq!(between("2026-02-28", "2026-03-01"), 1);
        assert_eq!(between("1999-12-31", "2001-01-01"), 367);
        assert_eq!(days("27 November 2026"), None);
    }
}
