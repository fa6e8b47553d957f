pub mod verdicts;

use crate::document::Block;
use crate::sections::trust::coverage::gaps;
use crate::table::Table;
use contactbench_record::findings::claim::{Evidence, Status, Verdict};
use contactbench_record::record::row::Outcome;
use contactbench_terms::number::{plural, short};

/// Formats a score such as `24 of 26 claims hold; 1 FAILS; 1 not covered`.
pub fn score(verdicts: &[Verdict]) -> String {
    let count = |status: Status| {
        verdicts.iter().filter(|verdict| verdict.evidence.status == status).count()
    };
    let mut said = format!("{} of {} claims hold", count(Status::Holds), verdicts.len());
    for status in [Status::Fails, Status::NotShown, Status::NotCovered] {
        if count(status) > 0 {
            said += &format!("; {} {}", count(status), status.name());
        }
    }
    said
}

pub fn evidence(verdict: &Verdict) -> String {
    let Verdict { claim, evidence, .. } = verdict;
    let machine = if claim.uses_time() { "on this machine: " } else { "" };
    let time = match evidence.time {
        Some([low, high]) if low < high => {
            format!("; {} to {} ns per particle on this machine", short(low), short(high))
        }
        Some([time, _]) => format!("; {} ns per particle on this machine", short(time)),
        None => String::new(),
    };
    let there = format!("{machine}{}{time}{}", evidence.found, left_out(evidence));
    match &evidence.uncovered {
        None => there,
        Some(cut) if evidence.nothing => gaps(cut),
        Some(cut) => format!("{}; in these: {there}", gaps(cut)),
    }
}

/// Formats text such as `; 4 of 7 cells left out: 3 refused, 1 not measured`.
fn left_out(Evidence { cells, left_out, .. }: &Evidence) -> String {
    if left_out.is_empty() {
        return String::new();
    }
    let part = |(outcome, count): (&Option<Outcome>, &usize)| {
        format!("{count} {}", outcome.map_or("not measured", Outcome::name))
    };
    let parts: Vec<String> = left_out.iter().map(part).collect();
    let count: usize = left_out.values().sum();
    format!("; {count} of {} left out: {}", plural(*cells, "cell"), parts.join(", "))
}

pub fn blocks(verdicts: &[Verdict]) -> Vec<Block> {
    if verdicts.is_empty() {
        return Vec::new();
    }
    let table = Table::of("", verdicts)
        .left("claim", |it| &*it.claim.name)
        .left("verdict", |it| it.evidence.status.name())
        .left("evidence", evidence)
        .left("source", |it| it.claim.origin());
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
        if several { format!("{}: {}", v.experiment, v.claim.name) } else { v.claim.name.clone() }
    };
    let table = Table::of("", verdicts)
        .left("", |it| it.evidence.status.name())
        .left("", named)
        .left("", evidence);
    vec![Block::table(table), Block::paragraph(score(verdicts))]
}
