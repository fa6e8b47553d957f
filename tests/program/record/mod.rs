//! Tests comparing and merging result folders, their pages, and damaged records.

mod builds;
mod ci;
mod committed;
mod edits;
mod gates;
mod integrity;
mod merge;
mod origins;

use std::path::Path;
use std::sync::OnceLock;

use contactbench::record::folder::{ledger, seal};
use contactbench::record::origin::provenance;
use contactbench::record::row;
use serde_json::Value;

use crate::common::{Place, Template};

const EXPERIMENT: &str = include_str!("../experiments/two_scenes.toml");

/// A fingerprint that none of the scenes and answers has.
const OTHER: &str = "0x0000000000000001";

/// Copies a result folder, and changes its rows and provenance.
fn changed(at: &Place, to: &str, change: impl Fn(&mut Value), fields_changed: impl Fn(&mut Value)) {
    copied(at, ["a", to], change, fields_changed);
}

fn copied(
    at: &Place,
    [from, to]: [&str; 2],
    change: impl Fn(&mut Value),
    fields_changed: impl Fn(&mut Value),
) {
    // Keeps the changed row valid: a sample has one detection, and the checksum is made again.
    let change = |row: &mut Value| {
        change(row);
        if row["time_ns"].is_u64() {
            (row["calls"], row["elapsed_ns"]) = (1.into(), row["time_ns"].clone());
        }
    };
    std::fs::create_dir_all(at.path(to).join("experiments")).unwrap();
    for name in ["experiments/t.toml", ledger::FILE] {
        std::fs::copy(at.path(from).join(name), at.path(to).join(name)).unwrap();
    }
    let record = at.read(&format!("{from}/{}", row::FILE));
    let rows = record.lines().map(|line| edited(line, change) + "\n");
    at.file(&format!("{to}/{}", row::FILE), rows.collect::<String>());
    let fields = at.read(&format!("{from}/{}", provenance::FILE));
    at.file(&format!("{to}/{}", provenance::FILE), edited(&fields, fields_changed));
}

/// Returns a row or a provenance, changed and with a new checksum.
fn edited(text: &str, change: impl FnOnce(&mut Value)) -> String {
    let mut fields: Value = serde_json::from_str(text).unwrap();
    fields.as_object_mut().unwrap().remove(seal::NAME);
    change(&mut fields);
    seal::sealed(&fields.to_string())
}

/// Returns a folder with a record `a` whose times do not depend on the load: 1000 ns plus the
/// number of the block.
fn started() -> Place {
    static RUN: OnceLock<Template> = OnceLock::new();
    let calm = |row: &mut Value| {
        if row["time_ns"].is_u64() {
            row["time_ns"] = (1000 + row["block"].as_u64().unwrap()).into();
        }
    };
    let template = RUN.get_or_init(|| {
        Template::new(|at| {
            at.file("t.toml", EXPERIMENT);
            at.good("run t.toml --out measured");
            copied(at, ["measured", "a"], calm, |_| ());
        })
    });
    template.place()
}

/// Returns the numbers of test cases and failures in JUnit XML.
pub fn junit(path: &Path) -> (usize, usize) {
    let text = std::fs::read_to_string(path).unwrap();
    let document = roxmltree::Document::parse(&text).unwrap();
    let count = |name: &str| document.descendants().filter(|node| node.has_tag_name(name)).count();
    let mut cases = document.descendants().filter(|node| node.has_tag_name("testcase"));
    assert!(cases.all(|case| case.attribute("classname").is_some()));
    (count("testcase"), count("failure"))
}
