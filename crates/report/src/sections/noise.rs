//! What two measurements of the same code differ by: a paragraph per twin, and the noise floor.

use super::{About, Section};
use crate::document::Block;
use contactbench_record::findings::noise::{Noise, Twin};
use contactbench_terms::number::{percent, plural, with_interval};

/// The section of a report, for each machine: a paragraph per twin, and one about all.
pub fn section(about: &About<'_>) -> Option<Section> {
    Section::by_machine("Noise floor", about.cells, |cells| {
        let found = Noise::new(cells);
        let twins = found.twins.iter().map(sentence);
        let blocks = twins.chain([floor(&found)]).map(Block::paragraph).collect();
        (!found.twins.is_empty()).then_some(blocks)
    })
}

fn floor(found: &Noise) -> String {
    let mut words = format!(
        "Nine in ten cells of the twins are within a factor of {:.2}, the noise floor: a smaller \
         difference is called undecided.",
        found.floor
    );
    let sizes: Vec<String> =
        found.by_size().map(|(n, floor)| format!("{floor:.2} at N = {n}")).collect();
    if sizes.len() > 1 {
        words += &format!(
            " A cell is held to the floor of its N (of fewer than five cells, no less than that \
             of all): {}.",
            sizes.join(", ")
        );
    }
    words
}

fn sentence(twin: &Twin) -> String {
    let said = format!(
        "{} is the code of {}, measured again. Over {} it takes {} times as long; in a cell the \
         two are typically {} apart, at worst by a ratio of {}. {} of {} intervals exclude 1, \
         where chance gives {}.",
        twin.name,
        twin.original,
        plural(twin.cells, "cell"),
        with_interval(&twin.overall),
        percent(twin.typical),
        with_interval(&twin.worst),
        twin.outside,
        twin.cells,
        percent(twin.by_chance),
    );
    // Where the machine was in one state only, that is all of it.
    match &twin.states {
        [Some(quiet), Some(slow)] => format!(
            "{said} While the machine was quiet it takes {} times as long, while it was slow {}.",
            with_interval(quiet),
            with_interval(slow)
        ),
        _ => said,
    }
}
