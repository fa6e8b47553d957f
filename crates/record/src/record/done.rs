//! What a record holds already: what is not measured again, what is still owed, and which
//! detectors were too slow. A run may be resumed on another machine.

use std::collections::{HashMap, HashSet};

use crate::record::id::{CellId, Projection};
use crate::record::outcome::{Outcome, Pass};
use crate::record::row::{Measurement, Row};

/// The scene that is read from a file.
pub const FILE: &str = "file";

pub struct Index {
    measured: HashSet<Measurement>,
    /// Cells that ended badly, with the first row that says so: nothing more is to be measured
    /// there.
    ended: HashMap<Tried, Row>,
    /// The fingerprints of the scenes, by what was asked for.
    scenes: HashMap<Projection, String>,
}

/// A subject on a scene, and whether copies were measured: failed copies decide nothing for the
/// rest.
type Tried = (CellId, bool);

fn tried(row: &Row) -> Tried {
    (row.id.clone().anywhere(), row.pass == Pass::Ceiling)
}

fn anywhere(row: &Row) -> Measurement {
    Measurement { id: row.id.clone().anywhere(), ..row.measurement() }
}

/// Returns the scene of a row, whatever was measured on it. A file decides how many particles there
/// are, and in how many dimensions.
pub fn scene(id: &CellId) -> Projection {
    let scene = id.scene_id();
    if id.scene == FILE { scene.without(&["dim", "n"]) } else { scene }
}

/// What tells a timed sample from all others: its cell, its machine in it, what was timed, when it
/// began, and where.
pub(crate) type Began = (CellId, Pass, u64, Option<u32>);

/// Which sample a row is of; none where nothing was timed, or it is not known when.
pub fn began(row: &Row) -> Option<Began> {
    row.time_ns?;
    Some((row.id.clone(), row.pass, row.began_ms?, row.processor))
}

/// What a timed row measured.
pub fn times(row: &Row) -> ([Option<u64>; 6], &[u64], Option<&str>) {
    (
        [row.time_ns, row.calls, row.elapsed_ns, row.first_ns, row.alone_ns, row.building_ns],
        &row.rounds_ns,
        row.digest.as_deref(),
    )
}

impl Index {
    pub fn new(rows: &[Row]) -> Index {
        let mut ended = HashMap::new();
        for row in rows.iter().filter(|row| row.outcome.is_final()) {
            ended.entry(tried(row)).or_insert_with(|| row.clone());
        }
        let made = rows.iter().filter(|row| !row.stats.scene_hash.is_empty());
        let scenes = made
            .map(|row| (scene(&row.id.clone().anywhere()), row.stats.scene_hash.clone()))
            .collect();
        Index { scenes, measured: rows.iter().map(anywhere).collect(), ended }
    }

    /// The fingerprint that the record gives of a row's scene, if it has rows of it.
    pub fn scene_hash(&self, row: &Row) -> Option<&str> {
        self.scenes.get(&scene(&row.id.clone().anywhere())).map(String::as_str)
    }

    pub fn has(&self, row: &Row) -> bool {
        self.measured.contains(&anywhere(row))
    }

    pub fn ended(&self, row: &Row) -> Option<&Row> {
        self.ended.get(&tried(row))
    }
}

/// Where in a sweep a detector has been too slow already: the fewest particles, by everything else
/// that makes the cell.
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

    /// The number of particles, not above the row's, at which its detector was too slow.
    pub fn at(&self, row: &Row) -> Option<u64> {
        self.0.get(&series(row)).copied().filter(|&n| n <= row.id.n)
    }
}

fn series(row: &Row) -> (Projection, bool) {
    let (id, copies) = tried(row);
    (id.without(&["n"]), copies)
}
