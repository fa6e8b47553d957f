//! What fails a comparison, and what is only shown.

use std::path::Path;

use contactbench::record::row;
use serde_json::Value;

use super::{OTHER, changed, junit, started};
use crate::common::{good, refused, run};

#[test]
fn counts_bytes_and_digests_are_gated_and_times_are_not() {
    let folder = started();
    let folder = folder.path();
    good(folder, &["run", "t.toml", "--out", "b", "--junit", "run.xml"]);
    let ended = good(folder, &["compare", "a", "b", "--junit", "compare.xml"]);
    assert!(
        ended.stdout.contains("compare: passed")
            && ended.stdout.contains("times: each a multiple of that of nbs"),
        "{}",
        ended.stdout
    );
    assert_eq!(junit(&folder.join("compare.xml")), (28, 0));
    assert_eq!(junit(&folder.join("run.xml")), (2, 0), "the claim, right answers");
    for (what, change) in [
        (
            "list_push",
            (|row| {
                if row["detector"] == "nbs"
                    && row["n"] == 50
                    && row["dim"] == 2
                    && row["pass"] == "count"
                {
                    row["counts"]["list_push"] = 51.into();
                }
            }) as fn(&mut Value),
        ),
        ("peak_bytes", |row| {
            if row["detector"] == "nbs"
                && row["n"] == 50
                && row["dim"] == 2
                && row["pass"] == "memory"
            {
                (row["peak_bytes"], row["live_bytes"]) = (1.into(), 1.into());
            }
        }),
        // A record in which only one of them has it would contradict itself.
        ("answer", |row| {
            if row["detector"] != "nothing" && row["n"] == 50 && row["dim"] == 2 {
                row["digest"] = OTHER.into()
            }
        }),
        ("outcome (time)", |row| {
            if row["detector"] == "nbs"
                && row["n"] == 50
                && row["dim"] == 2
                && row["pass"] == "time"
            {
                row["outcome"] = "wrong".into();
            }
        }),
        ("scene", |row| {
            if row["n"] == 50 && row["dim"] == 2 {
                row["stats"]["scene_hash"] = OTHER.into()
            }
        }),
    ] {
        let cells = match what {
            "answer" => 3,
            "scene" => 4,
            _ => 1,
        };
        let count = if cells == 1 { "1 cell".into() } else { format!("{cells} cells") };
        changed(folder, "a", "changed", change, |_| ());
        let ended =
            run(folder, &["compare", "a", "changed", "--junit", "compare.xml", "--annotations"]);
        assert_eq!(ended.code, Some(1), "{what}: {}", ended.stdout);
        assert!(
            ended.stdout.contains("CHANGED  nbs, exact, packed, 2D, n = 50\n"),
            "{what}: {}",
            ended.stdout
        );
        assert!(ended.stdout.contains(&format!("         {what} ")), "{what}: {}", ended.stdout);
        let words = format!("CHANGED in {count} (28 cells compared");
        assert!(ended.stdout.contains(&words), "{}", ended.stdout);
        assert!(ended.stdout.contains(
            "::error title=contactbench compare%3A t.packed%3A nbs%2C exact%2C packed%2C 2D%2C n \
             = 50::changed"
        ));
        assert_eq!(junit(&folder.join("compare.xml")), (28, cells));
    }
    // Ten times as slow: said, and gated only where that is asked for.
    let slower: fn(&mut Value) = |row| {
        if let Some(time) = row["time_ns"].as_u64().filter(|_| row["detector"] == "sweep") {
            row["time_ns"] = (10 * time).into();
        }
    };
    changed(folder, "a", "slower", slower, |_| ());
    let ended = good(folder, &["compare", "a", "slower", "--annotations"]);
    assert!(
        ended.stdout.contains("slower") && ended.stdout.contains("::warning"),
        "{}",
        ended.stdout
    );
    let json = |more: &[&str]| -> (Option<i32>, Value) {
        let ended = run(folder, &[&["compare", "a", "slower", "--json"], more].concat());
        (ended.code, serde_json::from_str(&ended.stdout).unwrap())
    };
    let (code, all) = json(&["--gate-time"]);
    assert_eq!(
        (code, &all["passed"], &all["summary"]["failed"], &all["summary"]["times"]["slower"]),
        (Some(1), &false.into(), &7.into(), &7.into())
    );
    let sweep = |all: &Value| {
        all["cells"]
            .as_array()
            .unwrap()
            .iter()
            .find(|cell| cell["key"]["detector"] == "sweep")
            .unwrap()
            .clone()
    };
    let ratio = sweep(&all)["time"]["ratio"].as_f64().unwrap();
    assert!((9.9..10.1).contains(&ratio), "{ratio}");
    assert_eq!(json(&["--gate-time", "--band", "1000"]).0, Some(0));
    // Another machine, and no control in both: shown, not judged, unless against a detector of
    // both.
    let no_control = |row: &mut Value| {
        if row["role"]["twin"].is_string() {
            row["role"] = "runner".into();
        }
    };
    changed(
        folder,
        "a",
        "slower",
        |row| {
            slower(row);
            no_control(row);
            row["machine"] = "other".into();
        },
        |fields| (fields["machine"], fields["host"]) = ("other".into(), "other".into()),
    );
    let (code, all) = json(&[]);
    assert_eq!((code, &sweep(&all)["time"]["verdict"]), (Some(0), &"not-judged".into()));
    // A gate that judges nothing is not passed.
    refused(
        folder,
        &["compare", "a", "slower", "--gate-time"],
        &["no time could be judged", "two machines"],
    );
    assert!(all["times"].as_str().unwrap().contains("two machines: "), "{}", all["times"]);
    // A control in both does not make one machine of two, and two are never gated.
    refused(
        folder,
        &["compare", "a", "slower", "--gate-time", "--against", "nbs"],
        &["no time could be judged", "two machines"],
    );
    let across = ["--against", "nbs", "--across-machines"];
    let (code, all) = json(&across[..2]);
    assert_eq!((code, &sweep(&all)["time"]["verdict"]), (Some(0), &"not-judged".into()));
    let (code, all) = json(&across);
    assert_eq!((code, &sweep(&all)["time"]["verdict"]), (Some(0), &"slower".into()));
    let gated = [&["compare", "a", "slower", "--gate-time"], &across[..]].concat();
    assert_eq!(run(folder, &gated).code, Some(2));
    // Names of virtual machines tell nothing: processors are named, and first.
    let ended = good(folder, &["compare", "a", "slower"]);
    assert!(ended.stdout.starts_with("NOTE: two machines: "), "{}", ended.stdout);
    changed(folder, "a", "slower", slower, |fields| fields["profile"] = "another".into());
    let (code, all) = json(&["--against", "nbs"]);
    assert_eq!(
        (code, &sweep(&all)["time"]["verdict"]),
        (Some(0), &"not-judged".into()),
        "{}",
        all["times"]
    );
}

