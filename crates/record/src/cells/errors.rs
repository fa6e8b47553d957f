//! Error rates of a cell, compared with exact decisions.

use crate::cells::Cell;
use contactbench_terms::errors::Causes;

pub fn true_contacts(cell: &Cell) -> f64 {
    let known = cell.values.get("true_contacts").copied();
    known.unwrap_or_else(|| cell.stats.true_contacts(cell.id.n))
}

/// Wrong pairs per true contact of the given scene. Without true contacts, the number of wrong
/// pairs.
pub fn rate(cell: &Cell) -> Option<f64> {
    Some(cell.errors?.wrong() as f64 / true_contacts(cell).max(1.0))
}

/// Wrong pairs per contact of the stored scene: errors of predicate and search only.
pub fn stored_rate(cell: &Cell) -> Option<f64> {
    let Causes { representation, stored, .. } = cell.causes?;
    let contacts =
        true_contacts(cell) - representation.missed as f64 + representation.spurious as f64;
    Some(stored.wrong() as f64 / contacts.max(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells::testing::Lab;
    use crate::cells::{self, Cell};
    use crate::record::column;
    use contactbench_terms::errors::Errors;

    /// Storage loses 20 of 250 contacts and adds 5, and the predicate loses one.
    #[test]
    fn every_error_has_a_variable() {
        let errors = |missed, spurious| Errors { missed, spurious, ..Errors::default() };
        let representation = Errors { deepest_miss: 0.25, ..errors(20, 5) };
        let [predicate, stored] = [errors(1, 0); 2];
        let causes = Causes { representation, predicate, stored, ..Causes::default() };
        let all = Errors { self_pairs: 2, deepest_miss: 0.25, ..errors(21, 5) };
        let mut lab = Lab::new("e", "packed");
        lab.arithmetic("f32").count(&[]).errors(all, causes);
        lab.arithmetic("exact").count(&[]).errors(Errors::default(), Causes::default());
        let cells = cells::cells(&lab.rows());
        let [exact, cell]: &[Cell; 2] = cells.as_array().unwrap();
        for (name, expected) in [
            ("missed", 21.0),
            ("self_pairs", 2.0),
            ("wrong", 28.0),
            ("deepest_miss", 0.25),
            ("representation_spurious", 5.0),
            ("representation_wrong", 25.0),
            ("predicate_missed", 1.0),
            ("search_widest_false", 0.0),
            ("true_contacts", 250.0),
        ] {
            assert_eq!(cell.variable(name, None), Some(expected), "{name}");
        }
        assert!(column::errors().all(|error| cell.variable(&error.name, None).is_some()));
        assert_eq!((rate(cell), stored_rate(cell)), (Some(28.0 / 250.0), Some(1.0 / 235.0)));
        assert_eq!(rate(exact), Some(0.0));
        // The sum of missed and spurious pairs must not overflow.
        let most = Errors { missed: u64::MAX, spurious: 1, ..Errors::default() };
        assert_eq!(most.wrong(), u64::MAX);
    }
}
