//! What is written about the committed records is what they say.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// A page of one screen and a half.
const LONGEST: usize = 70;

fn results() -> Vec<PathBuf> {
    let results = Path::new(env!("CARGO_MANIFEST_DIR")).join("results");
    let committed = |folder: &PathBuf| folder.join("report.md").exists();
    let mut folders: Vec<PathBuf> =
        std::fs::read_dir(results).unwrap().map(|entry| entry.unwrap().path()).collect();
    folders.retain(committed);
    folders.sort();
    folders
}

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
    for folder in results() {
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
    assert_eq!(invented(result, &root.join("results/reference-vectors")), [""; 0]);
}

#[test]
fn a_number_of_ones_own_is_found() {
    let folder = &results()[0];
    assert_eq!(invented("1.00 and 123456.789 times, at v1.2.3 of 12", folder), ["123456.789"]);
}
