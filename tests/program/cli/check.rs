//! `check` as users meet it.

use std::path::Path;

use contactbench::contact::Test;
use contactbench::detect::table::{Entry, TABLE};
use contactbench::detect::{Options, table};
use contactbench::io;

use crate::common::{file, run};

#[test]
fn check_passes_detectors_and_fails_the_control_that_finds_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let right = run(folder, &["check", "--detector", "nbs", "--seeds", "1"]);
    assert_eq!((right.code, &*right.stderr), (Some(0), ""));
    assert!(
        right.stdout.contains(" detections by nbs: all agree with all pairs tested"),
        "{}",
        right.stdout
    );
    // What cells cannot number is refused, and said; no generated scene is such.
    assert!(
        right.stdout.contains("scenes: generated 210, hard cases ")
            && right.stdout.contains(" times: nbs: "),
        "{}",
        right.stdout
    );
    let wrong = run(folder, &["check", "--detector", "nothing", "--seeds", "1"]);
    assert_eq!(wrong.code, Some(1));
    assert!(
        wrong.stdout.contains("2 particles, 1 missed, 0 spurious, 0 duplicate pairs"),
        "{}",
        wrong.stdout
    );
    // What it tells the user to type shows the difference.
    let commands: Vec<Vec<&str>> = wrong
        .stdout
        .lines()
        .filter_map(|line| line.split_once("contactbench "))
        .map(|(_, c)| c.split(' ').collect())
        .collect();
    let found: Vec<String> = commands.iter().map(|command| run(folder, command).stdout).collect();
    assert_eq!(found[1..], ["i,j\n", "i,j\n0,1\n"], "{commands:?}");
    assert!(
        found[0].contains("1 missed, 0 spurious, 0 duplicate pairs; missed 0,1"),
        "{}",
        found[0]
    );
    assert_eq!(run(folder, &["check", "--detector", "nsb"]).code, Some(2));
}

#[test]
fn check_takes_scenes() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "two.csv", "# a comment\nx,y,r\n0,0,1\n2,0,1\n9,0,1\n");
    file(folder, "far.csv", "x,y,z,r\n0,0,0,1\n1e40,0,0,1\n");
    let right = run(
        folder,
        &[
            "check",
            "--scene",
            "two.csv",
            "--scene",
            "far.csv",
            "--arithmetic",
            "exact",
            "--arithmetic",
            "f32",
        ],
    );
    assert_eq!(right.code, Some(0), "{}{}", right.stdout, right.stderr);
    assert!(!right.stderr.contains("contactbench: "), "{}", right.stderr);
    // All detectors on a scene in two arithmetics; on the other those that need no array over
    // cells, in exact: the others refuse, and f32 cannot hold it.
    let all = TABLE.iter().filter(|entry| entry.must_be_right()).count();
    let scene = io::scene(&folder.join("far.csv"), io::Options::default()).unwrap();
    let takes = |entry: &&Entry| {
        entry.make(Options::default()).list(&scene, Test::Exact, &mut Vec::new()).is_ok()
    };
    let far = TABLE.iter().filter(|entry| entry.must_be_right()).filter(takes).count();
    for name in ["direct", "sweep", "kd-tree", "bvh", "streamed-nbs"] {
        assert!(takes(&table::find(name).unwrap()), "{name}");
    }
    assert!(
        right.stdout.contains(&format!("check: {} detections by ", 2 * all + far)),
        "{}",
        right.stdout
    );
    assert!(
        right.stdout.contains("refused 1 times: f32: ")
            && right.stdout.contains("refused 1 times: nbs: "),
        "{}",
        right.stdout
    );
    let wrong = run(
        folder,
        &["check", "--scene", "two.csv", "--detector", "nothing", "--out", "new/folder"],
    );
    assert_eq!(wrong.code, Some(1), "{}", wrong.stderr);
    assert!(
        wrong.stdout.contains("on two.csv: 1 missed, 0 spurious, 0 duplicate pairs; missed 0,1\n"),
        "{}",
        wrong.stdout
    );
    assert!(folder.join("new/folder/failing-nothing-exact-two.csv").exists());
    // The folder that nobody named stays as it is.
    let before = std::fs::read_dir(folder).unwrap().count();
    let wrong = run(folder, &["check", "--scene", "two.csv", "--detector", "nothing"]);
    let place = wrong.stdout.lines().find_map(|line| line.split_once("smallest failing scene: "));
    let place = place.and_then(|(_, rest)| rest.rsplit_once(": ")).map(|(_, place)| place).unwrap();
    assert!(Path::new(place).exists() && place.contains("contactbench-check-"), "{place}");
    // The temporary folder of tests is this folder: one more folder is all there is.
    assert_eq!(std::fs::read_dir(folder).unwrap().count(), before + 1);
    assert_eq!(run(folder, &["check", "--scene", "none.csv"]).code, Some(2));
}

/// Refusals alone show nothing: not of one detector, and not beside a scene that was compared.
#[test]
fn a_check_that_compared_nothing_is_no_pass() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "far.csv", "x,y,r\n0,0,0.5\n1e12,0,0.5\n");
    file(folder, "two.csv", "x,y,r\n0,0,1\n2,0,1\n");
    let outputs = ["--junit", "a.xml", "--summary", "a.md"];
    for scenes in [&["--scene", "far.csv"][..], &["--scene", "far.csv", "--scene", "two.csv"]] {
        let check = [&["check", "--detector", "nbs"][..], scenes, &outputs].concat();
        let ended = run(folder, &check);
        assert_eq!(ended.code, Some(2), "{}", ended.stdout);
        assert!(ended.stdout.contains("nothing was compared of far.csv"), "{}", ended.stdout);
        assert!(!ended.stdout.contains("all agree"), "{}", ended.stdout);
        let junit = std::fs::read_to_string(folder.join("a.xml")).unwrap();
        let failed = "<testcase classname=\"far.csv\" name=\"nbs, exact arithmetic\"><failure ";
        assert!(junit.contains(failed) && junit.contains("failures=\"1\""), "{junit}");
        let json = run(folder, &[&["check", "--detector", "nbs", "--json"][..], scenes].concat());
        assert_eq!(json.code, Some(2));
        assert!(json.stdout.contains("\"passed\": false"), "{}", json.stdout);
    }
    // One that refuses beside others that answer is named, and no failure.
    let all = run(folder, &["check", "--scene", "far.csv", "--junit", "b.xml"]);
    assert_eq!(all.code, Some(0), "{}", all.stdout);
    let junit = std::fs::read_to_string(folder.join("b.xml")).unwrap();
    assert!(junit.contains("name=\"nbs, exact arithmetic\"><skipped "), "{junit}");
}
