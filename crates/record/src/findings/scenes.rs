//! The table of details: every subject on every shown scene, in every measured setting.

use std::collections::BTreeSet;

use crate::cells::Cell;
use crate::findings::claim::every::{Scene, every};
use crate::findings::winners::{by_ratio, time};
use contactbench_terms::number::plural;

pub struct SceneResults<'a> {
    pub title: String,
    pub n: f64,
    pub fastest: Option<&'a Cell>,
    /// Name and cell of each subject, the fastest first.
    pub cells: Vec<(String, &'a Cell)>,
}

pub fn scenes<'a>(cells: &[&'a Cell]) -> Vec<SceneResults<'a>> {
    every(cells).into_iter().filter(|scene| scene.shown).map(results).collect()
}

fn results(scene: Scene<'_>) -> SceneResults<'_> {
    let right = |cell: &&Cell| !cell.role.is_control() && time(cell).is_finite();
    let (right, others): (Vec<&Cell>, Vec<&Cell>) = scene.cells.into_iter().partition(right);
    let right = by_ratio(right);
    let fastest = right.first().copied();
    let mut cells = [right, others].concat();
    let place = |cell: &Cell| {
        let ratio = fastest.and_then(|fastest| cell.ratio(fastest));
        ratio.map_or(f64::INFINITY, |ratio| ratio.median)
    };
    cells.sort_by(|a, b| place(a).total_cmp(&place(b)));
    let several = |field: &str| {
        cells.iter().map(|cell| cell.id.axis(field)).collect::<BTreeSet<_>>().len() > 1
    };
    let (arithmetics, threads) = (several("arithmetic"), several("threads"));
    let name = |cell: &Cell| {
        let mut name = cell.id.subject();
        if arithmetics {
            name += &format!(" {}", cell.id.arithmetic);
        }
        if threads {
            name += &format!(" ({})", plural(cell.id.threads() as usize, "thread"));
        }
        name
    };
    let cells = cells.iter().map(|cell| (name(cell), *cell)).collect();
    SceneResults { title: scene.title, n: scene.n.max(1) as f64, fastest, cells }
}
