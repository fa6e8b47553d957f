//! Sizes and ids of particles in arrays of their own.

use anyhow::ensure;

use crate::columns::Column;
use crate::raw::lines::{among, exact, short};
use crate::raw::room::room;
use crate::types::{Notice, RadiusSource, assumed};

/// An array of sizes.
pub struct Size {
    pub values: Vec<f64>,
    pub column: Column,
    pub label: String,
    /// Whether there is one value per cell instead of one per point.
    pub of_cells: bool,
}

impl Size {
    pub fn radii(self) -> (RadiusSource, Option<Vec<f64>>) {
        let source = match self.column {
            Column::Diameter => RadiusSource::Halved(self.label),
            _ => RadiusSource::Column(self.label),
        };
        (source, Some(self.values))
    }
}

/// Largest relative difference of sizes that agree.
const ALIKE: f64 = 1e-6;

/// Returns the radii, else the diameters; arrays of sizes that differ are refused.
pub(crate) fn one_of(
    sizes: Vec<Size>,
    name: &str,
    notices: &mut Vec<Notice>,
) -> anyhow::Result<Option<Size>> {
    let first = sizes.iter().position(|size| size.column == Column::Radius).unwrap_or(0);
    for (_, other) in sizes.iter().enumerate().filter(|(k, _)| *k != first) {
        let taken = &sizes[first];
        let (a, b) = (short(&taken.label), short(&other.label));
        let alike = |(x, y): (&f64, &f64)| (x - y).abs() <= ALIKE * x.max(*y);
        let pairs = || taken.values.iter().zip(&other.values);
        ensure!(
            taken.values.len() == other.values.len() && pairs().all(alike),
            "{name}: the sizes in '{a}' and '{b}' differ; choose one: --columns r={a} or d={b}"
        );
        notices.push(assumed!("the sizes in '{a}' and '{b}' agree; '{a}' is taken"));
    }
    Ok(sizes.into_iter().nth(first))
}

/// An array of ids.
#[derive(Clone)]
pub struct Ids {
    pub label: String,
    /// The ids; `None` if a number is not whole or not exact in f64.
    values: Option<Vec<i64>>,
    /// Whether the array is named like a column of ids, or was chosen.
    sure: bool,
}

impl Ids {
    const NAMES: &str = "ids globalid globalids globalpointids globalnodeid globalnodeids";

    pub fn is_named(label: &str, column: Column) -> bool {
        column == Column::Id || among(Ids::NAMES, &label.to_ascii_lowercase())
    }

    pub fn new(label: &str, column: Column) -> Ids {
        Ids { label: label.into(), values: Some(Vec::new()), sure: column == Column::Id }
    }

    pub fn push(&mut self, value: f64) -> anyhow::Result<()> {
        match (exact(value), &mut self.values) {
            (Some(id), Some(values)) => {
                room(values)?;
                values.push(id);
            }
            _ => self.values = None,
        }
        Ok(())
    }

    /// Returns the ids of `n` particles, preferably from a column of ids. Other arrays named like
    /// ids are used if no number repeats.
    pub fn of(mut all: Vec<Ids>, n: usize) -> Option<Vec<i64>> {
        let differ = |values: &[i64]| {
            let mut seen = values.to_vec();
            seen.sort_unstable();
            seen.windows(2).all(|two| two[0] != two[1])
        };
        all.sort_by_key(|ids| !ids.sure);
        all.into_iter()
            .filter(|ids| ids.sure || ids.values.as_deref().is_some_and(differ))
            .filter_map(|ids| ids.values)
            .find(|values| values.len() == n)
    }
}
