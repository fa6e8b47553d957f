//! The cards at the top of a page: answer, correctness, claims.

use std::collections::BTreeSet;

use crate::document;
use crate::facts::{Chapter, Facts};
use contactbench_record::cells::Cell;
use contactbench_record::findings::claim::{self, Status};
use contactbench_record::record::row::Outcome;
use contactbench_terms::text::html as escape;

pub fn html(facts: &Facts<'_>) -> String {
    let card = |head: &str, (class, body): (&str, String)| {
        format!("<div class=\"card {class}\"><h3>{head}</h3><p>{body}</p></div>\n")
    };
    card("Answer", ("speed", answer(&facts.chapters)))
        + &card("Right", right(&facts.chapters))
        + &card("Claims", claims(facts))
}

fn answer(chapters: &[Chapter<'_>]) -> String {
    let brief = |chapter: &Chapter<'_>| chapter.brief().map(|text| document::inline_html(&text));
    match chapters {
        [chapter] if chapter.asks_fastest => document::inline_html(&chapter.sentence()),
        [chapter] => brief(chapter).unwrap_or_default(),
        chapters => {
            let named = |chapter: &Chapter<'_>| {
                Some(format!("{}: {}", escape(&chapter.experiment.name), brief(chapter)?))
            };
            chapters.iter().filter_map(named).collect::<Vec<_>>().join("; ") + "."
        }
    }
}

fn names<'a>(cells: &[&'a Cell], name: impl Fn(&'a Cell) -> &'a str) -> String {
    let names: BTreeSet<&str> = cells.iter().map(|cell| name(cell)).collect();
    escape(&names.into_iter().collect::<Vec<_>>().join(", "))
}

/// Returns the class of the card, and the number of cells by answer.
fn right(chapters: &[Chapter<'_>]) -> (&'static str, String) {
    let all: Vec<&Cell> = chapters.iter().flat_map(|chapter| &chapter.cells).copied().collect();
    let such = |wanted: &dyn Fn(&Cell) -> bool| -> Vec<&Cell> {
        all.iter().filter(|cell| wanted(cell)).copied().collect()
    };
    let good = such(&|cell| cell.overall().0.is_good());
    let wrong = such(&|cell| cell.overall().0 == Outcome::Wrong);
    let off = such(&|cell| {
        cell.overall().0.is_good() && cell.errors.is_some_and(|errors| errors.wrong() > 0)
    });
    let twins = chapters.iter().map(|chapter| chapter.coverage.twins).sum();
    let counts = [
        (wrong.len(), format!("wrong ({})", names(&wrong, |cell| &cell.id.detector))),
        (off.len(), format!("rounded ({})", names(&off, |cell| &cell.id.arithmetic))),
        (twins, "of twins".into()),
        (
            all.len() - good.len() - wrong.len(),
            "<a href=\"#outcomes\">without an answer</a>".into(),
        ),
    ];
    let said = format!("<strong>{} of {} cells right</strong>", good.len(), all.len());
    (if wrong.is_empty() { "good" } else { "bad" }, said + &counted(&counts))
}

/// Returns the class of the card, and the number of claims by status.
fn claims(facts: &Facts<'_>) -> (&'static str, String) {
    let verdicts = &facts.verdicts;
    let count = |status: Status| verdicts.iter().filter(|it| it.status == status).count();
    let (fails, failed) = (count(Status::Fails), claim::any_failed(verdicts));
    let counts = [Status::Fails, Status::NotShown, Status::NotCovered]
        .map(|status| (count(status), status.name().to_string()));
    let said = format!(
        "<a href=\"#claims\"><strong>{} of {} claims hold</strong></a>",
        count(Status::Holds),
        verdicts.len()
    );
    let class = match fails {
        _ if failed => "bad",
        0 => "good",
        _ => "open",
    };
    (class, said + &counted(&counts))
}

/// Formats counts that are not 0, such as `; 2 wrong (nbs); 1 of twins`.
fn counted(counts: &[(usize, String)]) -> String {
    let counts = counts.iter().filter(|(count, _)| *count > 0);
    counts.map(|(count, words)| format!("; {count} {words}")).collect()
}
