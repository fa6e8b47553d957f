//! The experiment files copied to a result folder. Each provenance contains their SHA-256 at the
//! start of the run, so that later edits of a claim or plan are detected.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use crate::record::faults::Damaged;
use crate::record::folder;
use crate::record::origin::provenance;

/// The field of a provenance with the SHA-256 of each copy, by name.
pub const FIELD: &str = "experiments_sha256";

/// Returns the SHA-256 in hexadecimal digits.
pub fn sha256(text: &[u8]) -> String {
    hexadecimal(Sha256::digest(text).as_slice())
}

/// Returns the SHA-256 of all bytes of a reader, which need not fit into memory.
pub fn sha256_of(reader: impl Read) -> io::Result<String> {
    let (mut reader, mut sum) = (BufReader::with_capacity(1 << 20, reader), Sha256::new());
    loop {
        let bytes = reader.fill_buf()?;
        if bytes.is_empty() {
            return Ok(hexadecimal(sum.finalize().as_slice()));
        }
        sum.update(bytes);
        let read = bytes.len();
        reader.consume(read);
    }
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

pub fn field<'a>(copies: impl Iterator<Item = (&'a str, &'a str)>) -> Value {
    json!(copies.map(|(name, text)| (name, sha256(text.as_bytes()))).collect::<BTreeMap<_, _>>())
}

/// Fails if a copy is missing or does not have the SHA-256 of every provenance.
pub(crate) fn sound(folder: &Path) -> Result<(), Damaged> {
    let mut sums: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for provenance in provenance::all(folder) {
        for (name, sum) in provenance.get(FIELD).and_then(Value::as_object).into_iter().flatten() {
            sums.entry(name.clone()).or_default().extend(sum.as_str().map(String::from));
        }
    }
    let copies: BTreeMap<String, PathBuf> = folder::experiments(folder).into_iter().collect();
    for name in sums.keys().chain(copies.keys()) {
        let place = folder.join(folder::EXPERIMENTS).join(format!("{name}.toml"));
        let text = copies.get(name).and_then(|path| std::fs::read(path).ok());
        let is = text.map(|text| sha256(&text)).unwrap_or_default();
        if !sums.get(name).is_some_and(|sums| sums.iter().all(|sum| *sum == is)) {
            let what = "its SHA-256 is not that of the provenance: it is missing or was edited";
            return Err(Damaged::new(&place, what));
        }
    }
    Ok(())
}
