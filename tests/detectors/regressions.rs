//! Runs all detectors on every file of `tests/regressions`, in all safe arithmetics.

use std::path::{Path, PathBuf};

use contactbench::check::subject::CheckedSubject;
use contactbench::check::{self, Limits};
use contactbench::io;
use contactbench::scene::Given;
use contactbench_detectors::oracle;
use contactbench_detectors::table::TABLE;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::detect::Options;

fn files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/regressions");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let is_scene =
        |path: &PathBuf| path.extension().is_some_and(|ending| ending == "csv" || ending == "xyz");
    files.filter(is_scene).collect()
}

fn given(path: &Path) -> Given {
    io::given(path, io::Options::default()).unwrap_or_else(|error| panic!("{error:#}"))
}

#[test]
fn all_detectors_are_right_on_all_files() {
    let detectors = TABLE.iter().filter(|entry| entry.must_be_right()).map(CheckedSubject::from);
    let detectors: Vec<CheckedSubject> = detectors.collect();
    // This limit lets detectors refuse scenes that need an array over very many cells.
    let options = Options { memory_limit: 64 << 20, ..Options::default() };
    let limits = Limits { options, ..Limits::default() };
    assert!(files().len() >= 5);
    for path in files() {
        let text = std::fs::read_to_string(&path).unwrap();
        // A scene in a box is in extended XYZ, which has no comments; other files begin with one.
        assert!(
            given(&path).lattice.is_some()
                || text.starts_with("# ") && text.contains("\n# contactbench check --scene "),
            "{}: begin with what was wrong",
            path.display()
        );
        let name = path.display().to_string();
        let (scene, all) = (given(&path), &Arithmetic::SAFE);
        let report = check::check_scene(&scene, &name, &detectors, all, &limits).unwrap();
        for failure in &report.failures {
            let (detector, arithmetic) = (&failure.detector, failure.arithmetic.name());
            println!("{detector} with {arithmetic} arithmetic on {name}: {}", failure.found);
        }
        assert!(report.failures.is_empty() && report.cases >= 2, "{name}");
    }
}

/// Each file has exactly the contacts for which it was written.
#[test]
fn the_files_hold_the_pairs_that_they_name() {
    let pairs = |name: &str, arithmetic| {
        let is_it = |path: &PathBuf| path.file_stem().is_some_and(|stem| stem == name);
        let path = files().into_iter().find(is_it).unwrap();
        oracle::truth(&given(&path).open("a regression").unwrap(), arithmetic).unwrap().pairs
    };
    assert_eq!(pairs("three-discs", Arithmetic::Exact), [[0, 1]]);
    assert_eq!(pairs("three-discs", Arithmetic::F64), [[0, 1], [1, 2]]);
    assert_eq!(pairs("tangent-3-4-5", Arithmetic::Exact), [[0, 1], [0, 2], [4, 5]]);
    assert_eq!(pairs("far-apart", Arithmetic::Exact), [[0, 1], [3, 4], [4, 5]]);
    assert_eq!(pairs("subnormal", Arithmetic::Exact), [[0, 1], [0, 3]]);
    let all = pairs("subnormal", Arithmetic::F64);
    assert_eq!(all.len(), 10);
}
