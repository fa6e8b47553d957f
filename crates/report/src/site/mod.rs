//! A site of many records: a front page with the answer, a table of all measurements, and a page
//! for each record, detector and library. The pages need no server, no network and no other site.
//! Only sorting, filtering and highlighting need JavaScript.

mod field;

use std::cmp::Reverse;
use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};

use anyhow::Context;

use crate::document::{self, Block};
use crate::facts::{Chapter, Facts};
use crate::figure::style::Styles;
use crate::table::{Cell as Entry, Table};
use crate::{page, sections};
use contactbench_record::cells::{Cell, cells};
use contactbench_record::experiment::Experiment;
use contactbench_record::findings::winners::Contest;
use contactbench_record::record::row::Row;
use contactbench_terms::number::{short, with_interval};
use contactbench_terms::text::{self, html as escape};
use field::Line;

const TEMPLATE: &str = include_str!("../../assets/site/page.html");
const STYLE: &str = include_str!("../../assets/site/style.css");
/// A file that only sites have. Without it, no folder is replaced.
pub const FILE: &str = "made-by-contactbench.txt";

const DATA: [&str; 7] = [
    "samples.jsonl",
    "samples.jsonl.gz",
    "summary.csv",
    "summary.csv.gz",
    "experiments",
    "provenance.json",
    "report.md",
];

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
    folder: &'a Path,
    pub facts: Facts<'a>,
    pub rows: &'a [Row],
    /// Day and time of the run.
    date: String,
    /// Day of the run, as YYYY-MM-DD.
    pub day: String,
    /// Name of the processor.
    pub cpu: String,
    /// First seven digits of the commit of the program.
    pub revision: String,
    /// Whether a later record is of another program.
    pub older: bool,
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

/// Writes the site into a folder, and returns its pages and notes on what was left out. Pages of an
/// earlier site are removed. `address` is that of the folder of the records on the web.
///
/// # Errors
/// A page that cannot be written.
pub fn write(
    out: &Path,
    given: &[Given],
    address: Option<&str>,
    about: &dyn Fn(&str) -> Option<About>,
) -> anyhow::Result<(Vec<PathBuf>, Vec<String>)> {
    let all: Vec<Vec<Cell>> = given.iter().map(|it| cells(&it.rows)).collect();
    let earlier = std::fs::read_to_string(out.join(FILE)).unwrap_or_default();
    for page in earlier.lines().filter(|page| page.ends_with(".html")) {
        let inside = Path::new(page).components().all(|it| matches!(it, Component::Normal(_)));
        if inside {
            // A page that cannot be removed is written over.
            let _ = std::fs::remove_file(out.join(page));
        }
    }
    let figures = out.join(".figures");
    let mut records = Vec::new();
    for (given, cells) in given.iter().zip(&all) {
        let mut record = Record::new(given, cells);
        record.facts.draw(&figures.join(stem(&given.name)), 1);
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
    let lines = field::lines(&records, about);
    let pages = Site { records: &records, lines: &lines, address, about }.pages();
    for (path, page) in &pages {
        let path = out.join(path);
        let write = || {
            std::fs::create_dir_all(path.parent().unwrap_or(out))?;
            std::fs::write(&path, page)
        };
        write().with_context(|| format!("cannot write the page {}", path.display()))?;
    }
    // The pages contain the figures.
    let _ = std::fs::remove_dir_all(&figures);
    let notes = records.iter().flat_map(|record| record.facts.warnings.iter().cloned());
    Ok((pages.into_iter().map(|page| page.0).collect(), notes.collect()))
}

impl<'a> Record<'a> {
    fn new(given: &'a Given, cells: &'a [Cell]) -> Record<'a> {
        let styles = Styles::new(cells.iter());
        let facts = Facts::new(&given.folder, &given.experiments, cells, &given.rows, styles);
        let text = |name: &str, most: usize| -> String {
            let value = facts.origin.provenance.as_ref().and_then(|it| it.get(name)?.as_str());
            value.unwrap_or_default().chars().take(most).collect()
        };
        Record {
            name: &given.name,
            folder: &given.folder,
            rows: &given.rows,
            date: text("date_utc", 20),
            day: text("date_utc", 10),
            cpu: text("cpu", 100),
            revision: text("revision", 7),
            older: false,
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

    /// Returns the first question of the record.
    fn question(&self) -> &str {
        let first = self.facts.chapters.first();
        first.map_or(self.facts.title(), |chapter| &chapter.experiment.question)
    }

    /// Returns the page: for each experiment its question, answers and first figure.
    fn html(&self) -> String {
        let facts = &self.facts;
        let mut blocks = facts.head();
        let older =
            "This record is old: a later record was made by another version of this program.";
        blocks.extend(self.older.then(|| Block::paragraph(older)));
        blocks.push(Block::paragraph(format!("{}, {}", self.day, self.cpu)));
        for chapter in &facts.chapters {
            blocks.push(Block::heading(2, &*chapter.experiment.title));
            blocks.push(chapter.reading());
            blocks.extend(chapter.matrix.iter().flat_map(sections::claims::verdicts::blocks));
            blocks.extend(chapter.pictures());
        }
        page::legend(facts.cells, &facts.styles) + &document::html(&blocks)
    }

    /// Returns links to the files of the record below this address.
    fn data(&self, address: &str) -> String {
        let link = |file: &&str| {
            // The folder of all records may be a record itself.
            let name = if self.folder.ends_with(self.name) { self.name } else { "." };
            let to = [address.trim_end_matches('/'), name, file].join("/");
            format!("<a href=\"{}\">{file}</a>", escape(&to))
        };
        let files = DATA.iter().filter(|file| self.folder.join(file).exists());
        format!("<p>Raw data: {}</p>\n", Vec::from_iter(files.map(link)).join(", "))
    }
}

struct Site<'a> {
    records: &'a [Record<'a>],
    lines: &'a [Line<'a>],
    address: Option<&'a str>,
    about: &'a dyn Fn(&str) -> Option<About>,
}

