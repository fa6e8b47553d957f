//! Checks that rows of one scene have one scene hash and one digest, and that their ids are valid.
//! A record with a fault is refused.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use crate::record::folder::{done, file};
use crate::record::id::Projection;
use crate::record::outcome::Outcome;
use crate::record::row::Row;
use contactbench_terms::must;
use contactbench_terms::text;

pub const MOST_THREADS: usize = 1024;

/// The first fault of a record: its file, with the line if the file has lines, and a sentence.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "{}; the record is damaged or was edited, and is not used: use an undamaged copy{}",
    text::line(.0),
    if .0.contains(file::FILE) {
        ", or remove this line, and measure it again with contactbench run ... --resume"
    } else {
        ""
    }
)]
pub struct Damaged(String);

impl Damaged {
    pub fn new(path: &Path, what: impl std::fmt::Display) -> Damaged {
        Damaged(format!("{}: {what}", path.display()))
    }

    pub fn at_line(path: &Path, line: usize, what: &str) -> Damaged {
        Damaged(format!("{}:{line}: {what}", path.display()))
    }
}

/// Returns the index and the fault of the first faulty row.
pub fn fault(rows: &[Row]) -> Option<(usize, String)> {
    let alone = rows.iter().enumerate().find_map(|(k, row)| Some((k, alone(row).err()?)));
    alone.or_else(|| together(rows))
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

/// Finds the first row whose scene hash or digest is not that of most rows of its scene.
fn together(rows: &[Row]) -> Option<(usize, String)> {
    // The rows with each value, by scene and column.
    let mut votes: HashMap<(Projection, &str, &str), BTreeMap<&str, Vec<usize>>> = HashMap::new();
    for (k, row) in rows.iter().enumerate() {
        let scene = done::scene(&row.id.clone().anywhere());
        let digest = row.digest.as_deref().filter(|_| row.outcome == Outcome::Ok);
        let hash = Some(&*row.stats.scene_hash).filter(|hash| !hash.is_empty());
        for (name, of, value) in [("digest", &*row.id.arithmetic, digest), ("scene_hash", "", hash)]
        {
            if let Some(value) = value {
                let votes = votes.entry((scene.clone(), name, of)).or_default();
                votes.entry(value).or_default().push(k);
            }
        }
    }
    let odd = votes.into_iter().filter_map(|((_, name, _), votes)| {
        // If two values are equally frequent, the first one counts as right.
        let common = votes.iter().max_by_key(|(_, rows)| (rows.len(), usize::MAX - rows[0]))?;
        let others = votes.iter().filter(|(value, _)| *value != common.0);
        let (value, rows) = others.min_by_key(|(_, rows)| rows[0])?;
        let (common, most) = (common.0, common.1.len());
        let words = "other rows of the same scene have";
        Some((rows[0], format!("its {name} is {value}, but {most} {words} {common}")))
    });
    odd.min()
}
