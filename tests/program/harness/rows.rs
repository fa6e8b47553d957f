//! What is planned has its rows, with all fields; what cannot be meant is refused.

use std::collections::BTreeSet;

use contactbench::record::row::{Measurement, Outcome, Pass, Row};
use serde_json::Value;

use super::{HEAD, of, rows, takes_its_time};
use crate::common::{fake, runner, say};

#[test]
fn every_planned_cell_has_its_rows_and_the_answers_are_right() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "{HEAD}detectors = [\"screening\", \"nbs\", \"nothing\"]\narithmetics = \
         [\"f32\", \"exact\"]\n[[scene]]\nname = \"packed\"\ndim = [2, 3]\nn = [0, 60]\nseed = \
         [1, 2]\n[[scene]]\nname = \"pack-c\"\nn = 16\ns = [1, 3]\n"
    );
    let (rows, code, _) = rows(folder.path(), &text);
    assert_eq!(code, Some(0));
    let keys: BTreeSet<Measurement> = rows.iter().map(Row::measurement).collect();
    assert_eq!(keys.len(), rows.len(), "no cell has two rows");
    // Packed: 2 dimensions, 2 sizes, 2 seeds; pack C: 2 spacings. 3 detectors, 2 arithmetics, and
    // a twin in the first of them; counts, memory and 2 blocks.
    assert_eq!(rows.len(), (2 * 2 * 2 + 2) * (3 * 2 + 1) * (1 + 1 + 2));
    for row in &rows {
        assert_eq!(
            row.outcome,
            if row.id.detector == "nothing" { Outcome::Control } else { Outcome::Ok },
            "{row:?}"
        );
        assert_eq!(row.block > 0, row.pass == Pass::Time);
        assert_eq!(row.time_ns.is_some(), row.pass == Pass::Time);
        assert_eq!(row.peak_bytes.is_some(), row.pass == Pass::Memory);
        assert_eq!(row.counts.is_empty(), row.pass != Pass::Count);
        let others = rows
            .iter()
            .filter(|other| other.stats == row.stats && other.id.arithmetic == row.id.arithmetic);
        assert!(
            row.id.detector == "nothing"
                || others.filter(|o| o.id.detector != "nothing").all(|o| o.digest == row.digest)
        );
    }
    assert!(rows.iter().any(|row| row.contacts > Some(60)), "the packed scenes have contacts");
    let nothing = rows.iter().find(|row| row.id.detector == "nothing" && row.id.n == 60).unwrap();
    assert_eq!((nothing.contacts, nothing.reason.contains("control")), (Some(0), true));
}

#[test]
fn a_row_has_the_fields_of_the_format() {
    let folder = tempfile::tempdir().unwrap();
    let (rows, ..) = rows(
        folder.path(),
        &format!("{HEAD}detectors = [\"nbs\"]\n[[scene]]\nname = \"loose\"\nn = 20\n"),
    );
    assert!(!rows.is_empty());
    let names =
        |value: &Value| value.as_object().unwrap().keys().cloned().collect::<BTreeSet<String>>();
    let text = std::fs::read_to_string(folder.path().join("result/samples.jsonl")).unwrap();
    let published = "experiment scene params dim n seed order detector arithmetic pass \
                     block time_ns outcome reason contacts digest counts peak_bytes live_bytes \
                     allocations formula_bytes stats";
    // What the format has beyond the fields promised.
    let more = "first_ns calls elapsed_ns warm_allocations errors causes schema machine role resources \
         process check";
    let expected: BTreeSet<String> =
        published.split_whitespace().chain(more.split_whitespace()).map(String::from).collect();
    for line in text.lines() {
        let row: Value = serde_json::from_str(line).unwrap();
        let mut said = names(&row);
        let timed = row["pass"] == "time" && cfg!(target_os = "linux");
        for place in ["span", "processor"] {
            assert_eq!(said.remove(place), timed, "{line}");
        }
        for beside in ["began_ms", "pulse_ns"] {
            assert_eq!(said.remove(beside), row["pass"] == "time", "{line}");
        }
        assert_eq!(said, expected);
        let stats =
            ["box_diameters", "coordination", "packing_fraction", "radius_ratio", "scene_hash"];
        assert_eq!(names(&row["stats"]), stats.map(String::from).into());
        for whole in ["dim", "n", "seed", "block", "contacts"] {
            assert!(row[whole].is_u64(), "{whole} in {line}");
        }
        assert!(row["resources"]["threads"].is_u64(), "{line}");
        assert_eq!(row["time_ns"].is_u64(), row["pass"] == "time");
        assert_eq!(row["first_ns"].is_u64(), row["pass"] == "time");
        // A sample is many detections, however short one is.
        if row["pass"] == "time" {
            let (calls, elapsed) = (&row["calls"], &row["elapsed_ns"]);
            assert!(calls.as_u64() > Some(100) && elapsed.as_u64() > Some(1_000_000), "{line}");
        }
        assert_eq!(row["digest"].as_str().unwrap().len(), "0x".len() + 16);
        assert_eq!(row["outcome"], "ok");
    }
}