impl Site<'_> {
    /// Returns each page with its path.
    fn pages(&self) -> Vec<(PathBuf, String)> {
        let names: BTreeSet<&str> = self.lines.iter().map(|line| line.detector()).collect();
        let note = "<p class=\"note\">One row for each detector, scene and machine that was timed. \
                    (old): a later record is from another version of the program. \
                    (disturbed): the record has a warning.</p>\n";
        let all: Vec<&Line<'_>> = self.lines.iter().collect();
        let field = note.to_string() + &field::table(&all, "").html("results");
        let mut pages = vec![
            ("style.css".into(), page::STYLE.to_string() + STYLE),
            ("index.html".into(), html("", "Which particles touch?", &self.front(&names))),
            ("field.html".into(), html("", "All measurements", &field)),
        ];
        pages.extend(self.records.iter().map(|record| {
            let page = record.html() + &self.address.map_or(String::new(), |it| record.data(it));
            (record.page().into(), html("../", record.facts.title(), &page))
        }));
        pages.extend(names.iter().map(|name| {
            let path = format!("detectors/{}.html", stem(name));
            (path.into(), html("../", name, &self.detector(name)))
        }));
        let written = pages.iter().map(|(path, _): &(PathBuf, _)| format!("{}\n", path.display()));
        let written: String = written.collect();
        pages.push((FILE.into(), format!("`contactbench site` replaces these files:\n{written}")));
        pages
    }

    /// Returns the scene with the shortest description of those with five libraries. Without such a
    /// scene, it is the one with most libraries. If several match, it is the last.
    fn best(&self) -> Option<(&Record<'_>, &Chapter<'_>, &Contest)> {
        let library = |name: &&str| !(self.about)(name).is_some_and(|about| about.ours);
        let libraries = |it: &Contest| {
            let names = it.others.iter().map(|it| &*it.name);
            names.chain(it.without.iter().map(|it| &*it.0)).filter(library).count()
        };
        let records = self.records.iter();
        let contests = records.flat_map(|record| {
            let chapters = record.facts.chapters.iter();
            let chapters = chapters.filter(|chapter| chapter.asks_fastest && record.sound());
            chapters.flat_map(move |chapter| {
                chapter.winners.contests.iter().map(move |contest| (record, chapter, contest))
            })
        });
        contests.max_by_key(|(record, _, contest)| {
            let parts = contest.title.split(',').count();
            (libraries(contest).min(5), !record.older, Reverse(parts))
        })
    }

    fn front(&self, names: &BTreeSet<&str>) -> String {
        let mut out = String::from(
            "<p class=\"lead\">Particle simulations spend much of their time on one question. \
             Every detector here read the same particles and was timed in turns with the others; \
             every answer was compared with the exact truth.</p>\n",
        );
        if let Some((record, chapter, contest)) = self.best() {
            let (cpu, day, page) = (escape(&record.cpu), escape(&record.day), record.page());
            let older = if record.older { ", by an older program" } else { "" };
            let sentence = document::html(&[Block::Paragraph(chapter.sentence())]);
            out += &format!(
                "{sentence}{}<p class=\"note\">{cpu}, {day}{older}. <a href=\"{page}\">All scenes of this \
                 record</a></p>\n",
                bars(contest, self.about),
            );
        }
        // Only claims that state an answer, and the winners of a race, answer a question.
        let answers = |record: &Record<'_>| -> Vec<String> {
            let first = |chapter: &Chapter<'_>| match chapter.is_a_race() {
                true => Some(Block::Paragraph(chapter.sentence())),
                false if chapter.verdicts.iter().all(|it| it.claim.answers.is_empty()) => None,
                false => chapter.answers(false).into_iter().next(),
            };
            let text = |block| document::plain(&[block], usize::MAX).trim_end().to_string();
            // The row has the question of the first chapter.
            record.facts.chapters.iter().take(1).filter_map(first).map(text).collect()
        };
        let table: Table = Table::of("", self.records)
            .left("question", |it| Entry::Link(it.question().into(), it.page()))
            .left("answer", answers)
            .left("machine", |it| &*it.cpu)
            .left("day", |it| &*it.day)
            .into();
        out += &format!("<h2>Questions</h2>\n{}", table.html(""));
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

    fn detector(&self, name: &str) -> String {
        let lines = self.lines.iter().filter(|line| line.detector() == name);
        let (old, mut lines): (Vec<_>, Vec<_>) = lines.partition(|line| line.old);
        if lines.is_empty() {
            lines = old;
        }
        let summary = (self.about)(name).map(|about| Block::paragraph(about.summary));
        let summary = document::html(&Vec::from_iter(summary));
        summary + &field::table(&lines, "../").html("results")
    }
}

