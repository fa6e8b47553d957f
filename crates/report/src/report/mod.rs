//! The report of a result folder: `report.md`, `report.html`, CSV files and `figures/`, from the
//! record alone. Report, page and terminal are written from the same facts and blocks.

mod text;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::Context;
use serde_json::Value;

use crate::document::{self, Block, Text};
use crate::figure::style::Styles;
use crate::sections::{self, About, DETAILS, SPEED, ratios};
use crate::table::{self, csv};
use crate::{csv as files, figure, page, research_object};
use contactbench_record::cells::{Cell, cells};
use contactbench_record::experiment::{Experiment, Table};
use contactbench_record::findings::claim::verdicts::Matrix;
use contactbench_record::findings::claim::{self, Verdict};
use contactbench_record::findings::ratios::Ratios;
use contactbench_record::findings::trust::conditions::Conditions;
use contactbench_record::findings::trust::coverage::Coverage;
use contactbench_record::findings::trust::failures::{Culprit, Culprits};
use contactbench_record::findings::winners::{Winners, winners};
use contactbench_record::record::folder::ledger::Ledger;
use contactbench_record::record::origin::{hardware, provenance};
use contactbench_record::record::row::Row;

pub struct Report {
    pub verdicts: Vec<Verdict>,
    /// Subjects that were wrong, crashed or could not be started, each listed once.
    pub culprits: Vec<Culprit>,
    pub terminal: Vec<Block>,
    pub figures: Vec<PathBuf>,
    pub path: PathBuf,
    pub page: PathBuf,
    /// Sentences about what was left out: those passed in, and one per figure that could not be
    /// drawn.
    pub warnings: Vec<String>,
}

pub struct Facts<'a> {
    pub parts: Vec<Part<'a>>,
    pub cells: &'a [Cell],
    pub verdicts: Vec<Verdict>,
    pub styles: Styles,
    pub origin: Origin,
    /// Notes on incomplete plans and on doubtful times.
    pub alerts: Vec<Block>,
    pub wrong: Vec<String>,
    pub culprits: Culprits,
    /// A sentence if the record has all of its plan.
    pub whole: Option<String>,
    pub warnings: Vec<String>,
}

pub struct Part<'a> {
    pub experiment: &'a Experiment,
    pub cells: Vec<&'a Cell>,
    pub coverage: Coverage<'a>,
    pub verdicts: Vec<Verdict>,
    pub winners: Winners,
    pub asks_fastest: bool,
    /// Comparison of the reference with libraries, in words.
    pub answer: Option<Text>,
    pub matrix: Option<Matrix>,
    /// Title and file of each figure.
    pub figures: Vec<(String, PathBuf)>,
    pub tables: Vec<Block>,
    pub files: Vec<(&'static str, table::Table)>,
}

pub struct Origin {
    pub provenance: Option<Value>,
    /// Provenance of the runs that resumed the record, by date.
    pub resumed: Vec<Value>,
    pub conditions: Conditions,
    pub ledger: Ledger,
}

/// Writes the report of these experiments into `folder`. Rows of other experiments only appear in
/// `summary.csv`. A figure that cannot be drawn causes a warning; a file that cannot be written is
/// an error.
pub fn write(
    folder: &Path,
    experiments: &[Experiment],
    rows: &[Row],
    warnings: &[String],
) -> anyhow::Result<Report> {
    let cells = cells(rows);
    let mut facts = Facts::new(folder, experiments, &cells, rows, Styles::new(cells.iter()));
    facts.warnings = warnings.to_vec();
    facts.draw(&folder.join("figures"), usize::MAX);
    let (path, page) = (folder.join("report.md"), folder.join("report.html"));
    for (path, text) in [(&path, document::markdown(&facts.report())), (&page, page::html(&facts))]
    {
        std::fs::write(path, text)
            .with_context(|| format!("cannot write the report {}", path.display()))?;
    }
    let mut tables = BTreeMap::from([("summary.csv", vec![files::summary(&cells)])]);
    for (name, table) in facts.parts.iter().flat_map(|part| part.files.iter().cloned()) {
        tables.entry(name).or_default().push(table);
    }
    for (name, tables) in tables {
        let path = folder.join(name);
        std::fs::write(&path, csv(&tables))
            .with_context(|| format!("cannot write {}", path.display()))?;
    }
    // Written last, because it lists all other files.
    if let Some(provenance) = &facts.origin.provenance {
        let question = facts.parts.first().map_or("", |part| &*part.experiment.question);
        let path = folder.join(research_object::FILE);
        research_object::text(folder, facts.title(), question, provenance)
            .and_then(|text| std::fs::write(&path, text))
            .with_context(|| format!("cannot write {}", path.display()))?;
    }
    let optional = facts.culprits.absent.iter().map(sections::trust::failures::culprit);
    let mut warnings = std::mem::take(&mut facts.warnings);
    warnings.extend(optional.map(|it| format!("{it} (it is optional)")));
    let figures = facts.parts.iter().flat_map(|part| &part.figures).map(|it| it.1.clone());
    Ok(Report {
        terminal: facts.terminal(),
        culprits: facts.culprits.all,
        figures: figures.collect(),
        verdicts: facts.verdicts,
        path,
        page,
        warnings,
    })
}

