//! `report.html`: a whole report in one file that opens from disk, without a server, the network,
//! or the files beside it.
//!
//! What can be said without a program stands in the page as HTML, made here: the answer, verdicts,
//! figures, what did not end well, machine and method. [`data`] gives the charts and the table
//! their numbers; [`marks`] keeps the colours of the figures; [`markup`] lets no text of a record
//! become markup. Style and program are in `crates/report/assets/report`, the charting library,
//! uPlot, in `crates/report/assets/uplot`. A content security policy in the page forbids every
//! request.

pub mod answer;
pub mod data;
pub mod map;
pub mod marks;
pub mod markup;
pub mod origin;

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use markup::data_uri;
use origin::shown;
use serde_json::Value;

use crate::escape::html as escape;
use crate::figure::style::{Styles, rank};
use crate::report::{Origin, Part, summaries};
use crate::sections::map::Drawn;
use crate::sections::winners::left_out;
use crate::{document, sections};
use contactbench_record::cells::Cell;
use contactbench_record::findings::claim::{self, Status, Verdict};
use contactbench_record::findings::failures::failures;
use contactbench_record::record::row::Outcome;
use contactbench_terms::number::plural;

const TEMPLATE: &str = include_str!("../../assets/report/page.html");
const STYLE: &str = include_str!("../../assets/report/style.css");
const CHART: &str = include_str!("../../assets/report/chart.js");
const TABLE: &str = include_str!("../../assets/report/table.js");
const UPLOT: &str = include_str!("../../assets/uplot/uPlot.iife.min.js");
const UPLOT_STYLE: &str = include_str!("../../assets/uplot/uPlot.min.css");
const UPLOT_LICENCE: &str = include_str!("../../assets/uplot/LICENSE");

/// Figures are put into the page up to so many bytes together; those beyond are linked.
const FIGURE_BYTES: usize = 2_500_000;

/// A page.
pub struct Page<'a> {
    /// Its experiments.
    pub parts: &'a [Part<'a>],
    /// All cells of the record.
    pub cells: &'a [Cell],
    /// Colours and markers.
    pub styles: &'a Styles,
    /// Where the record is from.
    pub origin: Origin<'a>,
    /// The same of runs that were resumed.
    pub resumed: Vec<Value>,
    /// What was left out.
    pub warnings: &'a [String],
}

