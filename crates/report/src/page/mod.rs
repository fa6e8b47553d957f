//! `report.html`: a report in one file that needs no server, no network and no other file. Only the
//! charts and the table of results need JavaScript. `data` gives them their numbers; `markup`
//! escapes texts of the record. Style and scripts are in `crates/report/assets`. A content security
//! policy in the page forbids every request.

pub(crate) mod answer;
mod cards;
mod data;
pub(crate) mod marks;
mod markup;
pub mod origin;

use std::fmt::Write as _;

use answer::Marks;
use markup::data_uri;
use origin::shown;

use crate::document::{self, Block};
use crate::figure::style::ranked;
use crate::report::{Facts, Part};
use crate::sections;
use contactbench_record::findings::claim::{Status, Verdict};
use contactbench_record::findings::trust::failures::failures;
use contactbench_terms::text;
use contactbench_terms::text::html as escape;

const TEMPLATE: &str = include_str!("../../assets/report/page.html");
const STYLE: &str = include_str!("../../assets/report/style.css");
const CHART: &str = include_str!("../../assets/report/chart.js");
const TABLE: &str = include_str!("../../assets/report/table.js");
const UPLOT: &str = include_str!("../../assets/uplot/uPlot.iife.min.js");
const UPLOT_STYLE: &str = include_str!("../../assets/uplot/uPlot.min.css");
const UPLOT_LICENCE: &str = include_str!("../../assets/uplot/LICENSE");

/// Limit of the bytes of figures inside a page; further figures are linked.
const FIGURE_BYTES: usize = 2_500_000;

pub fn html(facts: &Facts<'_>) -> String {
    let (parts, styles) = (&facts.parts, &facts.styles);
    let detectors = ranked(facts.cells, |cell| cell.id.subject());
    let detectors: Vec<&str> = detectors.iter().map(String::as_str).collect();
    let marks = Marks { detectors: &detectors, styles };
    let titles = parts.iter().map(|part| (&*part.experiment.name, &*part.experiment.title));
    let data = data::json(&titles.collect::<Vec<_>>(), facts.cells, &detectors, styles);
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
        ("answers", answers(parts, &marks)),
        ("claims", claims(parts)),
        ("figures", figures(parts)),
        ("outcomes", outcomes(parts)),
        ("tables", parts.iter().map(tables).collect()),
        ("machine", document::html(&notes) + &facts.origin.method()),
        ("commands", facts.origin.commands()),
        ("colours", marks::css(&detectors, styles)),
        ("data", markup::script_safe(&data.to_string())),
        ("style", STYLE.into()),
        ("chart", CHART.into()),
        ("table", TABLE.into()),
        ("uplot", UPLOT.into()),
        ("uplot-style", UPLOT_STYLE.into()),
        ("uplot-licence", escape(UPLOT_LICENCE)),
    ];
    text::fill(TEMPLATE, &values)
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
    let parts = [
        field("date_utc").map(first),
        field("cpu"),
        field("cores").map(|cores| format!("{cores} cores")),
        field("contactbench").map(|version| format!("contactbench {version}")),
        field("revision").map(|revision| format!("revision {}", short(revision))),
        quick.map(|_| "a quick run: times say little".into()),
    ];
    parts.into_iter().flatten().collect::<Vec<_>>().join(" · ")
}

