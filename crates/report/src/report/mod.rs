//! The report of a result folder: `report.md`, `report.html`, CSV files and `figures/`, from the
//! record alone. Report, page and terminal are written from the same facts and blocks.

mod text;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::Context;

use crate::document::{self, Block};
use crate::facts::Facts;
use crate::figure::style::Styles;
use crate::table::csv;
use crate::{csv as files, page, research_object, sections};
use contactbench_record::cells::cells;
use contactbench_record::experiment::Experiment;
use contactbench_record::findings::claim::Verdict;
use contactbench_record::findings::trust::failures::Culprit;
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
    for (name, table) in facts.chapters.iter().flat_map(|chapter| chapter.files.iter().cloned()) {
        tables.entry(name).or_default().push(table);
    }
    for (name, tables) in tables {
        let path = folder.join(name);
        std::fs::write(&path, csv(&tables))
            .with_context(|| format!("cannot write {}", path.display()))?;
    }
    // Written last, because it lists all other files.
    if let Some(provenance) = &facts.origin.provenance {
        let question = facts.chapters.first().map_or("", |chapter| &*chapter.experiment.question);
        let path = folder.join(research_object::FILE);
        research_object::text(folder, facts.title(), question, provenance)
            .and_then(|text| std::fs::write(&path, text))
            .with_context(|| format!("cannot write {}", path.display()))?;
    }
    let optional = facts.culprits.absent.iter().map(sections::trust::failures::culprit);
    let mut warnings = std::mem::take(&mut facts.warnings);
    warnings.extend(optional.map(|it| format!("{it} (it is optional)")));
    let figures = facts.chapters.iter().flat_map(|chapter| &chapter.figures).map(|it| it.1.clone());
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

#[cfg(test)]
mod tests;
