//! Tests `contactbench site`: its pages link only to each other, and say which rows are old.

use std::path::{Path, PathBuf};

use contactbench::record::origin::provenance;
use serde_json::Value;

use super::page;
use crate::common::Place;

/// Returns the folder of a site of one made-up record.
fn site(at: &Place) -> PathBuf {
    page::report(at);
    at.good("site . -o site");
    at.path("site")
}

fn pages(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        if entry.is_dir() {
            pages(&entry, found);
        } else if entry.extension().is_some_and(|ending| ending == "html") {
            found.push(entry);
        }
    }
}

#[test]
fn pages_link_only_to_files_of_the_site() {
    let (at, mut all) = (Place::new(), Vec::new());
    pages(&site(&at), &mut all);
    // The front page, the table, the record, and a page for each of three detectors.
    assert_eq!(all.len(), 6, "{all:?}");
    let mut links = 0;
    for path in &all {
        let html = std::fs::read_to_string(path).unwrap();
        assert!(!html.contains("<img src=x") && !html.contains("{{"), "{}", path.display());
        for (link, _) in ["href=\"", "src=\""]
            .iter()
            .flat_map(|name| html.split(name).skip(1))
            .filter_map(|rest| rest.split_once('"'))
            .filter(|(link, _)| !link.starts_with(['#', 'd']) || link.starts_with("detectors/"))
        {
            assert!(path.parent().unwrap().join(link).exists(), "{}: {link}", path.display());
            links += 1;
        }
    }
    assert!(links > 20, "{links}");
    // A site is replaced, any other folder is not. Equal records count once.
    at.file("site/records/stale.html", "");
    at.file("site/records/kept.csv", "");
    at.file("kept.html", "");
    let listed = at.read("site/made-by-contactbench.txt");
    let more = listed.clone() + "records/stale.html\nrecords/kept.csv\n../kept.html\n";
    at.file("site/made-by-contactbench.txt", more);
    at.shell("mkdir -p twice; cp -r samples.jsonl experiments provenance.json twice");
    at.good("site . -o site");
    assert!(!at.path("site/records/stale.html").exists());
    assert!(at.path("site/records/kept.csv").exists() && at.path("kept.html").exists());
    assert_eq!(at.read("site/made-by-contactbench.txt"), listed);
    at.shell(
        "mkdir -p two/a two/b; for it in a b; do cp -r twice/* two/$it; done; ln -s . two/loop",
    );
    let copy = at.good("site two -o site --address https://example.org/all/");
    for note in ["two/b is a copy of two/a and is left out", "two/loop is a link and is left out"] {
        assert!(copy.stderr.contains(note), "{}", copy.stderr);
    }
    let page = at.read("site/records/a.html");
    assert!(page.contains("href=\"https://example.org/all/a/samples.jsonl\""), "{page}");
    at.ends(2, "site . -o experiments", &["is not empty and not a site; choose another"]);
    at.ends(2, "site experiments -o other", &["found no record"]);
}

#[test]
fn each_record_has_its_page_and_old_rows_are_marked() {
    let at = Place::new();
    page::report(&at);
    let fields: Value = serde_json::from_str(&at.read("provenance.json")).unwrap();
    // Two names differ only in a sign, and a link leads back.
    let made =
        [("a/b", "2026-11-24", "new"), ("a-b", "2026-11-23", "old"), ("c", "2026-11-22", "new")];
    for (name, day, revision) in made {
        at.shell(&format!("mkdir -p all/{name}; cp -r samples.jsonl experiments all/{name}"));
        let mut fields = fields.clone();
        (fields["date_utc"], fields["revision"]) =
            (format!("{day}T01-00-00").into(), revision.into());
        at.file(&format!("all/{name}/provenance.json"), provenance::text(&fields).unwrap());
    }
    at.shell("ln -s .. all/a/up");
    at.good("site all -o site");
    let mut found = Vec::new();
    pages(&at.path("site/records"), &mut found);
    assert_eq!(found.len(), made.len(), "{found:?}");
    let field = at.read("site/field.html");
    // No record knows the load of its machine.
    let marked =
        |day: &str| ["", " (old)"].map(|old| field.contains(&format!(">{day}{old} (disturbed)<")));
    assert!(!at.read("site/index.html").contains("class=\"bars\""));
    // The library of the second record has a version of its own, so only our detectors are old.
    assert_eq!(made.map(|it| marked(it.1)), [[true, false], [true, true], [true, false]]);
}
