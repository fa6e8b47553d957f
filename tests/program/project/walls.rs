//! Tests which crates each crate imports.

use std::collections::BTreeSet;
use std::path::Path;

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

#[test]
fn crates_import_only_those_below_them() {
    for (name, allowed) in WALLS {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let path = root.join("crates").join(name).join("Cargo.toml");
        let text = std::fs::read_to_string(path).unwrap();
        let rest = text.split_once("\n[dependencies]\n").unwrap().1;
        let section = rest.split("\n[").next().unwrap();
        let linked = section.lines().filter_map(|line| line.strip_prefix("contactbench-"));
        let linked: BTreeSet<&str> = linked.filter_map(|line| line.split(' ').next()).collect();
        assert_eq!(linked, allowed.iter().copied().collect(), "{name}");
    }
}
