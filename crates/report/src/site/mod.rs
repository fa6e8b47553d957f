//! A site of many records: a front page with the answer, a table of all measurements, and a page
//! for each record, detector and library. The pages need no server, no network and no other site.
//! Only sorting and filtering need JavaScript.

mod field;

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use anyhow::Context;

use crate::document::{self, Block, Text};
use crate::figure::style::{Styles, ranked};
use crate::page::answer::{self, Marks};
use crate::page::{self, marks};
use crate::report::{Facts, Part};
use crate::sections;
use crate::table::{Cell as Entry, Table};
use contactbench_record::cells::{Cell, cells};
use contactbench_record::experiment::Experiment;
use contactbench_record::findings::winners::Contest;
use contactbench_record::record::row::Row;
use contactbench_terms::number::number;
use contactbench_terms::text;
use contactbench_terms::text::html as escape;
use field::Line;

const TEMPLATE: &str = include_str!("../../assets/site/page.html");
const STYLE: &str = include_str!("../../assets/report/style.css");
const OWN_STYLE: &str = include_str!("../../assets/site/style.css");
const SCRIPT: &str = include_str!("../../assets/site/field.js");

/// A record as it was read from its folder.
pub struct Given {
    /// Path relative to the folder of all records, such as `reference/scale`.
    pub name: String,
    pub folder: PathBuf,
    pub experiments: Vec<Experiment>,
    pub rows: Vec<Row>,
}

/// A detector or library, apart from its measurements.
pub struct About {
    pub summary: String,
    /// Whether it belongs to this project.
    pub ours: bool,
}

pub(crate) struct Record<'a> {
    pub name: &'a str,
    pub facts: Facts<'a>,
    pub rows: &'a [Row],
    /// Day of the run, as YYYY-MM-DD.
    pub day: String,
    /// Day and time of the run.
    date: String,
    /// Name of the processor.
    pub cpu: String,
    /// The processor, and how many the machine has.
    machine: String,
    /// First seven digits of the commit of the program.
    pub revision: String,
    /// Whether a later record is of another program.
    pub older: bool,
    detectors: Vec<String>,
}

/// Returns the name of a page: `reference/scale` becomes `reference.scale`. Two names never share a
/// page, because other bytes become `_` and their value.
fn stem(name: &str) -> String {
    let escaped = |byte: u8| match byte {
        b'/' => ".".into(),
        byte if byte.is_ascii_alphanumeric() || byte == b'-' => char::from(byte).to_string(),
        byte => format!("_{byte:02x}"),
    };
    name.bytes().map(escaped).collect()
}

/// Writes the site into an empty or missing folder, and returns its pages and notes on what was
/// left out. `today` is a day as YYYY-MM-DD.
///
/// # Errors
/// A page that cannot be written.
pub fn write(
    out: &Path,
    given: &[Given],
    today: &str,
    about: &dyn Fn(&str) -> Option<About>,
) -> anyhow::Result<(Vec<PathBuf>, Vec<String>)> {
    let all: Vec<Vec<Cell>> = given.iter().map(|it| cells(&it.rows)).collect();
    let mut records = Vec::new();
    for (given, cells) in given.iter().zip(&all) {
        let mut record = Record::new(given, cells);
        record.facts.draw(&out.join("figures").join(stem(&given.name)), 1);
        records.push(record);
    }
    // A contributed record does not make others old, nor does a doubtful one beside sound ones.
    let own = records.iter().filter(|record| !record.name.starts_with("contributed/"));
    let latest = own.max_by_key(|record| (record.sound(), &record.date));
    if let Some((date, revision)) = latest.map(|it| (it.date.clone(), it.revision.clone())) {
        for record in &mut records {
            record.older = record.revision != revision && record.date < date;
        }
    }
    let lines = field::lines(&records, today, about);
    let site = Site { records: &records, lines: &lines, about };
    let pages = site.pages();
    for (path, page) in &pages {
        let path = out.join(path);
        let write = || {
            std::fs::create_dir_all(path.parent().unwrap_or(out))?;
            std::fs::write(&path, page)
        };
        write().with_context(|| format!("cannot write the page {}", path.display()))?;
    }
    let notes = records.iter().flat_map(|record| record.facts.warnings.iter().cloned());
    Ok((pages.into_iter().map(|page| page.0).collect(), notes.collect()))
}

