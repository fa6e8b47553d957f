//! The value of an expression for a cell.
//!
//! Variables are measured columns, numbers of the cell's id, and numeric parameters of the scene.
//! In their names, minus becomes underscore: `per-cluster` is `per_cluster`.

use std::collections::BTreeSet;

use anyhow::bail;

use crate::cells::{Cell, variables};
pub use crate::experiment::expression::Expression;
use crate::record::column::Column;
use crate::record::row::{Outcome, Pass};
use contactbench_terms::nearest::hint;

#[derive(Clone, Debug, PartialEq)]
pub enum Reading {
    Value(f64),
    /// The cell ended well but lacks a variable, or the result is not a finite number.
    Missing,
    Not(Outcome),
}

impl Expression {
    pub fn check(&self, cells: &[Cell]) -> anyhow::Result<()> {
        let known = variables(cells);
        let unknown = |name: &str| Column::find(name).is_none() && !known.contains(name);
        if let Some((name, column)) = self.variables().find(|(name, _)| unknown(name)) {
            bail!(
                "unknown variable '{name}' at column {column} of '{self}'{}; the variables are: {}",
                hint(name, known.iter().map(String::as_str)),
                known.iter().map(String::as_str).collect::<Vec<_>>().join(", ")
            );
        }
        Ok(())
    }

    pub fn passes(&self) -> Vec<Pass> {
        let pass = |(name, _): (&str, usize)| Column::find(name)?.pass;
        let passes: BTreeSet<Pass> = self.variables().filter_map(pass).collect();
        passes.into_iter().collect()
    }

    pub fn read(&self, cell: &Cell) -> Reading {
        let (outcome, _) = cell.outcome(&self.passes());
        if !outcome.is_good() {
            return Reading::Not(outcome);
        }
        self.at(cell, None).map_or(Reading::Missing, Reading::Value)
    }

    /// Returns the value for a cell, whatever its outcome. `time_ns` replaces the median, if given.
    pub fn at(&self, cell: &Cell, time_ns: Option<f64>) -> Option<f64> {
        self.evaluate(|name| cell.variable(name, time_ns)).filter(|value| value.is_finite())
    }
}
