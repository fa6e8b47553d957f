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

/// Pieces of the example's code, their replacements, and words of the expected error.
const WAYS: [(&str, &str, &str); 14] = [
    // The runner prints other lines before and between replies.
    ("print(json.dumps({", "print('hello', file=channel)\nprint(json.dumps({", "hello"),
    ("    return pairs\n", "    print('found', file=channel)\n    return pairs\n", "found"),
    // Each change makes one thing wrong: version, arithmetic, digest, unit of time, repetitions.
    ("\"protocol\": 4", "\"protocol\": 3", "protocol 4"),
    ("\"f64\"", "\"double\"", "'double'"),
    ("<< 32", "<< 31", "0x447a68c51d52cce3"),
    ("016x", "016X", "lower-case"),
    (
        "elapsed = time.perf_counter_ns() - start",
        "elapsed = 1000 * (time.perf_counter_ns() - start)",
        "nanoseconds",
    ),
    ("while calls == 0 or time.perf_counter_ns() - start < min_ns:", "while calls == 0:", "min_ns"),
    // The count differs from the number of pairs in the written list.
    (
        "\"contacts\": len(pairs)}\n    return",
        "\"contacts\": len(pairs) + 1}\n    return",
        "file holds",
    ),
    // The first runner dies on a missing file, the second rejects unknown fields.
    ("except Exception", "except ZeroDivisionError", "sample before"),
    (
        ", **load_fields):",
        ", frames=(), dim=0, n=0, radius=None):\n    load_fields = dict(frames=frames, dim=dim, \
         n=n, radius=radius)",
        "WRONG",
    ),
    // Answers depend on earlier scenes.
    (
        NONE,
        "    known = globals().setdefault('known', {})\n    radii = \
         known.setdefault(len(radii), radii)\n    pairs = []\n",
        "earlier scenes",
    ),
    (NONE, "    raise ValueError('too hard')\n", "too hard"),
    ("append((i, j))", "append((i + 1, j + 1))", "pair 1,2"),
];

#[test]
fn every_way_to_be_wrong_is_named() {
    if !has("python3") {
        return;
    }
    let at = Place::new();
    for (old, new, words) in WAYS {
        changed(&at, [old, new], "--seconds 0", 1, &[words]);
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