impl<'a> Record<'a> {
    fn new(given: &'a Given, cells: &'a [Cell]) -> Record<'a> {
        let styles = Styles::new(cells.iter());
        let facts = Facts::new(&given.folder, &given.experiments, cells, &given.rows, styles);
        let fields = facts.origin.provenance.as_ref();
        let text = |name: &str| {
            let value = fields.and_then(|fields| fields.get(name)?.as_str());
            value.unwrap_or_default().to_string()
        };
        let cores = fields.and_then(|fields| fields.get("cores")?.as_u64());
        let cores = cores.map_or(String::new(), |cores| format!(", {cores} processors"));
        Record {
            name: &given.name,
            rows: &given.rows,
            day: escape(&text("date_utc").chars().take(10).collect::<String>()),
            date: text("date_utc"),
            machine: text("cpu") + &cores,
            cpu: text("cpu"),
            revision: text("revision").chars().take(7).collect(),
            older: false,
            detectors: ranked(cells.iter(), |cell| cell.id.subject()),
            facts,
        }
    }

    /// Returns whether the record is whole and its times are not doubtful.
    fn sound(&self) -> bool {
        self.facts.alerts.is_empty()
    }

    fn page(&self) -> String {
        format!("records/{}.html", stem(self.name))
    }

    fn detectors(&self) -> Vec<&str> {
        self.detectors.iter().map(String::as_str).collect()
    }

    /// Returns the table of the fastest detectors.
    fn winners(&self, part: &Part<'_>) -> String {
        let (detectors, styles) = (&self.detectors()[..], &self.facts.styles);
        answer::table(&part.winners, &Marks { detectors, styles })
    }

    /// Returns the answers of the experiments in a few words.
    fn brief(&self) -> String {
        let brief = |part: &Part<'_>| part.brief().map(|text| document::inline_html(&text));
        self.facts.parts.iter().filter_map(brief).collect::<Vec<_>>().join("; ")
    }
}

struct Site<'a> {
    records: &'a [Record<'a>],
    lines: &'a [Line<'a>],
    about: &'a dyn Fn(&str) -> Option<About>,
}

