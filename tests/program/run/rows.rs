//! Each planned cell has its rows with all fields.

use std::collections::BTreeSet;

use contactbench::record::row::{Measurement, Outcome, Pass, Row};
use serde_json::Value;

use super::{EMPTY, rows};

#[test]
fn every_planned_cell_has_its_rows_and_the_answers_are_right() {
    let text = "detectors = [\"screening\", \"nbs\", \"nothing\"]\narithmetics = [\"f32\", \
                \"exact\"]\n[[scene]]\nname = \"packed\"\ndim = [2, 3]\nn = [0, 60]\nseed = [1, \
                2]\n[[scene]]\nname = \"pack-c\"\nn = 16\ns = [1, 3]\n";
    let (_at, rows) = rows(text, 0);
    let keys: BTreeSet<Measurement> = rows.iter().map(Row::measurement).collect();
    assert_eq!(keys.len(), rows.len(), "no cell has two rows");
    // packed has 2 dimensions, 2 sizes, 2 seeds; pack-c 2 spacings. Each scene has 3 detectors in 2
    // arithmetics and a twin in the first; each of them has counts, memory and one block.
    assert_eq!(rows.len(), (2 * 2 * 2 + 2) * (3 * 2 + 1) * (1 + 1 + 1));
    for row in &rows {
        let control = row.id.detector == "nothing";
        assert_eq!(row.outcome, if control { Outcome::Control } else { Outcome::Ok }, "{row:?}");
        assert_eq!(row.block > 0, row.pass == Pass::Time);
        assert_eq!(row.time_ns.is_some(), row.pass == Pass::Time);
        assert_eq!(row.peak_bytes.is_some(), row.pass == Pass::Memory);
        assert_eq!(row.counts.is_empty(), row.pass != Pass::Count);
        let others = rows.iter().filter(|other| {
            other.stats == row.stats
                && other.id.arithmetic == row.id.arithmetic
                && other.id.detector != "nothing"
        });
        assert!(control || others.clone().all(|other| other.digest == row.digest), "{row:?}");
    }
    assert!(rows.iter().any(|row| row.contacts > Some(60)), "the packed scenes have contacts");
}

#[test]
fn a_row_has_the_fields_of_the_format() {
    let (at, _) = rows("detectors = [\"nbs\"]\n[[scene]]\nname = \"loose\"\nn = 20\n", 0);
    let names = |value: &Value| -> BTreeSet<String> {
        value.as_object().unwrap().keys().cloned().collect()
    };
    let published = "experiment scene params dim n seed order detector arithmetic pass \
                     block time_ns outcome reason contacts digest counts peak_bytes live_bytes \
                     allocations formula_bytes stats";
    // Fields of rows that the documentation does not promise.
    let more = "first_ns calls elapsed_ns warm_allocations errors causes schema machine role \
                resources process check";
    let expected: BTreeSet<String> =
        published.split_whitespace().chain(more.split_whitespace()).map(String::from).collect();
    let text = at.read("result/samples.jsonl");
    assert!(text.lines().count() > 3);
    for line in text.lines() {
        let row: Value = serde_json::from_str(line).unwrap();
        let (mut said, timed) = (names(&row), row["pass"] == "time");
        for (place, there) in [
            ("span", timed && cfg!(target_os = "linux")),
            ("processor", timed && cfg!(target_os = "linux")),
            ("began_ms", timed),
            ("pulse_ns", timed),
        ] {
            assert_eq!(said.remove(place), there, "{place} in {line}");
        }
        assert_eq!(said, expected);
        let stats =
            ["box_diameters", "coordination", "packing_fraction", "radius_ratio", "scene_hash"];
        assert_eq!(names(&row["stats"]), stats.map(String::from).into());
        for whole in ["dim", "n", "seed", "block", "contacts"] {
            assert!(row[whole].is_u64(), "{whole} in {line}");
        }
        assert!(row["resources"]["threads"].is_u64(), "{line}");
        assert_eq!((row["time_ns"].is_u64(), row["first_ns"].is_u64()), (timed, timed));
        // In a sample the detection is repeated many times.
        if timed {
            let (calls, elapsed) = (&row["calls"], &row["elapsed_ns"]);
            assert!(calls.as_u64() > Some(100) && elapsed.as_u64() > Some(1_000_000), "{line}");
        }
        assert_eq!(row["digest"].as_str().unwrap().len(), EMPTY.len());
        assert_eq!(row["outcome"], "ok");
    }
}
