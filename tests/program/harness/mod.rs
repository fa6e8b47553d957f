//! From experiment files to records, with the program itself and with runners that fail in every
//! way there is: each planned cell has its rows, each failure its outcome and reason, and costs no
//! other runner anything.

mod failures;
mod rows;
mod threads;

use std::path::Path;

use contactbench::record::row;
use contactbench::record::row::Row;

use crate::common::say;

const HEAD: &str = "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\nblocks = 2\n";

/// Runs an experiment to its end; gives the rows, the exit code and what was said on standard
/// error.
fn rows(folder: &Path, text: &str) -> (Vec<Row>, Option<i32>, String) {
    crate::common::file(folder, "t.toml", text);
    let ended = crate::common::run(folder, &["run", "t.toml", "--out", "result"]);
    let record = row::read(&folder.join("result/samples.jsonl"));
    (record.unwrap_or_else(|e| panic!("{e}: {}", ended.stderr)).rows, ended.code, ended.stderr)
}

fn of<'a>(rows: &'a [Row], detector: &str, n: u64) -> Vec<&'a Row> {
    rows.iter().filter(|row| row.id.detector == detector && row.id.n == n).collect()
}

/// Shell code that answers with a sample of a time that can be.
fn takes_its_time(fields: &str) -> String {
    let times = r#""time_ns":300000,"calls":1,"elapsed_ns":300000"#;
    format!("sleep 0.002; {}", say(&format!(r#"{{"reply":"sample",{times},{fields}}}"#)))
}