impl Site<'_> {
    /// Returns each page with its path.
    fn pages(&self) -> Vec<(PathBuf, String)> {
        let names: BTreeSet<&str> = self.lines.iter().map(|line| line.detector()).collect();
        let field = long(&field::table(self.lines), "field", self.lines);
        let note = "One row for each detector, scene and machine that was timed. Rows with (old) \
                    after their date are grey: they are older than 90 days, or a later \
                    record is of another program.";
        let script = format!("<script>\n{SCRIPT}</script>\n");
        let field = format!(
            "<p class=\"note\">{note}</p>\n<div id=\"filters\" class=\"controls\"></div>\n<p \
             id=\"count\" role=\"status\"></p>\n{field}{script}"
        );
        let style = STYLE.to_string() + OWN_STYLE;
        let mut pages = vec![
            ("style.css".into(), style),
            ("index.html".into(), self.page("", FRONT, &self.front(&names), None)),
            ("field.html".into(), self.page("", "All measurements", &field, None)),
        ];
        pages.extend(self.records.iter().map(|record| {
            let (path, title) = (record.page(), record.facts.title());
            (path.into(), self.page("../", title, &self.record(record), Some(record)))
        }));
        pages.extend(names.iter().map(|name| {
            let path = format!("detectors/{}.html", stem(name));
            (path.into(), self.page("../", name, &self.detector(name), None))
        }));
        pages
    }

    /// `of` has the colours of its detectors in the page.
    fn page(&self, root: &str, title: &str, main: &str, of: Option<&Record<'_>>) -> String {
        // HTML needs no end tags of cells and rows.
        let main = main.replace("</td>", "").replace("</tr>", "");
        let colours = of.map_or(String::new(), |record| {
            format!("<style>{}</style>\n", marks::css(&record.detectors(), &record.facts.styles))
        });
        let values =
            [("title", escape(title)), ("root", root.into()), ("colours", colours), ("main", main)];
        text::fill(TEMPLATE, &values)
    }

    /// Returns the scene with the shortest description of those with five libraries. Without such a
    /// scene, it is the one with most libraries. If several match, it is the last.
    fn best(&self) -> Option<(&Record<'_>, &Part<'_>, &Contest)> {
        let library = |name: &&str| !(self.about)(name).is_some_and(|about| about.ours);
        let libraries = |it: &Contest| {
            let names = it.others.iter().map(|it| &*it.name);
            names.chain(it.without.iter().map(|it| &*it.0)).filter(library).count()
        };
        let parts = self
            .records
            .iter()
            .flat_map(|record| record.facts.parts.iter().map(move |part| (record, part)));
        parts
            .filter(|(_, part)| part.asks_fastest)
            .flat_map(|(record, part)| {
                part.winners.contests.iter().map(move |contest| (record, part, contest))
            })
            .max_by_key(|(record, _, contest)| {
                let parts = contest.title.split(',').count();
                (record.sound(), !record.older, libraries(contest).min(5), Reverse(parts))
            })
    }

    fn front(&self, names: &BTreeSet<&str>) -> String {
        let mut out = String::from(
            "<p class=\"lead\">Particle simulations spend much of their time on one question. \
             Every detector here read the same particles and was timed in turns with the others; \
             every answer was compared with the exact truth.</p>\n",
        );
        if let Some((record, part, contest)) = self.best() {
            let sentence = document::inline_html(&part.sentence());
            out += &format!(
                "<div class=\"card speed\"><p>{sentence}</p></div>\n{}<p class=\"note\">{}, {}. <a \
                 href=\"{}\">All scenes of this record</a></p>\n",
                bars(contest),
                escape(&record.machine),
                record.day,
                record.page()
            );
        }
        out += "<h2>Questions</h2>\n";
        let question = |record: &Record<'_>| {
            let first = record.facts.parts.first();
            first.map_or(record.facts.title(), |part| &*part.experiment.question).to_string()
        };
        let rows = self.records.iter();
        let table: Table = Table::of("", rows)
            .left("question", |it| Entry::Link(question(it), it.page()))
            .left("answer", |_| "")
            .left("machine", |it| &*it.machine)
            .left("day", |it| &*it.day)
            .into();
        out += &table.html_with("", &|row, column| match (row, column) {
            (Some(row), 1) => self.records[row].brief(),
            _ => String::new(),
        });
        let (ours, others): (Vec<&str>, Vec<&str>) =
            names.iter().partition(|name| (self.about)(name).is_some_and(|about| about.ours));
        for (title, names) in [("Detectors", ours), ("Libraries and codes", others)] {
            let link = |name: &&str| {
                format!("<a href=\"detectors/{}.html\">{}</a>", stem(name), escape(name))
            };
            let links: Vec<String> = names.iter().map(link).collect();
            out += &format!("<h2>{title}</h2>\n<p>{}</p>\n", links.join(", "));
        }
        out
    }

    fn record(&self, record: &Record<'_>) -> String {
        let facts = &record.facts;
        let warning = |text: &String| Block::Warning(text.as_str().into());
        let mut first: Vec<Block> = facts.wrong.iter().map(warning).collect();
        first.extend(facts.alerts.iter().cloned());
        let older = "Another program made later records here.";
        first.extend(record.older.then(|| Block::paragraph(older)));
        let made = Text::from(format!("{}, {}, program ", record.day, record.machine));
        first.push(Block::Paragraph(made.code(&*record.revision).plain(".")));
        let mut out = document::html(&first);
        for part in &facts.parts {
            let mut head = vec![Block::heading(2, &*part.experiment.question)];
            head.extend(sections::answer::blocks(&part.verdicts, true));
            out += &document::html(&head);
            if part.asks_fastest && sections::winners::compared(&part.winners) {
                out += &format!("<p>{}</p>\n", document::inline_html(&part.sentence()));
                out += &record.winners(part);
            }
            out += &figure(record, part, "../");
            out += &format!("<p class=\"note\">{}</p>\n", page::code(&part.experiment.reading));
        }
        out
    }

    fn detector(&self, name: &str) -> String {
        let lines: Vec<&Line<'_>> =
            self.lines.iter().filter(|line| line.detector() == name).collect();
        let about = (self.about)(name);
        let summary = about.map(|about| Block::paragraph(about.summary));
        let mut out = document::html(&Vec::from_iter(summary));
        out += &field::history(&lines).map_or(String::new(), |table| {
            "<h2>Counts that changed from program to program</h2>\n<p class=\"note\">Counts are \
             exact and do not depend on the machine.</p>\n"
                .to_string()
                + &table.html()
        });
        out += "<h2>Measurements</h2>\n<p class=\"note\"><a href=\"../field.html\">All \
                measurements</a> has those of older programs, too.</p>\n";
        let mut by_record: BTreeMap<&str, Vec<Line<'_>>> = BTreeMap::new();
        let any = lines.iter().any(|line| !line.grey);
        for line in lines.into_iter().filter(|line| !(any && line.grey)) {
            by_record.entry(line.record.name).or_default().push(line.clone());
        }
        for lines in by_record.values() {
            let record = lines[0].record;
            out += &format!(
                "<details><summary><a href=\"../{}\">{}</a>, {}</summary>\n{}</details>\n",
                record.page(),
                escape(record.facts.title()),
                record.day,
                long(&field::own(lines), "own", lines)
            );
        }
        out
    }
}

