//! Tests threads as an axis, and copies of a detector that run at the same time.

use std::collections::BTreeSet;

use contactbench::record::row::{Outcome, Pass, Row};

use super::{of, rows};
use crate::common::{PROGRAM, runner};

#[test]
fn memory_is_measured_with_the_threads_of_the_row_and_sequential_detectors_have_one() {
    let text = "threads = [1, 2]\ndetectors = [\"cell-grid\", \"nbs\"]\n[[scene]]\nname = \
                \"packed\"\nn = 400\n";
    let (_at, rows) = rows(text, 0);
    assert!(of(&rows, "nbs", 400).iter().all(|row| row.id.threads() == 1));
    let memory = |threads| {
        let mut own = of(&rows, "cell-grid", 400).into_iter();
        let row = own.find(|row| row.pass == Pass::Memory && row.id.threads() == threads).unwrap();
        (row.peak_bytes.unwrap(), row.formula_bytes.unwrap())
    };
    let contacts = rows[0].contacts.unwrap();
    let ((peak, formula), (peak_of_two, formula_of_two)) = (memory(1), memory(2));
    assert_eq!(peak, formula);
    // The formula for two threads includes the contacts they collect, not their lists of work.
    assert!(contacts > 400 && formula_of_two >= peak + 8 * contacts, "{formula_of_two}, {peak}");
    let lists = formula_of_two..formula_of_two + (16 << 10);
    assert!(lists.contains(&peak_of_two), "{peak_of_two}, formula {formula_of_two}");
}

/// Returns an experiment with 1 and 2 threads: a detector that uses them, two that do not, and
/// runners that take the number, start with 2 only, or ignore it.
fn threaded(n: &str) -> String {
    let told = format!("exec {PROGRAM} runner --detector direct --threads {{threads}}");
    let particular = format!("[ {{threads}} = 2 ] || exit 7; {told}");
    format!(
        "threads = [1, 2]\nceiling = true\nratios-to = \"nbs\"\ndetectors = \
         [\"direct\", \"nbs\", \"nothing\"]\n[[scene]]\nname = \"packed\"\nn = {n}\n{}{}{}",
        runner("told", "sh", &told),
        runner("particular", "sh", &particular),
        runner("deaf", "sh", &format!("exec {PROGRAM} runner --detector sorting"))
    )
}

#[test]
fn threads_are_an_axis_and_copies_run_beside_them() {
    let (at, rows) = rows(&threaded("[50, 60]"), 0);
    let passes = |detector: &str, threads: u32| -> Vec<(Pass, u32, Outcome)> {
        let own = of(&rows, detector, 60).into_iter().filter(|row| row.id.threads() == threads);
        let mut found: Vec<_> = own.map(|row| (row.pass, row.block, row.outcome)).collect();
        found.sort();
        found
    };
    let alone = |outcome| {
        vec![(Pass::Time, 1, outcome), (Pass::Count, 0, outcome), (Pass::Memory, 0, outcome)]
    };
    let ok = alone(Outcome::Ok);
    let beside = [&ok[..], &[(Pass::Ceiling, 1, Outcome::Ok)]].concat();
    for (detector, one, two) in [
        ("direct", &ok, &beside),
        ("direct-twin", &ok, &vec![]),
        ("told", &ok, &beside),
        ("nbs", &ok, &vec![]),
        ("nothing", &alone(Outcome::Control), &vec![]),
        ("deaf", &ok, &vec![]),
    ] {
        assert_eq!((&passes(detector, 1), &passes(detector, 2)), (one, two), "{detector}");
    }
    // The cell of `particular` with two threads is complete, except that copies cannot run.
    let expected = [&ok[..], &[(Pass::Ceiling, 0, Outcome::Unavailable)]].concat();
    assert_eq!(passes("particular", 2), expected);
    for row in rows.iter().filter(|row| row.pass == Pass::Ceiling && row.outcome == Outcome::Ok) {
        assert!(row.time_ns > Some(0) && row.calls >= Some(2), "{row:?}");
        assert!(row.digest.is_some() && row.counts.is_empty(), "{row:?}");
    }
    // In each of two scenes three subjects have two threads; one of them has no time with one.
    let lines = |name: &str| at.read(&format!("result/{name}")).lines().count();
    assert_eq!(lines("threads.csv"), 1 + 2 * 2);
    assert_eq!(lines("ratios.csv"), 1 + 2 * (2 + 1 + 1 + 2 + 2 + 1));
    let report = at.read("result/report.md");
    for words in ["threads gain", "harness adds"] {
        assert!(report.contains(words), "{words} is not in the report");
    }
}

#[test]
fn ceilings_that_a_killed_run_owes_are_measured_when_it_is_resumed() {
    let (at, before) = rows(&threaded("50"), 0);
    let keys = |rows: &[Row]| rows.iter().map(Row::measurement).collect::<BTreeSet<_>>();
    let text = at.read("result/samples.jsonl");
    let cut: String =
        text.split_inclusive('\n').filter(|line| !line.contains("\"pass\":\"ceiling\"")).collect();
    assert!(cut.len() < text.len());
    at.file("result/samples.jsonl", cut);
    at.good("run t.toml --out result --resume");
    let after = at.rows("result");
    assert_eq!((keys(&after), after.len()), (keys(&before), before.len()));
    at.good("run t.toml --out result --resume");
    assert_eq!(at.rows("result").len(), before.len(), "a complete run has nothing to resume");
}
