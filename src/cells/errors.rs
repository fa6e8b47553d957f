//! Errors against exact decisions: their names in expressions and in `summary.csv`, and rates.

use crate::cells::Cell;
use crate::oracle::{Causes, Errors};

type OfCell = fn(&Cell) -> Option<Errors>;
type OfErrors = fn(&Errors) -> f64;

/// All causes together, and each: the prefix of its variables.
const CAUSES: [(&str, OfCell); 4] = [
    ("", |cell| cell.errors),
    ("input_", |cell| cell.causes.map(|causes| causes.input)),
    ("arithmetic_", |cell| cell.causes.map(|causes| causes.arithmetic)),
    ("algorithm_", |cell| cell.causes.map(|causes| causes.algorithm)),
];

const KINDS: [(&str, OfErrors); 7] = [
    ("missed", |errors| errors.missed as f64),
    ("spurious", |errors| errors.spurious as f64),
    ("duplicate", |errors| errors.duplicate as f64),
    ("self_pairs", |errors| errors.self_pairs as f64),
    ("deepest_miss", |errors| errors.deepest_miss),
    ("widest_false", |errors| errors.widest_false),
    ("wrong", |errors| errors.wrong() as f64),
];

/// The names of all variables that count errors, as `algorithm_missed`.
pub fn names() -> impl Iterator<Item = String> {
    CAUSES.iter().flat_map(|(cause, _)| KINDS.iter().map(move |(kind, _)| format!("{cause}{kind}")))
}

/// The value of such a variable; none where nothing was compared.
pub fn variable(cell: &Cell, name: &str) -> Option<f64> {
    let (of_cell, of_errors) = CAUSES.iter().find_map(|(cause, of_cell)| {
        let kind = name.strip_prefix(cause)?;
        Some((of_cell, KINDS.iter().find(|(known, _)| *known == kind)?.1))
    })?;
    Some(of_errors(&of_cell(cell)?))
}

/// Pairs that touch in exact arithmetic in the scene as given.
pub fn true_contacts(cell: &Cell) -> f64 {
    (cell.stats.coordination * cell.id.n as f64 / 2.0).round()
}

/// Wrong pairs per true contact, against the scene as given; without true contacts every wrong pair
/// counts as one.
pub fn rate(cell: &Cell) -> Option<f64> {
    Some(cell.errors?.wrong() as f64 / true_contacts(cell).max(1.0))
}

/// The same against the scene as stored: what deciding and looking did wrong, per contact of that
/// scene.
pub fn stored_rate(cell: &Cell) -> Option<f64> {
    let Causes { input, stored, .. } = cell.causes?;
    let contacts = true_contacts(cell) - input.missed as f64 + input.spurious as f64;
    Some(stored.wrong() as f64 / contacts.max(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells;
    use crate::findings::errors::testing::lab;

    #[test]
    fn every_error_has_a_variable() {
        let cells = cells::cells(&lab().rows());
        let find = |arithmetic: &str, offset: f64| {
            cells
                .iter()
                .find(|cell| {
                    cell.id.arithmetic == arithmetic
                        && cell.variable("offset", None) == Some(offset)
                })
                .unwrap()
        };
        let cell = find("f32", 1000.0);
        for (name, expected) in [
            ("missed", 21.0),
            ("self_pairs", 2.0),
            ("wrong", 28.0),
            ("deepest_miss", 0.25),
            ("input_missed", 20.0),
            ("input_spurious", 5.0),
            ("input_wrong", 25.0),
            ("arithmetic_missed", 1.0),
            ("arithmetic_wrong", 1.0),
            ("algorithm_wrong", 0.0),
            ("algorithm_widest_false", 0.0),
            ("true_contacts", 250.0),
        ] {
            assert_eq!(cell.variable(name, None), Some(expected), "{name}");
            assert!(cells::variables(&cells).contains(name), "{name}");
        }
        assert_eq!(names().count(), 28);
        assert!(names().all(|name| cell.variable(&name, None).is_some()));
        assert_eq!(cell.variable("storage_missed", None), None);
        assert_eq!((rate(cell), stored_rate(cell)), (Some(28.0 / 250.0), Some(1.0 / 235.0)));
        assert_eq!(rate(find("exact", 0.0)), Some(0.0));
    }
}
