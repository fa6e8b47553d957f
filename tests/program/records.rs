//! What is written about the committed records is what they say.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

use crate::committed::committed;

/// A page of one screen and a half.
const LONGEST: usize = 70;

/// The numbers with a decimal point in a text: measured ones, as all of them are printed.
fn measured(text: &str) -> BTreeSet<&str> {
    text.split(|c: char| !c.is_ascii_digit() && c != '.')
        .map(|word| word.trim_end_matches('.'))
        .filter(|word| word.contains('.') && word.parse::<f64>().is_ok())
        .collect()
}

/// Those that `page` has and the report of `folder` has not.
fn invented<'a>(page: &'a str, folder: &Path) -> Vec<&'a str> {
    let report = std::fs::read_to_string(folder.join("report.md")).unwrap();
    let known = measured(&report);
    measured(page).into_iter().filter(|number| !known.contains(number)).collect()
}

/// What stands between a heading of the second level and the next.
fn section<'a>(page: &'a str, heading: &str) -> &'a str {
    let start = format!("\n## {heading}\n");
    let rest = page.split_once(&start).unwrap_or_else(|| panic!("no section {heading}")).1;
    rest.split("\n## ").next().unwrap_or(rest)
}

#[test]
fn every_record_has_a_page_that_says_what_its_report_says() {
    for folder in committed() {
        let page = std::fs::read_to_string(folder.join("README.md"))
            .unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
        for heading in ["Question", "Setting", "Limits"] {
            assert!(!section(&page, heading).trim().is_empty(), "{}: {heading}", folder.display());
        }
        let result = section(&page, "Result");
        assert!(!measured(result).is_empty(), "{}: a result has numbers", folder.display());
        assert_eq!(invented(result, &folder), [""; 0], "{}", folder.display());
        assert!(page.lines().count() <= LONGEST, "{}: more than a page", folder.display());
    }
}

#[test]
fn what_the_pages_quote_is_in_the_records() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let libraries = include_str!("../../docs/LIBRARIES.md");
    let peers = root.join("results/reference-peers");
    assert_eq!(invented(section(libraries, "Results so far"), &peers), [""; 0]);
    let readme = include_str!("../../README.md");
    let result = readme.split_once("**One result:**").unwrap().1.split_once("\n\n").unwrap().0;
    let of = |name: &str| invented(result, &root.join("results").join(name));
    let (amd, intel) = (of("reference-vectors"), of("reference-vectors-intel"));
    // On which of the two processors each number was measured stands beside it.
    assert_eq!(amd.iter().filter(|number| intel.contains(number)).count(), 0, "{amd:?} {intel:?}");
    assert!(amd.len() < measured(result).len() && intel.len() < measured(result).len());
}

/// Detectors of a record whose code has changed since it was made, comments aside; none if the
/// history of commits is not there.
fn changed_since(folder: &Path) -> Option<BTreeSet<String>> {
    let provenance = std::fs::read_to_string(folder.join("provenance.json")).ok()?;
    let revision = provenance.split_once("\"revision\": \"")?.1.get(..40)?;
    let git = |arguments: &[&str]| {
        let root = env!("CARGO_MANIFEST_DIR");
        let output = Command::new("git").args(["-C", root]).args(arguments).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
    };
    let is_code = |line: &str| {
        let code = line.get(1..).unwrap_or_default().trim();
        let changed = line.starts_with(['+', '-']) && !line.starts_with("+++ ");
        changed && !line.starts_with("--- ") && !code.is_empty() && !code.starts_with("//")
    };
    git(&["cat-file", "-e", revision])?;
    let mut changed = BTreeSet::new();
    for name in detectors(folder) {
        let stem = if name == "streamed-nbs" { "streamed".into() } else { name.replace('-', "_") };
        let path = format!("core/src/detect/*{stem}*");
        if git(&["diff", revision, "--", &path])?.lines().any(is_code) {
            changed.insert(name);
        }
    }
    Some(changed)
}

/// The names of the detectors in a record, alone or in trackers.
fn detectors(folder: &Path) -> BTreeSet<String> {
    let mut table = csv::Reader::from_path(folder.join("summary.csv")).unwrap();
    let head = table.headers().unwrap().clone();
    let columns: Vec<usize> = ["detector", "over"]
        .iter()
        .filter_map(|name| head.iter().position(|column| column == *name))
        .collect();
    let records = table.records().map(Result::unwrap);
    let name = |cell: &str| cell.split(['(', ':']).next().unwrap_or_default().to_string();
    records.flat_map(|row| columns.iter().map(|&k| name(&row[k])).collect::<Vec<_>>()).collect()
}

/// The write-up of a record names the program that made it and the detectors that have changed
/// since, and a page that links to such a record names the program, too.
#[test]
fn records_of_an_older_program_say_so() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut pages = vec![root.join("README.md"), root.join("DESIGN.md"), root.join("BIAS.md")];
    let docs = std::fs::read_dir(root.join("docs")).unwrap().map(|entry| entry.unwrap().path());
    pages.extend(docs.filter(|path| path.extension().is_some_and(|ending| ending == "md")));
    let pages = pages.iter().map(|page| (page, std::fs::read_to_string(page).unwrap()));
    let pages: Vec<_> = pages.collect();
    for folder in committed() {
        if !folder.join("provenance.json").exists() {
            continue;
        }
        let Some(changed) = changed_since(&folder) else {
            return crate::common::untested("the age of records", "history of commits");
        };
        let page = std::fs::read_to_string(folder.join("README.md")).unwrap();
        let line = page.split("\n\n").find(|part| part.starts_with("Program of "));
        let line = line.unwrap_or_else(|| panic!("{}: no program", folder.display()));
        let missing: Vec<&String> =
            changed.iter().filter(|name| !line.contains(&format!("`{name}`"))).collect();
        assert!(missing.is_empty(), "{}: changed since: {missing:?}", folder.display());
        let program = line.split_once(" (").unwrap().0.replacen('P', "p", 1);
        let link = format!("results/{}/", folder.file_name().unwrap().to_string_lossy());
        let quotes = pages.iter().flat_map(|(page, text)| {
            text.split("\n\n")
                .filter(|part| part.contains(&link) && !part.starts_with("!["))
                .map(move |part| (page, part))
        });
        for (page, part) in quotes.filter(|_| !changed.is_empty()) {
            let said = part.replace('\n', " ");
            assert!(said.contains(&program), "{}: no '{program}' at {link}", page.display());
        }
    }
}

#[test]
fn a_number_of_ones_own_is_found() {
    let folder = &committed()[0];
    assert_eq!(invented("1.00 and 123456.789 times, at v1.2.3 of 12", folder), ["123456.789"]);
}
