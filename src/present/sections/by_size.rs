//! Tables with a line per contender and a column per N.

use crate::cells::series::BySize;
use crate::present::table::{Cell, Column, Table};

/// These values with `first` above them; `cell` is given the N and the value there.
pub(super) fn table<T>(
    found: &BySize<T>,
    first: Vec<Vec<Cell>>,
    cell: impl Fn(u64, &T) -> Cell,
) -> Table {
    let sizes = found.sizes.iter().map(|n| Column::right(format!("N = {n}"), ""));
    let columns = std::iter::once(Column::left("detector")).chain(sizes).collect();
    let row = |line: &crate::cells::series::LineValues<T>| {
        let values = found.sizes.iter().zip(&line.values);
        let cells =
            values.map(|(&n, value)| value.as_ref().map_or_else(Cell::absent, |v| cell(n, v)));
        std::iter::once(line.name.as_str().into()).chain(cells).collect()
    };
    Table::new(found.title.clone(), columns).with(first).with(found.lines.iter().map(row))
}

/// What a quantity comes to per particle.
pub(super) fn per_particle(value: f64, n: u64) -> f64 {
    value / n.max(1) as f64
}
