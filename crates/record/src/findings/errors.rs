//! Errors compared with exact decisions, by cause: representation, predicate, search.

use std::collections::{BTreeMap, BTreeSet};

use crate::cells::errors::true_contacts;
use crate::cells::{AxisValue, Cell, CellId, label};
use crate::record::id::variable;
use crate::record::row::Outcome;
use contactbench_terms::errors::{Causes, Errors};

/// The errors of detectors with equal errors, for one scene and arithmetic.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorLine {
    pub detectors: String,
    pub arithmetic: String,
    pub scene: String,
    pub sum: Sum,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sum {
    pub cells: usize,
    pub contacts: f64,
    pub errors: Errors,
    /// Errors by cause; `None` if exact contacts of a cell are unknown.
    pub causes: Option<Causes>,
    pub outcomes: BTreeSet<Outcome>,
}

impl Sum {
    fn new(cells: &[&Cell]) -> Sum {
        let mut sum = Sum { causes: Some(Causes::default()), ..Sum::default() };
        for cell in cells {
            let Some(errors) = cell.errors else { continue };
            sum.cells += 1;
            sum.contacts += true_contacts(cell);
            sum.errors.add(&errors);
            sum.causes = sum.causes.zip(cell.causes).map(|(mut all, one)| {
                all.add(&one);
                all
            });
            sum.outcomes.insert(cell.overall().0);
        }
        sum
    }

    /// Whether each cause has 0 errors; errors of two causes can cancel in the total.
    fn none(&self) -> bool {
        let causes = self.causes.unwrap_or_default();
        let parts = [causes.representation, causes.predicate, causes.search, self.errors];
        parts.iter().all(|errors| errors.wrong() == 0)
    }

    /// Whether two detectors can share a line. Without errors, the number of cells does not matter.
    fn same(&self, other: &Sum) -> bool {
        let blind = |sum: &Sum| Sum { cells: 0, contacts: 0.0, ..sum.clone() };
        if self.none() && other.none() { blind(self) == blind(other) } else { self == other }
    }
}

/// Sums over n, seeds and orders, and over parameters whose cells have no errors.
pub fn lines(cells: &[&Cell]) -> Vec<ErrorLine> {
    let compared = |cell: &&&Cell| cell.errors.is_some() && cell.overall().0 != Outcome::Control;
    let cells: Vec<&Cell> = cells.iter().filter(compared).copied().collect();
    let swept = label::swept(&cells);
    type Place<'a> = (String, u32, &'a str);
    type Params = Vec<(String, AxisValue)>;
    let mut scenes: BTreeMap<Place, BTreeMap<Params, Vec<&Cell>>> = BTreeMap::new();
    for &cell in &cells {
        let CellId { dim, arithmetic, params, .. } = &cell.id;
        let params = params
            .iter()
            .map(|(name, value)| (variable(name), value.clone()))
            .filter(|(name, _)| swept.contains(name) && name != "path")
            .collect();
        scenes
            .entry((label::scene(&cell.id), *dim, arithmetic))
            .or_default()
            .entry(params)
            .or_default()
            .push(cell);
    }
    let mut found = Vec::new();
    for ((scene, dim, arithmetic), places) in &scenes {
        let mut lines: Vec<(String, Vec<&Cell>)> = Vec::new();
        let all: Vec<&Cell> = places.values().flatten().copied().collect();
        if Sum::new(&all).none() {
            lines.push((format!("{scene} {dim}D"), all));
        } else {
            for (params, cells) in places {
                let params: String =
                    params.iter().map(|(name, value)| format!(", {name} = {value}")).collect();
                lines.push((format!("{scene} {dim}D{params}"), cells.clone()));
            }
        }
        for (place, cells) in lines {
            for (detectors, sum) in folded(&cells) {
                let (arithmetic, scene) = (arithmetic.to_string(), place.clone());
                found.push(ErrorLine { detectors, arithmetic, scene, sum });
            }
        }
    }
    found
}
fn folded(cells: &[&Cell]) -> Vec<(String, Sum)> {
    let mut detectors: BTreeMap<String, Vec<&Cell>> = BTreeMap::new();
    for &cell in cells {
        detectors.entry(cell.id.subject()).or_default().push(cell);
    }
    let mut groups: Vec<(Vec<&str>, Sum)> = Vec::new();
    for (detector, cells) in &detectors {
        let sum = Sum::new(cells);
        match groups.iter_mut().find(|(_, known)| known.same(&sum)) {
            Some((names, known)) => {
                names.push(detector);
                if sum.contacts > known.contacts {
                    *known = sum;
                }
            }
            None => groups.push((vec![detector], sum)),
        }
    }
    let all: Vec<&str> = detectors.keys().map(String::as_str).collect();
    groups.into_iter().map(|(names, sum)| (label::group(&names, &all), sum)).collect()
}
