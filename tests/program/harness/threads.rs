//! Threads as an axis, copies beside each other, and what both take.

use std::collections::BTreeSet;

use contactbench::record::row;
use contactbench::record::row::{Outcome, Pass, Row};

use super::{HEAD, of, rows};
use crate::common::{PROGRAM, runner};

#[test]
fn memory_is_measured_with_the_threads_of_the_row() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "{HEAD}threads = [1, 2]\ndetectors = [\"cell-grid\"]\n[[scene]]\nname = \"packed\"\nn = \
         400\n"
    );
    let (rows, code, stderr) = rows(folder.path(), &text);
    assert_eq!(code, Some(0), "{stderr}");
    let memory = |threads| {
        let row = rows.iter().find(|row| row.pass == Pass::Memory && row.id.threads() == threads);
        (row.unwrap().peak_bytes.unwrap(), row.unwrap().formula_bytes.unwrap())
    };
    let contacts = rows[0].contacts.unwrap();
    let ((peak, formula), (peak_of_two, formula_of_two)) = (memory(1), memory(2));
    assert_eq!(peak, formula);
    // The contacts that the threads have found are collected, and in the formula; what their lists
    // are listed in is not.
    assert!(contacts > 400 && formula_of_two >= peak + 8 * contacts, "{formula_of_two}, {peak}");
    let lists = formula_of_two..formula_of_two + (16 << 10);
    assert!(lists.contains(&peak_of_two), "{peak_of_two}, formula {formula_of_two}");
}

#[test]
fn a_sequential_detector_is_never_said_to_use_threads() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "{HEAD}threads = 2\ndetectors = [\"direct\", \"nbs\"]\n[[scene]]\nname = \"packed\"\nn = \
         50\n"
    );
    let (rows, code, stderr) = rows(folder.path(), &text);
    assert_eq!(code, Some(0), "{stderr}");
    for (detector, threads) in [("direct", 2), ("nbs", 1)] {
        assert!(
            of(&rows, detector, 50).len() == 4
                && of(&rows, detector, 50).iter().all(|row| row.id.threads() == threads),
            "{detector}"
        );
    }
}

/// Threads 1 and 2; a detector that has a use for them, two that have none, a runner that is told,
/// and one that is there with two only.
fn threaded() -> String {
    let told = format!("exec {PROGRAM} runner --detector direct --threads {{threads}}");
    let particular = format!("[ {{threads}} = 2 ] || exit 7; {told}");
    format!(
        "{HEAD}threads = [1, 2]\nceiling = true\nratios-to = \"nbs\"\nbound = true\n\
         detectors = [\"direct\", \"nbs\", \"nothing\"]\n[[scene]]\nname = \"packed\"\nn = \
         [50, 60]\n{}{}{}",
        runner("told", "sh", &told),
        runner("particular", "sh", &particular),
        runner("deaf", "sh", &format!("exec {PROGRAM} runner --detector sorting"))
    )
}

#[test]
fn threads_are_an_axis_and_copies_run_beside_them() {
    let folder = tempfile::tempdir().unwrap();
    let (rows, code, stderr) = rows(folder.path(), &threaded());
    assert_eq!(code, Some(0), "{stderr}");
    let passes = |detector: &str, threads: u32| -> Vec<(Pass, u32, Outcome)> {
        let mut found: Vec<_> = of(&rows, detector, 60)
            .iter()
            .filter(|row| row.id.threads() == threads)
            .map(|r| (r.pass, r.block, r.outcome))
            .collect();
        found.sort();
        found
    };
    let alone = |outcome| {
        vec![
            (Pass::Time, 1, outcome),
            (Pass::Time, 2, outcome),
            (Pass::Count, 0, outcome),
            (Pass::Memory, 0, outcome),
        ]
    };
    let beside = [
        alone(Outcome::Ok),
        vec![(Pass::Ceiling, 1, Outcome::Ok), (Pass::Ceiling, 2, Outcome::Ok)],
    ]
    .concat();
    for (detector, one, two) in [
        ("direct", alone(Outcome::Ok), beside.clone()),
        ("direct-twin", alone(Outcome::Ok), vec![]),
        ("told", alone(Outcome::Ok), beside),
        ("nbs", alone(Outcome::Ok), vec![]),
        ("nothing", alone(Outcome::Control), vec![]),
        ("deaf", alone(Outcome::Ok), vec![]),
    ] {
        assert_eq!((passes(detector, 1), passes(detector, 2)), (one, two), "{detector}");
    }
    // Without the copies its cell with two threads is whole.
    let two = passes("particular", 2);
    assert_eq!(two[..4], alone(Outcome::Ok));
    assert_eq!(two[4..], [(Pass::Ceiling, 0, Outcome::Unavailable)]);
    for row in rows.iter().filter(|row| row.pass == Pass::Ceiling && row.outcome == Outcome::Ok) {
        assert!(
            row.time_ns > Some(0)
                && row.calls >= Some(2)
                && row.digest.is_some()
                && row.counts.is_empty(),
            "{row:?}"
        );
    }
    let read =
        |name: &str| std::fs::read_to_string(folder.path().join("result").join(name)).unwrap();
    // Two scenes with three contenders of two threads, but that one of them has no time with one.
    assert_eq!(read("threads.csv").lines().count(), 1 + 2 * 2, "{}", read("threads.csv"));
    assert_eq!(
        read("ratios.csv").lines().count(),
        1 + 2 * (2 + 1 + 1 + 2 + 2 + 1),
        "{}",
        read("ratios.csv")
    );
    let report = read("report.md");
    for words in [
        "### Who is how fast, against nbs",
        "### What threads gain",
        "### What the harness adds",
        "asks for bound, which an older program computed",
    ] {
        assert!(report.contains(words), "{words} is not in the report");
    }
}

#[test]
fn ceilings_that_a_killed_run_owes_are_measured_when_it_is_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let (before, code, stderr) = rows(folder.path(), &threaded().replace("n = [50, 60]", "n = 50"));
    assert_eq!(code, Some(0), "{stderr}");
    let keys = |rows: &[Row]| rows.iter().map(Row::measurement).collect::<BTreeSet<_>>();
    let path = folder.path().join("result/samples.jsonl");
    let text = std::fs::read_to_string(&path).unwrap();
    let cut: String =
        text.split_inclusive('\n').filter(|line| !line.contains("\"pass\":\"ceiling\"")).collect();
    assert!(cut.len() < text.len());
    std::fs::write(&path, cut).unwrap();
    let resume =
        || crate::common::run(folder.path(), &["run", "t.toml", "--out", "result", "--resume"]);
    assert_eq!(resume().code, Some(0));
    let after = row::read(&path).unwrap().rows;
    assert_eq!((keys(&after), after.len()), (keys(&before), before.len()));
    assert_eq!(resume().code, Some(0));
    assert_eq!(
        row::read(&path).unwrap().rows.len(),
        before.len(),
        "a complete run has nothing to resume"
    );
}