/// Draws the times of a scene as bars. A subject without a time has its outcome instead.
fn bars(contest: &Contest) -> String {
    let timed = || std::iter::once(&contest.first).chain(&contest.others);
    let longest = timed().map(|it| it.per_particle).fold(0.0, f64::max);
    let mut out = format!(
        "<table class=\"bars\"><caption>{}: time per particle, in nanoseconds</caption><tbody>\n",
        escape(&contest.title)
    );
    let mut row = |name: &str, share: f64, text: &str| {
        let name = escape(name);
        out += &format!(
            "<tr><th scope=\"row\">{name}</th><td><i style=\"width:{:.1}%\"></i>{text}</td></tr>\n",
            70.0 * share
        );
    };
    for it in timed() {
        let ratio = it.ratio.map_or(String::new(), |it| format!(", {} times", number(it.median)));
        row(&it.name, it.per_particle / longest, &(number(it.per_particle) + &ratio));
    }
    contest.without.iter().for_each(|(name, outcome)| row(name, 0.0, outcome.name()));
    out + "</tbody></table>\n"
}

/// Formats a long table, whose columns of numbers the style sheet knows.
fn long(table: &Table, class: &str, lines: &[Line<'_>]) -> String {
    table.html_with(class, &field::greyed(lines)).replace("<td class=\"number\">", "<td>")
}

const FRONT: &str = "Which particles touch?";

fn figure(record: &Record<'_>, part: &Part<'_>, root: &str) -> String {
    let Some((title, path)) = part.figures.first() else { return String::new() };
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let (title, name) = (escape(title), escape(&name));
    format!(
        "<figure><img alt=\"{title}\" loading=\"lazy\" src=\"{root}figures/{}/{name}\">\
         <figcaption>{title}</figcaption></figure>\n",
        stem(record.name)
    )
}
