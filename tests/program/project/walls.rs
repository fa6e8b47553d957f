//! What may import what, and how much a folder holds.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The crates of the project that each crate is linked with. A record and its report need no
/// detector.
const WALLS: [(&str, &[&str]); 8] = [
    ("terms", &[]),
    ("core", &["terms"]),
    ("io", &["core", "terms"]),
    ("scenes", &["core", "io", "terms"]),
    ("record", &["terms"]),
    ("run", &["core", "io", "record", "scenes", "terms"]),
    ("report", &["record", "terms"]),
    ("views", &["core", "io", "scenes", "terms"]),
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

#[test]
fn the_top_is_seen_at_a_glance_and_modules_have_one_form() {
    let ignored = ["target", "shared"];
    let names = std::fs::read_dir(root()).unwrap().map(|entry| entry.unwrap().file_name());
    let names = names.map(|name| name.into_string().unwrap());
    let names: Vec<String> =
        names.filter(|name| !name.starts_with('.') && !ignored.contains(&&**name)).collect();
    assert!(names.len() <= 16, "{names:?}");
    let mut folders: Vec<PathBuf> = ["src", "crates"].map(|name| root().join(name)).into();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let beside = path.extension().is_some_and(|ending| ending == "rs");
            assert!(!(beside && path.with_extension("").is_dir()), "{}: mod.rs", path.display());
            if path.is_dir() && !path.ends_with("target") {
                folders.push(path);
            }
        }
    }
}
