//! A killed run continues: wherever it stopped, a resumed run ends with the rows of an undisturbed one, and no result is ever written over.

mod common;

use std::collections::BTreeMap;
use std::path::Path;
use std::time::{Duration, Instant};

use common::{Ended, fake, file, run, runner, say};
use contactbench::harness::record::{self, Row};

/// Cells that succeed, are refused, do nothing on purpose, crash in a timed pass (in an arithmetic that only the runner knows), crash at
/// once, and are not there at all.
fn experiment() -> String {
    let loaded = say(r#"{"reply":"loaded"}"#);
    let unsupported = say(r#"{"reply":"unsupported"}"#);
    let fails_late = fake(&[("load", &loaded), ("count", &unsupported), ("memory", &unsupported), ("sample", "exit 3")]);
    format!(
        "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\nblocks = 2\nmemory-limit-mib = 1\n\
         detectors = [\"nbs\", \"screening\", \"nothing\"]\n[[scene]]\nname = \"pack-c\"\nn = 100\ns = [2, 3000]\n{}{}{}",
        runner("late", "sh", &fails_late),
        runner("early", "sh", &fake(&[("load", "exit 4")])),
        runner("absent", "/no/such/program", "")
    )
}

/// Scenes; rows of nbs, of nothing (count, memory, 2 blocks), of late (count, memory, block 1), of early and of absent (one per pass); and
/// screening once good (4 rows), once refused (3).
const ROWS: usize = 2 * (4 + 4 + 3 + 3 + 3) + 4 + 3;

fn start(folder: &Path, more: &[&str]) -> Ended {
    run(folder, &[&["run", "t.toml", "--out", "result"], more].concat())
}

/// What must be the same whether a run was disturbed or not: everything but the times. Fails if a cell stands twice.
fn steady(folder: &Path) -> BTreeMap<String, String> {
    let record = record::read(&folder.join("result/samples.jsonl")).unwrap();
    assert!(record.warnings.is_empty(), "{:?}", record.warnings);
    let rows = record.rows.len();
    let of = |row: Row| (row.key(), format!("{:?}", Row { time_ns: None, calls: None, elapsed_ns: None, ..row }));
    let steady: BTreeMap<String, String> = record.rows.into_iter().map(of).collect();
    assert_eq!(steady.len(), rows, "a cell was written twice");
    steady
}

/// An undisturbed run in a folder of its own.
fn undisturbed() -> (tempfile::TempDir, BTreeMap<String, String>) {
    let folder = tempfile::tempdir().unwrap();
    file(folder.path(), "t.toml", experiment());
    let ended = start(folder.path(), &[]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let rows = steady(folder.path());
    assert_eq!(rows.len(), ROWS, "{rows:#?}");
    (folder, rows)
}

#[test]
fn a_record_cut_after_any_row_is_completed() {
    let (folder, expected) = undisturbed();
    let path = folder.path().join("result/samples.jsonl");
    let whole = std::fs::read_to_string(&path).unwrap();
    let lines: Vec<&str> = whole.split_inclusive('\n').collect();
    for kept in 0..lines.len() {
        let torn = &lines[kept][..lines[kept].len() / 2];
        std::fs::write(&path, lines[..kept].concat() + torn).unwrap();
        let ended = start(folder.path(), &["--resume"]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        assert!(ended.stderr.contains(&format!("line {} is torn", kept + 1)), "{}", ended.stderr);
        assert!(ended.stderr.contains(&format!("resuming: {kept} rows are there already")), "{}", ended.stderr);
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.starts_with(&lines[..kept].concat()), "rows that were there are left as they are");
        assert_eq!(steady(folder.path()), expected, "after {kept} rows");
    }
    let before = std::fs::read(&path).unwrap();
    assert_eq!(start(folder.path(), &["--resume"]).code, Some(0));
    assert_eq!(std::fs::read(&path).unwrap(), before, "a complete run has nothing to resume");
}

#[test]
fn a_run_killed_at_any_moment_is_completed() {
    let began = Instant::now();
    let (_folder, expected) = undisturbed();
    let whole = began.elapsed();
    let mut cut_short = 0;
    // Moments spread over the run, in an order without pattern: multiples of the golden ratio.
    for seed in 1..=6u32 {
        let part = (f64::from(seed) * 0.618_034).fract();
        let folder = tempfile::tempdir().unwrap();
        file(folder.path(), "t.toml", experiment());
        let mut child = common::program(folder.path(), &["run", "t.toml", "--out", "result"]);
        let mut child = child.stderr(std::process::Stdio::null()).stdout(std::process::Stdio::null()).spawn().unwrap();
        std::thread::sleep(Duration::from_secs_f64(whole.as_secs_f64() * part));
        // SIGKILL: nothing can be tidied up.
        child.kill().unwrap();
        child.wait().unwrap();
        let written = std::fs::read_to_string(folder.path().join("result/samples.jsonl")).unwrap_or_default().lines().count();
        cut_short += usize::from(written > 0 && written < ROWS);
        let ended = start(folder.path(), &["--resume"]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        assert_eq!(steady(folder.path()), expected, "killed after {part} of the time, {written} rows");
    }
    assert!(cut_short > 0, "no kill fell into the run: the test shows nothing");
}

#[test]
fn a_resumed_run_remembers_which_detector_was_too_slow() {
    let loaded = say(r#"{"reply":"loaded"}"#);
    let hangs = fake(&[("load", &loaded), ("count", "exec sleep 60")]);
    let text = experiment().split("[[scene]]").next().unwrap().replace("memory-limit-mib = 1\n", "time-limit-s = 0.5\n");
    let folder = tempfile::tempdir().unwrap();
    file(folder.path(), "t.toml", format!("{text}[[scene]]\nname = \"packed\"\nn = [10, 20]\n{}", runner("hangs", "sh", &hangs)));
    assert_eq!(start(folder.path(), &[]).code, Some(0));
    let expected = steady(folder.path());
    let path = folder.path().join("result/samples.jsonl");
    let text = std::fs::read_to_string(&path).unwrap();
    let first: Vec<&str> = text.split_inclusive('\n').filter(|line| line.contains("\"n\":10,")).collect();
    assert!(first.iter().any(|line| line.contains("timeout")) && first.len() < expected.len());
    std::fs::write(&path, first.concat()).unwrap();
    assert_eq!(start(folder.path(), &["--resume"]).code, Some(0));
    assert_eq!(steady(folder.path()), expected, "the reason says that it was not tried");
}

#[test]
fn a_result_is_never_written_over() {
    let (folder, _) = undisturbed();
    let files = || {
        let all =
            ["samples.jsonl", "provenance.json", "experiments/t.toml"].map(|name| std::fs::read(folder.path().join("result").join(name)));
        all.map(Result::unwrap)
    };
    let before = files();
    file(folder.path(), "t.toml", experiment().replace("blocks = 2", "blocks = 1"));
    let ended = start(folder.path(), &[]);
    assert_eq!(ended.code, Some(2));
    assert_eq!(ended.stderr.lines().count(), 1, "{}", ended.stderr);
    assert!(ended.stderr.contains("--resume") && ended.stderr.contains("--out"), "{}", ended.stderr);
    assert!(before == files());
    // Anything but a torn last line is not repaired.
    let path = folder.path().join("result/samples.jsonl");
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, format!("not a row\n{text}")).unwrap();
    let ended = start(folder.path(), &["--resume"]);
    assert_eq!(ended.code, Some(2));
    assert!(ended.stderr.contains("line 1 is not a row"), "{}", ended.stderr);
}
