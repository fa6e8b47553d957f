//! Short names of cells: only what distinguishes them from the other cells shown.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::cells::Cell;
use crate::record::id::{CellId, FIELDS, MACHINE, OVER, Projection, split_subject};
use crate::record::value::AxisValue;
use contactbench_terms::number;

/// Returns the value of an axis; unlike [`CellId::axis`], a detector includes its parameters.
fn shown(id: &CellId, name: &str) -> Option<AxisValue> {
    if name == "detector" { Some(id.subject().as_str().into()) } else { id.axis(name) }
}

/// Returns what the cells of one sweep must share: scene, dimension, file and machine.
pub fn family(id: &CellId) -> (&str, u32, [Option<String>; 2]) {
    (&id.scene, id.dim, ["path", MACHINE].map(|name| id.axis(name).map(|value| value.to_string())))
}

/// Returns the name of the scene: a file without its folder. If there are several machines, the
/// machine is added.
pub fn scene(id: impl Into<Projection>) -> String {
    let id = id.into();
    let text = |name: &str| id.axis(name).map(|value| value.to_string());
    let path = text("path");
    let file = path.as_deref().and_then(|path| Path::new(path).file_name());
    let name = file.map(|name| name.to_string_lossy().into());
    let name = name.or_else(|| text("scene")).unwrap_or_default();
    match text(MACHINE) {
        Some(machine) => format!("{name} on {machine}"),
        None => name,
    }
}

/// Returns a title such as `packed, 2D, N = 1000, s = 20`. It names the parameters in `swept`, and
/// other axes that are not at their default.
pub fn title(id: impl Into<Projection>, swept: &[String]) -> String {
    let id = id.into();
    let mut title = scene(&id);
    let text = |name: &str| id.axis(name).map(|value| value.to_string());
    title += &text("dim").map_or(String::new(), |dim| format!(", {dim}D"));
    title += &text("n").map_or(String::new(), |n| format!(", N = {n}"));
    for (name, value) in id.parameters() {
        if swept.contains(name) && !["path", MACHINE].contains(&name.as_str()) {
            title += &format!(", {name} = {value}");
        }
    }
    let order = text("order").filter(|order| order != "shuffled");
    title + &order.map_or(String::new(), |order| format!(", {order}"))
}

/// Returns the parameters of scenes that differ within one scene and dimension.
pub fn swept(cells: &[&Cell]) -> Vec<String> {
    let mut scenes: BTreeMap<(&str, u32), Vec<BTreeMap<String, AxisValue>>> = BTreeMap::new();
    for cell in cells {
        let params = cell.id.parameters().into_iter().collect();
        scenes.entry((&cell.id.scene, cell.id.dim)).or_default().push(params);
    }
    let mut names = BTreeSet::new();
    for cells in scenes.values() {
        let known: BTreeSet<&String> = cells.iter().flat_map(BTreeMap::keys).collect();
        let differs =
            |name: &&String| cells.iter().any(|params| params.get(*name) != cells[0].get(*name));
        names.extend(known.into_iter().filter(differs).cloned());
    }
    names.into_iter().collect()
}

pub fn varying(cells: &[&Cell]) -> Vec<String> {
    let mut names = swept(cells);
    let differs =
        |name: &&str| cells.iter().any(|it| shown(&it.id, name) != shown(&cells[0].id, name));
    names.extend(FIELDS.iter().copied().filter(differs).map(String::from));
    let first = ["detector", "arithmetic", "scene", "dim", "n"];
    names.sort_by_key(|name| first.iter().position(|it| it == name).unwrap_or(9));
    names
}

/// Returns the values of these fields, such as `nbs, packed, 2D, n = 1000, s = 2`.
pub fn place(id: impl Into<Projection>, fields: &[String]) -> String {
    let id = id.into();
    let part = |name: &String| match (name.as_str(), id.axis(name)?) {
        ("detector" | "scene" | "arithmetic" | "order", value) => Some(value.to_string()),
        ("dim", value) => Some(format!("{value}D")),
        (name, value) => Some(format!("{name} = {value}")),
    };
    let parts: Vec<String> = fields.iter().filter_map(part).collect();
    if parts.is_empty() { "its only cell".into() } else { parts.join(", ") }
}

/// Shortens names of trackers to rule and skin if all trackers have the same detector.
pub fn brief<'a>(names: impl Iterator<Item = &'a str>) -> impl Fn(&str) -> String {
    let over: BTreeSet<Option<AxisValue>> =
        names.map(|name| split_subject(name).1.remove(OVER)).collect();
    let same = over.len() == 1 && !over.contains(&None);
    move |name| {
        if !same {
            return name.into();
        }
        let (tracker, mut params) = split_subject(name);
        params.remove(OVER);
        let said: Vec<String> = params.values().map(AxisValue::to_string).collect();
        if said.is_empty() { tracker.replace('-', " ") } else { said.join(", ") }
    }
}

/// Names a group of detectors: `all`, `all but direct`, or a list of names.
pub fn group(names: &[&str], all: &[&str]) -> String {
    let others: Vec<&str> = all.iter().filter(|name| !names.contains(name)).copied().collect();
    match others.len() {
        0 => "all".into(),
        1 if names.len() > 2 => format!("all but {}", others[0]),
        _ => names.join(", "),
    }
}

/// Lists what differs among the cells, such as `s = 2 to 200; nbs, direct; 5 seeds`.
pub fn over(cells: &[&Cell]) -> String {
    let mut parts = Vec::new();
    for name in varying(cells).iter().filter(|name| *name != "experiment") {
        let values: BTreeSet<AxisValue> =
            cells.iter().filter_map(|cell| shown(&cell.id, name)).collect();
        let number = |value: Option<&AxisValue>| value.and_then(AxisValue::number);
        match (number(values.first()), number(values.last())) {
            (Some(low), Some(high)) if values.len() > 2 => {
                parts.push(format!("{name} = {low} to {high}"))
            }
            _ if values.len() <= 3 => {
                let list: Vec<String> = values.iter().map(AxisValue::to_string).collect();
                let named = number(values.first()).map(|_| format!("{name} = "));
                parts.push(named.unwrap_or_default() + &list.join(", "));
            }
            _ => parts.push(number::plural(values.len(), name.trim_end_matches('s'))),
        }
    }
    if parts.is_empty() { "its only cell".into() } else { parts.join("; ") }
}
