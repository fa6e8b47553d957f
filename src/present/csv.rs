//! `summary.csv`: one line per cell with all its values.

use std::collections::BTreeSet;

use crate::cells::{Cell, FIELDS};
use crate::present::table::{self, Column, Table};
use crate::record::column::{BUILDING, COLUMNS, FIRST, MEDIAN_STEP, WORST_STEP};
use crate::stats::interval::{mad, median};

/// What is said of the times.
const TIMES: [&str; 7] = [
    "time_ns_median",
    "time_ns_low",
    "time_ns_high",
    "time_ns_min",
    "time_ns_mad",
    "blocks",
    "first_ns_median",
];

/// One line per cell with all its values.
pub fn summary(cells: &[Cell]) -> Table {
    let params: BTreeSet<String> = cells
        .iter()
        .flat_map(|cell| cell.id.names())
        .filter(|name| !FIELDS.contains(&name.as_str()))
        .collect();
    // Only where copies were timed: other tables keep their columns.
    let beside: &[&str] = if cells.iter().any(|cell| !cell.copies_ns.is_empty()) {
        &["beside_ns_median"]
    } else {
        &[]
    };
    // The same where nobody looked at the state of the machine.
    let quiet: &[&str] = if cells.iter().any(|cell| cell.quiet_time().is_some()) {
        &["quiet_ns_median"]
    } else {
        &[]
    };
    // The same where nothing moves.
    let of_steps = [BUILDING, MEDIAN_STEP, WORST_STEP].into_iter();
    let of_steps: Vec<&str> = of_steps
        .filter(|name| cells.iter().any(|cell| cell.others_ns.contains_key(name)))
        .collect();
    let fields: Vec<&str> = FIELDS.into_iter().chain(params.iter().map(String::as_str)).collect();
    let numbers: Vec<&str> = COLUMNS
        .iter()
        .filter(|column| column.repeats())
        .map(|column| &*column.name)
        .filter(|name| cells.iter().any(|cell| cell.values.contains_key(name)))
        .collect();
    let columns =
        fields.iter().chain(&["outcome", "reason"]).chain(&TIMES).chain(quiet).chain(beside);
    let columns = columns.map(|name| Column::left(*name));
    let steps = of_steps.iter().map(|name| Column::left(format!("{name}_median")));
    let numbered = numbers.iter().map(|name| Column::left(*name));
    let columns = columns.chain(steps).chain(numbered).collect();
    let row = |cell: &Cell| {
        let (outcome, reason) = cell.overall();
        let mut row: Vec<table::Cell> = fields
            .iter()
            .map(|name| {
                cell.id
                    .axis(name)
                    .map_or_else(table::Cell::absent, |value| value.to_string().into())
            })
            .collect();
        row.extend([outcome.name(), reason].map(table::Cell::from));
        row.extend(time(cell).map(table::Cell::from));
        row.extend(quiet.iter().map(|_| table::Cell::from(cell.quiet_time())));
        let copies: Vec<f64> = cell.copies_ns.values().map(|&t| t as f64).collect();
        row.extend(beside.iter().map(|_| table::Cell::from(median(&copies))));
        row.extend(of_steps.iter().map(|name| table::Cell::from(cell.variable(name, None))));
        row.extend(numbers.iter().map(|name| table::Cell::from(cell.variable(name, None))));
        row
    };
    Table::new("", columns).with(cells.iter().map(row))
}

/// Median, interval, minimum, deviation and number of the times, and the first detection.
fn time(cell: &Cell) -> [Option<f64>; 7] {
    let Some(time) = cell.time() else { return [None; 7] };
    let all: Vec<f64> = cell.times.values().map(|&t| t as f64).collect();
    let least = all.iter().copied().fold(f64::INFINITY, f64::min);
    let deviation = mad(&all).unwrap_or(0.0);
    let all = [time.median, time.low, time.high, least, deviation, time.count as f64].map(Some);
    let [median, low, high, least, deviation, count] = all;
    [median, low, high, least, deviation, count, cell.variable(FIRST, None)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells;
    use crate::cells::testing::Lab;
    use crate::record::row::{Outcome, Pass};

    #[test]
    fn every_cell_is_a_line_with_all_its_digits() {
        let mut lab = Lab::new("e", "packed");
        lab.detector("nbs").time(&[100, 200, 301, 400]).memory(20_000, 21_000);
        lab.detector("direct").fail(Pass::Time, Outcome::Timeout, "30 s, the limit");
        let text = table::csv(&[summary(&cells::cells(&lab.rows()))]);
        assert_eq!(text.lines().count(), 3);
        assert!(text.starts_with("experiment,scene,dim,order,n,seed,arithmetic,threads,detector,"));
        assert!(text.contains(",timeout,\"30 s, the limit\",,,"), "{text}");
        assert!(text.contains(",ok,,250.5,100,400,100,"), "{text}");
    }
}
