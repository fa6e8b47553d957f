//! The write-ups about the committed records agree with these records.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::committed::committed;
use crate::common::Place;

/// Maximum number of lines in a write-up.
const LONGEST: usize = 70;

fn read(path: impl AsRef<Path>) -> String {
    let path = path.as_ref();
    std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn name(record: &Path) -> String {
    record.strip_prefix(root().join("results")).unwrap().display().to_string()
}

/// Returns the folder with the README.md about this record: its own folder or the one above.
fn write_up(record: &Path) -> &Path {
    if record.join("README.md").exists() { record } else { record.parent().unwrap() }
}

/// Returns the numbers with a decimal point in a text, which are the measured ones.
fn measured(text: &str) -> BTreeSet<&str> {
    text.split(|c: char| !c.is_ascii_digit() && c != '.')
        .map(|word| word.trim_end_matches('.'))
        .filter(|word| word.contains('.') && word.parse::<f64>().is_ok())
        .collect()
}

/// Returns the numbers of `page` that are not in the reports of these records.
fn invented<'a>(page: &'a str, records: &[PathBuf]) -> Vec<&'a str> {
    let reports: String = records.iter().map(|folder| read(folder.join("report.md"))).collect();
    let known = measured(&reports);
    measured(page).into_iter().filter(|number| !known.contains(number)).collect()
}

/// Returns the text between a heading of the second level and the next.
fn section<'a>(page: &'a str, heading: &str) -> &'a str {
    let start = format!("\n## {heading}\n");
    let rest = page.split_once(&start).unwrap_or_else(|| panic!("no section {heading}")).1;
    rest.split("\n## ").next().unwrap_or(rest)
}

/// Returns a field of the provenance as text; `None` if the record has no provenance.
fn provenance(record: &Path, field: &str) -> Option<String> {
    let text = std::fs::read_to_string(record.join("provenance.json")).ok()?;
    let fields: Value = serde_json::from_str(&text).unwrap();
    Some(fields[field].as_str().map_or_else(|| fields[field].to_string(), String::from))
}

/// Returns the date and revision of the program that made a record, as pages write them: `25
/// November 2026 (50b98b6)`.
fn program(record: &Path) -> Option<(String, String)> {
    const MONTHS: &str = "January February March April May June July August September October \
                          November December";
    let revision = provenance(record, "revision")?;
    let date = git(&["show", "-s", "--format=%cs", &revision])?;
    let mut parts = date.trim().split('-').map(|part| part.parse::<usize>().unwrap());
    let [year, month, day] = [(); 3].map(|()| parts.next().unwrap());
    let month = MONTHS.split(' ').nth(month - 1).unwrap();
    Some((format!("{day} {month} {year}"), revision[..7].into()))
}

fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").arg("-C").arg(root()).args(arguments).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}

fn pages() -> Vec<(PathBuf, String)> {
    let mut pages = ["README.md", "DESIGN.md"].map(|page| root().join(page)).to_vec();
    let docs = std::fs::read_dir(root().join("docs")).unwrap().map(|entry| entry.unwrap().path());
    pages.extend(docs.filter(|path| path.extension().is_some_and(|ending| ending == "md")));
    pages.into_iter().map(|page| (page.clone(), read(page))).collect()
}

/// Returns the paragraphs of a page that link to a record or to its write-up.
fn quotes<'a>(text: &'a str, record: &Path) -> impl Iterator<Item = &'a str> {
    let links = [
        format!("results/{}/", name(record)),
        format!("results/{}/README", name(write_up(record))),
    ];
    let linked = move |part: &&str| links.iter().any(|link| part.contains(link));
    text.split("\n\n").filter(|part| !part.starts_with("![")).filter(linked)
}

#[test]
fn every_record_has_a_page_that_says_what_its_reports_say() {
    let records = committed();
    let pages: BTreeSet<&Path> = records.iter().map(|record| write_up(record)).collect();
    for folder in pages {
        let own: Vec<PathBuf> =
            records.iter().filter(|it| it.starts_with(folder)).cloned().collect();
        let (page, place) = (read(folder.join("README.md")), folder.display());
        for heading in ["Question", "Limits"] {
            assert!(!section(&page, heading).trim().is_empty(), "{place}: {heading}");
        }
        let result = section(&page, "Result");
        assert!(!measured(result).is_empty(), "{place}: a result has numbers");
        assert_eq!(invented(result, &own), [""; 0], "{place}");
        assert!(page.lines().count() <= LONGEST, "{place}: more than a page");
    }
    assert_eq!(invented("1.00 and 123456.789 times, at v1.2.3", &records[..1]), ["123456.789"]);
}

