//! Tests which crates each crate imports, and where names stand.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use contactbench_detectors::table::TABLE;

/// The crates that each crate may depend on. Crates for records and reports do not need detectors.
const WALLS: [(&str, &[&str]); 12] = [
    ("terms", &[]),
    ("ground", &["terms"]),
    ("streamed", &["ground", "terms"]),
    ("lists", &["ground", "terms"]),
    ("detectors", &["ground", "lists", "streamed", "terms"]),
    ("core", &["detectors", "ground", "lists", "streamed"]),
    ("io", &["ground", "terms"]),
    ("scenes", &["ground", "io", "lists", "streamed", "terms"]),
    ("record", &["terms"]),
    ("run", &["detectors", "ground", "io", "lists", "record", "scenes", "terms"]),
    ("report", &["record", "terms"]),
    ("views", &["detectors", "ground", "io", "scenes", "terms"]),
];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn crates_import_only_those_below_them() {
    for (name, allowed) in WALLS {
        let path = root().join("crates").join(name).join("Cargo.toml");
        let text = std::fs::read_to_string(path).unwrap();
        let rest = text.split_once("\n[dependencies]\n").unwrap().1;
        let section = rest.split("\n[").next().unwrap();
        let linked = section.lines().filter_map(|line| line.strip_prefix("contactbench-"));
        let linked: BTreeSet<&str> = linked.filter_map(|line| line.split(' ').next()).collect();
        assert_eq!(linked, allowed.iter().copied().collect(), "{name}");
    }
}

fn below(folder: &str) -> Vec<PathBuf> {
    let (mut found, mut folders) = (Vec::new(), vec![root().join(folder)]);
    while let Some(next) = folders.pop() {
        for entry in std::fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() && !path.ends_with("target") {
                folders.push(path.clone());
            }
            found.push(path);
        }
    }
    found
}

fn is_rust(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "rs")
}

/// Only the table of detectors names them; other files use fields of its entries. The core, the
/// campaigns and the traces of single detectors are excepted.
#[test]
fn names_of_detectors_stand_in_the_table_alone() {
    let mut seen = 0;
    for path in ["src", "crates"].iter().flat_map(|name| below(name)) {
        let name = path.strip_prefix(root()).unwrap().display().to_string();
        let own = [
            "crates/streamed/",
            "crates/detectors/",
            "crates/campaigns/",
            "/trace",
            "test",
            "agreement",
            "in_words",
        ];
        if !is_rust(&path) || own.iter().any(|own| name.contains(own)) {
            continue;
        }
        seen += 1;
        let text = std::fs::read_to_string(&path).unwrap();
        let tests = ["#[cfg(test)]", "pub mod testing {"];
        let end = tests.iter().filter_map(|start| text.find(start)).min().unwrap_or(text.len());
        for line in text[..end].lines().filter(|line| !line.trim_start().starts_with("//")) {
            for entry in TABLE.iter().filter(|entry| !entry.is_control()) {
                assert!(!line.contains(&format!("\"{}\"", entry.name)), "{name}: {line}");
            }
        }
    }
    assert!(seen > 100, "{seen} files");
}
