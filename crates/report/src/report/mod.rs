//! The report of a result folder: `report.md`, `report.html`, `summary.csv` and `figures/`, from
//! the record alone. Report and page are written from the same findings and blocks.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::Context;
use serde_json::Value;

use crate::document::{self, Block, Text};
use crate::figure::style::Styles;
use crate::page::Page;
use crate::page::origin::{command, shown};
use crate::sections::map::Drawn;
use crate::sections::{self, About, DETAILS, SPEED};
use crate::table::{self, csv};
use crate::{csv as files, figure, page};
use contactbench_record::cells::machine::Machine;
use contactbench_record::cells::{Cell, cells};
use contactbench_record::experiment::{Experiment, Table};
use contactbench_record::findings::claim::{self, Verdict};
use contactbench_record::findings::conditions::Conditions;
use contactbench_record::findings::coverage::{Coverage, Scope, Summary};
use contactbench_record::findings::failures::{Culprit, Culprits};
use contactbench_record::findings::verdicts::Matrix;
use contactbench_record::findings::winners::{Winners, winners};
use contactbench_record::record::ledger::Ledger;
use contactbench_record::record::provenance;
use contactbench_record::record::row::Row;

/// What was written.
pub struct Report {
    /// All claims, in the order of the experiments.
    pub verdicts: Vec<Verdict>,
    /// Who is wrong, or crashed: each once.
    pub culprits: Vec<Culprit>,
    /// What a terminal shows: who is wrong, answers, winners, claims.
    pub terminal: Vec<Block>,
    /// The figures.
    pub figures: Vec<PathBuf>,
    /// The report in Markdown.
    pub path: PathBuf,
    /// The report as a page, with charts.
    pub page: PathBuf,
    /// Sentences about what was left out: those given, and figures that could not be drawn.
    pub warnings: Vec<String>,
}

/// What is found in one experiment.
pub struct Part<'a> {
    /// The experiment.
    pub experiment: &'a Experiment,
    /// Its cells.
    pub cells: Vec<&'a Cell>,
    /// How much of its plan is there.
    pub coverage: Summary,
    /// Its claims.
    pub verdicts: Vec<Verdict>,
    /// The fastest detector of each scene.
    pub winners: Winners,
    /// Does the question ask for it?
    pub asks_fastest: bool,
    /// How the detector of interest compares, in a sentence, if the experiment asks.
    pub headline: Option<sections::Headline>,
    /// Who is right, case by case, if the experiment asks.
    pub matrix: Option<Matrix>,
    /// Its figures: title and file.
    pub figures: Vec<(String, PathBuf)>,
    /// The maps among them.
    pub maps: Vec<Drawn>,
    /// All its tables.
    pub tables: Vec<Block>,
    /// Names and tables of CSV files.
    pub files: Vec<(&'static str, table::Table)>,
}

/// Where a record is from.
#[derive(Clone, Copy)]
pub struct Origin<'a> {
    /// Command, revision and machine.
    pub provenance: Option<&'a Value>,
    /// What makes its times doubtful, and what else the machine did.
    pub conditions: &'a Conditions,
    /// The programs that answered.
    pub ledger: &'a Ledger,
}

