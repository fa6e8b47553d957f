//! Texts of the report and of the terminal.

use serde_json::Value;

use super::{Facts, Part};
use crate::document::{Block, Text};
use crate::page::origin::{command, shown};
use crate::sections;

impl Facts<'_> {
    /// The title of report and page.
    pub fn title(&self) -> &str {
        match &self.parts[..] {
            [part] => &part.experiment.title,
            _ => "Contact detection: results",
        }
    }

    pub(super) fn terminal(&self, wrong: &[String]) -> Vec<Block> {
        let mut out: Vec<Block> = wrong.iter().map(|it| Block::paragraph(it.as_str())).collect();
        out.extend(self.alerts.iter().cloned());
        for part in &self.parts {
            let mut said =
                part.matrix.as_ref().map(sections::verdicts::terminal).unwrap_or_default();
            said.extend(part.answers(false));
            if !said.is_empty() {
                let experiment = part.experiment;
                let head = format!("{}: {}", experiment.name, experiment.title);
                out.extend([Block::heading(2, head), Block::paragraph(&*experiment.question)]);
                out.extend(said);
            }
        }
        out.extend(sections::claims::terminal(&self.verdicts));
        out
    }

    pub(super) fn report(&self) -> Vec<Block> {
        let mut out = self.head();
        self.parts.iter().for_each(|part| part.section(&mut out));
        self.foot(&mut out);
        out
    }

    /// Title, the command that made it, the score of the claims, warnings; each question with its
    /// answer: the verdicts of its claims, then the fastest detectors if it asks for them.
    fn head(&self) -> Vec<Block> {
        let mut out = vec![Block::heading(1, self.title())];
        out.extend(self.warnings.iter().map(|warning| Block::Warning(warning.as_str().into())));
        out.extend(self.alerts.iter().cloned());
        if let Some(fields) = self.provenance()
            && let Some(command) = command(fields)
        {
            out.push(Block::paragraph(format!("Made{} by", program(fields))));
            out.push(Block::Code(command));
        }
        out.push(Block::Paragraph(match &*self.verdicts {
            [] => "No claims were checked.".into(),
            all => Text::new().strong(format!("{}.", sections::claims::score(all))),
        }));
        for part in &self.parts {
            out.push(Block::Paragraph(Text::new().strong(part.experiment.question.as_str())));
            out.extend(part.answers(true));
        }
        out
    }

    fn provenance(&self) -> Option<&Value> {
        self.origin.provenance.as_ref()
    }

    /// Legend of the tables, machine, bias.
    fn foot(&self, out: &mut Vec<Block>) {
        out.push(Block::heading(2, "How to read the tables"));
        let text = Text::from(
            "Times are medians over paired blocks, from raw coordinates to the complete list of \
             pairs. Ratios are taken within a block; the numbers in brackets are the exact \
             order-statistic interval of their median (15 blocks: the 4th to the 12th, 96.5%). A \
             scene is one set of particles: another N, seed or parameter makes another scene. Each \
             detector takes part in it once, with its fewest threads, and in exact arithmetic if \
             it can. The fastest is decided if, for every other detector, the interval of the \
             ratio excludes 1 and the ratio is beyond the noise floor. A time is compared only if \
             the answer is right. Counts are exact and the same on every machine. All values, one \
             line per cell, are in ",
        );
        let text = text.code("summary.csv").plain(", every single measurement is in the record, ");
        let text = text.code("samples.jsonl").plain(" (or .gz), the pictures are in figures/. ");
        out.push(Block::Paragraph(text.code("contactbench report FOLDER").plain(
            " makes all of it again from the record, and a page, report.html, with the pictures \
             in it.",
        )));
        out.push(Block::paragraph(
            "docs/BIAS.md of the project lists the ways in which this comparison is unfair.",
        ));
        if let Some(Value::Object(fields)) = self.provenance() {
            out.push(Block::heading(2, "Machine and provenance"));
            out.extend(self.origin.machine());
            let line = |(name, value): (&String, &Value)| format!("{name}: {}", shown(value));
            out.push(Block::List(fields.iter().map(line).map(Text::from).collect()));
        }
        out.extend(self.origin.programs(2));
    }
}

/// Which program made a record, and when: a reader sees how old it is.
fn program(fields: &Value) -> String {
    let text = |name: &str| fields.get(name).and_then(Value::as_str).unwrap_or_default();
    let date = text("date_utc").split('T').next().filter(|date| !date.is_empty());
    let date = date.map(|date| format!(" on {date}")).unwrap_or_default();
    let short = |revision: &str| revision.get(..7).map(String::from);
    let revisions: Vec<String> = text("revision").split(", ").filter_map(short).collect();
    match &*revisions {
        [] => date,
        all => format!("{date}, with the program of commit {},", all.join(", ")),
    }
}

impl Part<'_> {
    /// The verdicts that answer the question, how the detector of interest compares, and the
    /// fastest.
    fn answers(&self, with_evidence: bool) -> Vec<Block> {
        let mut out = sections::answer::blocks(&self.verdicts, with_evidence);
        out.extend(self.headline.clone().map(Block::Paragraph));
        out.extend(self.fastest());
        out
    }

    /// Question, verdicts, how to read, answers, figures, tables.
    fn section(&self, out: &mut Vec<Block>) {
        let experiment = self.experiment;
        out.push(Block::heading(2, experiment.title.as_str()));
        out.push(Block::paragraph(experiment.question.as_str()));
        if self.cells.is_empty() {
            out.push(Block::paragraph("The record has no rows of this experiment."));
        }
        out.extend(sections::claims::blocks(&self.verdicts));
        let reading = Text::new().emphasis("How to read it:");
        out.push(Block::Paragraph(reading.plain(format!(" {}", experiment.reading))));
        if let Some(matrix) = &self.matrix {
            out.push(Block::heading(3, "Who is right"));
            out.extend(sections::verdicts::blocks(matrix));
        }
        let figures = self.figures.iter().cloned();
        out.extend(figures.map(|(title, path)| Block::Figure { title, path }));
        out.extend(self.tables.iter().cloned());
    }
}
