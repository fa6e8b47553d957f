use super::{Table, Value};
use contactbench_terms::text::csv_cell;

/// A CSV file of tables with the same columns: a line of names, then all rows. Numbers have all
/// their digits; what is absent, or of a wrong answer, is an empty field; no text is a formula.
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
    // Writing to memory cannot fail.
    let _ = writer.write_record(head);
    for table in tables {
        for row in &table.rows {
            let mut fields = Vec::new();
            for (cell, column) in row.iter().zip(&table.columns) {
                fields.push(field(&cell.value));
                if let (true, Value::Ratio(ratio)) = (column.interval, &cell.value) {
                    fields.extend([ratio.low.to_string(), ratio.high.to_string()]);
                } else if column.interval {
                    fields.extend([String::new(), String::new()]);
                }
            }
            let _ = writer.write_record(fields);
        }
    }
    writer
        .into_inner()
        .map_or_else(|_| String::new(), |bytes| String::from_utf8_lossy(&bytes).into_owned())
}

fn field(value: &Value) -> String {
    match value {
        Value::Absent | Value::Wrong(_) => String::new(),
        Value::Number(number) | Value::Share(number) => number.to_string(),
        Value::Ratio(ratio) => ratio.median.to_string(),
        value => csv_cell(&value.to_string()).into_owned(),
    }
}
