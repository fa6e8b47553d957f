//! `check` finds each kind of wrong runner.

use super::{changed, smallest};
use crate::common::{Place, has};

#[test]
fn wrong_pairs_are_named_shrunk_and_drawn() {
    if !has("python3") {
        return;
    }
    let at = Place::new();
    let words = ["17 particles", ": missed, overlap "];
    let ended = changed(&at, ["    return pairs\n", "    return pairs[:-1]\n"], "", 1, &words);
    assert_eq!(
        (smallest(&ended).0, smallest(&ended).1.ends_with(": ./failing-my-detector-f64.csv")),
        (2, true)
    );
    let csv = at.read("failing-my-detector-f64.csv");
    assert!(csv.ends_with("x,y,r\n0.0,0.0,1.0\n0.0,0.0,1.0\n"), "{csv}");
    let svg = at.read("failing-my-detector-f64.svg");
    assert!(svg.starts_with("<svg") && svg.contains("1 missed") && svg.contains("dasharray"));
    // The printed command finds the failure again.
    let again = "check --scene ./failing-my-detector-f64.csv --runner 'python3 changed.py'";
    assert!(ended.stdout.contains(&format!("  again:  contactbench {again}")), "{}", ended.stdout);
    at.ends(1, again, &[": 1 missed, 0 spurious"]);
    // Pairs that do not touch are listed, too, and become spurious.
    let change = ["<= total * total:", "<= 1.21 * total * total:"];
    let ended = changed(&at, change, "", 1, &["0 missed, 1 spurious"]);
    assert_eq!(smallest(&ended).0, 2, "{}", ended.stdout);
}

const NONE: &str = "    pairs = []\n";

#[test]
fn every_way_to_be_wrong_is_named() {
    if !has("python3") {
        return;
    }
    let at = Place::new();
    let lines = include_str!("ways.txt").lines().filter(|line| !line.starts_with('#'));
    let lines: Vec<String> = lines.map(|line| line.replace("\\n", "\n")).collect();
    let ways = lines.split(String::is_empty).filter(|way| !way.is_empty());
    assert_eq!(ways.clone().count(), 14);
    for way in ways {
        changed(&at, [&way[0], &way[1]], "--seconds 0", 1, &[&way[2]]);
    }
    // The runner dies with a message.
    let dies =
        "    if len(centres) > 10: sys.exit('first words\\nno room for more')\n    pairs = []\n";
    let words = ["exit status: 1: no room for more", "    first words\n    no room for"];
    let ended = changed(&at, [NONE, dies], "--seconds 0", 1, &words);
    // Each death costs a restart, so the time allows less shrinking on a slow machine.
    assert!((11..=17).contains(&smallest(&ended).0), "{}", ended.stdout);
    at.file(
        "hangs.py",
        super::PYTHON.replacen(
            NONE,
            &format!("    if len(centres) > 10: time.sleep(99)\n{NONE}"),
            1,
        ),
    );
    let line = "check --out . --runner 'python3 hangs.py' --deadline 2";
    at.ends(1, line, &["2 s", "17 particles"]);
    let refuses = "reply = answer(scene, **asked) if asked['request'] == 'load' else {'reply': \
                   'refused', 'reason': 'no'}";
    let words = [" 0 detections", "my-detector: no"];
    changed(&at, ["reply = answer(scene, **asked)", refuses], "--seconds 0", 2, &words);
}

/// These defects show only on near-tangent pairs and subnormal numbers, as in hard scenes.
#[test]
fn what_is_nearly_right_is_found() {
    if !has("python3") {
        return;
    }
    let at = Place::new();
    for (old, new) in [
        ("\"f64\"", "\"exact\""),
        ("+ 1e-150", "+ 0.0"),
        ("square <= total * total", "square < total * total"),
    ] {
        let ended = changed(&at, [old, new], "--seconds 60", 1, &[]);
        assert!(smallest(&ended).0 <= 3, "{new}: {}", ended.stdout);
        let explained = ended.stdout.contains("rounded arithmetic");
        assert_eq!(explained, new == "\"exact\"", "{new}: {}", ended.stdout);
    }
}
