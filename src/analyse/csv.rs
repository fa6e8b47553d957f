//! `summary.csv`: one line per cell with all its values.

use std::collections::BTreeSet;

use super::errors;
use super::interval::{mad, median};
use super::text;
use super::value::{Cell, FIELDS};

/// One line per cell with all its values, as CSV.
pub fn csv(cells: &[Cell]) -> String {
    let params: BTreeSet<&str> = cells.iter().flat_map(|cell| cell.key.params.iter().map(|(name, _)| name.as_str())).collect();
    let counts: BTreeSet<&str> = cells.iter().filter_map(|cell| cell.counts.as_ref()).flat_map(|c| c.keys().map(String::as_str)).collect();
    let bytes = ["peak_bytes", "live_bytes", "allocations", "warm_allocations", "formula_bytes"];
    let stats = ["packing_fraction", "coordination", "radius_ratio"];
    let times = ["time_ns_median", "time_ns_low", "time_ns_high", "time_ns_min", "time_ns_mad", "blocks"];
    let errors: Vec<String> = errors::names().collect();
    // Only where copies were timed: other tables keep their columns.
    let beside: &[&str] = if cells.iter().any(|cell| !cell.beside.is_empty()) { &["beside_ns_median"] } else { &[] };
    let head: Vec<String> = FIELDS
        .into_iter()
        .chain(params.iter().copied())
        .chain(["outcome", "reason"])
        .chain(times)
        .chain(beside.iter().copied())
        .chain(["contacts"])
        .chain(counts.iter().copied())
        .chain(bytes)
        .chain(["true_contacts"])
        .chain(errors.iter().map(String::as_str))
        .chain(stats)
        .map(text::quote)
        .collect();
    let mut out = head.join(",") + "\n";
    for cell in cells {
        let (outcome, reason) = cell.overall();
        let mut line: Vec<String> =
            FIELDS.iter().chain(&params).map(|name| cell.key.field(name).map_or(String::new(), |v| v.to_string())).collect();
        line.extend([outcome.name().to_string(), reason.to_string()]);
        match cell.time() {
            Some(time) => {
                let all: Vec<f64> = cell.times.values().map(|&t| t as f64).collect();
                let least = all.iter().copied().fold(f64::INFINITY, f64::min);
                let mad = mad(&all).unwrap_or(0.0);
                line.extend([time.median, time.low, time.high, least, mad, time.count as f64].map(|v| v.to_string()));
            }
            None => line.extend(times.map(|_| String::new())),
        }
        let copies: Vec<f64> = cell.beside.values().map(|&t| t as f64).collect();
        line.extend(beside.iter().map(|_| median(&copies).map_or(String::new(), |v| v.to_string())));
        let number = |name: &str| cell.variable(name, None).map_or(String::new(), |v| v.to_string());
        line.push(number("contacts"));
        let errors = errors.iter().map(String::as_str);
        line.extend(counts.iter().copied().chain(bytes).chain(["true_contacts"]).chain(errors).chain(stats).map(number));
        out += &line.iter().map(|text| text::quote(text)).collect::<Vec<_>>().join(",");
        out.push('\n');
    }
    out
}
