//! The sections of a report: each puts one finding into words and tables.

pub mod answer;
pub mod claims;
pub mod compare;
pub mod errors;
mod operations;
mod overhead;
pub mod ratios;
mod scenes;
pub mod threads;
mod tracking;
pub mod trust;
pub mod winners;

use crate::document::Block;
use crate::table::Table;
use contactbench_record::cells::{Cell, by_machine};
use contactbench_record::experiment::Experiment;
use contactbench_record::findings::winners::Winners;

pub struct About<'a> {
    pub experiment: &'a Experiment,
    pub cells: &'a [&'a Cell],
    pub winners: &'a Winners,
}

pub struct Section {
    pub heading: String,
    pub blocks: Vec<Block>,
    /// Name and table of a CSV file. Tables of all experiments with the same name form one file.
    pub csv: Option<(&'static str, Table)>,
}

/// Makes the sections of one kind; none if there is nothing to report.
type Make = fn(&About<'_>) -> Vec<Section>;

pub const SPEED: &[Make] = &[
    |about| Vec::from_iter(winners::section(about)),
    |about| Vec::from_iter(ratios::section(about)),
    |about| Vec::from_iter(threads::section(about)),
    |about| Vec::from_iter(overhead::section(about)),
];

/// Sections with the tables of all cells. An experiment with a table of verdicts leaves them out.
pub const DETAILS: &[Make] = &[
    tracking::sections,
    |about| Vec::from_iter(operations::section(about)),
    scenes::sections,
    |about| Vec::from_iter(trust::failures::section(about)),
    |about| Vec::from_iter(errors::section(about)),
    |about| Vec::from_iter(trust::noise::section(about)),
];

impl Section {
    fn new(heading: impl Into<String>, blocks: Vec<Block>) -> Section {
        Section { heading: heading.into(), blocks, csv: None }
    }

    /// Makes a section with the findings of each machine; `None` if there are none.
    fn by_machine(
        heading: &str,
        cells: &[&Cell],
        found: impl Fn(&[&Cell]) -> Option<Vec<Block>>,
    ) -> Option<Section> {
        let mut blocks = Vec::new();
        for (machine, cells) in by_machine(cells) {
            if let Some(found) = found(&cells) {
                blocks.extend(machine.map(|name| Block::paragraph(format!("On {name}:"))));
                blocks.extend(found);
            }
        }
        (!blocks.is_empty()).then(|| Section::new(heading, blocks))
    }
}
