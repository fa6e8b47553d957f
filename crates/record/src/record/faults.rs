//! Checks that rows of one scene have one scene hash and one digest, and that their ids are valid. A
//! record with a fault is refused, and all faulty rows are listed.

use std::collections::{BTreeMap, HashMap};
use std::fmt;

use crate::record::folder::{done, file};
use crate::record::id::Projection;
use crate::record::outcome::Outcome;
use crate::record::row::Row;
use contactbench_terms::must;
use contactbench_terms::number::plural;
use contactbench_terms::text;

pub const MOST_THREADS: usize = 1024;
const SHOWN: usize = 20;

#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// The file and, if it has lines, the line: `result/samples.jsonl:7`.
    pub place: String,
    /// The fault, as a sentence without a full stop.
    pub what: String,
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub struct Damaged(pub Vec<Fault>);

impl fmt::Display for Damaged {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Damaged(faults) = self;
        let count = plural(faults.len(), "fault");
        write!(f, "{count}: the record is damaged or was edited, and is not used")?;
        for Fault { place, what } in faults.iter().take(SHOWN) {
            write!(f, "\n{}", text::line(&format!("{place}: {what}")))?;
        }
        if faults.len() > SHOWN {
            write!(f, "\nand {} more", faults.len() - SHOWN)?;
        }
        write!(f, "\nuse an undamaged copy")?;
        if faults.iter().all(|fault| fault.place.contains(file::FILE)) {
            let again = "contactbench run ... --resume";
            write!(f, "; or remove these lines, and measure them again with {again}")?;
        }
        Ok(())
    }
}

pub fn sound(faults: Vec<Fault>) -> Result<(), Damaged> {
    if faults.is_empty() { Ok(()) } else { Err(Damaged(faults)) }
}

pub fn faults(rows: &[Row]) -> Vec<(usize, String)> {
    let alone = rows.iter().enumerate().filter_map(|(k, row)| Some((k, alone(row).err()?)));
    let mut found: Vec<(usize, String)> = alone.chain(together(rows)).collect();
    found.sort();
    found.dedup_by_key(|fault| fault.0);
    found
}

fn alone(row: &Row) -> Result<(), String> {
    let (id, threads) = (&row.id, row.id.threads() as usize);
    let name = id.experiment.escape_default();
    must!(is_word(&id.experiment), "the experiment '{name}' is not a valid name");
    must!((2..=3).contains(&id.dim), "dim is {}; it must be 2 or 3", id.dim);
    must!(id.n <= u64::from(u32::MAX), "n is {}; at most 2^32 - 1 particles are numbered", id.n);
    let some = (1..=MOST_THREADS).contains(&threads);
    must!(some, "threads is {threads}; it must be 1 to {MOST_THREADS}");
    must!(row.time_ns != Some(0), "its time_ns is 0: nothing was measured");
    must!(row.time_ns.is_none() || row.block > 0, "it has a time, and block 0: blocks begin at 1");
    Ok(())
}

/// Whether the name has only letters, digits, `-`, `_` and `.`, and no `.` first. Experiments and
/// their files need such names.
pub fn is_word(name: &str) -> bool {
    !name.is_empty()
        && name.chars().all(|c| c.is_ascii_alphanumeric() || "-_.".contains(c))
        && !name.starts_with('.')
}

/// The rows with each value.
type Votes<'a> = BTreeMap<&'a str, Vec<usize>>;

fn together(rows: &[Row]) -> Vec<(usize, String)> {
    let mut votes: HashMap<(Projection, &str, &str), Votes<'_>> = HashMap::new();
    for (k, row) in rows.iter().enumerate() {
        let scene = done::scene(&row.id.clone().anywhere());
        let (hash, good) = (&row.stats.scene_hash, row.outcome == Outcome::Ok);
        let digest = row.digest.as_deref().filter(|_| good);
        let place = (scene.clone(), "digest", &*row.id.arithmetic);
        if let Some(digest) = digest {
            votes.entry(place).or_default().entry(digest).or_default().push(k);
        }
        if !hash.is_empty() {
            votes.entry((scene, "scene_hash", "")).or_default().entry(hash).or_default().push(k);
        }
    }
    let mut found = Vec::new();
    for ((_, what, _), votes) in votes {
        // If two values are equally frequent, the first one counts as right.
        let common = votes.iter().max_by_key(|(_, rows)| (rows.len(), usize::MAX - rows[0]));
        let Some((common, most)) = common.map(|(value, rows)| (*value, rows.len())) else {
            continue;
        };
        for (value, rows) in votes.iter().filter(|(value, _)| **value != common) {
            let words = format!(
                "its {what} is {value}, but {most} other rows of the same scene have {common}"
            );
            found.extend(rows.iter().map(|&row| (row, words.clone())));
        }
    }
    found
}
