//! Names of detectors stand in the table alone.

use std::path::{Path, PathBuf};

use contactbench::detect::table::TABLE;

/// The sources below a folder, without tests.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let name = |path: &Path| path.file_name().unwrap().to_string_lossy().into_owned();
    let is_test = |path: &PathBuf| {
        ["test", "agreement", "in_words"].iter().any(|word| name(path).contains(word))
    };
    let found = entries.filter(|path| !is_test(path)).flat_map(|path| match path.is_dir() {
        true => sources(&path),
        false => vec![path],
    });
    found.filter(|path| path.extension().is_some_and(|ending| ending == "rs")).collect()
}

/// What others need to know of a detector are fields of its entry. The core's own files, the
/// campaigns, and the lectures on the book's detectors, are about single detectors.
#[test]
fn names_of_detectors_stand_in_the_table_alone() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folders = ["src", "crates"].map(|name| root.join(name));
    let mut seen = 0;
    for path in folders.iter().flat_map(|folder| sources(folder)) {
        let name = path.strip_prefix(root).unwrap().display().to_string();
        let own = ["crates/core/", "crates/campaigns/"].iter().any(|own| name.starts_with(own));
        if own || name.contains("/trace") {
            continue;
        }
        seen += 1;
        let text = std::fs::read_to_string(&path).unwrap();
        let tests = ["#[cfg(test)]", "pub mod testing {"];
        let end = tests.iter().filter_map(|start| text.find(start)).min().unwrap_or(text.len());
        let code = &text[..end];
        for line in code.lines().filter(|line| !line.trim_start().starts_with("//")) {
            for entry in TABLE.iter().filter(|entry| !entry.is_control()) {
                assert!(!line.contains(&format!("\"{}\"", entry.name)), "{name}: {line}");
            }
        }
    }
    assert!(seen > 100, "{seen} files");
}
