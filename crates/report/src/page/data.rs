//! Data of the charts and the table of a page: one row per cell, as JSON.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use crate::figure::style::{Marker, Styles};
use crate::page::marks;
use contactbench_record::cells::{AxisValue, Cell, FIELDS, errors, label};
use contactbench_record::record::column::Column;
use contactbench_record::record::row::Pass;

const MEASURES: &str = "outcome reason time_ns time_low time_high blocks contacts operations \
                        contact_test peak_bytes formula_bytes true_contacts wrong missed spurious \
                        duplicate error_rate";
const WORDS: [&str; 7] =
    ["experiment", "scene", "order", "arithmetic", "detector", "outcome", "reason"];

/// Returns the number in its shortest form; null for `None` and for numbers that JSON cannot hold.
fn number(value: Option<f64>) -> Value {
    match value {
        Some(value) if value == value.trunc() && value.abs() < 9e15 => json!(value as i64),
        Some(value) if value.is_finite() => json!(value),
        _ => Value::Null,
    }
}

fn measure(cell: &Cell, name: &str) -> Option<f64> {
    match name {
        "time_low" => Some(cell.time()?.ends()?[0]),
        "time_high" => Some(cell.time()?.ends()?[1]),
        "blocks" => Some(cell.time()?.count as f64),
        "operations" => {
            Column::measured_by(Pass::Count).map(|column| cell.variable(&column.name, None)).sum()
        }
        "error_rate" => errors::rate(cell),
        "true_contacts" => cell.errors.and_then(|_| cell.variable(name, None)),
        _ => cell.variable(name, None),
    }
}

/// Returns `detectors` with their markers, names and titles of `experiments`, `columns`, `texts`
/// and `rows`. Texts in rows are indices into `texts`; missing values are null.
pub fn json(
    experiments: &[(&str, &str)],
    cells: &[Cell],
    detectors: &[&str],
    styles: &Styles,
) -> Value {
    let swept = label::swept(&cells.iter().collect::<Vec<_>>());
    let has_text = |name: &str| {
        cells.iter().any(|cell| matches!(cell.id.axis(name), Some(AxisValue::Text(_))))
    };
    let is_word =
        |name: &str| WORDS.contains(&name) || swept.iter().any(|it| it == name) && has_text(name);
    let keys = ["experiment", "scene", "dim"].into_iter().chain(swept.iter().map(String::as_str));
    let keys = keys.chain(["order", "n", "seed", "detector", "arithmetic", "threads"]);
    // Name of a column, whether it belongs to the id of the cell, and whether it holds text.
    let columns: Vec<(&str, bool, bool)> = keys
        .map(|name| (name, true, is_word(name)))
        .chain(MEASURES.split(' ').map(|name| (name, false, is_word(name))))
        .collect();
    debug_assert!(FIELDS.iter().all(|field| columns.iter().any(|column| column.0 == *field)));
    let (mut texts, mut places) = (Vec::new(), BTreeMap::new());
    let mut index = |text: String| {
        *places.entry(text).or_insert_with_key(|text| {
            texts.push(text.clone());
            texts.len() - 1
        })
    };
    let mut value = |cell: &Cell, &(name, key, word): &(&str, bool, bool)| {
        let axis = cell.id.axis(name).filter(|_| key);
        let text = match name {
            "detector" => Some(cell.id.subject()),
            "outcome" => Some(cell.overall().0.name().into()),
            "reason" => Some(cell.overall().1.into()),
            _ => axis.as_ref().filter(|_| word).map(AxisValue::to_string),
        };
        match text {
            Some(text) => json!(index(text)),
            None if key => number(axis.and_then(|value| value.number())),
            None => number(measure(cell, name)),
        }
    };
    let mut row = |cell| columns.iter().map(|column| value(cell, column)).collect();
    let rows: Vec<Value> = cells.iter().map(&mut row).collect();
    let detector = |name: &&str| {
        let style = styles.get(name);
        json!({"name": name, "mark": marks::outline(style.marker), "control": style.control,
            "filled": !matches!(style.marker, Marker::Cross | Marker::Plus)})
    };
    let columns =
        columns.iter().map(|(name, key, text)| json!({"name": name, "key": key, "text": text}));
    json!({
        "detectors": detectors.iter().map(detector).collect::<Vec<_>>(),
        "experiments": experiments,
        "columns": columns.collect::<Vec<_>>(),
        "texts": texts,
        "rows": rows,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use contactbench_record::cells;
    use contactbench_record::cells::testing::Lab;
    use contactbench_record::record::row::Outcome;
    use contactbench_terms::errors::Errors;

    #[test]
    fn rows_hold_what_was_measured_and_null_for_the_rest() {
        let mut lab = Lab::new("e", "packed");
        let counts = [("contact_test", 60), ("list_push", 40)];
        lab.param("s", 2).time(&[300, 100, 200]).count(&counts).memory(1024, 1000);
        lab.edit(|row| row.errors = Some(Errors { missed: 2, ..Errors::default() }));
        lab.param("s", "wide").detector("sorting").fail(Pass::Time, Outcome::Timeout, "30 s");
        let cells = cells::cells(&lab.rows());
        let data = json(&[], &cells, &["nbs", "sorting"], &Styles::new(cells.iter()));
        let at = |row: usize, name: &str| {
            let columns = data["columns"].as_array().unwrap();
            let k = columns.iter().position(|column| column["name"] == name).unwrap();
            match (&data["rows"][row][k], &columns[k]["text"]) {
                (Value::Number(text), Value::Bool(true)) => {
                    data["texts"][text.as_u64().unwrap() as usize].clone()
                }
                (value, _) => value.clone(),
            }
        };
        let (time, counted) = (json!([200, 100, 300, 3]), json!([100, 60, 1024, 2]));
        let first = |names: [&str; 4]| json!(names.map(|name| at(0, name)));
        assert_eq!(first(["time_ns", "time_low", "time_high", "blocks"]), time);
        assert_eq!(first(["operations", "contact_test", "peak_bytes", "wrong"]), counted);
        assert_eq!(["s", "detector"].map(|name| at(0, name)), ["2", "nbs"]);
        assert_eq!(["s", "outcome", "reason"].map(|name| at(1, name)), ["wide", "timeout", "30 s"]);
        assert!(["time_ns", "error_rate", "operations"].iter().all(|name| at(1, name).is_null()));
    }
}
