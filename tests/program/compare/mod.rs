//! Result folders beside each other and put together: shards, machines, revisions; and what
//! continuous integration is told.

mod builds;
mod ci;
mod gates;
mod merge;

use std::path::Path;
use std::sync::OnceLock;

use contactbench::record::row::Row;
use contactbench::record::{ledger, provenance, row, seal};
use serde_json::Value;

use crate::common::{Template, file, good};

const EXPERIMENT: &str = "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\nblocks \
                          = 5\ndetectors = [\"nbs\", \"sweep\", \"nothing\"]\n[[scene]]\nname = \
                          \"packed\"\ndim = [2, 3]\nn = [50, 200]\n[[scene]]\nname = \
                          \"pack-c\"\nn = 100\ns = [2, 5, 9]\n[[claim]]\nname = \"nbs \
                          pushes\"\nkind = \"at-most\"\nvalue = \"n\"\nto = \"list_push\"\nwhere \
                          = { detector = \"nbs\" }\n";

/// A fingerprint that nothing has.
const OTHER: &str = "0x0000000000000001";

fn rows(folder: &Path, name: &str) -> Vec<Row> {
    let record = row::read(&folder.join(name).join(row::FILE)).unwrap();
    assert!(record.warnings.is_empty(), "{:?}", record.warnings);
    record.rows
}

/// A copy of a result folder, with its rows and its provenance changed.
fn changed(
    folder: &Path,
    from: &str,
    to: &str,
    change: impl Fn(&mut Value),
    fields_changed: impl Fn(&mut Value),
) {
    let (from, to) = (folder.join(from), folder.join(to));
    std::fs::create_dir_all(to.join("experiments")).unwrap();
    std::fs::copy(from.join("experiments/t.toml"), to.join("experiments/t.toml")).unwrap();
    std::fs::copy(from.join(ledger::FILE), to.join(ledger::FILE)).unwrap();
    let edit = |text: &str, change: &dyn Fn(&mut Value)| {
        let mut value: Value = serde_json::from_str(text).unwrap();
        change(&mut value);
        value
    };
    // As a run would have written it: one detection in each sample, and a check of the line.
    let change = |row: &mut Value| {
        change(row);
        if row["time_ns"].is_u64() {
            (row["calls"], row["elapsed_ns"]) = (1.into(), row["time_ns"].clone());
        }
    };
    let record = std::fs::read_to_string(from.join(row::FILE)).unwrap();
    let sealed =
        |line: &str| seal::sealed(&edit(&seal::unsealed(line), &change).to_string()) + "\n";
    let lines: Vec<String> = record.lines().map(sealed).collect();
    std::fs::write(to.join(row::FILE), lines.concat()).unwrap();
    let fields = std::fs::read_to_string(from.join(provenance::FILE)).unwrap();
    let fields = provenance::text(&edit(&fields, &fields_changed)).unwrap();
    std::fs::write(to.join(provenance::FILE), fields).unwrap();
}

/// A result folder `a`, with times that do not depend on what else the machine does: 1000 ns and
/// the number of the block.
fn started() -> tempfile::TempDir {
    static RUN: OnceLock<Template> = OnceLock::new();
    let calm = |row: &mut Value| {
        if row["time_ns"].is_u64() {
            row["time_ns"] = (1000 + row["block"].as_u64().unwrap()).into();
        }
    };
    let template = RUN.get_or_init(|| {
        Template::new(|folder| {
            file(folder, "t.toml", EXPERIMENT);
            good(folder, &["run", "t.toml", "--out", "measured"]);
            changed(folder, "measured", "a", calm, |_| ());
        })
    });
    template.copy()
}

/// Test cases and failures of a file that is well-formed.
fn junit(path: &Path) -> (usize, usize) {
    let text = std::fs::read_to_string(path).unwrap();
    let document = roxmltree::Document::parse(&text).unwrap();
    let count = |name: &str| document.descendants().filter(|node| node.has_tag_name(name)).count();
    assert!(
        document
            .descendants()
            .filter(|node| node.has_tag_name("testcase"))
            .all(|case| case.attribute("classname").is_some())
    );
    (count("testcase"), count("failure"))
}
