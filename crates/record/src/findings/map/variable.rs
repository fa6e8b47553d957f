//! The axes of a map: their values in order, and the position of each cell on them.

use std::collections::BTreeSet;

use anyhow::bail;

use super::Axis;
use crate::cells::{AxisValue, Cell};
use crate::record::id::{THREADS, variable};
use contactbench_terms::nearest::hint;

pub(super) const MOST_VALUES: usize = 12;
/// Factor within which measured values share a place, unless a map then has too many places.
const NEAR: f64 = 1.1;
/// Columns that describe the scene, whatever the subject.
const OF_SCENES: [&str; 8] = [
    "packing_fraction",
    "coordination",
    "radius_ratio",
    "mean_way",
    "longest_way",
    "born",
    "ended",
    "at_rest",
];
pub(super) struct Variable {
    pub name: String,
    values: Values,
    /// Subjects without this axis, named with parameters. They take part at all its values.
    free: BTreeSet<String>,
}

enum Values {
    Known(Vec<AxisValue>),
    Measured(Vec<(f64, f64)>),
}

pub(super) enum Place {
    At(usize),
    Everywhere,
    Nowhere,
}

impl Variable {
    pub fn new(name: &str, cells: &[&Cell]) -> anyhow::Result<Variable> {
        let name = variable(name);
        if cells.iter().any(|cell| cell.id.axis(&name).is_some()) {
            let values: BTreeSet<AxisValue> =
                cells.iter().filter_map(|cell| cell.id.axis(&name)).collect();
            let free = free(&name, cells);
            return Ok(Variable {
                name,
                values: Values::Known(values.into_iter().collect()),
                free,
            });
        }
        let measured = || cells.iter().filter_map(|cell| of_scene(cell, &name));
        let mut numbers: Vec<f64> = measured().filter(|value| value.is_finite()).collect();
        if numbers.is_empty() {
            let named = cells.iter().flat_map(|cell| cell.id.names());
            let has = |name: &&str| cells.iter().any(|cell| of_scene(cell, name).is_some());
            let measured = OF_SCENES.iter().copied().filter(has).map(String::from);
            let known: BTreeSet<String> = named.chain(measured).collect();
            // The name that the options `--x` and `--y` accept.
            let plain = |name| if name == "packing_fraction" { "density" } else { name };
            let known: Vec<&str> = known.iter().map(|name| plain(name.as_str())).collect();
            bail!(
                "these cells have no '{name}' of a scene or a detector{}; there are: {}",
                hint(&name, known.iter().copied()),
                known.join(", ")
            );
        }
        numbers.sort_by(f64::total_cmp);
        Ok(Variable { name, values: Values::Measured(classes(&numbers)), free: BTreeSet::new() })
    }

    pub fn place(&self, cell: &Cell) -> Place {
        if self.free.contains(&cell.id.subject()) {
            return Place::Everywhere;
        }
        let found = match &self.values {
            Values::Known(values) => {
                cell.id.axis(&self.name).and_then(|value| values.binary_search(&value).ok())
            }
            Values::Measured(classes) => of_scene(cell, &self.name)
                .and_then(|value| classes.iter().position(|it| (it.0..=it.1).contains(&value))),
        };
        found.map_or(Place::Nowhere, Place::At)
    }

    pub fn axis(&self) -> Axis {
        let values = match &self.values {
            Values::Known(values) => values.iter().map(AxisValue::to_string).collect(),
            Values::Measured(classes) => classes.iter().map(|&class| shown(class)).collect(),
        };
        Axis { name: self.name.clone(), values }
    }
}

fn of_scene(cell: &Cell, name: &str) -> Option<f64> {
    OF_SCENES.contains(&name).then(|| cell.variable(name, None)).flatten()
}

fn free(name: &str, cells: &[&Cell]) -> BTreeSet<String> {
    let bound = |cell: &&&Cell| match name {
        THREADS => cell.id.threads() > 1,
        _ => cell.id.detector_parameters().any(|(own, _)| own == name),
    };
    let all = |cells: &mut dyn Iterator<Item = &&Cell>| -> BTreeSet<String> {
        cells.map(|cell| cell.id.subject()).collect()
    };
    let bound = all(&mut cells.iter().filter(bound));
    if bound.is_empty() {
        bound
    } else {
        all(&mut cells.iter()).difference(&bound).cloned().collect()
    }
}

pub(super) fn classes(sorted: &[f64]) -> Vec<(f64, f64)> {
    let mut near = NEAR;
    loop {
        let mut found: Vec<(f64, f64)> = Vec::new();
        for &value in sorted {
            match found.last_mut() {
                Some(class) if value <= class.0 + (near - 1.0) * class.0.abs() => class.1 = value,
                _ => found.push((value, value)),
            }
        }
        if found.len() <= MOST_VALUES || near > 1e6 {
            return found;
        }
        near *= 1.2;
    }
}

/// Formats a range such as `0.52 to 0.56`, with two digits.
pub(super) fn shown((low, high): (f64, f64)) -> String {
    let digits = |value: f64| -> String {
        let rounded: f64 = format!("{value:.1e}").parse().unwrap_or(value);
        rounded.to_string()
    };
    let (low, high) = (digits(low), digits(high));
    if low == high { low } else { format!("{low} to {high}") }
}
