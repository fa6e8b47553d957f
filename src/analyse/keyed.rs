//! Rows and the cells that they belong to, where a record may be of several machines.

use std::collections::BTreeMap;

use super::value::{Cell, Key, Param};
use crate::harness::record::Row;

/// The cell that each row belongs to. Times of several machines are not values of one thing: where rows of several are together, the machine is a
/// parameter.
pub fn keyed(rows: &[Row]) -> impl Iterator<Item = (Key, &Row)> {
    let several = rows.iter().any(|row| row.machine != rows[0].machine);
    rows.iter().map(move |row| {
        let mut key = Key::of(row);
        if several {
            let place = key.params.partition_point(|(name, _)| name.as_str() < MACHINE);
            key.params.insert(place, (MACHINE.into(), Param::Text(row.machine.clone())));
        }
        (key, row)
    })
}

/// The parameter of cells in records of several machines.
pub const MACHINE: &str = "machine";

/// The cells of each machine apart, with its name where there are several: for what is said of a machine and not of a scene.
pub fn by_machine<'a>(cells: &[&'a Cell]) -> Vec<(Option<String>, Vec<&'a Cell>)> {
    let mut machines: BTreeMap<Option<String>, Vec<&Cell>> = BTreeMap::new();
    for &cell in cells {
        machines.entry(cell.key.field(MACHINE).map(|name| name.to_string())).or_default().push(cell);
    }
    machines.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::super::{fake::Lab, value};

    #[test]
    fn times_of_several_machines_are_not_one_median() {
        let mut lab = Lab::new("e", "packed");
        lab.param("spacing", 1).machine("a").time(&[100, 100]).machine("b").time(&[300, 300]);
        let cells = value::cells(&lab.rows());
        let times: Vec<_> =
            cells.iter().map(|cell| (cell.key.field("machine").unwrap().to_string(), cell.time().unwrap().median)).collect();
        assert_eq!(times, [("a".into(), 100.0), ("b".into(), 300.0)]);
        let apart = super::by_machine(&cells.iter().collect::<Vec<_>>());
        assert_eq!(apart.iter().map(|(name, cells)| (name.as_deref().unwrap(), cells.len())).collect::<Vec<_>>(), [("a", 1), ("b", 1)]);
        // One machine is no parameter, whatever its name.
        assert_eq!(value::cells(&lab.rows()[..2])[0].key.field("machine"), None);
    }
}
