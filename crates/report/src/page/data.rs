//! What the charts and the table of a page are made from: one row per cell, as JSON.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Value, json};

use crate::figure::style::{Marker, Styles};
use crate::page::marks;
use contactbench_record::cells::{AxisValue, Cell, FIELDS, errors, label};
use contactbench_record::record::column::Column;
use contactbench_record::record::row::Pass;

/// What was measured: names in rows. Text first.
const MEASURES: [&str; 17] = [
    "outcome",
    "reason",
    "time_ns",
    "time_low",
    "time_high",
    "blocks",
    "contacts",
    "operations",
    "contact_test",
    "peak_bytes",
    "formula_bytes",
    "true_contacts",
    "wrong",
    "missed",
    "spurious",
    "duplicate",
    "error_rate",
];
/// Fields that are words.
const WORDS: [&str; 7] =
    ["experiment", "scene", "order", "arithmetic", "detector", "outcome", "reason"];

/// The texts of all rows, each once.
#[derive(Default)]
struct Texts(BTreeMap<String, usize>, Vec<String>);

impl Texts {
    fn index(&mut self, text: &str) -> Value {
        if let Some(&known) = self.0.get(text) {
            return json!(known);
        }
        let next = self.1.len();
        self.0.insert(text.into(), next);
        self.1.push(text.into());
        json!(next)
    }
}

/// A number in its shortest form; null for none and for what JSON cannot say.
fn number(value: Option<f64>) -> Value {
    match value {
        Some(value) if value == value.trunc() && value.abs() < 9e15 => json!(value as i64),
        Some(value) if value.is_finite() => json!(value),
        _ => Value::Null,
    }
}

/// A measured number of a cell.
fn measure(cell: &Cell, name: &str) -> Option<f64> {
    match name {
        "time_low" => Some(cell.time()?.low),
        "time_high" => Some(cell.time()?.high),
        "blocks" => Some(cell.time()?.count as f64),
        "operations" => {
            Column::measured_by(Pass::Count).map(|column| cell.variable(&column.name, None)).sum()
        }
        "error_rate" => errors::rate(cell),
        // Of a scene whose answers were compared with the truth.
        "true_contacts" => cell.errors.and_then(|_| cell.variable(name, None)),
        _ => cell.variable(name, None),
    }
}

/// The data of a page: `detectors` with their marks, names and titles of `experiments`, `columns`,
/// `texts` and `rows`. Words stand in rows as their index in `texts`; what was not measured is
/// null.
pub fn json(
    experiments: &[(&str, &str)],
    cells: &[Cell],
    detectors: &[&str],
    styles: &Styles,
) -> Value {
    let all: Vec<&Cell> = cells.iter().collect();
    let swept = label::swept(&all);
    let is_word = |name: &str| {
        let text = |cell: &Cell| matches!(cell.id.axis(name), Some(AxisValue::Text(_)));
        WORDS.contains(&name)
            || (swept.iter().any(|known| known == name) && all.iter().any(|cell| text(cell)))
    };
    let keys: Vec<&str> = ["experiment", "scene", "dim"]
        .into_iter()
        .chain(swept.iter().map(String::as_str))
        .chain(["order", "n", "seed", "detector", "arithmetic", "threads"])
        .collect();
    debug_assert!(FIELDS.iter().all(|field| keys.contains(field)), "a field of cells is not shown");
    let words: BTreeSet<&str> =
        keys.iter().chain(&MEASURES).copied().filter(|name| is_word(name)).collect();
    let columns: Vec<Value> =
        (keys.iter().map(|name| (name, true)).chain(MEASURES.iter().map(|name| (name, false))))
            .map(|(name, key)| json!({"name": name, "key": key, "text": words.contains(name)}))
            .collect();
    let mut texts = Texts::default();
    let rows: Vec<Value> = cells
        .iter()
        .map(|cell| {
            let (outcome, reason) = cell.overall();
            let key = |name: &&str| match cell.id.axis(name) {
                Some(_) if *name == "detector" => texts.index(&cell.id.contender()),
                Some(value) if words.contains(name) => texts.index(&value.to_string()),
                value => number(value.and_then(|value| value.number())),
            };
            let mut row: Vec<Value> = keys.iter().map(key).collect();
            row.extend(MEASURES.iter().map(|name| match *name {
                "outcome" => texts.index(outcome.name()),
                "reason" => texts.index(reason),
                name => number(measure(cell, name)),
            }));
            Value::Array(row)
        })
        .collect();
    let detector = |name: &&str| {
        let style = styles.get(name);
        json!({"name": name, "mark": marks::outline(style.marker), "control": style.control,
            "filled": !matches!(style.marker, Marker::Cross | Marker::Plus)})
    };
    json!({
        "detectors": detectors.iter().map(detector).collect::<Vec<_>>(),
        "experiments": experiments,
        "columns": columns,
        "texts": texts.1,
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
        lab.param("s", 2)
            .time(&[300, 100, 200])
            .count(&[("contact_test", 60), ("list_push", 40)])
            .memory(1024, 1000);
        lab.edit(|row| row.errors = Some(Errors { missed: 2, ..Errors::default() }));
        lab.param("s", "wide").detector("sorting").fail(Pass::Time, Outcome::Timeout, "30 s");
        let cells = cells::cells(&lab.rows());
        let styles = Styles::new(cells.iter());
        let data = json(&[("e", "A title")], &cells, &["nbs", "sorting"], &styles);
        let at = |row: usize, name: &str| {
            let column = data["columns"]
                .as_array()
                .unwrap()
                .iter()
                .position(|column| column["name"] == name)
                .unwrap();
            let value = data["rows"][row][column].clone();
            match (value.as_u64(), data["columns"][column]["text"].as_bool().unwrap()) {
                (Some(index), true) => data["texts"][index as usize].clone(),
                _ => value,
            }
        };
        assert_eq!(
            ["time_ns", "time_low", "time_high", "blocks"].map(|name| at(0, name)),
            [200, 100, 300, 3].map(|v| json!(v))
        );
        assert_eq!(
            ["operations", "contact_test", "peak_bytes", "wrong"].map(|name| at(0, name)),
            [100, 60, 1024, 2].map(|v| json!(v))
        );
        assert_eq!(
            ["s", "detector", "outcome"].map(|name| at(0, name)),
            ["2", "nbs", "ok"].map(|v| json!(v))
        );
        assert_eq!(
            ["s", "outcome", "reason"].map(|name| at(1, name)),
            ["wide", "timeout", "30 s"].map(|v| json!(v))
        );
        assert_eq!(
            (at(1, "time_ns"), at(1, "error_rate"), at(1, "operations")),
            (Value::Null, Value::Null, Value::Null)
        );
        assert_eq!(data["experiments"], json!([["e", "A title"]]));
    }
}
