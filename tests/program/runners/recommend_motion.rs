//! `recommend` of frames.

use std::path::Path;

use contactbench::contact::Test;
use contactbench::track;
use serde_json::Value;

use crate::common::{file, good, refused};

const FLIGHT: &str = "3\nProperties=species:S:1:pos:R:2:radius:R:1 step=0\n\
    A 0 0 0.5\nA 1 0 0.5\nA 2.5 0 0.5\n\
    3\nProperties=species:S:1:pos:R:2:radius:R:1 step=10\n\
    A 0 0 0.5\nA 1.25 0 0.5\nA 2 0 0.5\n";

fn json(folder: &Path, arguments: &[&str]) -> Value {
    serde_json::from_str(&good(folder, &[arguments, &["--json"]].concat()).stdout).unwrap()
}

/// A safe tracker is named and compared with its detector alone; what popular settings miss is
/// what `track` counts.
#[test]
fn recommend_of_a_motion_names_a_safe_tracker_and_what_others_miss() {
    for scene in ["loose:dim=2,n=300,fraction=0.5", "loose:dim=2,n=300,fraction=0.5,periodic=true"]
    {
        names_a_safe_tracker(scene);
    }
}

fn names_a_safe_tracker(scene: &str) {
    let folder = tempfile::tempdir().unwrap();
    let flight = [scene, "--motion", "drift:speed=0.02", "--frames", "41"];
    let found = json(folder.path(), &[&["recommend"], &flight[..], &["--seconds", "2"]].concat());
    let trackers = found["trackers"].as_array().unwrap();
    let of = |name: &Value| trackers.iter().find(|it| it["tracker"] == *name).unwrap();
    for it in trackers {
        let spec = track::parse(it["tracker"].as_str().unwrap()).unwrap();
        assert!(spec.is_safe(Test::Exact), "{it}");
        assert!(["ok", "timeout"].contains(&it["outcome"].as_str().unwrap()), "{it}");
    }
    let choice = of(&found["use"]);
    assert!(choice["ns_per_particle"]["median"].as_f64() > Some(0.0), "{choice}");
    assert!(choice["peak_bytes"].as_u64() > Some(300), "{choice}");
    assert!(choice["formula_bytes"].as_u64() > Some(300), "{choice}");
    let plain = of(&found["compared_with"]);
    assert_eq!((&plain["built"], plain["outcome"].as_str()), (&41.into(), Some("ok")));
    assert!(plain["ns_per_particle"]["blocks"] == found["blocks"], "{plain}");
    let because = found["because"].as_str().unwrap();
    assert!(because.contains("ns per particle and frame in this run"), "{because}");
    assert!(because.contains("of 41 frames"), "{because}");
    // By two paths.
    let contacts = found["moved"]["contacts"].as_f64().unwrap();
    let popular = found["popular"].as_array().unwrap();
    assert_eq!(popular.len(), 5);
    let names = popular.iter().flat_map(|it| ["--tracker", it["tracker"].as_str().unwrap()]);
    let names: Vec<&str> = names.collect();
    let tracked = json(folder.path(), &[&["track"], &flight[..], &names].concat());
    for (it, tracked) in popular.iter().zip(tracked["trackers"].as_array().unwrap()) {
        for key in ["tracker", "built", "missed", "first_missed_frame", "latest", "deepest"] {
            assert_eq!(it[key], tracked[key], "{key}: {it}");
        }
        let share = it["missed"].as_f64().unwrap() / contacts;
        assert!((it["share"].as_f64().unwrap() - share).abs() < 1e-12, "{it}");
        assert!(!it["origin"].as_str().unwrap().is_empty());
    }
    assert_eq!(found["moved"]["contacts"], tracked["contacts"]);
    assert_eq!(popular[0]["missed"], 0, "LAMMPS looks in every frame");
    assert!(popular[4]["missed"].as_u64() > Some(20), "{}", popular[4]);
}

/// A file of several frames moves by itself; one of its frames, or a file of one, is at rest.
#[test]
fn recommend_takes_the_frames_of_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "flight.xyz", FLIGHT);
    let ask = ["recommend", "flight.xyz", "--seconds", "1"];
    let found = json(folder, &ask);
    assert_eq!([&found["moved"]["frames"], &found["n"], &found["dim"]], [2, 3, 2]);
    assert_eq!((&found["moved"]["contacts"], &found["motion"]), (&2.into(), &"as recorded".into()));
    assert!(found["use"].is_string());
    let still = json(folder, &[&ask[..], &["--frame", "0"]].concat());
    assert!(still["trackers"].is_null() && still["detectors"].is_array(), "{still}");
    let moved =
        json(folder, &[&ask[..], &["--frame", "0", "--motion", "rest", "--frames", "4"]].concat());
    assert_eq!((&moved["moved"]["frames"], &moved["motion"]), (&4.into(), &"rest".into()));
    // In words: that frames may not be steps, and that the file has more.
    file(folder, "longer.xyz", FLIGHT.repeat(2));
    let said = good(folder, &["recommend", "longer.xyz", "--frames", "2", "--seconds", "0.5"]);
    assert!(said.stdout.starts_with("longer.xyz: 3 discs, as recorded, the first 2 frames, exact"));
    for words in ["\nuse ", "What popular settings would miss", "bench in.lj", "Rules count"] {
        assert!(said.stdout.contains(words), "{words}: {}", said.stdout);
    }
    let whole = good(folder, &["recommend", "longer.xyz", "--seconds", "0.5"]).stdout;
    assert!(whole.contains("as recorded, 4 frames,"), "{whole}");
}

#[test]
fn recommend_refuses_frames_of_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "flight.xyz", FLIGHT);
    file(folder, "discs.csv", "x,y,r\n0,0,1\n1,0,1\n");
    let wider = FLIGHT.replace("A 2 0 0.5", "A 2 0 0.75");
    file(folder, "wider.xyz", wider);
    for (arguments, words) in [
        (&["--motion", "drift"][..], &["name a particle file, or a scene"][..]),
        (&["packed:n=50", "--frames", "3"], &["nothing moves; add --motion drift"]),
        (&["discs.csv", "--frames", "3"], &["has one frame; add --motion drift"]),
        (&["packed:n=50", "--motion", "drift", "--frames", "0"], &["--frames 0"]),
        (&["packed:n=50", "--motion", "drift", "--frames", "1"], &["trackers need several"]),
        (&["flight.xyz", "--frames", "1"], &["trackers need several"]),
        (&["loose:n=0", "--motion", "drift"], &["no particles; there is nothing to recommend"]),
        (&["wider.xyz"], &["frame 1: the bodies have other radii"]),
    ] {
        refused(folder, &[&["recommend"], arguments].concat(), words);
    }
}
