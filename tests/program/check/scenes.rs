//! Tests `check` of detectors on generated scenes; `cases/records.txt` gives it files.

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
