//! Matches measured cells to planned ones.

use std::path::Path;

use crate::cells::CellId;
use crate::experiment::Planned;
use crate::record::folder::done::FILE;
use crate::record::id::Projection;

/// The common key of a planned cell and its measurement. Files and hard cases determine their own
/// n; if `open`, the arithmetic is not known in advance.
pub fn key(plan: &Planned, id: &CellId, open: bool) -> CellId {
    let mut key = id.clone().anywhere();
    if open {
        key.arithmetic.clear();
    }
    if plan.own_n.contains(&id.scene) {
        key.n = 0;
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

const FILES: [&str; 2] = ["path", "grading"];

/// Compares a path relative to the experiment with the path that was opened.
pub fn same_file(planned: &CellId, measured: &CellId) -> bool {
    FILES.iter().all(|&name| {
        let path = |id: &CellId| id.params.get(name).map(ToString::to_string).unwrap_or_default();
        let (planned, measured) = (path(planned), path(measured));
        Path::new(&measured).ends_with(planned.trim_start_matches("./"))
    })
}

pub fn scene(plan: &Planned, id: &CellId) -> Projection {
    key(plan, id, false).scene_id()
}
