//! The sections of a report that are about speed: ratios to one detector, threads, the harness's
//! share.
//!
//! Each appears where its experiment asks for it, or its rows are in the record; a report without
//! them is as it was.

pub mod answer;
mod by_size;
pub mod claims;
pub mod compare;
pub mod conditions;
pub mod courses;
pub mod coverage;
pub mod errors;
pub mod failures;
pub mod map;
pub mod noise;
pub mod operations;
pub mod overhead;
pub mod ratios;
pub mod scenes;
pub mod threads;
pub mod verdicts;
pub mod winners;

use crate::cells::{Cell, by_machine};
use crate::experiment::Experiment;
use crate::findings::noise::Noise;
use crate::findings::overhead::Overhead;
use crate::findings::ratios::Ratios;
use crate::findings::threads::Threads;
use crate::present::document::{Block, Text};
use crate::present::table::{Table, csv};

/// What the sections of all experiments leave for files.
#[derive(Default)]
pub struct Files {
    ratios: Vec<Table>,
    threads: Vec<Table>,
    /// Of all maps.
    pub maps: Vec<Table>,
}

impl Files {
    /// Names and contents; only those that have any.
    pub fn all(&self) -> Vec<(&'static str, String)> {
        let files = [
            ("ratios.csv", &self.ratios),
            ("threads.csv", &self.threads),
            ("maps.csv", &self.maps),
        ];
        let files = files.into_iter();
        files
            .filter(|(_, tables)| !tables.is_empty())
            .map(|(name, tables)| (name, csv(tables)))
            .collect()
    }
}

/// The sentence at the head of a report, if the experiment asks for a comparison.
pub struct Headline {
    /// The sentence.
    pub text: Text,
    /// Is it what the experiment asks, so that who the fastest of all is need not be said?
    pub answers: bool,
}

impl Headline {
    /// Of these cells.
    pub fn new(experiment: &Experiment, own: &[&Cell]) -> Option<Headline> {
        let found = Ratios::new(own, experiment.ratios_to.as_deref()?)?;
        let answers = !found.libraries.is_empty();
        Some(Headline { text: ratios::headline(&found), answers })
    }
}

/// The sections of an experiment.
pub fn sections(experiment: &Experiment, own: &[&Cell], files: &mut Files) -> Vec<Block> {
    let mut out = Vec::new();
    if let Some(reference) = &experiment.ratios_to {
        out.push(Block::heading(3, format!("Who is how fast, against {reference}")));
        match Ratios::new(own, reference) {
            Some(found) => {
                out.extend(ratios::blocks(&found));
                files.ratios.push(ratios::rows(&found));
            }
            None => out.push(Block::paragraph("The reference has no time in this record.")),
        }
    }
    if let Some(found) = Threads::new(own) {
        out.push(Block::heading(3, "What threads gain"));
        out.extend(threads::blocks(&found));
        files.threads.push(threads::rows(&found));
    }
    let found = by_machine(own).into_iter().map(|(machine, cells)| {
        (machine, Overhead::new(&cells).map(|found| overhead::blocks(&found)))
    });
    out.extend(by_machine_blocks("What the harness adds", found));
    if !experiment.retired.is_empty() {
        let keys = experiment.retired.join(", ");
        out.push(Block::paragraph(format!(
            "The experiment asks for {keys}, which an older program computed; this one does not."
        )));
    }
    out
}

/// The line before what is said of one of several machines.
pub fn of_machine(machine: &Option<String>) -> Option<Block> {
    machine.as_ref().map(|name| Block::paragraph(format!("On {name}:")))
}

/// The tables of all cells: growth, scenes, failures, errors, noise.
pub fn tables(own: &[&Cell]) -> Vec<Block> {
    let moving = crate::findings::courses::Courses::new(own);
    let mut out = moving.map_or_else(Vec::new, |found| courses::blocks(&found));
    out.extend(operations::blocks(&crate::findings::operations::operations(own)));
    out.extend(scenes::blocks(&crate::findings::scenes::scenes(own)));
    let failed = failures::blocks(&crate::findings::failures::failures(own));
    if !failed.is_empty() {
        out.push(Block::heading(3, "Without a right answer"));
        out.extend(failed);
    }
    if let Some(found) = crate::findings::errors::ErrorTable::new(own) {
        out.push(Block::heading(3, "Against the exact truth"));
        out.extend(errors::blocks(&found));
    }
    let found = by_machine(own).into_iter().map(|(machine, cells)| {
        let blocks = noise::blocks(&Noise::new(&cells));
        (machine, Some(blocks).filter(|blocks| !blocks.is_empty()))
    });
    out.extend(by_machine_blocks("Noise floor", found));
    out
}

/// What is said of each machine, below a heading; nothing if nothing is.
fn by_machine_blocks(
    title: &str,
    found: impl Iterator<Item = (Option<String>, Option<Vec<Block>>)>,
) -> Vec<Block> {
    let mut out = Vec::new();
    for (machine, blocks) in found.filter_map(|(machine, blocks)| Some((machine, blocks?))) {
        if out.is_empty() {
            out.push(Block::heading(3, title));
        }
        out.extend(of_machine(&machine));
        out.extend(blocks);
    }
    out
}
