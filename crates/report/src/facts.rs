//! Everything that report, page and site show of a record: its experiments with their findings, and
//! where it comes from.

use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::document::{Block, Text};
use crate::figure::style::Styles;
use crate::sections::{self, About, DETAILS, SPEED, ratios};
use crate::{figure, table};
use contactbench_record::cells::Cell;
use contactbench_record::experiment::{Experiment, Table};
use contactbench_record::findings::claim::verdicts::Matrix;
use contactbench_record::findings::claim::{self, Verdict};
use contactbench_record::findings::ratios::Ratios;
use contactbench_record::findings::trust::conditions::Conditions;
use contactbench_record::findings::trust::coverage::Coverage;
use contactbench_record::findings::trust::failures::Culprits;
use contactbench_record::findings::trust::modes::Modes;
use contactbench_record::findings::winners::{Winners, winners};
use contactbench_record::record::folder::ledger::Ledger;
use contactbench_record::record::origin::{hardware, provenance};
use contactbench_record::record::row::Row;

pub struct Facts<'a> {
    pub chapters: Vec<Chapter<'a>>,
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

pub struct Chapter<'a> {
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
    pub conditions: Conditions,
    pub ledger: Ledger,
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
        let ledger = Ledger::read(folder);
        let conditions = Conditions::new(&provenance::all(folder), &ledger, rows);
        let origin = Origin { provenance: provenance::of_folder(folder), conditions, ledger };
        let disturbed = origin.conditions.disturbed;
        let chapters: Vec<Chapter<'_>> =
            experiments.iter().map(|it| Chapter::new(it, cells, disturbed)).collect();
        let culprits = Culprits::new(&cells.iter().collect::<Vec<_>>(), experiments);
        let doubts = sections::trust::conditions::sentence(&origin.conditions);
        let coverage =
            chapters.iter().map(|chapter| (&*chapter.experiment.name, &chapter.coverage));
        let (whole, partial) =
            sections::trust::coverage::whole_or_partial(&coverage.collect::<Vec<_>>());
        let modes = Modes::new(&cells.iter().collect::<Vec<_>>());
        let doubts = doubts.into_iter().chain(sections::trust::conditions::modes(modes));
        let alerts = partial.into_iter().chain(doubts).map(|text| Block::Warning(text.into()));
        Facts {
            verdicts: chapters.iter().flat_map(|chapter| chapter.verdicts.clone()).collect(),
            cells,
            styles,
            alerts: alerts.collect(),
            wrong: culprits.all.iter().map(sections::trust::failures::culprit).collect(),
            culprits,
            whole,
            warnings: Vec::new(),
            origin,
            chapters,
        }
    }

    /// Draws at most `most` figures of each experiment into a folder. A figure that cannot be drawn
    /// causes a warning.
    pub fn draw(&mut self, folder: &Path, most: usize) {
        let caches = hardware::caches_of(self.origin.provenance.as_ref());
        let (styles, caches) = (&self.styles, &*caches);
        for chapter in &mut self.chapters {
            let (experiment, cells) = (chapter.experiment, of(chapter.experiment, self.cells));
            // An experiment that has not begun has no variables, either.
            let begun = if cells.is_empty() { 0 } else { most };
            for figure in experiment.figures.iter().take(begun) {
                match (figure::About { experiment, figure, cells, styles, caches }).draw(folder) {
                    Ok(path) => {
                        chapter.figures.extend(path.map(|path| (figure.title.clone(), path)))
                    }
                    Err(error) => self.warnings.push(format!(
                        "the figure {} of {} was not drawn: {error:#}",
                        figure.name, experiment.name
                    )),
                }
            }
        }
    }
}

impl<'a> Chapter<'a> {
    fn new(experiment: &'a Experiment, cells: &'a [Cell], disturbed: bool) -> Chapter<'a> {
        let own: Vec<&Cell> = of(experiment, cells).iter().collect();
        let coverage = Coverage::new(experiment, &own);
        let matrix = Matrix::new(&own).filter(|_| experiment.table == Some(Table::Verdicts));
        let mut winners = winners(&own);
        let mut verdicts = claim::verdicts(experiment, cells, &coverage);
        if disturbed {
            winners.withdraw();
            verdicts.iter_mut().for_each(Verdict::withdraw);
        }
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
        Chapter {
            experiment,
            verdicts,
            coverage,
            asks_fastest: experiment.asks_fastest(),
            answer: compared.as_ref().map(|it| ratios::headline(it, disturbed)),
            matrix,
            figures: Vec::new(),
            winners,
            tables,
            files,
            cells: own,
        }
    }

    /// Returns whether the answer is which subject is the fastest.
    pub fn is_a_race(&self) -> bool {
        let answered = self.verdicts.iter().any(|verdict| !verdict.claim.answers.is_empty());
        self.asks_fastest && !self.winners.contests.is_empty() && !answered
    }

    pub fn sentence(&self) -> Text {
        self.answer.clone().unwrap_or_else(|| sections::winners::sentence(&self.winners))
    }

    pub fn fastest(&self, cold: bool) -> Vec<Block> {
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
