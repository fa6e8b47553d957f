//! The value of an expression for a cell.
//!
//! Variables are measured columns, numbers of the cell's id, and numeric parameters of the scene.
//! In their names, minus becomes underscore: `per-cluster` is `per_cluster`.

use std::collections::BTreeSet;

use crate::cells::Cell;
pub use crate::experiment::expression::Expression;
use crate::record::column::Column;
use crate::record::row::{Outcome, Pass};

#[derive(Clone, Debug, PartialEq)]
pub enum Reading {
    Value(f64),
    /// The cell ended well but lacks a variable, or the result is not a finite number.
    Missing,
    Not(Outcome),
}

impl Expression {
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
