//! Claims and what came of them.

use crate::document::Block;
use crate::sections::coverage::uncovered;
use crate::table::Table;
use contactbench_record::findings::claim::{Evidence, Status, Verdict, Without};
use contactbench_record::record::row::Outcome;
use contactbench_terms::number::{number, plural};

/// `26 claims: 25 hold, 1 fails, 0 could not be shown`.
pub fn score(verdicts: &[Verdict]) -> String {
    let count = |status: Status| verdicts.iter().filter(|verdict| verdict.status == status).count();
    let (holds, fails, open) =
        (count(Status::Holds), count(Status::Fails), count(Status::NotShown));
    let verb = |count: usize, verb: &str| match count {
        1 => format!("1 {verb}s"),
        _ => format!("{count} {verb}"),
    };
    let all = plural(verdicts.len(), "claim");
    let cut = match count(Status::NotCovered) {
        0 => String::new(),
        cut => format!(", {cut} not covered"),
    };
    format!(
        "{all}: {}, {}, {open} could not be shown{cut}",
        verb(holds, "hold"),
        verb(fails, "fail")
    )
}

/// The numbers of a verdict in a line.
pub fn evidence(evidence: &Evidence) -> String {
    let machine = if evidence.of_machine { "time, this machine: " } else { "" };
    let without = evidence.without.as_ref().map_or_else(String::new, left_out);
    let time = match evidence.time {
        Some([low, high]) if low < high => {
            format!("; {} to {} ns per particle on this machine", number(low), number(high))
        }
        Some([time, _]) => format!("; {} ns per particle on this machine", number(time)),
        None => String::new(),
    };
    let there = format!("{machine}{}{time}{without}", evidence.found);
    let Some(cut) = evidence.uncovered.as_ref().map(uncovered) else {
        return there;
    };
    if evidence.nothing {
        return cut;
    }
    let all = evidence.uncovered.as_ref().is_some_and(|cut| cut.cells == cut.of);
    let rest = if all { "its own cells" } else { "the other cells" };
    format!("{cut}; in {rest}: {there}")
}

/// `; without 4 of 7 cells: 3 refused, 1 timeout`.
fn left_out(without: &Without) -> String {
    let part = |(outcome, count): (&Option<_>, &usize)| {
        format!("{count} {}", outcome.map_or("without a value", Outcome::name))
    };
    let parts: Vec<String> = without.outcomes.iter().map(part).collect();
    let count: usize = without.outcomes.values().sum();
    format!("; without {count} of {}: {}", plural(without.of, "cell"), parts.join(", "))
}

/// For a report: the table, and how the claims are checked.
pub fn blocks(verdicts: &[Verdict]) -> Vec<Block> {
    if verdicts.is_empty() {
        return Vec::new();
    }
    let table = Table::of("", verdicts)
        .left("claim", |it| &*it.claim)
        .left("verdict", |it| it.status.name())
        .left("evidence", |it| evidence(&it.evidence))
        .left("source", |it| &*it.source);
    vec![
        Block::table(table),
        Block::paragraph(
            "Claims are checked from counts, bytes and digests, which are the same on every \
             machine, except those marked \"time, this machine\". A claim holds over all that the \
             experiment plans; if a part of that is not in the record, it is not covered.",
        ),
    ]
}

/// For a terminal: the table and the score.
pub fn terminal(verdicts: &[Verdict]) -> Vec<Block> {
    if verdicts.is_empty() {
        return Vec::new();
    }
    let several = verdicts.iter().any(|verdict| verdict.experiment != verdicts[0].experiment);
    let named = |v: &Verdict| {
        if several { format!("{}: {}", v.experiment, v.claim) } else { v.claim.clone() }
    };
    let table = Table::of("", verdicts)
        .left("", |it| it.status.name())
        .left("", named)
        .left("", |it| evidence(&it.evidence));
    vec![Block::table(table), Block::paragraph(score(verdicts))]
}
