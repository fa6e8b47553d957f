//! What two measurements of the same code differ by, in a paragraph per twin.

use crate::findings::noise::{Noise, Twin};
use crate::number::{percent, plural, with_interval};
use crate::present::document::Block;

/// A paragraph per twin.
pub fn blocks(found: &Noise) -> Vec<Block> {
    found.twins.iter().map(|twin| Block::paragraph(sentence(twin, found.floor))).collect()
}

fn sentence(twin: &Twin, floor: f64) -> String {
    format!(
        "{} is the code of {}, measured again. Over {} it takes {} times as long; in a cell the \
         two are typically {} apart, at worst by a ratio of {}. {} of {} intervals exclude 1, \
         where chance gives {}. Nine in ten cells are within a factor of {floor:.2}, the noise \
         floor: a smaller difference is called undecided, at each N by the floor there (of fewer \
         than five cells, no less than this one).",
        twin.name,
        twin.original,
        plural(twin.cells, "cell"),
        with_interval(&twin.overall),
        percent(twin.typical),
        with_interval(&twin.worst),
        twin.outside,
        twin.cells,
        percent(twin.by_chance),
    )
}