#[test]
fn the_result_of_readme_is_in_the_records() {
    let readme = include_str!("../../../README.md");
    let records =
        ["reference-peers", "reference/scale"].map(|name| root().join("results").join(name));
    assert_eq!(invented(section(readme, "One result"), &records), [""; 0]);
}

/// A write-up names the program that made each record.
#[test]
fn write_ups_name_the_program() {
    for record in committed() {
        let Some((date, short)) = program(&record) else { continue };
        let folder = write_up(&record);
        let page = read(folder.join("README.md"));
        let report = record.join("report.md");
        let link = format!("({})", report.strip_prefix(folder).unwrap().display());
        let made = format!("{date} ({short})");
        let named = page.lines().any(|line| line.contains(&link) && line.contains(&made));
        assert!(named, "{}: no line with {link} and {made}", record.display());
    }
}

/// results/README.md has a correct line for each record. Pages quote only records without doubts
/// about their times, made from committed sources.
#[test]
fn the_index_names_every_record() {
    let index = read(root().join("results/README.md"));
    let rows: Vec<Vec<&str>> = index
        .lines()
        .filter(|line| line.starts_with("| ["))
        .map(|line| line.trim_matches('|').split('|').map(str::trim).collect())
        .collect();
    let link = |row: &[&str]| row[0].split_once("](").unwrap().1.trim_end_matches(')').to_string();
    let listed: BTreeSet<String> = rows.iter().map(|row| link(row)).collect();
    let expected: BTreeSet<String> =
        committed().into_iter().map(|record| name(&record) + "/report.md").collect();
    assert_eq!(listed, expected);
    let pages = pages();
    for row in rows {
        let [_, question, answer, made, day, machine, trust] = row[..] else { panic!("{row:?}") };
        let record = root().join("results").join(link(&row).strip_suffix("/report.md").unwrap());
        assert!(![question, answer, made, day, machine].contains(&""), "{row:?}");
        let Some(revision) = provenance(&record, "revision") else { continue };
        assert_eq!(made, &revision[..7], "{row:?}");
        assert_eq!(day, &provenance(&record, "date_utc").unwrap()[..10], "{row:?}");
        let report = read(record.join("report.md"));
        // A record of counts alone has no times to doubt.
        let timed = report.contains(" s of timing");
        let sealed = provenance(&record, "record_schema").is_some_and(|it| &*it >= "4");
        let words = [
            ("clean", provenance(&record, "dirty").is_some_and(|it| it == "false")),
            ("idle", timed && !report.contains("do not quote the times")),
            ("sealed", sealed),
            ("twins", report.contains("measured again as a second subject")),
        ];
        let words: Vec<&str> = words.iter().filter(|(_, is)| *is).map(|(word, _)| *word).collect();
        assert_eq!(trust, words.join(", "), "{row:?}");
        if pages.iter().any(|(_, text)| quotes(text, &record).next().is_some()) {
            assert!(trust.starts_with(if timed { "clean, idle" } else { "clean" }), "{row:?}");
            let ancestor = ["merge-base", "--is-ancestor", &revision, "HEAD"];
            let shallow = git(&["rev-parse", "--is-shallow-repository"]);
            assert!(shallow.is_none_or(|it| it.trim() == "true") || git(&ancestor).is_some());
        }
    }
}

/// All verbs read a compressed record, and none appends to it.
#[test]
fn verbs_read_compressed_records() {
    let record = &root().join("results/reference/vectors-intel");
    let at = Place::new();
    let copy = Command::new("cp").arg("-r").args([record, at.root()]).status().unwrap();
    assert!(copy.success());
    at.remove("vectors-intel/report.md");
    at.good("report vectors-intel");
    assert!(at.read("vectors-intel/report.md") == read(record.join("report.md")));
    at.good("compare vectors-intel vectors-intel");
    at.good("merge vectors-intel --out whole");
    assert!(at.read("whole/samples.jsonl").lines().count() > 100);
    let words = ["vectors-intel/samples.jsonl.gz", "gunzip"];
    at.ends(2, "run vectors --resume --out vectors-intel", &words);
    at.ends(2, "merge whole --out vectors-intel", &["--out"]);
}
