pub mod verdicts;

use crate::document::Block;
use crate::sections::trust::coverage::gaps;
use crate::table::Table;
use contactbench_record::findings::claim::{Evidence, Status, Verdict, Without};
use contactbench_record::record::row::Outcome;
use contactbench_terms::number::{plural, short};

/// Formats a score such as `All 26 claims hold`, or `26 claims: 24 hold, 1 fails, 1 not covered`.
pub fn score(verdicts: &[Verdict]) -> String {
    let count = |status: Status| verdicts.iter().filter(|verdict| verdict.status == status).count();
    let all = verdicts.len();
    match count(Status::Holds) {
        1 if all == 1 => return "The claim holds".into(),
        2 if all == 2 => return "Both claims hold".into(),
        holds if holds == all => return format!("All {all} claims hold"),
        _ => {}
    }
    let parts = [
        (Status::Holds, ["holds", "hold"]),
        (Status::Fails, ["fails", "fail"]),
        (Status::NotShown, ["could not be shown"; 2]),
        (Status::NotCovered, ["not covered"; 2]),
    ];
    let parts = parts.map(|(status, words)| (count(status), words)).into_iter();
    let parts = parts.filter(|(count, _)| *count > 0);
    let parts: Vec<String> = parts
        .map(|(count, [one, more])| format!("{count} {}", if count == 1 { one } else { more }))
        .collect();
    format!("{}: {}", plural(all, "claim"), parts.join(", "))
}

pub fn evidence(evidence: &Evidence) -> String {
    let machine = if evidence.of_machine { "on this machine: " } else { "" };
    let without = evidence.without.as_ref().map_or_else(String::new, left_out);
    let time = match evidence.time {
        Some([low, high]) if low < high => {
            format!("; {} to {} ns per particle on this machine", short(low), short(high))
        }
        Some([time, _]) => format!("; {} ns per particle on this machine", short(time)),
        None => String::new(),
    };
    let there = format!("{machine}{}{time}{without}", evidence.found);
    match &evidence.uncovered {
        None => there,
        Some(cut) if evidence.nothing => gaps(cut),
        Some(cut) => format!("{}; in these: {there}", gaps(cut)),
    }
}

/// Formats text such as `; 4 of 7 cells have no value: 3 refused, 1 timeout`.
fn left_out(without: &Without) -> String {
    let part = |(outcome, count): (&Option<_>, &usize)| match outcome {
        Some(outcome) => format!("{count} {}", Outcome::name(*outcome)),
        None => format!("{count} not measured"),
    };
    let parts: Vec<String> = without.outcomes.iter().map(part).collect();
    let count: usize = without.outcomes.values().sum();
    let of = plural(without.of, "cell");
    match &*parts {
        [_] => format!(
            "; {count} of {of} left out ({})",
            parts[0].split_once(' ').unwrap_or_default().1
        ),
        _ => format!("; {count} of {of} left out: {}", parts.join(", ")),
    }
}

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
             machine. Those marked \"on this machine\" are about times. A claim holds only if it \
             is true of all that the experiment plans; it is not covered if a part of the plan is \
             missing.",
        ),
    ]
}

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
