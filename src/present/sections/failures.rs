//! Cells without a right answer, in a line per contender, scene and outcome.

use crate::findings::failures::{Culprit, Failure};
use crate::number::plural;
use crate::present::document::Block;
use crate::present::table::{Column, Table};
use crate::record::row::Outcome;

/// Who is wrong, in a sentence.
pub fn culprit(culprit: &Culprit) -> String {
    let Culprit { name, outcome, cells, of, worst, reason, .. } = culprit;
    let what = match outcome {
        Outcome::Wrong => "WRONG",
        Outcome::Unavailable => "NOT STARTED",
        _ => "CRASHED",
    };
    let of = plural(*of, "cell");
    let place = if *outcome == Outcome::Wrong { "worst in" } else { "first in" };
    let worst = if *cells > 1 { format!("{place} {worst}") } else { worst.clone() };
    let reason = if reason.is_empty() { String::new() } else { format!(": {reason}") };
    format!("{what}: {name}, in {cells} of its {of}, {worst}{reason}")
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
