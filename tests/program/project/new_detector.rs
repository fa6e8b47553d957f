//! Compiles and checks the detector that `new-detector` writes. Its lines go to the right places in
//! other files, all or none.

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

#[test]
fn the_lines_come_to_their_places() {
    let at = Place::new();
    std::fs::create_dir_all(at.path(FOLDER).join("table")).unwrap();
    let path = |name: &str| format!("{FOLDER}/{name}");
    for name in ["lib.rs", "table/mod.rs"] {
        let from = Path::new(env!("CARGO_MANIFEST_DIR")).join(path(name));
        std::fs::copy(from, at.path(&path(name))).unwrap();
    }
    at.ends(0, "new-detector quick_tree", &["check --detector quick-tree"]);
    let written = TEMPLATE.replace("new-detector", "quick-tree");
    let written = written.replace("NewDetector", "QuickTree");
    assert_eq!(at.read(&path("quick_tree.rs")), written);
    let [modules, table] = ["lib.rs", "table/mod.rs"].map(|name| at.read(&path(name)));
    let mut names = modules.lines().filter_map(|line| line.strip_prefix("pub mod "));
    assert!(names.clone().is_sorted() && names.any(|name| name == "quick_tree;"), "{modules}");
    let place = |words: &str| table.find(words).unwrap();
    let constructor = place("super::quick_tree::QuickTree");
    assert!(place("name: \"quick-tree\"") < constructor && constructor < place("\"nothing\""));
    at.ends(2, "new-detector quick-tree", &["quick_tree"]);
    // Nothing is written to a table of another form, and the entry is printed.
    at.file(&path("table/mod.rs"), table.replace("pub static TABLE", "static OTHER"));
    at.ends(2, "new-detector other", &["name: \"other\"", "table/mod.rs"]);
    assert!(!at.path(&path("other.rs")).exists());
}
