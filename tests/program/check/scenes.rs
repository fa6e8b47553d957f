//! Tests `check` of detectors, on generated and given scenes.

use std::path::Path;

use contactbench::contact::Test;
use contactbench::detect::Options;
use contactbench::detect::table::{self, Entry, TABLE};
use contactbench::io;

use crate::common::Place;

#[test]
fn check_passes_detectors_and_fails_the_control_that_finds_nothing() {
    let at = Place::new();
    let words = ["scenes: generated 210, hard cases ", " times: nbs: ", " by nbs: "];
    assert_eq!(at.ends(0, "check --detector nbs --seeds 1", &words).stderr, "");
    let words = ["2 particles, 1 missed, 0 spurious, 0 duplicate pairs"];
    let wrong = at.ends(1, "check --detector nothing --seeds 1 --annotations", &words).stdout;
    assert!(wrong.contains("::error title=contactbench check%3A generated%3A nothing%2C exact"));
    // Running the printed commands shows the missed pair.
    let lines = wrong.lines().filter(|line| !line.starts_with("::"));
    let commands: Vec<&str> =
        lines.filter_map(|line| Some(line.split_once("contactbench ")?.1)).collect();
    let found: Vec<String> = commands.iter().map(|command| at.run(command).stdout).collect();
    assert_eq!(found[1..], ["i,j\n0,1\n"], "{commands:?}");
    assert!(found[0].contains("missed 0,1"), "{}", found[0]);
}

#[test]
fn check_takes_scenes() {
    let at = Place::new();
    at.file("two.csv", "# a comment\nx,y,r\n0,0,1\n2,0,1\n9,0,1\n");
    at.file("far.csv", "x,y,z,r\n0,0,0,1\n1e40,0,0,1\n");
    // Each detector runs on the near scene in two arithmetics. Detectors without an array over
    // cells also run on the far scene, in exact arithmetic only.
    let scene = io::scene(&at.path("far.csv"), io::Options::default()).unwrap();
    let takes = |entry: &&Entry| {
        entry.make(Options::default()).list(&scene, Test::Exact, &mut Vec::new()).is_ok()
    };
    for name in ["direct", "sweep", "kd-tree", "bvh", "streamed-nbs"] {
        assert!(takes(&table::find(name).unwrap()), "{name}");
    }
    let must = || TABLE.iter().filter(|entry| entry.must_be_right());
    let count = 2 * must().count() + must().filter(takes).count();
    let line = "check --scene two.csv --scene far.csv --arithmetic exact --arithmetic f32";
    let words = format!("check: {count} detections by ");
    at.ends(0, line, &[&words, "refused 1 time: f32: ", "refused 1 time: nbs: "]);
    let line = "check --scene two.csv --detector nothing";
    let words = "two.csv: 1 missed, 0 spurious, 0 duplicate";
    at.ends(1, &format!("{line} --out new/folder"), &[words]);
    assert!(at.path("new/folder/failing-nothing-exact-two.csv").exists());
    // Without --out, `check` makes a folder in the temporary folder, which is this one in the
    // tests.
    let before = std::fs::read_dir(at.root()).unwrap().count();
    let wrong = at.ends(1, line, &[]).stdout;
    let place = wrong.lines().find_map(|line| line.split_once("smallest failing scene: "));
    let place = place.and_then(|(_, rest)| rest.rsplit_once(": ")).map(|(_, place)| place).unwrap();
    assert!(Path::new(place).exists() && place.contains("contactbench-check-"), "{place}");
    assert_eq!(std::fs::read_dir(at.root()).unwrap().count(), before + 1);
    let json = at.json(&format!("{line} --detector direct"));
    let failure = &json["checks"][0]["failures"][0];
    assert_eq!((&json["passed"], &failure["detector"]), (&false.into(), &"nothing".into()));
    assert!(at.path(failure["file"].as_str().unwrap()).exists());
    let json = at.json("check --scene two.csv --detector nbs --junit good.xml");
    assert_eq!((&json["passed"], &json["detectors"][0]), (&true.into(), &"nbs".into()));
    assert_eq!(crate::record::junit(&at.path("good.xml")), (1, 0));
}
