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

pub fn table(found: &[Failure]) -> Block {
    let reason = |failure: &Failure| match failure.more {
        0 => failure.reason.clone(),
        more => format!("{} (and {} like it)", failure.reason, plural(more, "reason")),
    };
    let sizes =
        |failure: &Failure| failure.sizes.iter().map(u64::to_string).collect::<Vec<_>>().join(", ");
    let table = Table::of("", found)
        .left("detector", |failure| &*failure.name)
        .left("scene", |failure| &*failure.scene)
        .right("N", sizes)
        .left("outcome", |failure| failure.outcome.name())
        .left("reason", reason);
    Block::table(table)
}
