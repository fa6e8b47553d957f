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
    let mut sums: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for provenance in provenance::all(folder) {
        for (name, sum) in provenance.get(FIELD).and_then(Value::as_object).into_iter().flatten() {
            sums.entry(name.clone()).or_default().extend(sum.as_str().map(String::from));
        }
    }
    let copies: BTreeMap<String, PathBuf> = folder::experiments(folder).into_iter().collect();
    let names: BTreeSet<&String> = sums.keys().chain(copies.keys()).collect();
    let what = |name: &String| -> Option<String> {
        let Some(path) = copies.get(name) else { return Some("the copy is missing".into()) };
        let Some(known) = sums.get(name) else {
            return Some("no provenance has its SHA-256".into());
        };
        let is = std::fs::read(path).map(|text| sha256(&text)).unwrap_or_default();
        let edited = known.iter().any(|sum| *sum != is);
        edited.then(|| format!("its SHA-256 is {is}, not that of the provenance: it was edited"))
    };
    let place = |name: &String| folder.join(folder::EXPERIMENTS).join(format!("{name}.toml"));
    let fault =
        |name: &String| Some(Fault { place: place(name).display().to_string(), what: what(name)? });
    names.into_iter().filter_map(fault).collect()
}
