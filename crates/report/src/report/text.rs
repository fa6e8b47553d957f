use serde_json::Value;

use crate::document::{Block, Text};
use crate::facts::{Chapter, Facts};
use crate::sections;
use crate::sections::trust::conditions;

impl Facts<'_> {
    pub fn title(&self) -> &str {
        match &self.chapters[..] {
            [chapter] => &chapter.experiment.title,
            _ => "Contact detection: results",
        }
    }

    pub(super) fn terminal(&self) -> Vec<Block> {
        let paragraph = |text: &String| Block::paragraph(text.as_str());
        let mut out: Vec<Block> = self.wrong.iter().map(paragraph).collect();
        out.extend(self.alerts.iter().cloned());
        for chapter in &self.chapters {
            let mut said =
                chapter.matrix.as_ref().map(sections::claims::verdicts::blocks).unwrap_or_default();
            said.extend(chapter.answers(false));
            if !said.is_empty() {
                let experiment = chapter.experiment;
                let head = format!("{}: {}", experiment.name, experiment.title);
                out.extend([Block::heading(2, head), Block::paragraph(&*experiment.question)]);
                out.extend(said);
            }
        }
        out.extend(sections::claims::terminal(&self.verdicts));
        out.extend(self.whole.iter().map(paragraph));
        out
    }

    pub(crate) fn report(&self) -> Vec<Block> {
        let mut out = vec![Block::heading(1, self.title())];
        out.extend(self.head());
        self.chapters.iter().for_each(|chapter| chapter.section(&mut out));
        self.foot(&mut out);
        out
    }

    /// Returns warnings, each question with its answer, and the origin of the record.
    pub(crate) fn head(&self) -> Vec<Block> {
        let warning = |text: &String| Block::Warning(text.as_str().into());
        let mut out: Vec<Block> = self.wrong.iter().map(warning).collect();
        out.extend(self.alerts.iter().cloned());
        for chapter in &self.chapters {
            out.push(Block::Paragraph(
                Text::default().strong(chapter.experiment.question.as_str()),
            ));
            out.extend(chapter.answers(true));
        }
        out.push(Block::heading(2, "The record"));
        match &*self.verdicts {
            [] => out.push(Block::paragraph("No claims were checked.")),
            all if self.chapters.len() > 1 => {
                out.push(Block::paragraph(sections::claims::score(all) + "."));
            }
            _ => {}
        }
        out.extend(self.whole.iter().cloned().map(Block::paragraph));
        if let Some(fields) = &self.origin.provenance
            && let Some(command) = fields.get("command")
        {
            out.push(Block::paragraph(format!("Made{} with this command:", program(fields))));
            out.push(Block::Code(shown(command)));
        }
        out.extend(self.warnings.iter().map(warning));
        out
    }

    fn foot(&self, out: &mut Vec<Block>) {
        out.push(Block::heading(2, "How to read the tables"));
        let lines = include_str!("legend.txt").lines().filter_map(|line| line.split_once(": "));
        let line = |(term, text)| Text::default().emphasis(term).plain(format!(": {text}"));
        out.push(Block::List(lines.map(line).collect()));
        out.push(Block::Paragraph(Text::marked(
            "All values, one line per cell, are in `summary.csv`, all measurements in the record, \
             `samples.jsonl` (or .gz), the pictures in figures/. `contactbench report FOLDER` makes \
             this report and report.html, which contains the pictures, from the record. \
             docs/BIAS.md lists the ways in which this comparison is unfair.",
        )));
        if let Some(Value::Object(fields)) = &self.origin.provenance {
            out.push(Block::heading(2, "Machine and provenance"));
            out.extend(conditions::machine(&self.origin.conditions).map(Block::paragraph));
            let line = |(name, value): (&String, &Value)| format!("{name}: {}", shown(value));
            out.push(Block::List(fields.iter().map(line).map(Text::from).collect()));
        }
        let programs = conditions::programs(&self.origin.ledger);
        if !programs.is_empty() {
            let programs = Block::List(programs.into_iter().map(Text::from).collect());
            out.extend([Block::heading(2, "Programs"), programs]);
        }
    }
}

fn shown(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), String::from)
}

/// Returns the date and the program of a record, from which a reader sees its age.
fn program(fields: &Value) -> String {
    let text = |name: &str| fields.get(name).and_then(Value::as_str).unwrap_or_default();
    let date = text("date_utc").split('T').next().filter(|date| !date.is_empty());
    let date = date.map(|date| format!(" on {date}")).unwrap_or_default();
    let short = |revision: &str| revision.get(..7).map(String::from);
    let revisions: Vec<String> = text("revision").split(", ").filter_map(short).collect();
    match &*revisions {
        [] => date,
        all => format!("{date} by the program of commit {},", all.join(", ")),
    }
}

impl Chapter<'_> {
    pub(crate) fn answers(&self, with_evidence: bool) -> Vec<Block> {
        let mut out = sections::answer::blocks(&self.verdicts, with_evidence);
        out.extend(self.fastest(with_evidence));
        if self.experiment.question.contains("threads") {
            out.extend(sections::threads::answer(&self.cells));
        }
        if out.is_empty() && self.matrix.is_none() {
            out.extend(sections::errors::answer(&self.cells).map(Block::Paragraph));
        }
        out
    }

    fn section(&self, out: &mut Vec<Block>) {
        let experiment = self.experiment;
        out.push(Block::heading(2, experiment.title.as_str()));
        out.push(Block::paragraph(experiment.question.as_str()));
        if self.cells.is_empty() {
            out.push(Block::paragraph("The record has no rows of this experiment."));
        }
        out.extend(sections::claims::blocks(&self.verdicts));
        out.push(self.reading());
        if let Some(matrix) = &self.matrix {
            out.push(Block::heading(3, "Who is right"));
            out.extend(sections::claims::verdicts::blocks(matrix));
        }
        out.extend(self.pictures());
        out.extend(self.tables.iter().cloned());
    }

    pub(crate) fn reading(&self) -> Block {
        let reading = Text::default().emphasis("How to read it:");
        Block::Paragraph(reading.plain(format!(" {}", self.experiment.reading)))
    }

    pub(crate) fn pictures(&self) -> impl Iterator<Item = Block> {
        let figures = self.figures.iter().cloned();
        figures.map(|(title, path)| Block::Figure { title, path })
    }
}