/// A run that was cut short has not passed what it has not measured.
#[test]
fn what_one_has_not_measured_is_lacking() {
    let folder = started();
    let folder = folder.path();
    changed(folder, "a", "cut", |_| (), |_| ());
    let record = folder.join("cut").join(row::FILE);
    let text = std::fs::read_to_string(&record).unwrap();
    let kept: String = text
        .lines()
        .filter(|line| !line.contains("\"pass\":\"time\""))
        .map(|line| format!("{line}\n"))
        .collect();
    assert!(kept.len() < text.len());
    std::fs::write(&record, kept).unwrap();
    let ended = good(folder, &["compare", "a", "cut"]);
    assert!(ended.stdout.contains("28 measured in part in one"), "{}", ended.stdout);
    let ended = run(folder, &["compare", "a", "cut", "--strict"]);
    assert!(
        ended.code == Some(1) && ended.stdout.contains("the time pass only in A"),
        "{}",
        ended.stdout
    );
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let folder = started();
    let folder = folder.path();
    refused(folder, &["compare", "a", "none"], &["cannot read the record none/samples.jsonl"]);
    refused(
        folder,
        &["compare", "a", "a", "--against", "bvh"],
        &["--against bvh: a has no rows of this detector", "nbs, nbs-twin, nothing, sweep"],
    );
    refused(
        folder,
        &["compare", "a", "a", "--band", "-1"],
        &["--band -1: give percent from 0 to 1000"],
    );
    changed(folder, "a", "b", |row| row["seed"] = 7.into(), |_| ());
    refused(folder, &["compare", "a", "b"], &["a and b have no cell in common"]);
    // Records of an older schema.
    let old = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/records/schema-3");
    let old = old.display().to_string();
    let ended = good(folder, &["compare", &old, &old, "--strict", "--against", "nbs"]);
    assert!(ended.stdout.contains("the same everywhere"), "{}", ended.stdout);
}

/// The gate is passed only by a comparison that could have failed.
#[test]
fn a_gate_that_sees_nothing_is_not_passed() {
    let folder = started();
    let folder = folder.path();
    let times = |factor: fn(u64) -> u64, of: &'static str| {
        move |row: &mut Value| {
            if let Some(time) = row["time_ns"].as_u64()
                && row["detector"].as_str().is_some_and(|name| name.starts_with(of))
            {
                row["time_ns"] = (time * factor(row["block"].as_u64().unwrap())).into();
            }
        }
    };
    changed(folder, "a", "same", |_| (), |_| ());
    good(folder, &["compare", "a", "same", "--gate-time"]);
    // Equal code that moved.
    changed(folder, "a", "moved", times(|_| 6, "nbs-twin"), |_| ());
    let words = ["nbs-twin is equal code and moved by 6.00: nothing is decided"];
    refused(folder, &["compare", "a", "moved", "--gate-time"], &words);
    let ended = good(folder, &["compare", "a", "moved"]);
    assert!(ended.stdout.contains(words[0]) && !ended.stdout.contains("slower "), "a verdict");
    // Times that scatter by a factor of 50.
    changed(folder, "a", "noisy", times(|block| [1, 50][block as usize % 2], "sweep"), |_| ());
    let ended = run(folder, &["compare", "noisy", "noisy", "--gate-time"]);
    assert_eq!(ended.code, Some(0), "one of two detectors sees: {}", ended.stderr);
    changed(folder, "a", "noisy", times(|block| [1, 50][block as usize % 2], "nbs"), |_| ());
    refused(
        folder,
        &["compare", "noisy", "noisy", "--gate-time", "--against", "sweep"],
        &["this comparison can only find slowdowns of ", "run --against"],
    );
}
