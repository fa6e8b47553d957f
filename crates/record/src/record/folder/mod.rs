//! The files of a result folder, and checks of those other than its record.

pub mod copies;
pub mod done;
pub mod file;
pub mod ledger;
pub mod seal;

use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::record::faults::{self, Damaged, Fault, is_word};
use crate::record::origin::provenance;

pub const EXPERIMENTS: &str = "experiments";
const FOLDERS: [&str; 2] = [EXPERIMENTS, "figures"];

/// Refuses links that lead out of the folder, unreadable provenance, and experiments with invalid
/// names; the error lists all of them.
pub fn sound(folder: &Path) -> Result<(), Damaged> {
    let mut found = Vec::new();
    let Ok(root) = folder.canonicalize() else { return Ok(()) };
    for name in [""].into_iter().chain(FOLDERS) {
        for path in entries(&folder.join(name)) {
            let fault = |what: String| Fault { place: path.display().to_string(), what };
            if path.is_symlink() && !path.canonicalize().is_ok_and(|to| to.starts_with(&root)) {
                found.push(fault("it is a link that leads out of the folder".into()));
            } else if is_provenance(&path) {
                found.extend(damage(&path).map(fault));
            } else if path.ends_with(ledger::FILE) {
                let faults = ledger::faults(folder).into_iter();
                let place = |line| format!("{}:{line}", path.display());
                found.extend(faults.map(|(line, what)| Fault { place: place(line), what }));
            } else if name == EXPERIMENTS && is_experiment(&path) && !is_word(&stem(&path)) {
                found.push(fault("its name is not valid for an experiment".into()));
            }
        }
    }
    // If the provenance is damaged, its sums are not compared.
    faults::sound(if found.is_empty() { copies::faults(folder) } else { found })
}

fn entries(folder: &Path) -> Vec<PathBuf> {
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

fn is_provenance(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    name == provenance::FILE || name.starts_with("provenance-") && name.ends_with(".json")
}

fn damage(path: &Path) -> Option<String> {
    let bytes = match std::fs::read(path) {
        Ok(bytes) => bytes,
        Err(error) => return Some(format!("it cannot be read: {error}")),
    };
    match serde_json::from_slice(&bytes) {
        Ok(Value::Object(_)) => seal::verify(&bytes).err(),
        Ok(_) => Some("it is not an object of fields".into()),
        Err(error) => Some(format!("it is not whole: {error}")),
    }
}
