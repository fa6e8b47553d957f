//! Checks that rows of one scene have one scene hash and one digest. A record with a fault is
//! refused.

use std::collections::HashMap;
use std::path::Path;

use crate::record::folder::{done, file};
use crate::record::id::Projection;
use crate::record::outcome::Outcome;
use crate::record::row::Row;
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

/// Whether the name has only letters, digits, `-`, `_` and `.`, and no `.` first. Experiments and
/// their files need such names.
pub fn is_word(name: &str) -> bool {
    !name.is_empty()
        && name.chars().all(|c| c.is_ascii_alphanumeric() || "-_.".contains(c))
        && !name.starts_with('.')
}

/// Returns the index of the first row whose scene hash or digest is not that of earlier rows of its
/// scene, and a sentence about it.
pub fn fault(rows: &[Row]) -> Option<(usize, String)> {
    let mut known: HashMap<(Projection, &str, &str), &str> = HashMap::new();
    for (k, row) in rows.iter().enumerate() {
        let scene = done::scene(&row.id.clone().anywhere());
        let digest = row.digest.as_deref().filter(|_| row.outcome == Outcome::Ok);
        let hash = Some(&*row.stats.scene_hash).filter(|hash| !hash.is_empty());
        for (name, of, value) in [("digest", &*row.id.arithmetic, digest), ("scene_hash", "", hash)]
        {
            let Some(value) = value else { continue };
            let first = *known.entry((scene.clone(), name, of)).or_insert(value);
            if first != value {
                let words = "earlier rows of the same scene have";
                return Some((k, format!("its {name} is {value}, but {words} {first}")));
            }
        }
    }
    None
}
