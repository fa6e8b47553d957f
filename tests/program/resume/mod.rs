//! A killed run continues: wherever it stopped, a resumed run ends with the rows of an undisturbed
//! one, and no result is ever written over.

mod changes;
mod kills;
mod signals;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use contactbench::record::row;
use contactbench::record::row::Measurement;

use crate::common;
use crate::common::{Ended, Template, fake, file, run, runner, say};

/// A whole run of [`experiment`] ends with this, because two of its runners crash in every scene.
const WHOLE: Option<i32> = Some(1);

/// Cells that succeed, are refused, do nothing on purpose, crash in a timed pass (in an arithmetic
/// that only the runner knows), crash at once, and are not there at all.
fn experiment() -> String {
    let loaded = say(r#"{"reply":"loaded"}"#);
    let unsupported = say(r#"{"reply":"unsupported"}"#);
    let fails_late = fake(&[
        ("load", &loaded),
        ("count", &unsupported),
        ("memory", &unsupported),
        ("sample", "exit 3"),
    ]);
    format!(
        "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\nblocks = \
         2\nmemory-limit-mib = 1\ndetectors = [\"nbs\", \"screening\", \
         \"nothing\"]\n[[scene]]\nname = \"pack-c\"\nn = 100\ns = [2, 3000]\n{}{}{}",
        runner("late", "sh", &fails_late),
        runner("early", "sh", &fake(&[("load", "exit 4")])),
        runner("absent", "/no/such/program", "")
    )
}

/// Scenes; rows of nbs, of its twin, of nothing (count, memory, 2 blocks), of late (count, memory, block 1), of
/// early and of absent (one per pass); and screening once good (4 rows), once refused (3).
const ROWS: usize = 2 * (4 + 4 + 4 + 3 + 3 + 3) + 4 + 3;

fn start(folder: &Path, more: &[&str]) -> Ended {
    run(folder, &[&["run", "t.toml", "--out", "result"], more].concat())
}

/// The rows of the result, without their times.
fn steady(folder: &Path) -> BTreeMap<Measurement, String> {
    let record = row::read(&folder.join("result/samples.jsonl")).unwrap();
    assert!(record.warnings.is_empty(), "{:?}", record.warnings);
    common::steady(&record.rows)
}

/// A copy of an undisturbed run in a folder of its own; all tests share one run, and how long it
/// took.
fn undisturbed() -> (tempfile::TempDir, BTreeMap<Measurement, String>, Duration) {
    static RUN: OnceLock<(Template, Duration)> = OnceLock::new();
    let (template, took) = RUN.get_or_init(|| {
        let mut took = Duration::ZERO;
        let template = Template::new(|folder| {
            file(folder, "t.toml", experiment());
            let began = Instant::now();
            let ended = start(folder, &[]);
            took = began.elapsed();
            assert_eq!(ended.code, WHOLE, "{}", ended.stderr);
        });
        (template, took)
    });
    let folder = template.copy();
    let rows = steady(folder.path());
    assert_eq!(rows.len(), ROWS, "{rows:#?}");
    (folder, rows, *took)
}
