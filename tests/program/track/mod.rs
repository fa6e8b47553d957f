//! Tests `track`: moving particles and neighbour lists.

mod frames;
mod tracking;

use serde_json::{Value, json};

use crate::common::{PROGRAM, Place};

fn number(value: &Value, key: &str) -> u64 {
    value[key].as_u64().unwrap_or_else(|| panic!("{key}: {value}"))
}

const FLIGHT: &str = "track loose:dim=2,n=400,fraction=0.5 --motion drift:speed=0.02 --frames 61 \
                      --tracker verlet(nbs,skin=0.05,rule=every-20) --tracker \
                      verlet(nbs,skin=0.05,rule=lammps-10-1-yes) --tracker \
                      verlet(nbs,skin=0.05,rule=half-skin)";

#[test]
fn what_rules_miss_is_counted_frame_by_frame() {
    let found = Place::new().json(FLIGHT);
    assert_eq!([number(&found, "particles"), number(&found, "frames")], [400, 61]);
    let trackers = found["trackers"].as_array().unwrap();
    let [every, lammps, half_skin] = &trackers[..] else { panic!("{trackers:?}") };
    assert_eq!(number(every, "built"), 4, "frames 0, 20, 40 and 60");
    assert!(number(every, "missed") > 50 && number(lammps, "missed") > 0, "{trackers:?}");
    assert!(number(every, "latest") >= 3 && number(every, "worst_missed") > 3, "{every}");
    assert_eq!(number(half_skin, "missed"), 0);
    assert!(half_skin["first_missed_frame"].is_null());
    for tracker in trackers {
        let seen = number(tracker, "reported") + number(tracker, "missed");
        assert_eq!((seen, number(tracker, "spurious")), (number(&found, "contacts"), 0));
        assert!(number(tracker, "formula_bytes") > 400 * 36, "{tracker}");
    }
    // LAMMPS flags some builds needlessly. The rightly flagged ones are among those with missed
    // contacts.
    let [flags, right, missing] =
        ["dangerous", "dangerous_rightly", "missing_builds"].map(|key| number(lammps, key));
    assert!(right <= flags && right <= missing && missing > 0, "{lammps}");
    assert!(found["mean_way"].as_f64().unwrap() < found["longest_way"].as_f64().unwrap());
}

#[test]
fn experiments_find_of_a_course_what_track_finds() {
    let at = Place::new();
    at.file("steps.toml", include_str!("../experiments/steps.toml"));
    at.ends(0, "run steps.toml --out out", &["2 of 2 claims hold"]);
    let found = at.json(FLIGHT);
    let [every, lammps, half_skin] = &found["trackers"].as_array().unwrap()[..] else { panic!() };
    let mut judged = 0;
    for line in at.read("out/samples.jsonl").lines() {
        let row: Value = serde_json::from_str(line).unwrap();
        let (course, rule) = (&row["course"], &row["detector_params"]["rule"]);
        for key in ["particles", "frames", "contacts", "born", "ended"] {
            assert_eq!(row["moved"][key], found[key], "{key}: {row}");
        }
        let expected = match rule.as_str() {
            Some("every-20") => every,
            Some("lammps-10-1-yes") => lammps,
            Some("half-skin") => half_skin,
            _ => {
                assert_eq!([&course["builds"], &row["contacts"]], [61, number(&found, "contacts")]);
                continue;
            }
        };
        judged += 1;
        for (key, of_track) in tracking::SAME {
            assert_eq!(course[key], expected[of_track], "{key}: {row}");
        }
        assert_eq!(row["errors"]["missed"], expected["missed"], "{row}");
        assert_eq!(row["contacts"], expected["reported"], "{row}");
        let missed = number(expected, "missed") > 0;
        assert_eq!(row["outcome"], if missed { "lossy" } else { "ok" }, "{row}");
        match row["pass"].as_str().unwrap() {
            "memory" => assert_eq!(row["formula_bytes"], expected["formula_bytes"], "{row}"),
            "count" => assert!(number(&row["counts"], "contact_test") >= number(course, "listed")),
            _ => assert!(number(&row, "building_ns") < number(&row, "time_ns"), "{row}"),
        }
    }
    assert!(judged >= 3 * 3, "{judged} rows of trackers");
}

/// A record can hold trackers and detectors, moving and resting scenes, and two builds.
#[test]
fn motion_and_rest_are_in_one_record() {
    let at = Place::new();
    let experiment = include_str!("../experiments/mixed.toml");
    at.file("mixed.toml", experiment);
    at.file("one.toml", experiment.replace("[\"exact\", \"textbook\"]", "[\"exact\"]"));
    for (out, line) in [
        ("out", "run mixed.toml --out out"),
        ("beside", &*format!("run one.toml --out beside --against {PROGRAM}")),
    ] {
        let said = at.good(line);
        assert!(!said.stderr.contains("WRONG"), "{}", said.stderr);
        for line in at.read(&format!("{out}/samples.jsonl")).lines() {
            let row: Value = serde_json::from_str(line).unwrap();
            let outcome = row["outcome"].as_str().unwrap();
            assert!(["ok", "lossy", "control"].contains(&outcome), "{row}");
            let moves = row["params"].get("motion").is_some();
            assert_eq!(moves, !row["moved"].is_null(), "{row}");
            assert_eq!(moves && outcome != "control", !row["course"].is_null(), "{row}");
        }
    }
    let before = at.read("out/samples.jsonl");
    at.good("run mixed.toml --out out --resume");
    assert_eq!(before, at.read("out/samples.jsonl"));
}

/// A sample finds a part of the missed contacts. Without a check, no number is printed.
#[test]
fn a_sample_or_nothing_is_checked_on_request() {
    let at = Place::new();
    let line = "track loose:dim=2,n=3000,fraction=0.5 --motion drift:speed=0.02 --frames 21 \
                --tracker verlet(nbs,skin=0.05,rule=every-20)";
    let [all, sample, none] =
        ["all", "sample", "none"].map(|truth| at.json(&format!("{line} --truth {truth}")));
    let missed = |of: &Value| number(&of["trackers"][0], "missed");
    assert!(0 < missed(&sample) && missed(&sample) < missed(&all), "{sample}");
    assert!(number(&sample, "contacts") < number(&all, "contacts"));
    assert_eq!(sample["truth"], json!({ "checked": "sample", "particles": 1000, "seed": 1 }));
    assert_eq!(all["truth"], json!({ "checked": "all" }));
    for key in ["missed", "spurious", "never_reported"] {
        assert!(none["trackers"][0][key].is_null() && none["contacts"].is_null(), "{none}");
    }
    assert_eq!(none["trackers"][0]["reported"], all["trackers"][0]["reported"]);
}
