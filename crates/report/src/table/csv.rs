use super::{Cell, Table};
use contactbench_terms::text::csv_cell;

/// Returns tables with the same columns as one CSV file. Numbers have all digits. Absent values and
/// those of wrong answers are empty fields. Text that looks like a formula is made harmless.
pub fn csv(tables: &[Table]) -> String {
    let mut writer = csv::WriterBuilder::new().flexible(true).from_writer(Vec::new());
    let Some(first) = tables.first() else { return String::new() };
    let mut head = Vec::new();
    for column in &first.columns {
        head.push(csv_cell(&column.name).into_owned());
        if column.interval {
            head.extend(["low", "high"].map(|end| format!("{}_{end}", column.name)));
        }
    }
    let _ = writer.write_record(head);
    for row in tables.iter().flat_map(|table| &table.rows) {
        let mut fields = Vec::new();
        for (cell, column) in row.iter().zip(&first.columns) {
            fields.push(field(cell));
            if column.interval {
                let ends = if let Cell::Ratio(ratio) = cell { ratio.ends() } else { None };
                fields.extend(match ends {
                    Some(ends) => ends.map(|end| end.to_string()),
                    None => [const { String::new() }; 2],
                });
            }
        }
        let _ = writer.write_record(fields);
    }
    let bytes = writer.into_inner().unwrap_or_default();
    String::from_utf8_lossy(&bytes).into_owned()
}

fn field(cell: &Cell) -> String {
    match cell {
        Cell::Absent | Cell::Wrong(_) => String::new(),
        Cell::Number(number) | Cell::Share(number) => number.to_string(),
        Cell::Ratio(ratio) => ratio.median.to_string(),
        Cell::Strong(cell) => field(cell),
        cell => csv_cell(&cell.to_string()).into_owned(),
    }
}
