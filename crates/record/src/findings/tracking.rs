//! Moving scenes: displacements, how often each tracker rebuilt its list, and missed contacts.

use std::collections::{BTreeMap, BTreeSet};

use crate::cells::label::{brief, swept, title};
use crate::cells::{Cell, CellId};
use contactbench_terms::arithmetic::Arithmetic;

#[derive(Clone, Debug)]
pub struct Tracking<'a> {
    pub trackers: Vec<String>,
    pub arithmetic: Option<String>,
    pub scenes: Vec<Scene<'a>>,
}

/// Results of the trackers on one scene. Displacements are in diameters of its largest particle.
#[derive(Clone, Debug)]
pub struct Scene<'a> {
    pub title: String,
    /// Mean displacement per frame.
    pub mean_way: Option<f64>,
    pub longest_way: Option<f64>,
    pub contacts: Option<f64>,
    pub born: Option<f64>,
    /// One cell per tracker, in the order of the trackers; `None` if there is no answer.
    pub done: Vec<Option<&'a Cell>>,
}

impl<'a> Tracking<'a> {
    /// Uses the cells in exact arithmetic if there are some; returns `None` if nothing moves.
    pub fn new(cells: &[&'a Cell]) -> Option<Tracking<'a>> {
        let mut own: Vec<&'a Cell> = cells.to_vec();
        own.retain(|cell| !cell.role.is_control() && cell.values.contains_key("builds"));
        let arithmetics: BTreeSet<&str> =
            own.iter().map(|cell| cell.id.arithmetic.as_str()).collect();
        let arithmetic = match arithmetics.contains(Arithmetic::Exact.name()) {
            true => Arithmetic::Exact.name(),
            false => arithmetics.first()?,
        };
        let arithmetic = arithmetic.to_string();
        let several = arithmetics.len() > 1;
        own.retain(|cell| cell.id.arithmetic == arithmetic);
        let names: BTreeSet<String> = own.iter().map(|cell| cell.id.subject()).collect();
        let called = brief(names.iter().map(String::as_str));
        let swept = swept(&own);
        let mut scenes: BTreeMap<_, (&CellId, BTreeMap<String, &'a Cell>)> = BTreeMap::new();
        for &cell in &own {
            let (_, done) = scenes.entry(cell.id.scene_id()).or_insert((&cell.id, BTreeMap::new()));
            done.insert(cell.id.subject(), cell);
        }
        // Missed contacts are known only if answers were compared.
        let judged = |cell: &&Cell| cell.values.contains_key("search_missed");
        let scene = |(id, done): &(&CellId, BTreeMap<String, &'a Cell>)| {
            let frames = done.values().next().map_or(1.0, |cell| cell.frames());
            let value = |name: &str| done.values().find_map(|cell| cell.variable(name, None));
            let steps = (frames - 1.0).max(1.0);
            Scene {
                title: title(*id, &swept),
                mean_way: value("mean_way"),
                longest_way: value("longest_way"),
                contacts: value("true_contacts").map(|all| all / frames),
                born: value("born").map(|all| all / steps),
                done: names.iter().map(|name| done.get(name).copied().filter(judged)).collect(),
            }
        };
        Some(Tracking {
            trackers: names.iter().map(|name| called(name)).collect(),
            arithmetic: several.then_some(arithmetic),
            scenes: scenes.values().map(scene).collect(),
        })
    }
}
