//! Which measured cell is a planned one.

use std::path::Path;

use crate::cells::CellId;
use crate::experiment::Planned;
use crate::record::done::FILE;
use crate::record::id::Projection;

/// What is the same in a planned cell and the measured one: a file and a hard case bring their own
/// particles, and of an `open` entrant the arithmetic is not known.
pub fn key(plan: &Planned, id: &CellId, open: bool) -> CellId {
    let mut key = id.clone().anywhere();
    if open {
        key.arithmetic.clear();
    }
    if plan.own_n.contains(&id.scene) {
        key.n = 0;
    }
    // A generator may have more parameters than when an older record was made.
    for (name, value) in plan.defaults.get(&(id.scene.clone(), id.dim)).into_iter().flatten() {
        key.params.entry(name.clone()).or_insert_with(|| value.clone());
    }
    if id.scene == FILE {
        key.dim = 0;
    }
    for name in FILES {
        if let Some(path) = key.params.get(name).map(ToString::to_string) {
            let file = Path::new(&path).file_name().unwrap_or_default().to_string_lossy();
            key.params.insert(name.into(), (&*file).into());
        }
    }
    key
}

/// Parameters that name files: of particles, and of a grading curve. (Points of a curve that are
/// written out are the end of themselves.)
const FILES: [&str; 2] = ["path", "grading"];

/// A file is named from the folder of the experiment; the record has the path that was opened.
pub fn same_file(planned: &CellId, measured: &CellId) -> bool {
    FILES.iter().all(|&name| {
        let path = |id: &CellId| id.params.get(name).map(ToString::to_string).unwrap_or_default();
        let (planned, measured) = (path(planned), path(measured));
        Path::new(&measured).ends_with(planned.trim_start_matches("./"))
    })
}

/// The scene of a cell, as it is planned.
pub fn scene(plan: &Planned, id: &CellId) -> Projection {
    key(plan, id, false).scene_id()
}
