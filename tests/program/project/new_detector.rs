//! Compiles and checks the detector that `new-detector` writes. Its lines go to the right places in
//! other files, all or none.

use std::collections::BTreeMap;
use std::path::Path;

use contactbench::check::subject::CheckedSubject;
use contactbench::check::{self, Limits};
use contactbench_detectors::table::{Entry, PLAIN};
use contactbench_ground::contact;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::detect::Options;
use contactbench_ground::detect::any::Both;
use contactbench_ground::pairs::sink;

use crate::common::Place;

#[path = "../../../src/cli/your_detector/template.rs"]
mod written;
use written::NewDetector;

const TEMPLATE: &str = include_str!("../../../src/cli/your_detector/template.rs");
const FOLDER: &str = "crates/detectors/src";

static ENTRY: Entry =
    Entry { name: "new-detector", constructor: Both::<NewDetector, NewDetector>::boxed, ..PLAIN };

#[test]
fn what_is_written_works() {
    let limits = Limits { seeds: 1, time: std::time::Duration::from_secs(60), ..Limits::default() };
    let report =
        check::battery(&[CheckedSubject::from(&ENTRY)], &[Arithmetic::Exact], &limits).unwrap();
    let failures: Vec<String> = report
        .failures
        .iter()
        .map(|it| format!("on {}:\n{}", it.found_on, check::as_csv(&it.smallest.scene)))
        .collect();
    assert!(failures.is_empty() && !report.cut && report.cases > 400, "{failures:?}");
    // The new detector itself refuses no scene here; only the arithmetic may.
    let refused = &report.refused;
    assert!(refused.keys().all(|reason| !reason.starts_with("new-detector")), "{refused:?}");
    // The new detector respects the memory limit.
    let scene = contactbench::scene::spec::Spec::parse("packed:n=300").unwrap().make().unwrap();
    for (memory_limit, enough) in [(16 * 300, true), (16 * 300 - 1, false)] {
        let (mut count, mut detector) =
            (sink::Count::default(), ENTRY.make(Options { memory_limit, threads: 1 }));
        let answer = detector.visit(&scene, contact::Test::Exact, &mut count);
        assert_eq!((answer.is_ok(), count.0 > 0), (enough, enough));
    }
}

/// Returns a folder with the two files that `new-detector` changes.
fn checkout() -> Place {
    let at = Place::new();
    std::fs::create_dir_all(at.path(FOLDER).join("table")).unwrap();
    for name in ["lib.rs", "table/mod.rs"] {
        let from = Path::new(env!("CARGO_MANIFEST_DIR")).join(FOLDER).join(name);
        std::fs::copy(from, at.path(FOLDER).join(name)).unwrap();
    }
    at
}

fn files(at: &Place) -> BTreeMap<String, String> {
    let entries = std::fs::read_dir(at.path(FOLDER)).unwrap().map(|entry| entry.unwrap());
    let files = entries.filter(|entry| entry.path().is_file());
    let names = files.map(|entry| entry.file_name().into_string().unwrap());
    let names = names.chain(["table/mod.rs".to_string()]);
    names.map(|name| (name.clone(), at.read(&format!("{FOLDER}/{name}")))).collect()
}

/// Returns the lines added to `before`; fails if one was removed.
fn added<'a>(before: &str, after: &'a str) -> Vec<&'a str> {
    let mut old = before.lines().peekable();
    let new = after.lines().filter(|line| old.next_if_eq(line).is_none()).collect();
    assert_eq!(old.next(), None, "a line is gone");
    new
}

#[test]
fn the_lines_come_to_their_places() {
    let long = "a-name-as-long-as-it-may-be-1234";
    for (given, name, kind) in [
        ("quick-tree", "quick-tree", "QuickTree"),
        ("aaa_1", "aaa-1", "Aaa1"),
        ("zz", "zz", "Zz"),
        (long, long, "ANameAsLongAsItMayBe1234"),
    ] {
        let module = name.replace('-', "_");
        let at = checkout();
        let before = files(&at);
        let line = format!("new-detector {given}");
        assert_eq!(at.ends(0, &line, &[&format!("check --detector {name}")]).stderr, "");
        let after = files(&at);
        assert_eq!(after.len(), 3);
        let file = &after[&format!("{module}.rs")];
        assert_eq!(*file, TEMPLATE.replace("new-detector", name).replace("NewDetector", kind));
        // The module list stays sorted, and attributes stay with their modules.
        assert_eq!(added(&before["lib.rs"], &after["lib.rs"]), [format!("pub mod {module};")]);
        let modules = after["lib.rs"].lines().filter_map(|line| line.strip_prefix("pub mod "));
        assert!(modules.clone().is_sorted(), "{:?}", modules.collect::<Vec<_>>());
        // The table gains one entry, before the controls.
        let table = &after["table/mod.rs"];
        let lines = added(&before["table/mod.rs"], table).join("\n");
        assert_eq!(lines.matches("Entry {").count(), 1, "{lines}");
        assert!(lines.contains(&format!("super::{module}::{kind}")), "{lines}");
        let place = |name: &str| table.find(&format!("name: \"{name}\",")).unwrap();
        assert!(place("kd-tree") < place(name) && place(name) < place("nothing"));
        at.ends(2, &line, &[&module]);
        assert_eq!(files(&at), after);
    }
}

#[test]
fn in_an_unexpected_tree_nothing_is_changed_and_the_lines_are_printed() {
    let (at, taken) = (Place::new(), checkout());
    for module in ["modern", "oracle"] {
        taken.ends(2, &format!("new-detector {module}"), &[module]);
    }
    for (file, old, words) in [
        ("table/mod.rs", "pub static TABLE", "constructor: Both::<super::quick_tree::QuickTree"),
        ("lib.rs", "pub mod ", "pub mod quick_tree;"),
    ] {
        let checkout = checkout();
        let name = format!("{FOLDER}/{file}");
        let text = checkout.read(&name).replace(old, "pub(crate) thing ");
        let path = checkout.file(&name, text).display().to_string();
        let before = files(&checkout);
        let line = format!("new-detector quick-tree --in '{}'", checkout.root().display());
        at.ends(2, &line, &[words, &path]);
        assert_eq!(files(&checkout), before, "{file}");
    }
}