/// Returns a page. `root` is the way to the front page.
fn html(root: &str, title: &str, main: &str) -> String {
    // HTML needs no end tags of cells and rows.
    let main = main.replace("</td>", "").replace("</tr>", "");
    let script = page::SCRIPT.to_string();
    let values =
        [("title", escape(title)), ("root", root.into()), ("main", main), ("script", script)];
    text::fill(TEMPLATE, &values)
}

/// Draws the times of a scene as bars. A subject without a time has its outcome instead.
fn bars(contest: &Contest, about: &dyn Fn(&str) -> Option<About>) -> String {
    let timed = || std::iter::once(&contest.first).chain(&contest.others);
    let longest = timed().map(|it| it.per_particle).fold(0.0, f64::max);
    let mut out = format!(
        "<table class=\"bars\"><caption>{}: time per particle, in nanoseconds, and the time over \
         that of the first; blue: ours</caption><tbody>\n",
        escape(&contest.title)
    );
    let mut row = |name: &str, detector: &str, share: f64, text: &str| {
        let ours = about(detector).is_some_and(|about| about.ours);
        let (name, class) = (escape(name), if ours { " class=\"ours\"" } else { "" });
        out += &format!(
            "<tr{class}><th scope=\"row\">{name}</th>\
             <td><i style=\"width:{:.1}%\"></i>{text}</td></tr>\n",
            70.0 * share
        );
    };
    for it in timed() {
        let ratio = it.ratio.as_ref().map(|it| format!(", {} times", with_interval(it)));
        let text = short(it.per_particle) + &ratio.unwrap_or_default();
        row(&it.name, &it.line.detector, it.per_particle / longest, &text);
    }
    contest.without.iter().for_each(|(name, outcome)| row(name, name, 0.0, outcome.name()));
    out + "</tbody></table>\n"
}
