//! The records that belong to the project. A user's own runs stand in `results/` as well, and no
//! test may depend on them.

use std::path::{Path, PathBuf};

/// Returns the folders of the committed records: those that `.gitignore` exempts.
pub fn committed() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let ignored = std::fs::read_to_string(root.join(".gitignore")).unwrap();
    let named = |line: &str| line.strip_prefix("!/results/")?.strip_suffix('/').map(String::from);
    let folders: Vec<PathBuf> =
        ignored.lines().filter_map(named).map(|name| root.join("results").join(name)).collect();
    assert!(folders.len() >= 3, "{} records", folders.len());
    folders
}
