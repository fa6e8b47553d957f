//! The sections of a report that are about speed: ratios to one detector, threads, the memory bound, the cost model, the harness's share.
//!
//! Each appears where its experiment asks for it, or its rows are in the record; a report without them is as it was.

use super::keyed::by_machine;
use super::machine::Machine;
use super::summary::Table;
use super::value::Cell;
use super::{bound, crossover, overhead, ratios, text, threads};
use crate::harness::experiment::Experiment;

const RATIOS: &str = "Times as multiples of that of the reference (with one thread, in the same arithmetic if it has one, else exact): \
    median of the ratios within a block, and its interval. Below 1 is faster than the reference. *wrong [0.45]* is a wrong answer, whose \
    time means nothing; other words say why there is none. All of it is in [ratios.csv](ratios.csv).";
const THREADS: &str = "Speed-up: the time with one thread over that with several. Ceiling: the throughput of as many copies with one thread \
    each, at work beside each other, over that of one alone. Fraction: the first over the second; over 100% is possible, since copies share \
    no cache lines and threads do. All are paired within blocks; the numbers are in [threads.csv](threads.csv).";
const BOUND: &str = "No detection can take less than the bound: every coordinate is read once (8 bytes, 4 in f32; radii too, unless all are \
    the same), every pair is written once (8 bytes), at the triad's bandwidth with the same number of threads. The other lines are the \
    fraction of it that is reached: bound over time. A scene that fits a cache is not bound by the memory, and could pass 100%. \
    All numbers are in [bound.csv](bound.csv).";

/// What the sections of all experiments leave for files.
#[derive(Default)]
pub struct Files {
    ratios: Vec<String>,
    threads: Vec<String>,
    bound: Vec<String>,
}

impl Files {
    /// Names and contents; only those that have any.
    pub fn all(&self) -> Vec<(&'static str, String)> {
        let lines = |all: &[String]| all.concat();
        let files = [
            ("ratios.csv", ratios::csv as fn(&str) -> String, lines(&self.ratios)),
            ("threads.csv", threads::csv, lines(&self.threads)),
            ("bound.csv", bound::csv, lines(&self.bound)),
        ];
        files.into_iter().filter(|file| !file.2.is_empty()).map(|(name, csv, lines)| (name, csv(&lines))).collect()
    }
}

/// The sentence at the head of a report, if the experiment asks for a comparison.
pub fn headline(experiment: &Experiment, own: &[&Cell]) -> Option<String> {
    Some(ratios::of(own, experiment.ratios_to.as_deref()?)?.headline)
}

/// The sections of an experiment.
pub fn sections(out: &mut String, experiment: &Experiment, own: &[&Cell], machine: &Machine, files: &mut Files) {
    let paragraph = |out: &mut String, parts: &[&str]| {
        parts.iter().filter(|part| !part.is_empty()).for_each(|part| *out += &format!("{}\n\n", part.trim_end()))
    };
    if let Some(reference) = &experiment.ratios_to {
        paragraph(out, &[&format!("### Who is how fast, against {}", text::escape(reference))]);
        match ratios::of(own, reference) {
            Some(found) => {
                paragraph(out, &[&found.headline, &found.fastest, RATIOS]);
                tables(out, &found.tables);
                let missing: Vec<String> = found.missing.iter().map(|line| format!("* {}\n", text::escape(line))).collect();
                if !missing.is_empty() {
                    paragraph(out, &["Without an answer, or with a wrong one:", &missing.concat()]);
                }
                files.ratios.push(found.lines);
            }
            None => paragraph(out, &["The reference has no time in this record."]),
        }
    }
    if let Some(found) = threads::of(own) {
        paragraph(out, &["### What threads gain", &found.sentences.join("\n\n"), THREADS, &found.table]);
        files.threads.push(found.lines);
    }
    if experiment.bound {
        paragraph(out, &["### How near the memory's bound"]);
        match bound::of(own, machine) {
            Some(found) => {
                paragraph(out, &[BOUND, &found.measured]);
                tables(out, &found.tables);
                files.bound.push(found.lines);
            }
            None => paragraph(out, &["The provenance of this record holds no bandwidth: it was not measured before the run."]),
        }
    }
    if experiment.cost_model {
        paragraph(out, &["### What an operation costs"]);
        for (machine, cells) in by_machine(own) {
            paragraph(out, &[&of_machine(&machine), &crossover::section(&cells)]);
        }
    }
    if experiment.ratios_to.is_some() || experiment.bound || experiment.cost_model {
        let said = |cells: &[&Cell]| overhead::sentences(cells).iter().map(|line| text::escape(line)).collect::<Vec<_>>().join("\n\n");
        let said: Vec<String> = by_machine(own).iter().map(|(_, cells)| said(cells)).collect();
        if said.iter().any(|said| !said.is_empty()) {
            paragraph(out, &["### What the harness adds"]);
            by_machine(own).iter().zip(&said).for_each(|((machine, _), said)| paragraph(out, &[&of_machine(machine), said]));
        }
    }
}

/// The line before what is said of one of several machines.
pub fn of_machine(machine: &Option<String>) -> String {
    machine.as_ref().map_or(String::new(), |name| format!("On {}:", text::escape(name)))
}

fn tables(out: &mut String, tables: &[Table]) {
    for table in tables {
        *out += &format!("**{}**\n\n{}\n", text::escape(&table.title), table.markdown);
    }
}
