//! The measurements that a record already contains, for resuming a run, perhaps on another machine.

use std::collections::{HashMap, HashSet};

use crate::record::id::{CellId, Projection};
use crate::record::outcome::{Outcome, Pass};
use crate::record::row::{Measurement, Row};

pub const FILE: &str = "file";

pub struct Index {
    measured: HashSet<Measurement>,
    /// Cells that ended badly, with the first bad row. A resumed run measures nothing more there.
    ended: HashMap<Tried, Row>,
    /// The hash and the last block of each scene.
    scenes: HashMap<Projection, (String, u32)>,
}

/// A subject on a scene, and whether it was timed as copies. Failed copies do not affect other
/// passes.
type Tried = (CellId, bool);

fn tried(row: &Row) -> Tried {
    (row.id.clone().anywhere(), row.pass == Pass::Ceiling)
}

/// Returns the scene of a row, without the subject. A file determines its own n and dimension.
pub fn scene(id: &CellId) -> Projection {
    let scene = id.scene_id();
    if id.scene == FILE { scene.without(&["dim", "n"]) } else { scene }
}

impl Index {
    pub fn new(rows: &[Row]) -> Index {
        let mut ended = HashMap::new();
        for row in rows.iter().filter(|row| row.outcome.is_final()) {
            ended.entry(tried(row)).or_insert_with(|| row.clone());
        }
        let mut scenes: HashMap<Projection, (String, u32)> = HashMap::new();
        for row in rows {
            let (hash, last) = scenes.entry(scene(&row.id.clone().anywhere())).or_default();
            *last = row.block.max(*last);
            if !row.stats.scene_hash.is_empty() {
                hash.clone_from(&row.stats.scene_hash);
            }
        }
        Index { scenes, measured: rows.iter().map(Row::anywhere).collect(), ended }
    }

    pub fn scene_hash(&self, row: &Row) -> Option<&str> {
        self.of(row).map(|(hash, _)| &**hash).filter(|hash| !hash.is_empty())
    }

    /// The last block of the row's scene.
    pub fn blocks(&self, row: &Row) -> u32 {
        self.of(row).map_or(0, |(_, last)| *last)
    }

    fn of(&self, row: &Row) -> Option<&(String, u32)> {
        self.scenes.get(&scene(&row.id.clone().anywhere()))
    }

    pub fn has(&self, row: &Row) -> bool {
        self.measured.contains(&row.anywhere())
    }

    pub fn ended(&self, row: &Row) -> Option<&Row> {
        self.ended.get(&tried(row))
    }
}

/// The smallest n at which a detector was too slow, for each series.
#[derive(Default)]
pub struct TooSlow(HashMap<(Projection, bool), u64>);

impl TooSlow {
    pub fn new(rows: &[Row]) -> TooSlow {
        let mut slow = TooSlow::default();
        rows.iter().filter(|row| row.outcome == Outcome::Timeout).for_each(|row| slow.note(row));
        slow
    }

    pub fn note(&mut self, row: &Row) {
        let n = self.0.entry(series(row)).or_insert(row.id.n);
        *n = row.id.n.min(*n);
    }

    pub fn at(&self, row: &Row) -> Option<u64> {
        self.0.get(&series(row)).copied().filter(|&n| n <= row.id.n)
    }
}

fn series(row: &Row) -> (Projection, bool) {
    let (id, copies) = tried(row);
    (id.without(&["n"]), copies)
}