impl Page<'_> {
    /// The page.
    pub fn html(&self) -> String {
        let detectors = self.detectors();
        let detectors: Vec<&str> = detectors.iter().map(String::as_str).collect();
        let titles: Vec<(&str, &str)> = self
            .parts
            .iter()
            .map(|part| (part.experiment.name.as_str(), part.experiment.title.as_str()))
            .collect();
        let title = if let [(_, title)] = titles[..] {
            title.to_string()
        } else {
            "Contact detection: results".into()
        };
        let data = data::json(&titles, self.cells, &detectors, self.styles);
        let values = [
            ("title", escape(&title)),
            ("source", escape(&self.source())),
            (
                "warnings",
                document::html(&sections::coverage::blocks(&summaries(self.parts)))
                    + &sections::conditions::sentence(self.origin.conditions)
                        .iter()
                        .chain(self.warnings)
                        .map(|line| format!("<p class=\"warning\">{}</p>\n", escape(line)))
                        .collect::<String>(),
            ),
            ("cards", self.cards()),
            ("answers", self.answers(&detectors)),
            ("claims", self.claims()),
            ("maps-link", self.maps().map_or("", |_| "<a href=\"#maps\">Maps</a> ").into()),
            ("maps", self.maps().unwrap_or_default()),
            ("figures", self.figures()),
            ("outcomes", self.outcomes()),
            ("tables", self.tables()),
            ("machine", self.machine()),
            ("commands", self.commands()),
            ("colours", marks::css(&detectors, self.styles)),
            ("data", markup::script_safe(&data.to_string())),
            ("style", STYLE.into()),
            ("chart", CHART.into()),
            ("table", TABLE.into()),
            ("uplot", UPLOT.into()),
            ("uplot-style", UPLOT_STYLE.into()),
            ("uplot-licence", escape(UPLOT_LICENCE)),
        ];
        markup::fill(TEMPLATE, &values.each_ref().map(|(name, value)| (*name, value.as_str())))
    }

    /// In the order of legends.
    fn detectors(&self) -> Vec<String> {
        let ranked: BTreeSet<(usize, String)> =
            self.cells.iter().map(|cell| (rank(cell), cell.id.contender())).collect();
        ranked.into_iter().map(|(_, name)| name).collect()
    }

    /// The line below the title: when, on what, by which program.
    fn source(&self) -> String {
        let field = |name: &str| {
            self.origin
                .provenance
                .and_then(|fields| fields.get(name))
                .filter(|value| !value.is_null())
                .map(shown)
        };
        let date =
            field("date_utc").map(|date| date.split('T').next().unwrap_or_default().to_string());
        let cores = field("cores").map(|cores| format!("{cores} cores"));
        let program = field("contactbench").map(|version| format!("contactbench {version}"));
        let revision = field("revision")
            .map(|revision| format!("revision {}", revision.chars().take(10).collect::<String>()));
        let quick = (field("quick").as_deref() == Some("true"))
            .then(|| "a quick run: times say little".into());
        [date, field("cpu"), cores, program, revision, quick]
            .into_iter()
            .flatten()
            .collect::<Vec<_>>()
            .join(" · ")
    }

    /// The three answers at a glance: speed, correctness, claims.
    fn cards(&self) -> String {
        let own = || self.parts.iter().flat_map(|part| &part.cells);
        let count = |wanted: &dyn Fn(&Cell) -> bool| own().filter(|cell| wanted(cell)).count();
        let good = count(&|cell| cell.overall().0.is_good());
        let is_off = |cell: &Cell| {
            cell.overall().0.is_good() && cell.errors.is_some_and(|errors| errors.wrong() > 0)
        };
        let off = count(&is_off);
        let defects = count(&|cell| cell.overall().0 == Outcome::Wrong);
        let (all, without) =
            (count(&|_| true), count(&|cell| !cell.overall().0.is_good()) - defects);
        let twins = self.parts.iter().map(|part| part.coverage.twins).sum::<usize>();
        let twins = if twins > 0 { format!(" ({twins} of twins)") } else { String::new() };
        let mut right = match defects {
            0 => {
                format!(
                    "<strong>No detector was wrong</strong>: {good} of {}{twins} ended well, \
                     every answer checked.",
                    plural(all, "cell")
                )
            }
            _ => {
                let wrong = own()
                    .filter(|cell| cell.overall().0 == Outcome::Wrong)
                    .map(|cell| cell.id.detector.as_str());
                let names: BTreeSet<&str> = wrong.collect();
                let names = escape(&names.into_iter().collect::<Vec<_>>().join(", "));
                format!(
                    "<strong>Wrong in {} of {all}</strong>: {names}. Such times are compared with \
                     nothing.",
                    plural(defects, "cell")
                )
            }
        };
        if off > 0 {
            let rounded = own().filter(|cell| is_off(cell)).map(|cell| &*cell.id.arithmetic);
            let rounded = rounded.collect::<BTreeSet<_>>().into_iter().collect::<Vec<_>>();
            let _ = write!(
                right,
                " In {} rounding lost or added pairs, as {} may.",
                plural(off, "cell"),
                escape(&rounded.join(", "))
            );
        }
        if without > 0 {
            let _ = write!(right, " <a href=\"#outcomes\">Without an answer</a>: {without}.");
        }
        let verdicts: Vec<Verdict> =
            self.parts.iter().flat_map(|part| part.verdicts.clone()).collect();
        let count =
            |status: Status| verdicts.iter().filter(|verdict| verdict.status == status).count();
        let (fails, open) = (count(Status::Fails), count(Status::NotShown));
        let cut = count(Status::NotCovered);
        let mut claims = match verdicts.len() {
            0 => "No claims were checked.".to_string(),
            all => format!(
                "<a href=\"#claims\"><strong>{} of {} hold</strong></a>",
                count(Status::Holds),
                plural(all, "claim")
            ),
        };
        if fails > 0 {
            let ours = if claim::any_failed(&verdicts) { "" } else { ", of times on this machine" };
            let _ = write!(claims, "; {fails} {}{ours}", if fails == 1 { "fails" } else { "fail" });
        }
        if open > 0 {
            let _ = write!(claims, "; {open} could not be shown");
        }
        if cut > 0 {
            let _ = write!(claims, "; {cut} not covered");
        }
        let class = match fails {
            _ if claim::any_failed(&verdicts) => "bad",
            0 => "good",
            _ => "open",
        };
        let card = |class: &str, head: &str, body: &str| {
            format!("<div class=\"card {class}\"><h3>{head}</h3><p>{body}</p></div>\n")
        };
        let answer = match self.parts {
            [part] if part.asks_fastest => document::inline_html(&part.sentence()),
            [part] => part.brief().map_or(String::new(), |text| document::inline_html(&text)),
            parts => {
                let brief = |part: &Part| {
                    let said = document::inline_html(&part.brief()?);
                    Some(format!("{}: {said}", escape(&part.experiment.name)))
                };
                parts.iter().filter_map(brief).collect::<Vec<_>>().join("; ") + "."
            }
        };
        card("speed", "Answer", &answer)
            + &card(if defects > 0 { "bad" } else { "good" }, "Right", &right)
            + &card(class, "Claims", &claims)
    }

    /// Question and answer of every experiment.
    fn answers(&self, detectors: &[&str]) -> String {
        let mut out = String::from("<ul class=\"who\" aria-label=\"Marks of the detectors\">");
        for (k, name) in
            detectors.iter().enumerate().filter(|(_, name)| !self.styles.get(name).control)
        {
            let _ = write!(
                out,
                "<li>{}{}</li>",
                marks::chip(k, self.styles.get(name).marker),
                escape(name)
            );
        }
        out += "</ul>\n";
        for part in self.parts {
            let _ = write!(out, "<article>\n<h3>{}</h3>\n", escape(&part.experiment.question));
            out += &document::html(&sections::answer::blocks(&part.verdicts, true));
            let asked = part.asks_fastest && !part.winners.contests.is_empty();
            // Of a single experiment the card has said it.
            if self.parts.len() > 1 && asked {
                let sentence = document::inline_html(&part.sentence());
                let _ = writeln!(out, "<p class=\"lead\">{sentence}</p>");
            }
            if let Some(headline) = part.headline.as_ref().filter(|headline| !headline.answers) {
                let _ = writeln!(out, "<p>{}</p>", document::inline_html(&headline.text));
            }
            if asked && sections::winners::compared(&part.winners) {
                let marks = answer::Marks { detectors, styles: self.styles };
                out += &document::html(Vec::from_iter(left_out(&part.winners)).as_slice());
                out += &answer::table(&part.winners, &marks);
            }
            if let Some(matrix) = &part.matrix {
                let blocks = document::html(&sections::verdicts::blocks(matrix));
                out += &details(
                    "Who is right, case by case",
                    &blocks,
                    part.winners.contests.is_empty(),
                );
            }
            out += "</article>\n";
        }
        out
    }

    fn claims(&self) -> String {
        let mut out = String::new();
        for part in self.parts.iter().filter(|part| !part.verdicts.is_empty()) {
            let _ = write!(
                out,
                "<h3>{}</h3>\n<div class=\"scroll\" tabindex=\"0\"><table \
                 class=\"claims\"><thead><tr>",
                escape(&part.experiment.title)
            );
            out += "<th>claim</th><th>verdict</th><th>evidence</th></tr></thead><tbody>\n";
            for verdict in &part.verdicts {
                let (class, sign) = match verdict.status {
                    Status::Holds => ("good", "✓"),
                    Status::Fails => ("bad", "✗"),
                    Status::NotCovered | Status::NotShown => ("open", "–"),
                };
                let source = if verdict.source.is_empty() {
                    String::new()
                } else {
                    format!("<br><small>{}</small>", escape(&verdict.source))
                };
                let _ = writeln!(
                    out,
                    "<tr><td>{}{source}</td><td class=\"verdict {class}\">{sign} \
                     {}</td><td><small>{}</small></td></tr>",
                    escape(&verdict.claim),
                    verdict.status.name(),
                    escape(&sections::claims::evidence(&verdict.evidence))
                );
            }
            out += "</tbody></table></div>\n";
        }
        if out.is_empty() { "<p>No claims were checked.</p>".into() } else { out }
    }

    /// The maps, if there are any.
    fn maps(&self) -> Option<String> {
        let maps: Vec<&Drawn> = self.parts.iter().flat_map(|part| &part.maps).collect();
        (!maps.is_empty()).then(|| map::section(&maps, self.styles))
    }

    /// The figures, and links to their files.
    fn figures(&self) -> String {
        let (mut out, mut room) = (String::new(), FIGURE_BYTES);
        for (title, path) in self.parts.iter().flat_map(|part| &part.figures) {
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

    fn outcomes(&self) -> String {
        let found = self.parts.iter().map(|part| failures(&part.cells));
        let tables = found.filter(|found| !found.is_empty());
        let tables = tables.map(|found| sections::failures::table(&found));
        match &*tables.collect::<Vec<_>>() {
            [] => "<p>Every cell has a right answer.</p>".into(),
            blocks => document::html(blocks),
        }
    }

    fn tables(&self) -> String {
        let part = |part: &Part| {
            let reading = format!(
                "<p><em>How to read the figures:</em> {}</p>",
                escape(&part.experiment.reading)
            );
            details(
                &escape(&part.experiment.title),
                &(reading + &document::html(&part.tables)),
                false,
            )
        };
        self.parts.iter().map(part).collect()
    }
}

fn details(head: &str, body: &str, open: bool) -> String {
    format!(
        "<details{}><summary>{head}</summary>\n{body}</details>\n",
        if open { " open" } else { "" }
    )
}

/// The page of a folder: its name beside `report.md`.
pub fn path(folder: &Path) -> PathBuf {
    folder.join("report.html")
}
