//! Expressions over the variables of a cell.
//!
//! Arithmetic over a cell: `(list_push + list_step) / n`, `n * log2(n)`, `time_ns / n`. Parsed by the `exmex` crate;
//! its rules: `log` is the natural logarithm (use `log2`, `log10`), and a leading minus binds tighter than `^`, so `-n^2` is n².
//! Numbers have no exponent part: write `10^6`, not `1e6`. Minus signs in parameter names become underscores: `per-cluster` is `per_cluster`.

use std::collections::BTreeSet;

use anyhow::{anyhow, ensure};
use exmex::{Express, FlatEx};

use super::value::{Cell, is_operation, variables};
use crate::harness::record::{Outcome, Pass};

/// What an expression gives for a cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Reading {
    /// A finite number.
    Value(f64),
    /// The cell ended well but lacks a variable, or the result is not a finite number.
    Missing,
    /// The cell did not end well.
    Not(Outcome),
}

/// An expression over the variables of a cell.
#[derive(Clone, Debug)]
pub struct Expression {
    tree: FlatEx<f64>,
    names: Vec<String>,
}

impl Expression {
    /// Parses an expression.
    pub fn parse(text: &str) -> anyhow::Result<Expression> {
        ensure!(!text.trim().is_empty(), "the expression is empty; give a variable or a formula such as contact_test / n");
        let tree = FlatEx::<f64>::parse(text).map_err(|e| anyhow!("cannot read the expression '{text}': {e}"))?;
        let names = tree.var_names().to_vec();
        Ok(Expression { tree, names })
    }

    /// Parses an expression and checks that these cells know its variables.
    pub fn parse_for(text: &str, cells: &[Cell]) -> anyhow::Result<Expression> {
        let (expression, known) = (Expression::parse(text)?, variables(cells));
        if let Some(name) = expression.names.iter().find(|name| !known.contains(*name)) {
            let known = known.into_iter().collect::<Vec<_>>().join(", ");
            return Err(anyhow!("unknown variable '{name}' in '{text}'; the variables are: {known}"));
        }
        Ok(expression)
    }

    /// Does it use the measured time, so that it has an interval?
    pub fn uses_time(&self) -> bool {
        self.names.iter().any(|name| name == "time_ns")
    }

    /// The passes it needs.
    pub fn passes(&self) -> Vec<Pass> {
        let pass = |name: &String| match name.as_str() {
            "time_ns" => Some(Pass::Time),
            "peak_bytes" | "live_bytes" | "allocations" | "warm_allocations" => Some(Pass::Memory),
            name if is_operation(name) => Some(Pass::Count),
            _ => None,
        };
        let passes: BTreeSet<Pass> = self.names.iter().filter_map(pass).collect();
        passes.into_iter().collect()
    }

    /// The value for a cell.
    pub fn read(&self, cell: &Cell) -> Reading {
        let (outcome, _) = cell.outcome(&self.passes());
        if !outcome.is_good() {
            return Reading::Not(outcome);
        }
        self.at(cell, None).map_or(Reading::Missing, Reading::Value)
    }

    /// The value for a cell, whatever its outcome, with this time in place of the median.
    pub fn at(&self, cell: &Cell, time_ns: Option<f64>) -> Option<f64> {
        let values: Option<Vec<f64>> = self.names.iter().map(|name| cell.variable(name, time_ns)).collect();
        self.tree.eval(&values?).ok().filter(|value| value.is_finite())
    }
}
