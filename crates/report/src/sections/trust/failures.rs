use std::collections::BTreeSet;

use crate::document::Block;
use crate::sections::{About, Section};
use crate::table::Table;
use contactbench_record::findings::trust::failures::{Culprit, Failure, failures};
use contactbench_record::record::row::Outcome;
use contactbench_terms::number::plural;

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
    format!("{what}: {name} in {cells} of its {of}, {worst}{reason}")
}

pub fn section(about: &About<'_>) -> Option<Section> {
    let found = failures(about.cells);
    (!found.is_empty()).then(|| Section::new("Without a right answer", vec![table(&found)]))
}

fn table(found: &[Failure<'_>]) -> Block {
    let reason = |cells: &[(u64, &str)]| {
        let reasons: BTreeSet<&str> = cells.iter().map(|(_, reason)| *reason).collect();
        match reasons.len() {
            1 => cells[0].1.to_string(),
            all => format!("{} (and {})", cells[0].1, plural(all - 1, "similar reason")),
        }
    };
    let sizes = |cells: &[(u64, &str)]| {
        let sizes: BTreeSet<u64> = cells.iter().map(|(n, _)| *n).collect();
        sizes.iter().map(u64::to_string).collect::<Vec<_>>().join(", ")
    };
    let table = Table::of("", found)
        .left("detector", |((name, ..), _)| &**name)
        .left("scene", |((_, scene, _), _)| &**scene)
        .right("N", |(_, cells)| sizes(cells))
        .left("outcome", |((.., outcome), _)| outcome.name())
        .left("reason", |(_, cells)| reason(cells));
    Block::table(table)
}
