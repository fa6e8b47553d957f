//! Filters of claims and figures: `where = { detector = "nbs", s = [2, 20], n = ">= 1000" }`.
//!
//! All entries must match. A value matches an equal value (2 equals 2.0); a list matches if one of
//! its values does. A text that starts with <, <=, >, >=, = or !=, followed by a number, is a
//! comparison.

use crate::cells::Cell;
use crate::experiment::Where;
use crate::record::column::Column;
use crate::record::id::{CellId, MACHINE, variable};
use crate::record::value::AxisValue;

pub fn select<'a>(cells: &'a [Cell], filter: &Where) -> Vec<&'a Cell> {
    cells.iter().filter(|cell| matches(cell, filter)).collect()
}

pub fn matches(cell: &Cell, filter: &Where) -> bool {
    filter.iter().all(|(name, wanted)| {
        let name = variable(name);
        let found = cell.id.axis(&name).or_else(|| cell.variable(&name, None).map(AxisValue::from));
        found.is_some_and(|found| wanted.iter().any(|wanted| equal(&found, wanted)))
    })
}

/// Whether a planned cell may match. Measured values, which are not known yet, count as matching.
pub fn may_match(id: &CellId, filter: &Where) -> bool {
    filter.iter().all(|(name, wanted)| {
        let name = variable(name);
        match id.axis(&name) {
            Some(found) => wanted.iter().any(|wanted| equal(&found, wanted)),
            None => name == MACHINE || Column::find(&name).is_some(),
        }
    })
}

fn equal(found: &AxisValue, wanted: &toml::Value) -> bool {
    match (found.number(), wanted) {
        (Some(found), toml::Value::Integer(wanted)) => close(found, *wanted as f64),
        (Some(found), toml::Value::Float(wanted)) => close(found, *wanted),
        (Some(found), toml::Value::String(wanted)) => compare(found, wanted),
        (Some(_), _) => false,
        (None, toml::Value::String(wanted)) => found.to_string() == *wanted,
        (None, wanted) => found.to_string() == wanted.to_string(),
    }
}

fn close(a: f64, b: f64) -> bool {
    a == b || (a - b).abs() <= 1e-12 * a.abs().max(b.abs())
}

/// Evaluates a comparison such as `>= 2`; a text without an operator must be an equal number.
fn compare(found: f64, wanted: &str) -> bool {
    let wanted = wanted.trim();
    for (sign, holds) in [
        ("<=", (|a, b| a <= b || close(a, b)) as fn(f64, f64) -> bool),
        (">=", |a, b| a >= b || close(a, b)),
        ("!=", |a, b| !close(a, b)),
        ("<", |a, b| a < b),
        (">", |a, b| a > b),
        ("=", close),
        ("", close),
    ] {
        if let Some(rest) = wanted.strip_prefix(sign) {
            return rest.trim().parse().is_ok_and(|limit| holds(found, limit));
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells;
    use crate::cells::testing::Lab;
    use crate::cells::testing::filter as parsed;

    #[test]
    fn every_kind_of_entry_selects() {
        let mut lab = Lab::new("e", "pack-c");
        for s in [2, 20, 200] {
            lab.param("s-over-d", s).param("kind", "hexagonal").n(1000 * s).count(&[]);
        }
        let cells = cells::cells(&lab.rows());
        let count = |filter: &str| select(&cells, &parsed(filter)).len();
        for (filter, expected) in [
            ("", 3),
            ("scene = 'pack-c'", 3),
            ("scene = 'loose'", 0),
            ("s-over-d = 20", 1),
            ("s_over_d = 20.0", 1),
            ("s-over-d = [2, 200, 7]", 2),
            ("s-over-d = '>= 20'", 2),
            ("s-over-d = '<20'", 1),
            ("s-over-d = '!= 20', kind = 'hexagonal'", 2),
            ("s-over-d = 'about 20'", 0),
            ("n = '> 2000', detector = ['nbs', 'direct']", 2),
            ("kind = 7", 0),
            ("coordination = 5", 3),
            ("spacing = 1", 0),
        ] {
            assert_eq!(count(filter), expected, "{filter}");
        }
    }
}
