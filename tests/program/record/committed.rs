//! The write-ups about the committed records agree with these records.

use std::collections::BTreeSet;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::committed::committed;
use crate::common::{Place, untested};

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
        for heading in ["Question", "Setting", "Limits"] {
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
fn what_the_pages_quote_is_in_the_records() {
    let results = root().join("results");
    let libraries = include_str!("../../../docs/LIBRARIES.md");
    let peers = [results.join("reference-peers")];
    assert_eq!(invented(section(libraries, "Results so far"), &peers), [""; 0]);
    let readme = include_str!("../../../README.md");
    let result = readme.split_once("**One result:**").unwrap().1.split_once("\n\n").unwrap().0;
    let of = |name: &str| invented(result, &[results.join("reference").join(name)]);
    let (amd, intel) = (of("vectors-amd"), of("vectors-intel"));
    // No measured number is in the records of both processors.
    assert_eq!(amd.iter().filter(|number| intel.contains(number)).count(), 0, "{amd:?} {intel:?}");
    assert!(amd.len() < measured(result).len() && intel.len() < measured(result).len());
}

/// Returns the names of the detectors in a record, including those inside trackers.
fn detectors(record: &Path) -> BTreeSet<String> {
    let summary = record.join("summary.csv");
    let text = if summary.exists() {
        read(summary)
    } else {
        let packed = std::fs::File::open(record.join("summary.csv.gz")).unwrap();
        let mut text = String::new();
        flate2::read::GzDecoder::new(packed).read_to_string(&mut text).unwrap();
        text
    };
    let mut table = csv::Reader::from_reader(text.as_bytes());
    let head = table.headers().unwrap().clone();
    let columns: Vec<usize> = ["detector", "over"]
        .iter()
        .filter_map(|name| head.iter().position(|column| column == *name))
        .collect();
    let records = table.records().map(Result::unwrap);
    let name = |cell: &str| cell.split(['(', ':']).next().unwrap_or_default().to_string();
    records.flat_map(|row| columns.iter().map(|&k| name(&row[k])).collect::<Vec<_>>()).collect()
}

/// Returns the detectors of a record whose code, without comments and tests, has changed since
/// `revision`; `None` if the history of commits is missing.
fn changed_since(record: &Path, revision: &str) -> Option<BTreeSet<String>> {
    let is_code = |line: &str| {
        let code = line.get(1..).unwrap_or_default().trim();
        let changed = line.starts_with(['+', '-']) && !line.starts_with("+++ ");
        let is_test = ["#[cfg(test)]", "mod tests;"].contains(&code);
        changed
            && !line.starts_with("--- ")
            && !(code.is_empty() || code.starts_with("//") || is_test)
    };
    git(&["cat-file", "-e", revision])?;
    let mut changed = BTreeSet::new();
    for name in detectors(record) {
        let stem = if name == "streamed-nbs" { "streamed".into() } else { name.replace('-', "_") };
        // The file of the detector may have been moved since that revision.
        let path = format!("*core/src/detect/*{stem}*");
        // A library may have the name of a detector.
        let others = if name == "kd-tree" { ":!*/peers/*" } else { ":!*tests*" };
        if git(&["diff", "-M", revision, "--", &path, ":!*tests*", others])?.lines().any(is_code) {
            changed.insert(name);
        }
    }
    Some(changed)
}

/// A write-up names the program that made each record, and the detectors that have changed since.
/// Pages that link to such a record name the program, too.
#[test]
fn records_of_an_older_program_say_so() {
    let pages = pages();
    for record in committed() {
        let Some(revision) = provenance(&record, "revision") else { continue };
        let (Some((date, short)), Some(changed)) =
            (program(&record), changed_since(&record, &revision))
        else {
            return untested("the age of records", "history of commits");
        };
        let (folder, place) = (write_up(&record), record.display());
        let page = read(folder.join("README.md"));
        let report = record.join("report.md");
        let link = format!("({})", report.strip_prefix(folder).unwrap().display());
        let made = format!("{date} ({short})");
        let line = page.lines().find(|line| line.contains(&link) && line.contains(&made));
        let line = line.unwrap_or_else(|| panic!("{place}: no line with {link} and {made}"));
        let missing: Vec<&String> =
            changed.iter().filter(|name| !line.contains(&format!("`{name}`"))).collect();
        assert!(missing.is_empty(), "{place}: changed since: {missing:?}");
        for (page, text) in pages.iter().filter(|_| !changed.is_empty()) {
            for part in quotes(text, &record) {
                let said = part.replace('\n', " ");
                let named = said.contains(&format!("program of {date}"))
                    || said.contains(&format!("that of {date}"));
                assert!(named, "{}: no 'program of {date}' beside {place}", page.display());
            }
        }
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
