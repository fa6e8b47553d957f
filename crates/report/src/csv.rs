//! `summary.csv`: one line per cell with all its values.

use std::collections::BTreeSet;

use crate::table::Table;
use contactbench_record::cells::{Cell, FIELDS};
use contactbench_record::record::column::{BUILDING, COLUMNS, FIRST, MEDIAN_STEP, WORST_STEP};
use contactbench_record::stats::interval::{mad, median};
use contactbench_terms::number::number;

/// Returns one line per cell. Optional columns that all cells lack, such as copies and counts, are
/// left out, and errors by cause that no cell has.
pub fn summary(cells: &[Cell]) -> Table {
    let params: BTreeSet<String> = cells
        .iter()
        .flat_map(|cell| cell.id.names())
        .filter(|name| !FIELDS.contains(&name.as_str()))
        .collect();
    let fields = FIELDS.into_iter().chain(params.iter().map(String::as_str));
    let copies = cells.iter().any(|cell| !cell.copies_ns.is_empty());
    let quiet = cells.iter().any(|cell| cell.quiet_time().is_some());
    let steps = [BUILDING, MEDIAN_STEP, WORST_STEP]
        .into_iter()
        .filter(|name| cells.iter().any(|cell| cell.others_ns.contains_key(name)));
    let numbers = COLUMNS
        .iter()
        .filter(|column| column.repeats())
        .map(|column| (&*column.name, column.is_of_cause()))
        .filter(|(name, is_of_cause)| {
            let shown = |value: &f64| *value != 0.0 || !is_of_cause;
            cells.iter().any(|cell| cell.values.get(name).is_some_and(shown))
        });
    // The time columns are empty unless all blocks of the cell ended well.
    let timed = |cell: &Cell, value: fn(&[f64]) -> Option<f64>| {
        let times: Vec<f64> = cell.times.values().map(|&time| time as f64).collect();
        cell.time().and_then(|_| value(&times))
    };
    let per_pair = |cell: &Cell, name| cell.per_pair(cell.variable(name, None)?).map(number);
    let beside =
        |cell: &Cell| median(&cell.copies_ns.values().map(|&time| time as f64).collect::<Vec<_>>());
    Table::of("", cells)
        .each(fields, |table, name| {
            table.left(name, |cell| cell.id.axis(name).map(|value| value.to_string()))
        })
        .left("outcome", |cell| cell.overall().0.name())
        .left("reason", |cell| cell.overall().1)
        .left("time_ns_median", |cell| cell.time().map(|time| time.median))
        .left("time_ns_low", |cell| Some(cell.time()?.ends()?[0]))
        .left("time_ns_high", |cell| Some(cell.time()?.ends()?[1]))
        .left("time_ns_min", |cell| timed(cell, |all| all.iter().copied().reduce(f64::min)))
        .left("time_ns_mad", |cell| timed(cell, mad))
        .left("blocks", |cell| cell.time().map(|time| time.count as u64))
        .left("first_ns_median", |cell| cell.variable(FIRST, None))
        .when(quiet, |table| table.left("quiet_ns_median", Cell::quiet_time))
        .when(copies, |table| table.left("beside_ns_median", beside))
        .each(steps, |table, name| {
            table.left(format!("{name}_median"), |cell| cell.variable(name, None))
        })
        .left("ns_per_pair", |cell| per_pair(cell, "time_ns"))
        .left("bytes_per_pair", |cell| per_pair(cell, "peak_bytes"))
        .each(numbers, |table, (name, _)| table.left(name, |cell| cell.variable(name, None)))
        .into()
}
