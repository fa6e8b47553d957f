//! The experiment files copied to a result folder. Each provenance contains their SHA-256 at the
//! start of the run, so that later edits of a claim or plan are detected.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use crate::record::faults::Fault;
use crate::record::folder;
use crate::record::origin::provenance;

/// The field of a provenance with the SHA-256 of each copy, by name.
pub const FIELD: &str = "experiments_sha256";

fn sha256(text: &[u8]) -> String {
    Sha256::digest(text).iter().map(|byte| format!("{byte:02x}")).collect()
}

pub fn field<'a>(copies: impl Iterator<Item = (&'a str, &'a str)>) -> Value {
    json!(copies.map(|(name, text)| (name, sha256(text.as_bytes()))).collect::<BTreeMap<_, _>>())
}

/// Whether a provenance contains the sums. Older runs did not write them.
pub fn are_sealed<'a>(mut provenances: impl Iterator<Item = &'a Value>) -> bool {
    provenances.any(|provenance| provenance.get(FIELD).is_some_and(Value::is_object))
}

pub fn unsealed<'a>(folder: &Path, provenances: impl Iterator<Item = &'a Value>) -> Option<String> {
    (!are_sealed(provenances)).then(|| {
        let name = folder.file_name().unwrap_or_default().to_string_lossy();
        format!(
            "the record {name} has no checksums of its copies of experiments: an edit in {}/ would \
             go unnoticed",
            folder::EXPERIMENTS
        )
    })
}

pub(crate) fn faults(folder: &Path) -> Vec<Fault> {
    let provenances = provenance::all(folder);
    if !are_sealed(provenances.iter()) {
        return Vec::new();
    }
    let sums = provenances.iter().filter_map(|it| it.get(FIELD)?.as_object()).flatten();
    let known: Vec<(&str, &str)> =
        sums.filter_map(|(name, sum)| Some((name.as_str(), sum.as_str()?))).collect();
    let copies: BTreeMap<String, PathBuf> = folder::experiments(folder).into_iter().collect();
    let what = |name: &str| -> Option<String> {
        let mut sums = known.iter().filter(|(other, _)| *other == name).map(|it| it.1).peekable();
        let Some(path) = copies.get(name) else { return Some("the copy is missing".into()) };
        if sums.peek().is_none() {
            return Some("the run had no experiment of this name".into());
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

/// Adds the sums of the present copies to a folder without a seal. Existing seals are never
/// changed.
pub fn seal(folder: &Path) -> anyhow::Result<usize> {
    let path = folder.join(provenance::FILE);
    let mut fields = provenance::of_folder(folder)
        .with_context(|| format!("cannot read {}: there is nothing to seal", path.display()))?;
    ensure!(
        !are_sealed(provenance::all(folder).iter()),
        "{} is sealed already; a seal is made once",
        folder.display()
    );
    let read = |(name, path): (String, PathBuf)| {
        let text = std::fs::read_to_string(&path);
        Ok((name, text.with_context(|| format!("cannot read {}", path.display()))?))
    };
    let copies = folder::experiments(folder).into_iter().map(read);
    let copies = copies.collect::<anyhow::Result<Vec<(String, String)>>>()?;
    fields[FIELD] = field(copies.iter().map(|(name, text)| (name.as_str(), text.as_str())));
    std::fs::write(&path, provenance::text(&fields)?)
        .with_context(|| format!("cannot write {}", path.display()))?;
    Ok(copies.len())
}
