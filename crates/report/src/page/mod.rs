//! `report.html`: a report in one file that needs no server, no network and no other file. Only
//! sorting, filtering and highlighting need JavaScript. Style and script are in
//! `crates/report/assets`. A content security policy in the page forbids every request.

mod cards;
pub mod origin;

use std::fmt::Write as _;

use origin::shown;

use crate::document::{self, Block};
use crate::facts::{Chapter, Facts};
use crate::figure::style::{Styles, ranked};
use crate::table::{Rows, Table};
use crate::{sections, table};
use contactbench_record::cells::{Cell, errors, label};
use contactbench_record::findings::claim::{Status, Verdict};
use contactbench_record::findings::trust::failures::failures;
use contactbench_record::record::column::Column;
use contactbench_record::record::row::{Outcome, Pass};
use contactbench_terms::number::short;
use contactbench_terms::text;
use contactbench_terms::text::html as escape;

const TEMPLATE: &str = include_str!("../../assets/report/page.html");
pub(crate) const STYLE: &str = include_str!("../../assets/report/style.css");
pub(crate) const SCRIPT: &str = include_str!("../../assets/report/page.js");

/// Limit of the bytes of figures inside a page; further figures are linked.
const FIGURE_BYTES: usize = 2_500_000;

pub fn html(facts: &Facts<'_>) -> String {
    let chapters = &facts.chapters;
    let warning = |line: &String| Block::Warning(line.as_str().into());
    let wrong = facts.wrong.iter().map(warning);
    let first: Vec<Block> = wrong.chain(facts.alerts.iter().cloned()).collect();
    let whole = facts.whole.iter().map(|line| Block::paragraph(line.as_str()));
    let notes: Vec<Block> = whole.chain(facts.warnings.iter().map(warning)).collect();
    let values = [
        ("title", escape(facts.title())),
        ("source", escape(&source(facts))),
        ("warnings", document::html(&first)),
        ("cards", cards::html(facts)),
        ("answers", chapters.iter().map(|chapter| answers(chapter, chapters.len() > 1)).collect()),
        ("claims", claims(chapters)),
        ("legend", legend(facts.cells, &facts.styles)),
        ("figures", figures(chapters)),
        ("results", results(facts.cells).html("results")),
        ("outcomes", outcomes(chapters)),
        ("tables", chapters.iter().map(tables).collect()),
        ("machine", document::html(&notes) + &facts.origin.method()),
        ("commands", facts.origin.commands()),
        ("style", STYLE.into()),
        ("script", SCRIPT.into()),
    ];
    text::fill(TEMPLATE, &values)
}

/// Returns a button for each detector, with its colour in the figures.
pub(crate) fn legend(cells: &[Cell], styles: &Styles) -> String {
    let mut out = String::from("<div class=\"who\" role=\"group\" aria-label=\"Detectors\">");
    for name in ranked(cells, |cell| cell.id.subject()) {
        let (r, g, b) = styles.get(&name).colour;
        let colour = format!("#{r:02X}{g:02X}{b:02X}");
        let _ = write!(
            out,
            "<button type=\"button\" aria-pressed=\"false\" data-colour=\"{colour}\" \
             style=\"--c:{colour}\">{}</button>",
            escape(&name)
        );
    }
    out + "</div>\n"
}

/// Returns the table of all cells.
fn results(cells: &[Cell]) -> Table {
    let swept = label::swept(&cells.iter().collect::<Vec<_>>());
    let per = |cell: &Cell, name| Some(cell.variable(name, None)? / cell.id.n.max(1) as f64);
    let rows = Table::of("", cells)
        .left("scene", |it| label::title(it.id.scene_id(), &swept))
        .left("detector", |it| it.id.subject());
    measured(rows, |it| it)
        .right("contact tests / N", |it| per(it, "contact_test"))
        .right("operations / N", |it| operations(it) / it.id.n.max(1) as f64)
        .right("wrong / contact", errors::rate)
        .left("experiment", |it| &*it.id.experiment)
        .left("reason", |it| it.overall().1)
        .into()
}

/// Returns the line below the title: date, machine, program.
fn source(facts: &Facts<'_>) -> String {
    let field = |name: &str| {
        let value = facts.origin.provenance.as_ref()?.get(name);
        value.filter(|value| !value.is_null()).map(shown)
    };
    let first = |text: String| text.split('T').next().unwrap_or_default().to_string();
    let short = |revision: String| revision.chars().take(10).collect::<String>();
    let quick = field("quick").filter(|quick| quick == "true");
    let known = [
        field("date_utc").map(first),
        field("cpu"),
        field("cores").map(|cores| format!("{cores} cores")),
        field("contactbench").map(|version| format!("contactbench {version}")),
        field("revision").map(|revision| format!("revision {}", short(revision))),
        quick.map(|_| "a quick run: times say little".into()),
    ];
    known.into_iter().flatten().collect::<Vec<_>>().join(" · ")
}

/// Returns the question of an experiment with its answers.
pub(crate) fn answers(chapter: &Chapter<'_>, several: bool) -> String {
    let compared = chapter.asks_fastest && sections::winners::compared(&chapter.winners);
    let mut blocks = vec![Block::heading(3, chapter.experiment.question.as_str())];
    blocks.extend(sections::answer::blocks(&chapter.verdicts, true));
    // If there is only one experiment, the card already holds the sentence.
    blocks.extend((compared && several).then(|| Block::Paragraph(chapter.sentence())));
    blocks.extend(sections::winners::left_out(&chapter.winners).filter(|_| compared));
    let mut out = document::html(&blocks);
    if compared {
        out += &fastest(chapter);
    }
    if let Some(matrix) = &chapter.matrix {
        let blocks = document::html(&sections::claims::verdicts::blocks(matrix));
        out += &details("Who is right, case by case", &blocks, chapter.winners.contests.is_empty());
    }
    out
}

