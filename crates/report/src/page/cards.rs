//! The cards at the top of a page: answer, correctness, claims.

use std::collections::BTreeSet;

use crate::document;
use crate::report::{Facts, Part};
use contactbench_record::cells::Cell;
use contactbench_record::findings::claim::{self, Status};
use contactbench_record::record::row::Outcome;
use contactbench_terms::number::plural;
use contactbench_terms::text::html as escape;

pub fn html(facts: &Facts<'_>) -> String {
    let card = |head: &str, (class, body): (&str, String)| {
        format!("<div class=\"card {class}\"><h3>{head}</h3><p>{body}</p></div>\n")
    };
    card("Answer", ("speed", answer(&facts.parts)))
        + &card("Right", right(&facts.parts))
        + &card("Claims", claims(facts))
}

fn answer(parts: &[Part<'_>]) -> String {
    let brief = |part: &Part<'_>| part.brief().map(|text| document::inline_html(&text));
    match parts {
        [part] if part.asks_fastest => document::inline_html(&part.sentence()),
        [part] => brief(part).unwrap_or_default(),
        parts => {
            let named = |part: &Part<'_>| {
                Some(format!("{}: {}", escape(&part.experiment.name), brief(part)?))
            };
            parts.iter().filter_map(named).collect::<Vec<_>>().join("; ") + "."
        }
    }
}

fn names<'a>(cells: &[&'a Cell], name: impl Fn(&'a Cell) -> &'a str) -> String {
    let names: BTreeSet<&str> = cells.iter().map(|cell| name(cell)).collect();
    escape(&names.into_iter().collect::<Vec<_>>().join(", "))
}

/// Returns the class of the card, and the number of right answers in words.
fn right(parts: &[Part<'_>]) -> (&'static str, String) {
    let all: Vec<&Cell> = parts.iter().flat_map(|part| &part.cells).copied().collect();
    let such = |wanted: &dyn Fn(&&Cell) -> bool| -> Vec<&Cell> {
        all.iter().filter(|cell| wanted(cell)).copied().collect()
    };
    let good = such(&|cell| cell.overall().0.is_good());
    let off = |cell: &&Cell| cell.errors.is_some_and(|errors| errors.wrong() > 0);
    let off: Vec<&Cell> = good.iter().filter(|cell| off(cell)).copied().collect();
    let wrong = such(&|cell| cell.overall().0 == Outcome::Wrong);
    let twins = match parts.iter().map(|part| part.coverage.twins).sum::<usize>() {
        0 => String::new(),
        twins => format!(" ({twins} of twins)"),
    };
    let (class, mut said) = match wrong.len() {
        0 => (
            "good",
            format!(
                "<strong>No detector was wrong</strong>: {} of {}{twins} ended well, every answer \
                 checked.",
                good.len(),
                plural(all.len(), "cell")
            ),
        ),
        count => (
            "bad",
            format!(
                "<strong>Wrong in {} of {}</strong>: {}. Times of wrong answers are not compared.",
                plural(count, "cell"),
                all.len(),
                names(&wrong, |cell| &cell.id.detector)
            ),
        ),
    };
    if !off.is_empty() {
        said += &format!(
            " Rounding lost or added pairs in {}, as {} may.",
            plural(off.len(), "cell"),
            names(&off, |cell| &cell.id.arithmetic)
        );
    }
    let without = all.len() - good.len() - wrong.len();
    if without > 0 {
        said += &format!(" <a href=\"#outcomes\">Without an answer</a>: {without}.");
    }
    (class, said)
}

/// Returns the class of the card, and the number of claims that hold in words.
fn claims(facts: &Facts<'_>) -> (&'static str, String) {
    let verdicts = &facts.verdicts;
    let count = |status: Status| verdicts.iter().filter(|it| it.status == status).count();
    let mut said = match verdicts.len() {
        0 => "No claims were checked.".to_string(),
        all => format!(
            "<a href=\"#claims\"><strong>{} of {} hold</strong></a>",
            count(Status::Holds),
            plural(all, "claim")
        ),
    };
    let failed = claim::any_failed(verdicts);
    let ours = if failed { "" } else { " (about times on this machine)" };
    let (fails, open) = (count(Status::Fails), count(Status::NotShown));
    let verb = if fails == 1 { "fails" } else { "fail" };
    for (count, words) in [
        (fails, format!("{verb}{ours}")),
        (open, "could not be shown".into()),
        (count(Status::NotCovered), "not covered".into()),
    ] {
        if count > 0 {
            said += &format!("; {count} {words}");
        }
    }
    let class = match fails {
        _ if failed => "bad",
        0 => "good",
        _ => "open",
    };
    (class, said)
}
