//! Finds the committed records. Tests must not depend on a user's own runs, which are in
//! `results/`, too.

use std::path::{Path, PathBuf};

/// Returns the folders of committed records, sorted: each `results/reference*` or its subfolders.
pub fn committed() -> Vec<PathBuf> {
    let inside = |folder: &Path| -> Vec<PathBuf> {
        let entries = std::fs::read_dir(folder).into_iter().flatten();
        entries.filter_map(|entry| Some(entry.ok()?.path())).collect()
    };
    let of_project = |path: &PathBuf| {
        path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("reference"))
    };
    // This file is also compiled into other crates of the workspace.
    let mut above = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
    let root = above.find(|folder| folder.join("results/README.md").exists());
    let all = inside(&root.expect("the project has results/").join("results"));
    let all = all.into_iter().filter(of_project).flat_map(|folder| {
        if folder.join("report.md").exists() { vec![folder] } else { inside(&folder) }
    });
    let mut folders: Vec<PathBuf> =
        all.filter(|folder| folder.join("report.md").exists()).collect();
    folders.sort();
    assert!(folders.len() >= 3, "{} records", folders.len());
    folders
}