/// Returns the table of the fastest detectors.
pub(crate) fn fastest(chapter: &Chapter<'_>) -> String {
    let shown = sections::winners::shown(&chapter.winners);
    sections::winners::table(&shown, true, short).html("answer")
}

fn claims(chapters: &[Chapter<'_>]) -> String {
    let claimed = chapters.iter().filter(|chapter| !chapter.verdicts.is_empty());
    let tables = claimed.map(|chapter| {
        let title = escape(&chapter.experiment.title);
        let table = Table::of("", &chapter.verdicts).left("claim", |it| &*it.claim);
        let table = table.left("verdict", verdict);
        let table = table.left("evidence", |it| sections::claims::evidence(&it.evidence));
        let table = Table::from(table.left("source", |it| &*it.source));
        format!("<h3>{title}</h3>\n{}", table.html("claims"))
    });
    tables.reduce(|all, next| all + &next).unwrap_or("<p>No claims were checked.</p>".into())
}

fn verdict(verdict: &Verdict) -> String {
    let sign = match verdict.status {
        Status::Holds => "✓",
        Status::Fails => "✗",
        Status::NotCovered | Status::NotShown => "–",
    };
    format!("{sign} {}", verdict.status.name())
}

fn figures(chapters: &[Chapter<'_>]) -> String {
    let (mut out, mut room) = (String::new(), FIGURE_BYTES);
    for (title, path) in chapters.iter().flat_map(|chapter| &chapter.figures) {
        let title = escape(title);
        let name = escape(&path.file_name().unwrap_or_default().to_string_lossy());
        let svg = std::fs::read_to_string(path).ok().filter(|svg| svg.len() <= room);
        room -= svg.as_ref().map_or(0, String::len);
        let image = svg.map_or("<p>(too large for this page)</p>".into(), |svg| {
            svg.replacen("<svg", &format!("<svg role=\"img\" aria-label=\"{title}\""), 1)
        });
        let _ = writeln!(
            out,
            "<figure>{image}<figcaption>{title} <a href=\"figures/{name}\" \
             download=\"{name}\">SVG</a></figcaption></figure>"
        );
    }
    if out.is_empty() { "<p>The experiments ask for no figures.</p>".into() } else { out }
}

fn outcomes(chapters: &[Chapter<'_>]) -> String {
    let found = chapters.iter().map(|chapter| failures(&chapter.cells));
    let tables = found.filter(|found| !found.is_empty());
    match &*tables.map(|found| sections::trust::failures::table(&found)).collect::<Vec<_>>() {
        [] => "<p>Every cell has a right answer.</p>".into(),
        blocks => document::html(blocks),
    }
}

fn tables(chapter: &Chapter<'_>) -> String {
    let reading = code(&chapter.experiment.reading);
    let tables = document::html(&chapter.tables);
    let body = format!("<p><em>How to read the figures:</em> {reading}</p>{tables}");
    details(&escape(&chapter.experiment.title), &body, false)
}

/// Formats a text whose words in backticks are code.
pub(crate) fn code(text: &str) -> String {
    let pieces = text.split('`').enumerate();
    let format = |(k, piece): (usize, &str)| match k % 2 {
        0 => escape(piece),
        _ => format!("<code>{}</code>", escape(piece)),
    };
    pieces.map(format).collect()
}

fn details(head: &str, body: &str, open: bool) -> String {
    let open = if open { " open" } else { "" };
    format!("<details{open}><summary>{head}</summary>\n{body}</details>\n")
}

/// Adds the columns that all tables of measurements share.
pub(crate) fn measured<'a, R: Copy>(rows: Rows<R>, cell: impl Fn(R) -> &'a Cell + Copy) -> Rows<R> {
    let per = move |row: R, name: &str| {
        let cell = cell(row);
        Some(cell.variable(name, None)? / cell.id.n.max(1) as f64 / cell.frames())
    };
    let time = move |row: R| match cell(row).wrong_time() {
        Some(time) => table::Cell::Number(time / cell(row).id.n.max(1) as f64).wrong(),
        None => per(row, "time_ns").into(),
    };
    rows.left("answer", move |row| answer(cell(row)))
        .right("wrong pairs", move |row| wrong(cell(row)))
        .unit("time / N", "ns", time)
        .unit("time / pair", "ns", move |row| cell(row).per_pair(cell(row).time()?.median))
        .unit("memory / N", "bytes", move |row| per(row, "peak_bytes"))
        .right("threads", move |row| cell(row).id.threads())
        .left("arithmetic", move |row| &*cell(row).id.arithmetic)
}

fn answer(cell: &Cell) -> &'static str {
    match cell.overall().0 {
        Outcome::Ok | Outcome::Lossy if wrong(cell).is_some() => Outcome::Wrong.name(),
        Outcome::Ok => "right",
        outcome => outcome.name(),
    }
}

/// Returns the number of wrong pairs; `None` if there are none, or if they were not counted.
fn wrong(cell: &Cell) -> Option<u64> {
    cell.errors.map(|errors| errors.wrong()).filter(|&wrong| wrong > 0)
}

pub(crate) fn operations(cell: &Cell) -> f64 {
    let counted = Column::measured_by(Pass::Count);
    counted.filter_map(|column| cell.variable(&column.name, None)).sum()
}
