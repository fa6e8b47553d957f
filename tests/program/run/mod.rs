//! Tests runs of experiments: each planned cell has its rows, a failure has an outcome and a reason
//! and harms no other runner, and a stopped run can be completed.

mod errors;
mod failures;
mod hostile;
mod recommend;
mod resume;
mod rows;
mod signals;
mod threads;

use contactbench::record::row::Row;

use crate::common::Place;

const HEAD: &str = "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\nblocks = 1\n";

const SPARSE: &str = "[[scene]]\nname = \"pack-c\"\nn = 25\ns = 5\n";

const EMPTY: &str = "0x0000000000000000";

/// Runs an experiment, which must end with this exit code; returns the folder and the rows.
fn rows(text: &str, code: i32) -> (Place, Vec<Row>) {
    let at = Place::new();
    at.file("t.toml", format!("{HEAD}{text}"));
    at.ends(code, "run t.toml --out result", &[]);
    let rows = at.rows("result");
    (at, rows)
}

fn of<'a>(rows: &'a [Row], detector: &str, n: u64) -> Vec<&'a Row> {
    rows.iter().filter(|row| row.id.detector == detector && row.id.n == n).collect()
}