impl<'a> Facts<'a> {
    /// Everything but figures and the warnings of the record.
    pub fn new(
        folder: &Path,
        experiments: &'a [Experiment],
        cells: &'a [Cell],
        rows: &[Row],
        styles: Styles,
    ) -> Facts<'a> {
        let origin = Origin::read(folder, rows);
        let parts: Vec<Part<'_>> = experiments.iter().map(|it| Part::new(it, cells)).collect();
        let culprits = Culprits::new(&cells.iter().collect::<Vec<_>>(), experiments);
        let doubts = sections::trust::conditions::sentence(&origin.conditions);
        let coverage = parts.iter().map(|part| (&*part.experiment.name, &part.coverage));
        let (whole, partial) =
            sections::trust::coverage::whole_or_partial(&coverage.collect::<Vec<_>>());
        let alerts = partial.into_iter().chain(doubts).map(|text| Block::Warning(text.into()));
        Facts {
            verdicts: parts.iter().flat_map(|part| part.verdicts.clone()).collect(),
            cells,
            styles,
            alerts: alerts.collect(),
            wrong: culprits.all.iter().map(sections::trust::failures::culprit).collect(),
            culprits,
            whole,
            warnings: Vec::new(),
            origin,
            parts,
        }
    }

    /// Draws at most `most` figures of each experiment into a folder. A figure that cannot be drawn
    /// causes a warning.
    pub fn draw(&mut self, folder: &Path, most: usize) {
        let caches = hardware::caches_of(self.origin.provenance.as_ref());
        for part in &mut self.parts {
            let failed = part.draw(folder, most, self.cells, &self.styles, &caches);
            self.warnings.extend(failed);
        }
    }
}

impl Origin {
    fn read(folder: &Path, rows: &[Row]) -> Origin {
        let ledger = Ledger::read(folder);
        Origin {
            provenance: provenance::of_folder(folder),
            resumed: provenance::of_others(folder, "resumed-"),
            conditions: Conditions::new(&provenance::all(folder), &ledger, rows),
            ledger,
        }
    }
}

impl<'a> Part<'a> {
    fn new(experiment: &'a Experiment, cells: &'a [Cell]) -> Part<'a> {
        let own: Vec<&Cell> = of(experiment, cells).iter().collect();
        let coverage = Coverage::new(experiment, &own);
        let matrix = Matrix::new(&own).filter(|_| experiment.table == Some(Table::Verdicts));
        let winners = winners(&own);
        let about = About { experiment, cells: &own, winners: &winners };
        let (mut tables, mut files) = (Vec::new(), Vec::new());
        let details = if matrix.is_none() { DETAILS } else { &[] };
        for section in SPEED.iter().chain(details).flat_map(|make| make(&about)) {
            tables.push(Block::heading(3, section.heading));
            tables.extend(section.blocks);
            files.extend(section.csv);
        }
        files.extend(
            matrix.iter().map(|_| ("verdicts.csv", sections::claims::verdicts::rows(&own))),
        );
        let found = experiment.ratios_to.as_deref().and_then(|to| Ratios::new(&own, to));
        let compared = found.filter(|found| !found.libraries.is_empty());
        Part {
            experiment,
            verdicts: claim::verdicts(experiment, cells, &coverage),
            coverage,
            asks_fastest: experiment.asks_fastest(),
            answer: compared.as_ref().map(ratios::headline),
            matrix,
            figures: Vec::new(),
            winners,
            tables,
            files,
            cells: own,
        }
    }

    /// Draws the figures into a folder, and returns a sentence for each that cannot be drawn.
    fn draw(
        &mut self,
        folder: &Path,
        most: usize,
        cells: &[Cell],
        styles: &Styles,
        caches: &[(String, u64)],
    ) -> Vec<String> {
        let (mut failed, experiment) = (Vec::new(), self.experiment);
        // An experiment that has not begun has no variables, either.
        let begun = if of(experiment, cells).is_empty() { 0 } else { most };
        for figure in experiment.figures.iter().take(begun) {
            let cells = of(experiment, cells);
            match (figure::About { experiment, figure, cells, styles, caches }).draw(folder) {
                Ok(path) => self.figures.extend(path.map(|path| (figure.title.clone(), path))),
                Err(error) => failed.push(format!(
                    "the figure {} of {} was not drawn: {error:#}",
                    figure.name, experiment.name
                )),
            }
        }
        failed
    }

    pub fn sentence(&self) -> Text {
        self.answer.clone().unwrap_or_else(|| sections::winners::sentence(&self.winners))
    }

    pub fn brief(&self) -> Option<Text> {
        let fastest = self.asks_fastest && !self.winners.contests.is_empty();
        match self.verdicts.iter().any(|verdict| !verdict.answers.is_empty()) {
            false if fastest => Some(sections::winners::brief(&self.winners)),
            _ => sections::answer::brief(&self.verdicts),
        }
    }

    fn fastest(&self, cold: bool) -> Vec<Block> {
        let mut blocks = match self.asks_fastest {
            true => sections::winners::blocks(&self.winners, cold),
            false => Vec::new(),
        };
        if let Some(first) = blocks.first_mut() {
            *first = Block::Paragraph(self.sentence());
        }
        blocks
    }
}

/// Returns the cells of an experiment. The input must be sorted by experiment.
fn of<'a>(experiment: &Experiment, cells: &'a [Cell]) -> &'a [Cell] {
    let name = &experiment.name;
    let start = cells.partition_point(|cell| cell.id.experiment < *name);
    let count = cells[start..].partition_point(|cell| cell.id.experiment == *name);
    &cells[start..start + count]
}

#[cfg(test)]
mod tests;
