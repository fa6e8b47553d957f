//! The experiment files copied to a result folder. Each provenance contains their SHA-256 at the
//! start of the run, so that later edits of a claim or plan are detected.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use crate::record::faults::Fault;
use crate::record::folder;
use crate::record::origin::provenance;

/// The field of a provenance with the SHA-256 of each copy, by name.
pub const FIELD: &str = "experiments_sha256";

/// Returns the SHA-256 in hexadecimal digits.
pub fn sha256(text: &[u8]) -> String {
    Sha256::digest(text).iter().map(|byte| format!("{byte:02x}")).collect()
}

pub fn field<'a>(copies: impl Iterator<Item = (&'a str, &'a str)>) -> Value {
    json!(copies.map(|(name, text)| (name, sha256(text.as_bytes()))).collect::<BTreeMap<_, _>>())
}

pub(crate) fn faults(folder: &Path) -> Vec<Fault> {
    let provenances = provenance::all(folder);
    let sums = provenances.iter().filter_map(|it| it.get(FIELD)?.as_object()).flatten();
    let known: Vec<(&str, &str)> =
        sums.filter_map(|(name, sum)| Some((name.as_str(), sum.as_str()?))).collect();
    let copies: BTreeMap<String, PathBuf> = folder::experiments(folder).into_iter().collect();
    let what = |name: &str| -> Option<String> {
        let mut sums = known.iter().filter(|(other, _)| *other == name).map(|it| it.1).peekable();
        let Some(path) = copies.get(name) else { return Some("the copy is missing".into()) };
        if sums.peek().is_none() {
            return Some("no provenance has its SHA-256".into());
        }
        let is = std::fs::read(path).map(|text| sha256(&text)).unwrap_or_default();
        let sum = sums.find(|sum| *sum != is)?;
        Some(format!(
            "its SHA-256 is {is}, and by the provenance that of the run is {sum}: it was edited"
        ))
    };
    let names = known.iter().map(|(name, _)| *name).chain(copies.keys().map(String::as_str));
    let names: BTreeSet<&str> = names.collect();
    let fault = |name| {
        let place = folder.join(folder::EXPERIMENTS).join(format!("{name}.toml"));
        Some(Fault { place: place.display().to_string(), what: what(name)? })
    };
    names.into_iter().filter_map(fault).collect()
}