fn answers(parts: &[Part<'_>], marks: &Marks<'_>) -> String {
    let mut out = String::from("<ul class=\"who\" aria-label=\"Marks of the detectors\">");
    for (k, name) in marks.detectors.iter().enumerate() {
        let style = marks.styles.get(name);
        if !style.control {
            out += &format!("<li>{}{}</li>", marks::chip(k, style.marker), escape(name));
        }
    }
    out += "</ul>\n";
    for part in parts {
        let contests = !part.winners.contests.is_empty();
        let mut head = vec![Block::heading(3, part.experiment.question.as_str())];
        head.extend(sections::answer::blocks(&part.verdicts, true));
        out += &format!("<article>\n{}", document::html(&head));
        let asked = part.asks_fastest && contests;
        // If there is only one experiment, the card already holds the sentence.
        if parts.len() > 1 && asked {
            let sentence = document::inline_html(&part.sentence());
            out += &format!("<p class=\"lead\">{sentence}</p>\n");
        }
        let compared = asked && sections::winners::compared(&part.winners);
        let left_out = sections::winners::left_out(&part.winners).filter(|_| compared);
        out += &document::html(&Vec::from_iter(left_out));
        if compared {
            out += &answer::table(&part.winners, marks);
        }
        if let Some(matrix) = &part.matrix {
            let blocks = document::html(&sections::claims::verdicts::blocks(matrix));
            out += &details("Who is right, case by case", &blocks, !contests);
        }
        out += "</article>\n";
    }
    out
}

fn claims(parts: &[Part<'_>]) -> String {
    let mut out = String::new();
    for part in parts.iter().filter(|part| !part.verdicts.is_empty()) {
        let _ = writeln!(
            out,
            "<h3>{}</h3>\n<div class=\"scroll\" tabindex=\"0\"><table \
             class=\"claims\"><thead><tr><th>claim</th><th>verdict</th><th>evidence</th></tr>\
             </thead><tbody>",
            escape(&part.experiment.title)
        );
        out.extend(part.verdicts.iter().map(claim));
        out += "</tbody></table></div>\n";
    }
    if out.is_empty() { "<p>No claims were checked.</p>".into() } else { out }
}

fn claim(verdict: &Verdict) -> String {
    let (class, sign) = match verdict.status {
        Status::Holds => ("good", "✓"),
        Status::Fails => ("bad", "✗"),
        Status::NotCovered | Status::NotShown => ("open", "–"),
    };
    let source = match &*verdict.source {
        "" => String::new(),
        source => format!("<br><small>{}</small>", escape(source)),
    };
    format!(
        "<tr><td>{}{source}</td><td class=\"verdict {class}\">{sign} \
         {}</td><td><small>{}</small></td></tr>\n",
        escape(&verdict.claim),
        verdict.status.name(),
        escape(&sections::claims::evidence(&verdict.evidence))
    )
}

fn figures(parts: &[Part<'_>]) -> String {
    let (mut out, mut room) = (String::new(), FIGURE_BYTES);
    for (title, path) in parts.iter().flat_map(|part| &part.figures) {
        let title = escape(title);
        let name = escape(&path.file_name().unwrap_or_default().to_string_lossy());
        let svg = std::fs::read_to_string(path).ok().map(|svg| data_uri(&svg));
        let svg = svg.filter(|svg| svg.len() <= room);
        let image = match &svg {
            Some(svg) => format!("<img alt=\"{title}\" loading=\"lazy\" src=\"{svg}\">"),
            None => "<p>(too large for this page)</p>".into(),
        };
        room -= svg.map_or(0, |svg| svg.len());
        let _ = writeln!(
            out,
            "<figure>{image}<figcaption>{title}<span class=\"links\">Download: <a \
             href=\"figures/{name}\" download=\"{name}\">SVG</a></span></figcaption></figure>"
        );
    }
    if out.is_empty() { "<p>The experiments ask for no figures.</p>".into() } else { out }
}

fn outcomes(parts: &[Part<'_>]) -> String {
    let found = parts.iter().map(|part| failures(&part.cells));
    let tables = found.filter(|found| !found.is_empty());
    match &*tables.map(|found| sections::trust::failures::table(&found)).collect::<Vec<_>>() {
        [] => "<p>Every cell has a right answer.</p>".into(),
        blocks => document::html(blocks),
    }
}

fn tables(part: &Part<'_>) -> String {
    let reading = code(&part.experiment.reading);
    let tables = document::html(&part.tables);
    let body = format!("<p><em>How to read the figures:</em> {reading}</p>{tables}");
    details(&escape(&part.experiment.title), &body, false)
}

/// Formats a text whose words in backticks are code.
pub(crate) fn code(text: &str) -> String {
    let parts = text.split('`').enumerate();
    let format = |(k, part): (usize, &str)| match k % 2 {
        0 => escape(part),
        _ => format!("<code>{}</code>", escape(part)),
    };
    parts.map(format).collect()
}

fn details(head: &str, body: &str, open: bool) -> String {
    let open = if open { " open" } else { "" };
    format!("<details{open}><summary>{head}</summary>\n{body}</details>\n")
}
