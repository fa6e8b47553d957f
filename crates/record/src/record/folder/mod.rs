//! The files of a result folder, and checks of those other than its record.

pub mod copies;
pub mod done;
pub mod file;
pub mod ledger;
pub mod seal;

use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::record::faults::{Damaged, is_word};
use crate::record::origin::provenance;

pub const EXPERIMENTS: &str = "experiments";
const FOLDERS: [&str; 2] = [EXPERIMENTS, "figures"];

/// Refuses links that lead out of the folder, unreadable provenance, and experiments with invalid
/// names.
pub fn sound(folder: &Path) -> Result<(), Damaged> {
    let Ok(root) = folder.canonicalize() else { return Ok(()) };
    for name in [""].into_iter().chain(FOLDERS) {
        for path in entries(&folder.join(name)) {
            if path.is_symlink() && !path.canonicalize().is_ok_and(|to| to.starts_with(&root)) {
                return Err(Damaged::new(&path, "it is a link that leads out of the folder"));
            }
            let of_record = is_provenance(&path) || path.ends_with(ledger::FILE);
            if of_record || name == EXPERIMENTS {
                regular(&path)?;
            }
            if is_provenance(&path) {
                whole(&path).map_err(|what| Damaged::new(&path, what))?;
            } else if path.ends_with(ledger::FILE) {
                ledger::sound(&path)?;
            } else if name == EXPERIMENTS && is_experiment(&path) && !is_word(&stem(&path)) {
                return Err(Damaged::new(&path, "its name is not valid for an experiment"));
            }
        }
    }
    copies::sound(folder)
}

/// Fails if the path exists but is not a file, because reading a pipe or device may never end.
pub fn regular(path: &Path) -> Result<(), Damaged> {
    let other = std::fs::metadata(path).is_ok_and(|it| !it.is_file());
    if other { Err(Damaged::new(path, "it is not a file")) } else { Ok(()) }
}

pub(super) fn entries(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    let mut paths: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.sort();
    paths
}

pub fn experiments(folder: &Path) -> Vec<(String, PathBuf)> {
    let copies = entries(&folder.join(EXPERIMENTS)).into_iter();
    copies.filter(|path| is_experiment(path)).map(|path| (stem(&path), path)).collect()
}

fn is_experiment(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "toml")
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

pub(super) fn is_provenance(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    name == provenance::FILE || name.starts_with("provenance-") && name.ends_with(".json")
}

fn whole(path: &Path) -> Result<(), String> {
    let bytes = std::fs::read(path).map_err(|error| format!("it cannot be read: {error}"))?;
    let fields = serde_json::from_slice::<serde_json::Map<String, Value>>(&bytes);
    let fields = fields.map_err(|error| format!("it is not an object of fields: {error}"))?;
    provenance::sound(&fields)?;
    seal::verify(&bytes)
}
