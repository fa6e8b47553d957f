//! Naming cells: what must be said of a cell to tell it from the others at hand, and no more.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::keyed::MACHINE;
use super::text;
use super::value::{Cell, FIELDS, Key, Num, Param};

fn differ<'a>(cells: impl Iterator<Item = &'a Cell>, name: &str) -> bool {
    cells.map(|cell| cell.key.field(name)).collect::<BTreeSet<_>>().len() > 1
}

/// What may be swept together: a scene in its dimension. Two files are two scenes, and what two machines measured is not one.
pub fn family(key: &Key) -> (&str, u32, [Option<String>; 2]) {
    (&key.scene, key.dim, ["path", MACHINE].map(|name| key.field(name).map(|value| value.to_string())))
}

/// The scene's name: of a file its own, without folders; where there are several machines, with the machine.
pub fn scene(key: &Key) -> String {
    let path = key.field("path").map(|path| path.to_string());
    let name = path.as_deref().and_then(|path| Path::new(path).file_name()).map_or(key.scene.clone(), |name| name.to_string_lossy().into());
    match key.field(MACHINE) {
        Some(machine) => format!("{name} on {machine}"),
        None => name,
    }
}

/// The parameters that differ within one scene and dimension.
pub fn swept(cells: &[&Cell]) -> Vec<String> {
    let mut scenes: BTreeMap<(&str, u32), Vec<&Cell>> = BTreeMap::new();
    for cell in cells {
        scenes.entry((&cell.key.scene, cell.key.dim)).or_default().push(cell);
    }
    let mut names = BTreeSet::new();
    for cells in scenes.values() {
        let params: BTreeSet<&str> = cells.iter().flat_map(|cell| cell.key.params.iter().map(|(name, _)| name.as_str())).collect();
        names.extend(params.into_iter().filter(|name| differ(cells.iter().copied(), name)).map(String::from));
    }
    names.into_iter().collect()
}

/// The fields in which cells differ, and the parameters that are swept: those that differ within one scene and dimension. (That two
/// scenes have different parameters goes without saying.)
pub fn varying(cells: &[&Cell]) -> Vec<String> {
    let mut names = swept(cells);
    names.extend(FIELDS.iter().filter(|name| differ(cells.iter().copied(), name)).map(|name| name.to_string()));
    // what is compared first, then where
    names.sort_by_key(|name| ["detector", "arithmetic", "scene", "dim", "n"].iter().position(|first| first == name).unwrap_or(9));
    names
}

/// `nbs, packed, 2D, n = 1000, s = 2`, of these fields.
pub fn place(key: &Key, fields: &[String]) -> String {
    let part = |name: &String| match (name.as_str(), key.field(name)?) {
        ("detector" | "scene" | "arithmetic" | "order", value) => Some(value.to_string()),
        ("dim", value) => Some(format!("{value}D")),
        (name, value) => Some(format!("{name} = {value}")),
    };
    let parts: Vec<String> = fields.iter().filter_map(part).collect();
    if parts.is_empty() { "its only cell".into() } else { parts.join(", ") }
}

/// `s = 2..200, n = 100..10000` for the numbers that vary, and how many of the rest.
pub fn over(cells: &[&Cell]) -> String {
    let mut parts = Vec::new();
    for name in varying(cells).iter().filter(|name| *name != "experiment") {
        let values: BTreeSet<Param> = cells.iter().filter_map(|cell| cell.key.field(name)).collect();
        match (values.first(), values.last()) {
            (Some(Param::Number(Num(low))), Some(Param::Number(Num(high)))) if values.len() > 2 => {
                parts.push(format!("{name} = {low}..{high}"))
            }
            _ if values.len() <= 3 => {
                let list: Vec<String> = values.iter().map(Param::to_string).collect();
                let list = list.join(", ");
                parts.push(if matches!(values.first(), Some(Param::Number(_))) { format!("{name} = {list}") } else { list });
            }
            _ => parts.push(text::plural(values.len(), name)),
        }
    }
    if parts.is_empty() { "its only cell".into() } else { parts.join("; ") }
}
