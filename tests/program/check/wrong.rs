//! Each way to be wrong is found out.

use super::{changed, smallest};
use crate::common::{Place, has};

#[test]
fn wrong_pairs_are_named_shrunk_and_drawn() {
    if !has("python3") {
        return;
    }
    let at = Place::new();
    let words = ["  the worst there, of ", ": missed, overlap "];
    let ended = changed(&at, ["    return pairs\n", "    return pairs[:-1]\n"], "", 1, &words);
    assert_eq!(
        smallest(&ended),
        (2, "1 missed, 0 spurious, 0 duplicate pairs; missed 0,1: ./failing-my-detector-f64.csv")
    );
    let csv = at.read("failing-my-detector-f64.csv");
    assert!(csv.ends_with("x,y,r\n0.0,0.0,1.0\n0.0,0.0,1.0\n"), "{csv}");
    let svg = at.read("failing-my-detector-f64.svg");
    assert!(svg.starts_with("<svg") && svg.contains("1 missed") && svg.contains("dasharray"));
    // The printed command finds the failure again.
    let again = "check --scene ./failing-my-detector-f64.csv --runner 'python3 changed.py'";
    assert!(ended.stdout.contains(&format!("  again:  contactbench {again}")), "{}", ended.stdout);
    at.ends(1, again, &[": 1 missed, 0 spurious"]);
    // Pairs of neighbours in the list that do not touch: spurious ones.
    let change = ["<= total * total:", "<= 1.21 * total * total:"];
    let ended = changed(&at, change, "", 1, &["0 missed, 1 spurious"]);
    assert_eq!(smallest(&ended).0, 2, "{}", ended.stdout);
}

const NONE: &str = "    pairs = []\n";

/// Whatever is wrong, the scene is small, and the words name it: pieces of the example, what stands
/// in their place, words that are printed.
const WAYS: [(&str, &str, &str); 14] = [
    // Speaks of other things, before and in between.
    ("print(json.dumps({", "print('hello', file=channel)\nprint(json.dumps({", "hello"),
    ("    return pairs\n", "    print('found', file=channel)\n    return pairs\n", "found"),
    // Another version, arithmetic, digest, unit of time; a sample without repetition.
    (
        "\"protocol\": 4",
        "\"protocol\": 3",
        "speaks protocol 3, but this program requires protocol 4",
    ),
    ("\"f64\"", "\"double\"", "arithmetic 'double'; it must be one of f32, "),
    ("<< 32", "<< 31", "of the pairs 0,1 and 1,2 the digest is 0x447a68c51d52cce3"),
    ("016x", "016X", "lower-case"),
    (
        "elapsed = time.perf_counter_ns() - start",
        "elapsed = 1000 * (time.perf_counter_ns() - start)",
        "are these nanoseconds?",
    ),
    (
        "while calls == 0 or time.perf_counter_ns() - start < min_ns:",
        "while calls == 0:",
        "repeat the detection until min_ns are over",
    ),
    // The count of a list that is not the one that it writes.
    (
        "\"contacts\": len(pairs)}\n    return",
        "\"contacts\": len(pairs) + 1}\n    return",
        "and its file holds",
    ),
    // A missing file is its end; a field that it does not know is an error.
    (
        "except Exception",
        "except ZeroDivisionError",
        "it dies: asked for a sample before any scene",
    ),
    (
        ", **load_fields):",
        ", frames=(), dim=0, n=0, radius=None):\n    load_fields = dict(frames=frames, dim=dim, \
         n=n, radius=radius)",
        "a field that it does not know",
    ),
    // What it has seen before.
    (
        NONE,
        "    known = globals().setdefault('known', {})\n    radii = \
         known.setdefault(len(radii), radii)\n    pairs = []\n",
        "only after earlier scenes: something is left in its buffers",
    ),
    (NONE, "    raise ValueError('too hard')\n", "too hard"),
    // Particles are numbered from 1.
    ("append((i, j))", "append((i + 1, j + 1))", "it reports the pair 1,2 in a scene of 2"),
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
    // Dies, and prints why.
    let dies =
        "    if len(centres) > 10: sys.exit('first words\\nno room for more')\n    pairs = []\n";
    let words = ["it dies: exit status: 1: no room for more", "    first words\n    no room for"];
    let ended = changed(&at, [NONE, dies], "--seconds 0", 1, &words);
    // Each death costs a new start: how far it is made smaller depends on the time that this takes.
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
    at.ends(1, line, &["it hangs: not ready after 2 s", "17 particles"]);
    // Refuses all.
    let refuses = "reply = answer(scene, **asked) if asked['request'] == 'load' else {'reply': \
                   'refused', 'reason': 'no'}";
    let words = ["0 detections by my-detector: nothing was compared", "my-detector: no"];
    changed(&at, ["reply = answer(scene, **asked)", refuses], "--seconds 0", 2, &words);
}

/// Near-tangent couples, subnormal numbers: what only the hard scenes of the battery show.
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
        let explained = ended.stdout.contains("it seems to decide contacts in rounded arithmetic");
        assert_eq!(explained, new == "\"exact\"", "{new}: {}", ended.stdout);
    }
}
