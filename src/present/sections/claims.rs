//! Claims and what came of them.

use crate::findings::claim::{Evidence, Found, Series, Status, Verdict, Without};
use crate::number::{number, percent, plural, times, with_interval};
use crate::present::document::{Block, Text};
use crate::present::sections::coverage::uncovered;
use crate::present::table::{Cell, Column, Table};
use crate::record::row::Outcome;
use crate::stats::growth::{LIMIT, Tail};

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

/// Series that do not grow as claimed, said one by one.
const SERIES: usize = 3;

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
    let there = format!("{machine}{}{time}{without}", found(&evidence.found));
    let Some(cut) = evidence.uncovered.as_ref().map(uncovered) else {
        return there;
    };
    match &evidence.found {
        Found::NoRows | Found::NoCell | Found::NoValue | Found::NoTimes { .. } => cut,
        _ => {
            let all = evidence.uncovered.as_ref().is_some_and(|cut| cut.cells == cut.of);
            let rest = if all { "its own cells" } else { "the other cells" };
            format!("{cut}; in {rest}: {there}")
        }
    }
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

fn found(found: &Found) -> String {
    match found {
        Found::NoRows => "no rows of this experiment".into(),
        Found::NoCell => "no cell matches".into(),
        Found::NoValue => "no cell has a value".into(),
        Found::NoSides => "no cell has both sides".into(),
        Found::Unusable(why) => format!("cannot be checked: {why}"),
        Found::Wrong { cells, first } => {
            format!("wrong answers in {}, first at {first}", plural(*cells, "cell"))
        }
        Found::Crashed { first } => format!("a detector of this program crashed, first at {first}"),
        Found::Single(value) => {
            format!("{} in the only cell; a constant needs two", number(*value))
        }
        Found::Constant { low, high, spread, within, over } => {
            let range = format!("{} to {} over {over}", number(low.value), number(high.value));
            match spread {
                None => format!("{range}; the smallest is not positive"),
                Some(spread) if spread <= within => {
                    format!("{range} ({})", apart(*spread, *within))
                }
                Some(spread) => format!(
                    "{range} ({}, allowed {}); lowest at {}, highest at {}",
                    apart(*spread, *within),
                    apart(*within, *within),
                    low.place,
                    high.place
                ),
            }
        }
        Found::Compared { equal, cells, bad, worst, limit, gap, over } => {
            let (count, at) = (plural(*cells, "cell"), &worst.place);
            let (value, limit) = (number(worst.value), number(*limit));
            match (*bad, equal) {
                (0, true) if *gap == 0.0 => format!("exactly, in {count} over {over}"),
                (0, true) => format!("within {} in {count} over {over}", percent(*gap)),
                (0, false) => {
                    format!("in {count} over {over}; nearest: {value} against {limit} at {at}")
                }
                (bad, _) => {
                    let sign = if *equal { "differs from" } else { "exceeds" };
                    let by = match gap.is_finite() {
                        true => format!(" by {}", percent(*gap)),
                        false => String::new(),
                    };
                    format!("in {bad} of {count}; worst: {value} {sign} {limit}{by} at {at}")
                }
            }
        }
        Found::Growth { law, fitting, others } => {
            let mut parts: Vec<String> = Vec::new();
            if let Some(fitting) = fitting {
                let [low, high] = fitting.exponents;
                let range =
                    if low < high { format!("{low:.3} to {high:.3}") } else { format!("{low:.3}") };
                parts.push(format!(
                    "{} fits {} series: exponent {range}, ΔAICc {:.0} or more to the next law",
                    law.name(),
                    fitting.series,
                    fitting.delta
                ));
            }
            parts.extend(others.iter().take(SERIES).map(|other| series(other, law.name())));
            if others.len() > SERIES {
                parts.push(format!("and {} more series", others.len() - SERIES));
            }
            parts.join("; ")
        }
        Found::Faster { than, by, cells, low, high, slower, open, worst, place } => {
            let goal = if *by == 1.0 { "faster".into() } else { format!("{by} times as fast") };
            let tell = match (slower, open) {
                (0, 0) => "nearest to the limit".into(),
                (0, open) => format!("not shown in {open} of them, where noise hides it; worst"),
                (slower, 0) => format!("not {goal} in {slower} of them; worst"),
                (slower, open) => {
                    format!("not {goal} in {slower} of them, not shown in {open} more; worst")
                }
            };
            let cells = plural(*cells, "cell");
            format!(
                "{} to {} times the time of {than} in {cells}; {tell} {} at {place}",
                times(*low),
                times(*high),
                with_interval(worst)
            )
        }
        Found::NoTimes { than } => format!("no cell has times of both it and {than}"),
    }
}