#[test]
fn a_runner_of_version_1_is_given_the_path_of_its_scene() {
    let path = r#"case "$line" in *'"path":"'*scene-0.npy*) echo '{"reply":"loaded"}' ;; *) echo '{"reply":"error","reason":"no path"}' ;; esac"#;
    let sample = takes_its_time(r#""contacts":0,"digest":"0x0000000000000000""#);
    let unsupported = say(r#"{"reply":"unsupported"}"#);
    let new = fake(&[
        ("load", path),
        ("sample", &sample),
        ("count", &unsupported),
        ("memory", &unsupported),
    ]);
    let old = new.replace("\"protocol\":2", "\"protocol\":1");
    assert_ne!(old, new);
    let text = format!(
        "{HEAD}detectors = [\"nbs\"]\n[[scene]]\nname = \"pack-c\"\nn = 25\ns = 5\n{}{}",
        runner("old", "sh", &old),
        runner("new", "sh", &new)
    );
    let folder = tempfile::tempdir().unwrap();
    let (rows, _, stderr) = rows(folder.path(), &text);
    let old = of(&rows, "old", 25);
    assert!(old.len() == 4 && old.iter().all(|row| row.outcome == Outcome::Ok), "{stderr}");
    let new = of(&rows, "new", 25);
    assert!(new.iter().all(|row| row.reason == "no path"), "{new:?}");
}

#[test]
fn an_experiment_that_cannot_be_meant_is_refused() {
    let scene = "[[scene]]\nname = \"packed\"\nn = 10\n";
    let folder = tempfile::tempdir().unwrap();
    for (line, words) in [
        ("detectors = [\"nbs\", \"nbs\"]", "two runners named 'nbs'"),
        ("detectors = [\"nsb\"]", "there is no detector 'nsb'"),
        ("detectors = [\"nbs\"]\ntime-limit-s = -1", "time-limit-s = -1"),
        ("detectors = [\"nbs\"]\ntime-limit-s = inf", "time-limit-s = inf"),
        (
            "detectors = [\"nbs\"]\nmemory-limit-mib = 17592186044416",
            "memory-limit-mib = 17592186044416",
        ),
        ("detectors = [\"nbs\"]\nthreads = 0", "threads = 0"),
        ("detectors = [\"nbs\"]\nthreads = [1, 0]", "threads = 0"),
        ("detectors = [\"nbs\"]\nthreads = []", "threads is empty"),
        ("detectors = [\"nbs\"]\nthreads = [2, 1, 2]", "threads names a number twice"),
        ("detectors = [\"nbs\"]\nthreads = 1000000", "at most 1024"),
        ("detectors = [\"direct\"]\nthreads = 2\nceiling = true", "say threads = [1, 2]"),
        (
            "detectors = [\"nbs\"]\nratios-to = \"sorting\"",
            "ratios-to = \"sorting\": it must be one of",
        ),
        (
            "detectors = [\"nbs\"]\n[[figure]]\nname = \"f\"\ntitle = \"F\"\nx = \"s\"\nx-label = \
             \"s\"\ny = \"n\"\ny-label = \"n\"\ncaches = true",
            "its x must be n",
        ),
        ("detectors = [\"nbs\"]\nblock-budget-s = nan", "budget"),
        ("detectors = [\"nbs\"]\nblokcs = 3", "blokcs"),
        ("detectors = [\"nbs\"]\ntable = \"verdict\"", "verdicts"),
        (
            "detectors = [\"nbs\"]\n[[figure]]\nname = \"f\"\ntitle = \"F\"",
            "line 7, column 1: the key 'x' is missing",
        ),
    ] {
        crate::common::file(folder.path(), "t.toml", format!("{HEAD}{line}\n{scene}"));
        let ended = crate::common::run(folder.path(), &["run", "t.toml", "--out", "result"]);
        assert_eq!(ended.code, Some(2), "{line}");
        assert!(ended.stderr.contains(words), "{line}: {}", ended.stderr);
        assert!(!folder.path().join("result").exists(), "{line}: nothing is written");
    }
    crate::common::file(folder.path(), "t.toml", format!("{HEAD}detectors = [\"nbs\"]\n{scene}"));
    let twice = crate::common::run(folder.path(), &["run", "t.toml", "t.toml", "--out", "result"]);
    assert_eq!(twice.code, Some(2));
    assert!(twice.stderr.contains("two experiments named 't'"), "{}", twice.stderr);
}