/// Writes the report of these experiments into `folder`. Rows of other experiments are in
/// `summary.csv` only. A figure that cannot be drawn as written is a warning; files that cannot be
/// written are an error.
pub fn write(
    folder: &Path,
    experiments: &[Experiment],
    rows: &[Row],
    warnings: &[String],
) -> anyhow::Result<Report> {
    let cells = cells(rows);
    let styles = Styles::new(cells.iter());
    let figure_folder = folder.join("figures");
    let provenance = provenance::of_folder(folder);
    let provenance = provenance.as_ref();
    let ledger = Ledger::read(folder);
    let conditions = Conditions::new(&provenance::all(folder), &ledger, rows);
    let machine = Machine::from_provenance(provenance);
    let scope = Scope::new(provenance, experiments);
    let (mut parts, mut warnings) = (Vec::new(), warnings.to_vec());
    for experiment in experiments {
        let mut part = Part::new(experiment, &cells, &scope);
        for plan in &experiment.figures {
            match figure::draw(&figure_folder, experiment, plan, &cells, &styles, &machine) {
                Ok(path) => part.figures.extend(path.map(|path| (plan.title.clone(), path))),
                Err(error) => warnings.push(format!(
                    "the figure {} of {} was not drawn: {error:#}",
                    plan.name, experiment.name
                )),
            }
        }
        parts.push(part);
    }
    let (path, page) = (folder.join("report.md"), page::path(folder));
    let culprits = Culprits::new(&cells.iter().collect::<Vec<_>>(), experiments);
    // Nothing is more important.
    let wrong: Vec<String> = culprits.all.iter().map(sections::failures::culprit).collect();
    let said = [&wrong[..], &warnings[..]].concat();
    let origin = Origin { provenance, conditions: &conditions, ledger: &ledger };
    let text = document::markdown(&blocks(&parts, &said, &origin));
    let (resumed, cells, styles) = (resumed(folder), &cells, &styles);
    let (warned, parted) = (&said, &parts);
    let html = Page { parts: parted, cells, styles, origin, resumed, warnings: warned }.html();
    for (path, text) in [(&path, text), (&page, html)] {
        std::fs::write(path, text)
            .with_context(|| format!("cannot write the report {}", path.display()))?;
    }
    let mut tables = BTreeMap::from([("summary.csv", vec![files::summary(cells)])]);
    for (name, table) in parts.iter().flat_map(|part| part.files.iter().cloned()) {
        tables.entry(name).or_default().push(table);
    }
    for (name, tables) in tables {
        let path = folder.join(name);
        std::fs::write(&path, csv(&tables))
            .with_context(|| format!("cannot write {}", path.display()))?;
    }
    // Failures on the page say it, too.
    let optional = culprits.absent.iter().map(sections::failures::culprit);
    warnings.extend(optional.map(|it| format!("{it} (it is optional)")));
    Ok(Report {
        terminal: terminal(&parts, &wrong, &conditions),
        culprits: culprits.all,
        figures: parts.iter().flat_map(|part| &part.figures).map(|it| it.1.clone()).collect(),
        verdicts: parts.into_iter().flat_map(|part| part.verdicts).collect(),
        path,
        page,
        warnings,
    })
}

impl<'a> Part<'a> {
    fn new(experiment: &'a Experiment, cells: &'a [Cell], scope: &Scope<'_>) -> Part<'a> {
        let own: Vec<&Cell> =
            cells.iter().filter(|cell| cell.id.experiment == experiment.name).collect();
        let coverage = Coverage::new(experiment, &own, scope);
        let matrix = Matrix::new(&own).filter(|_| experiment.table == Some(Table::Verdicts));
        let (maps, winners) = (Drawn::all(experiment, cells), winners(&own));
        let about = About { experiment, cells: &own, maps: &maps, winners: &winners };
        let (mut tables, mut files) = (Vec::new(), Vec::new());
        let details = if matrix.is_none() { DETAILS } else { &[] };
        for section in SPEED.iter().chain(details).flat_map(|make| make(&about)) {
            tables.push(Block::heading(3, section.heading));
            tables.extend(section.blocks);
            files.extend(section.csv);
        }
        files.extend(matrix.iter().map(|_| ("verdicts.csv", sections::verdicts::rows(&own))));
        Part {
            experiment,
            verdicts: claim::verdicts(experiment, cells, &coverage),
            coverage: coverage.summary(),
            asks_fastest: experiment.asks_fastest(),
            headline: sections::Headline::new(experiment, &own),
            matrix,
            figures: Vec::new(),
            maps,
            winners,
            tables,
            files,
            cells: own,
        }
    }
}

impl Part<'_> {
    /// What the experiment asks, answered in a sentence.
    pub fn sentence(&self) -> Text {
        match self.headline.as_ref().filter(|headline| headline.answers) {
            Some(headline) => headline.text.clone(),
            None => sections::winners::sentence(&self.winners),
        }
    }

    /// The answer in a few words: of claims, of an experiment that asks for it the fastest.
    pub fn brief(&self) -> Option<Text> {
        let fastest = self.asks_fastest && !self.winners.contests.is_empty();
        match self.verdicts.iter().any(|verdict| !verdict.answers.is_empty()) {
            false if fastest => Some(sections::winners::brief(&self.winners)),
            _ => sections::answer::brief(&self.verdicts),
        }
    }