/// How far a value is above another: in percent, or as a factor where that is allowed to be large.
fn apart(spread: f64, within: f64) -> String {
    match within >= 1.0 || spread >= 1.0 {
        true => format!("a factor of {}", number(1.0 + spread)),
        false => percent(spread),
    }
}

fn series(series: &Series, wanted: &str) -> String {
    let place = if series.place.is_empty() { String::new() } else { format!("{}: ", series.place) };
    let exponent = series.slope.map_or_else(String::new, |slope| {
        format!("exponent {:.3} [{:.3}, {:.3}], ", slope.exponent, slope.low, slope.high)
    });
    let law = match (series.law, series.off) {
        (Ok(law), _) if law.name() != wanted => format!("{} fits, not {wanted}", law.name()),
        (_, Some(Tail { sizes: [first, last], found, law })) => format!(
            "{found:.3} over n = {first}..{last}, where {wanted} has {law:.3}: {:.3} off, {LIMIT} \
             allowed",
            (found - law).abs()
        ),
        (Ok(_), None) => format!("{wanted} fits"),
        (Err(doubt), None) => format!("undecided: {doubt}"),
    };
    format!("{place}{exponent}{law}")
}

/// For a report: the table, and how the claims are checked.
pub fn blocks(verdicts: &[Verdict]) -> Vec<Block> {
    if verdicts.is_empty() {
        return Vec::new();
    }
    let columns = ["claim", "verdict", "evidence", "source"].map(Column::left).into();
    let row = |verdict: &Verdict| -> Vec<Cell> {
        let evidence = evidence(&verdict.evidence);
        [&*verdict.claim, verdict.status.name(), &evidence, &verdict.source].map(Cell::from).into()
    };
    vec![
        Block::Table(Table::new("", columns).with(verdicts.iter().map(row))),
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
    let row = |v: &Verdict| -> Vec<Cell> {
        vec![v.status.name().into(), named(v).into(), evidence(&v.evidence).into()]
    };
    let table = Table::new("", ["", "", ""].map(Column::left).into());
    let score = Block::Paragraph(Text::from(score(verdicts)));
    vec![Block::Table(table.with(verdicts.iter().map(row))), score]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::present::document::{markdown, plain};

    #[test]
    fn the_table_fits_a_terminal() {
        let verdict = Verdict {
            experiment: "e".into(),
            claim: "c".into(),
            source: String::new(),
            answers: String::new(),
            status: Status::Fails,
            machine_independent: true,
            evidence: Evidence {
                found: Found::Unusable("a long reason, ".repeat(9)),
                of_machine: false,
                without: None,
                uncovered: None,
                time: None,
            },
        };
        let text = plain(&terminal(&[verdict.clone(), verdict.clone()]), 80);
        assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
        assert!(text.starts_with("FAILS  c  cannot be checked: a long"), "{text}");
        assert!(text.ends_with("2 claims: 0 hold, 2 fail, 0 could not be shown\n"), "{text}");
        assert!(markdown(&blocks(&[verdict])).contains("| c | FAILS | cannot be checked: a long"));
    }
}
