//! What a record holds already, by cell: what is not measured again, what is still owed, and which detectors were too slow.

use std::collections::{HashMap, HashSet};

use super::record::{Outcome, Pass, Row};
use crate::scene::generate::file;

/// What the record holds already.
pub(super) struct Index {
    keys: HashSet<String>,
    /// Cells that ended badly, with the first row that says so: nothing more is to be measured there.
    ended: HashMap<String, Row>,
    /// The fingerprints of the scenes, by what was asked for.
    scenes: HashMap<String, String>,
}

impl Index {
    pub fn new(rows: &[Row]) -> Index {
        let mut ended = HashMap::new();
        for row in rows.iter().filter(|row| is_final(row.outcome)) {
            ended.entry(Index::cell(row)).or_insert_with(|| row.clone());
        }
        let made = rows.iter().filter(|row| !row.stats.scene_hash.is_empty());
        let scenes = made.map(|row| (Index::scene(row), row.stats.scene_hash.clone())).collect();
        Index { scenes, keys: rows.iter().map(Row::key).collect(), ended }
    }

    /// The key of the detector on its scene, whatever the pass; but that its copies failed says nothing about the detector.
    pub fn cell(row: &Row) -> String {
        let pass = if row.pass == Pass::Ceiling { Pass::Ceiling } else { Pass::Count };
        Row { pass, block: 0, ..row.clone() }.key()
    }

    /// The key of the scene, whoever looks at it. A file decides how many elements there are, and in how many dimensions.
    pub fn scene(row: &Row) -> String {
        let (dim, n) = if row.scene == file::NAME { (0, 0) } else { (row.dim, row.n) };
        let nobody = || (String::new(), String::new());
        let (detector, arithmetic) = nobody();
        Row { detector, arithmetic, threads: 0, pass: Pass::Count, block: 0, dim, n, ..row.clone() }.key()
    }

    /// The fingerprint that the record gives of a row's scene, if it has rows of it.
    pub fn scene_hash(&self, row: &Row) -> Option<&str> {
        self.scenes.get(&Index::scene(row)).map(String::as_str)
    }

    pub fn has(&self, row: &Row) -> bool {
        self.keys.contains(&row.key())
    }

    pub fn ended(&self, row: &Row) -> Option<&Row> {
        self.ended.get(&Index::cell(row))
    }
}

/// After these the detector is not asked again on this scene.
fn is_final(outcome: Outcome) -> bool {
    !matches!(outcome, Outcome::Ok | Outcome::Control | Outcome::Wrong)
}

/// The passes that fall with a failed one, itself included.
pub(super) fn rest(pass: Pass) -> &'static [Pass] {
    match pass {
        Pass::Count => &[Pass::Count, Pass::Memory, Pass::Time],
        Pass::Memory => &[Pass::Memory, Pass::Time],
        Pass::Time => &[Pass::Time],
        Pass::Ceiling => &[Pass::Ceiling],
    }
}

/// The passes whose rows follow that of a failed one.
pub(super) fn owed(failed: Pass) -> &'static [Pass] {
    &rest(failed)[1..]
}

/// Where in a sweep a detector has been too slow already: the fewest elements, by everything else that makes the cell.
#[derive(Default)]
pub(super) struct TooSlow(HashMap<String, u64>);

impl TooSlow {
    /// What the time limits met in a record say.
    pub fn new(rows: &[Row]) -> TooSlow {
        let mut slow = TooSlow::default();
        rows.iter().filter(|row| row.outcome == Outcome::Timeout).for_each(|row| slow.note(row));
        slow
    }

    /// This row's detector met the time limit.
    pub fn note(&mut self, row: &Row) {
        let n = self.0.entry(series(row)).or_insert(row.n);
        *n = row.n.min(*n);
    }

    /// The number of elements, not above the row's, at which its detector was too slow.
    pub fn at(&self, row: &Row) -> Option<u64> {
        self.0.get(&series(row)).copied().filter(|&n| n <= row.n)
    }
}

/// The cell but for its number of elements: what a sweep over N keeps.
fn series(row: &Row) -> String {
    Index::cell(&Row { n: 0, ..row.clone() })
}