    /// The fastest detectors, if the question asks for them: the sentence, and a line per scene.
    fn fastest(&self) -> Vec<Block> {
        if !self.asks_fastest {
            return Vec::new();
        }
        let mut blocks = sections::winners::blocks(&self.winners);
        if let Some(first) = blocks.first_mut() {
            *first = Block::Paragraph(self.sentence());
        }
        blocks
    }
}

/// The provenance of runs that went on with a record, in the order of their dates.
fn resumed(folder: &Path) -> Vec<Value> {
    let names = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .filter_map(|entry| Some(entry.ok()?.path()));
    let is_resumed = |path: &PathBuf| {
        path.file_name()
            .is_some_and(|name| name.to_string_lossy().starts_with("provenance-resumed-"))
    };
    let mut paths: Vec<PathBuf> = names.filter(is_resumed).collect();
    paths.sort();
    paths
        .iter()
        .filter_map(|path| serde_json::from_slice(&std::fs::read(path).ok()?).ok())
        .collect()
}

/// The warning at the head of everything that shows times, if they are doubtful.
fn doubts(conditions: &Conditions) -> Option<Block> {
    Some(Block::Warning(sections::conditions::sentence(conditions)?.into()))
}

/// How much of each plan is there.
pub fn summaries(parts: &[Part<'_>]) -> Vec<Summary> {
    parts.iter().map(|part| part.coverage.clone()).collect()
}

/// What a terminal shows.
fn terminal(parts: &[Part<'_>], wrong: &[String], conditions: &Conditions) -> Vec<Block> {
    let mut out: Vec<Block> = wrong.iter().map(|it| Block::paragraph(it.as_str())).collect();
    out.extend(sections::coverage::blocks(&summaries(parts)));
    out.extend(doubts(conditions));
    for part in parts {
        let matrix = part.matrix.as_ref().map(sections::verdicts::terminal).unwrap_or_default();
        let claims = sections::answer::blocks(&part.verdicts, false);
        let headline = part.headline.as_ref().filter(|headline| !headline.answers);
        let headline = headline.map(|headline| Block::Paragraph(headline.text.clone()));
        let said: Vec<Block> =
            matrix.into_iter().chain(claims).chain(headline).chain(part.fastest()).collect();
        if !said.is_empty() {
            let Experiment { name, title, question, .. } = part.experiment;
            out.push(Block::heading(2, format!("{name}: {title}")));
            out.push(Block::paragraph(question.as_str()));
            out.extend(said);
        }
    }
    let verdicts: Vec<Verdict> = parts.iter().flat_map(|part| part.verdicts.clone()).collect();
    out.extend(sections::claims::terminal(&verdicts));
    out
}

/// All of the report.
fn blocks(parts: &[Part<'_>], warnings: &[String], origin: &Origin<'_>) -> Vec<Block> {
    let mut out = head(parts, warnings, origin);
    for part in parts {
        section(&mut out, part);
    }
    foot(&mut out, origin);
    out
}

/// Which program made a record, and when: a reader sees how old it is.
fn program(fields: &Value) -> String {
    let text = |name: &str| fields.get(name).and_then(Value::as_str).unwrap_or_default();
    let date = text("date_utc").split('T').next().filter(|date| !date.is_empty());
    let short = |revision: &str| revision.get(..7).map(String::from);
    let revisions: Vec<String> = text("revision").split(", ").filter_map(short).collect();
    let date = date.map(|date| format!(" on {date}")).unwrap_or_default();
    match &*revisions {
        [] => date,
        all => format!("{date}, with the program of commit {},", all.join(", ")),
    }
}

/// Title, the command that made it, the score of the claims, warnings; each question with its
/// answer: the verdicts of its claims, then the fastest detectors if it asks for them.
fn head(parts: &[Part<'_>], warnings: &[String], origin: &Origin<'_>) -> Vec<Block> {
    let title = match parts {
        [part] => part.experiment.title.as_str(),
        _ => "Contact detection: results",
    };
    let mut out = vec![Block::heading(1, title)];
    out.extend(warnings.iter().map(|warning| Block::Warning(warning.as_str().into())));
    out.extend(sections::coverage::blocks(&summaries(parts)));
    out.extend(doubts(origin.conditions));
    if let Some(command) = origin.provenance.and_then(|fields| fields.get("command")).map(command) {
        let program = origin.provenance.map(program).unwrap_or_default();
        out.extend([Block::paragraph(format!("Made{program} by")), Block::Code(command)]);
    }
    let verdicts: Vec<Verdict> = parts.iter().flat_map(|part| part.verdicts.clone()).collect();
    out.push(Block::Paragraph(match &*verdicts {
        [] => "No claims were checked.".into(),
        all => Text::new().strong(format!("{}.", sections::claims::score(all))),
    }));
    for part in parts {
        out.push(Block::Paragraph(Text::new().strong(part.experiment.question.as_str())));
        out.extend(sections::answer::blocks(&part.verdicts, true));
        if let Some(headline) = part.headline.as_ref().filter(|headline| !headline.answers) {
            out.push(Block::Paragraph(headline.text.clone()));
        }
        out.extend(part.fastest());
    }
    out
}

/// Question, verdicts, how to read, answers, figures, tables.
fn section(out: &mut Vec<Block>, part: &Part<'_>) {
    let experiment = part.experiment;
    out.push(Block::heading(2, experiment.title.as_str()));
    out.push(Block::paragraph(experiment.question.as_str()));
    if part.cells.is_empty() {
        out.push(Block::paragraph("The record has no rows of this experiment."));
    }
    out.extend(sections::claims::blocks(&part.verdicts));
    let reading = Text::new().emphasis("How to read it:");
    out.push(Block::Paragraph(reading.plain(format!(" {}", experiment.reading))));
    if let Some(matrix) = &part.matrix {
        out.push(Block::heading(3, "Who is right"));
        out.extend(sections::verdicts::blocks(matrix));
    }
    for (title, path) in &part.figures {
        out.push(Block::Figure { title: title.clone(), path: path.clone() });
    }
    out.extend(part.tables.iter().cloned());
}

/// Legend of the tables, machine, bias.
fn foot(out: &mut Vec<Block>, origin: &Origin<'_>) {
    out.push(Block::heading(2, "How to read the tables"));
    let text = Text::from(
        "Times are medians over paired blocks, from raw coordinates to the complete list of \
         pairs. Ratios are taken within a block; the numbers in brackets are the exact \
         order-statistic interval of their median (15 blocks: the 4th to the 12th, 96.5%). A \
         scene is one set of particles: another N, seed or parameter makes another scene. Each \
         detector takes part in it once, with its fewest threads, and in exact arithmetic if it \
         can. The fastest is decided if, for every other detector, the interval of the ratio \
         excludes 1 and the ratio is beyond the noise floor. A time is compared only if the \
         answer is right. Counts are exact and the \
         same on every machine. All values, one line per cell, are in ",
    );
    let text = text
        .code("summary.csv")
        .plain(", every single measurement is in the record, ")
        .code("samples.jsonl")
        .plain(" (or .gz), the pictures are in figures/. ")
        .code("contactbench report FOLDER");
    out.push(Block::Paragraph(text.plain(
        " makes all of it again from the record, and a page, report.html, with the pictures in it.",
    )));
    out.push(Block::paragraph(
        "docs/BIAS.md of the project lists the ways in which this comparison is unfair.",
    ));
    if let Some(Value::Object(fields)) = origin.provenance {
        out.push(Block::heading(2, "Machine and provenance"));
        let machine = sections::conditions::machine(origin.conditions);
        out.extend(machine.into_iter().map(Block::paragraph));
        let line = |(name, value): (&String, &Value)| format!("{name}: {}", shown(value)).into();
        out.push(Block::List(fields.iter().map(line).collect()));
    }
    let programs = sections::conditions::programs(origin.ledger);
    if !programs.is_empty() {
        out.push(Block::heading(2, "Programs"));
        out.push(Block::List(programs.into_iter().map(Text::from).collect()));
    }
}

#[cfg(test)]
mod agreement;
#[cfg(test)]
mod claims_in_words;
#[cfg(test)]
mod plans_in_words;
#[cfg(test)]
mod tests;
