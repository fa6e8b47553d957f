//! Cells without a right answer, in a line per contender, scene and outcome.

use crate::findings::failures::{Culprit, Failure};
use crate::number::plural;
use crate::present::document::Block;
use crate::present::table::{Column, Table};
use crate::record::row::Outcome;

/// Who is wrong, in a sentence.
pub fn culprit(culprit: &Culprit) -> String {
    let Culprit { name, outcome, cells, first, reason, .. } = culprit;
    let what = match outcome {
        Outcome::Wrong => "WRONG",
        Outcome::Unavailable => "NOT STARTED",
        _ => "CRASHED",
    };
    let cells = plural(*cells, "cell");
    let reason = if reason.is_empty() { String::new() } else { format!(": {reason}") };
    format!("{what}: {name}, in {cells}, first in {first}{reason}")
}

/// A table; nothing if every cell ended well.
pub fn blocks(found: &[Failure]) -> Vec<Block> {
    if found.is_empty() {
        return Vec::new();
    }
    let columns = vec![
        Column::left("detector"),
        Column::left("scene"),
        Column::right("N", ""),
        Column::left("outcome"),
        Column::left("reason"),
    ];
    let row = |failure: &Failure| {
        let sizes: Vec<String> = failure.sizes.iter().map(u64::to_string).collect();
        let more = match failure.more {
            0 => String::new(),
            more => format!(" (and {} like it)", plural(more, "reason")),
        };
        vec![
            failure.name.as_str().into(),
            failure.scene.as_str().into(),
            sizes.join(", ").into(),
            failure.outcome.name().into(),
            format!("{}{more}", failure.reason).into(),
        ]
    };
    vec![Block::Table(Table::new("", columns).with(found.iter().map(row)))]
}
