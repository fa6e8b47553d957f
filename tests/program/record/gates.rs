//! Tests which columns make a comparison fail, and which are only printed.

use serde_json::Value;

use super::{OTHER, changed, junit, started};
use crate::common::Place;

#[test]
fn a_changed_answer_fails_the_comparison() {
    let at = started();
    at.good("run t.toml --out b --junit run.xml");
    at.ends(0, "compare a b --junit compare.xml", &["passed", "of nbs"]);
    assert_eq!(junit(&at.path("compare.xml")), (28, 0));
    assert_eq!(junit(&at.path("run.xml")), (2, 0), "the claim, right answers");
    // All answers change, because otherwise the record would contradict itself.
    let other = |row: &mut Value| {
        if row["detector"] != "nothing" && row["n"] == 50 && row["dim"] == 2 {
            row["digest"] = OTHER.into()
        }
    };
    changed(&at, "changed", other, |_| ());
    let words = [
        "CHANGED  nbs, exact, packed, 2D, n = 50\n         answer ",
        "CHANGED in 3 cells (28 cells compared",
        "::error title=contactbench compare%3A t.packed%3A nbs%2C exact%2C packed%2C 2D%2C n = \
         50::changed",
    ];
    at.ends(1, "compare a changed --junit compare.xml --annotations", &words);
    assert_eq!(junit(&at.path("compare.xml")), (28, 3));
}

fn slower(row: &mut Value) {
    if let Some(time) = row["time_ns"].as_u64().filter(|_| row["detector"] == "sweep") {
        row["time_ns"] = (10 * time).into();
    }
}

/// Returns the exit code and the JSON of a comparison, and in it the times of the cell of sweep.
fn compared(at: &Place, more: &str) -> (Option<i32>, Value, Value) {
    let ended = at.run(&format!("compare a slower --json {more}"));
    let all: Value = serde_json::from_str(&ended.stdout).unwrap();
    let cells = all["cells"].as_array().unwrap();
    let sweep = cells.iter().find(|cell| cell["key"]["detector"] == "sweep").unwrap();
    (ended.code, all.clone(), sweep["time"].clone())
}

#[test]
fn times_are_shown_and_gated_where_that_is_asked_for_on_one_machine() {
    let at = started();
    changed(&at, "slower", slower, |_| ());
    at.ends(0, "compare a slower --annotations", &["slower", "::warning"]);
    let (code, all, sweep) = compared(&at, "--gate-time");
    assert_eq!((code, &all["passed"]), (Some(1), &false.into()));
    assert_eq!([&all["failed"], &all["summary"]["times"]["slower"]], [7, 7]);
    assert!((9.9..10.1).contains(&sweep["ratio"]["median"].as_f64().unwrap()), "{sweep}");
    assert_eq!(compared(&at, "--gate-time --band 1000").0, Some(0));
    changed(&at, "slower", slower, |fields| fields["profile"] = "another".into());
    assert_eq!(compared(&at, "--against nbs").2["verdict"], "not-judged");
    // Times of another machine are printed without a verdict. If requested, they are judged in
    // units of a detector that both records have. They never fail a gate.
    let elsewhere = |row: &mut Value| {
        slower(row);
        row["machine"] = "other".into();
        if row["role"]["twin"].is_string() {
            row["role"] = "runner".into();
        }
    };
    let host = |fields: &mut Value| {
        (fields["machine"], fields["host"]) = ("other".into(), "other".into());
    };
    changed(&at, "slower", elsewhere, host);
    for (more, verdict) in [
        ("", "not-judged"),
        ("--against nbs", "not-judged"),
        ("--against nbs --across-machines", "slower"),
    ] {
        let (code, _, sweep) = compared(&at, more);
        assert_eq!((code, &sweep["verdict"]), (Some(0), &verdict.into()), "{more}");
        at.ends(2, &format!("compare a slower --gate-time {more}"), &[]);
    }
    at.ends(2, "compare a slower --gate-time", &["two machines"]);
    let ended = at.good("compare a slower");
    assert!(ended.stdout.starts_with("NOTE: "), "{}", ended.stdout);
}

/// A gate on times is an error if it could not fail, as when a control has changed.
#[test]
fn a_gate_that_sees_nothing_is_not_passed() {
    let at = started();
    let times = |factor: fn(u64) -> u64, of: &'static str| {
        move |row: &mut Value| {
            if let Some(time) = row["time_ns"].as_u64()
                && row["detector"].as_str().is_some_and(|name| name.starts_with(of))
            {
                row["time_ns"] = (time * factor(row["block"].as_u64().unwrap())).into();
            }
        }
    };
    at.good("compare a a --gate-time");
    // The time of the twin has changed, although its code is equal.
    changed(&at, "moved", times(|_| 6, "nbs-twin"), |_| ());
    let words = ["nbs-twin", "6.00"];
    at.ends(2, "compare a moved --gate-time", &words);
    let ended = at.ends(0, "compare a moved", &words);
    assert!(!ended.stdout.contains("slower "), "a verdict: {}", ended.stdout);
    // First the times of sweep scatter by a factor of 50, then those of nbs and its twin.
    changed(&at, "noisy", times(|block| [1, 50][block as usize % 2], "sweep"), |_| ());
    at.good("compare noisy noisy --gate-time");
    changed(&at, "noisy", times(|block| [1, 50][block as usize % 2], "nbs"), |_| ());
    let line = "compare noisy noisy --gate-time --against sweep";
    at.ends(2, line, &["slowdowns", "run --against"]);
}
