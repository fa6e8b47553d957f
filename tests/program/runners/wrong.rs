//! Each way to be wrong is found out.

use super::{changed, check, smallest};
use crate::common::{has, run};

#[test]
fn wrong_pairs_are_named_shrunk_and_drawn() {
    if !has("python3") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let ended = changed(folder, "    return pairs\n", "    return pairs[:-1]\n", &[]);
    assert_eq!(ended.code, Some(1), "{}", ended.stdout);
    assert_eq!(
        smallest(&ended),
        (2, "1 missed, 0 spurious, 0 duplicate pairs; missed 0,1: ./failing-my-detector-f64.csv")
    );
    let csv = std::fs::read_to_string(folder.join("failing-my-detector-f64.csv")).unwrap();
    assert!(
        csv.ends_with("x,y,r\n0.0,0.0,1.0\n0.0,0.0,1.0\n")
            && csv.contains("--runner 'python3 changed.py'\n"),
        "{csv}"
    );
    let svg = std::fs::read_to_string(folder.join("failing-my-detector-f64.svg")).unwrap();
    assert!(
        svg.starts_with("<svg") && svg.contains("1 missed") && svg.contains("stroke-dasharray"),
        "{svg}"
    );
    assert!(
        ended.stdout.contains("  the worst there, of ")
            && ended.stdout.contains(": missed, overlap "),
        "{}",
        ended.stdout
    );
    // What it says finds it again.
    let again =
        ended.stdout.lines().find_map(|line| line.strip_prefix("  again:  contactbench ")).unwrap();
    assert_eq!(again, "check --scene ./failing-my-detector-f64.csv --runner 'python3 changed.py'");
    let again = check(folder, "python3 changed.py", &["--scene", "failing-my-detector-f64.csv"]);
    assert!(
        again.code == Some(1) && again.stdout.contains(": 1 missed, 0 spurious"),
        "{}",
        again.stdout
    );
    // Pairs of neighbours in the list that do not touch: spurious ones.
    let ended = changed(folder, "<= total * total:", "<= 1.21 * total * total:", &[]);
    let (n, words) = smallest(&ended);
    assert!(n == 2 && words.starts_with("0 missed, 1 spurious"), "{}", ended.stdout);
}

/// Whatever is wrong, the scene is small, and the words say what it is.
#[test]
fn every_way_to_be_wrong_is_told() {
    if !has("python3") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let told = |old: &str, new: &str, options: &[&str], words: &[&str]| {
        let ended = changed(folder.path(), old, new, options);
        assert_eq!(ended.code, Some(1), "{new}: {}{}", ended.stdout, ended.stderr);
        for word in words {
            assert!(ended.stdout.contains(word), "{new}: no '{word}' in {}", ended.stdout);
        }
        ended
    };
    let none: &[&str] = &["--seconds", "0", "--deadline", "60"];
    // Particles are numbered from 1.
    let ended = told(
        "append((i, j))",
        "append((i + 1, j + 1))",
        none,
        &["it reports the pair 1,2 in a scene of 2 particles: they are numbered from 0 to 1"],
    );
    assert_eq!(smallest(&ended).0, 2);
    // Dies, and says why.
    let new =
        "    if len(centres) > 10: sys.exit('first words\\nno room for more')\n    pairs = []\n";
    let words = [
        "it dies: exit status: 1: no room for more",
        "  the last lines of its standard error:\n    first words\n    no room for more\n",
    ];
    let ended = told("    pairs = []\n", new, none, &words);
    // Each death costs a new start: how far it is made smaller depends on the time that this takes.
    assert!((11..=17).contains(&smallest(&ended).0), "{}", ended.stdout);
    // Hangs.
    let new = "    if len(centres) > 10: time.sleep(99)\n    pairs = []\n";
    told(
        "    pairs = []\n",
        new,
        &["--deadline", "3"],
        &["it hangs: not ready after 3 s", "17 particles"],
    );
    // Speaks of other things, before and in between.
    told(
        "print(json.dumps({",
        "print('hello', file=channel)\nprint(json.dumps({",
        none,
        &["it breaks the protocol: the runner's answer is not a reply", "hello", "by no detector"],
    );
    told(
        "    return pairs\n",
        "    print('found', len(pairs), file=channel)\n    return pairs\n",
        none,
        &["asked for a sample: the runner's answer is not a reply", "found"],
    );
    // Another version, arithmetic, digest, unit of time; a sample without repetition.
    told("\"protocol\": 2", "\"protocol\": 5", none, &["speaks protocol 5, this program 1 to 4"]);
    told("\"f64\"", "\"double\"", none, &["arithmetic 'double'; it must be one of f32, "]);
    told("<< 32", "<< 31", none, &["of the pairs 0,1 and 1,2 the digest is 0x447a68c51d52cce3"]);
    told("016x", "016X", none, &["lower-case"]);
    told(
        "elapsed = time.perf_counter_ns() - start",
        "elapsed = 1000 * (time.perf_counter_ns() - start)",
        none,
        &["are these nanoseconds?"],
    );
    told(
        "while calls == 0 or time.perf_counter_ns() - start < min_ns:",
        "while calls == 0:",
        none,
        &["repeat the detection until min_ns are over"],
    );
    // The count of a list that is not the one that it writes.
    told(
        "\"contacts\": len(pairs)}\n    return",
        "\"contacts\": len(pairs) + 1}\n    return",
        none,
        &["and its file holds"],
    );
    // A missing file is its end; a field that it does not know is an error.
    told(
        "except Exception",
        "except ZeroDivisionError",
        none,
        &["it dies: asked for a sample before any scene"],
    );
    told(
        ", **load_fields):",
        ", frames=(), dim=0, n=0, radius=None):\n    load_fields = dict(frames=frames, dim=dim, \
         n=n, radius=radius)",
        none,
        &["a field that it does not know"],
    );
    // What it has seen before.
    let stale = "    known = globals().setdefault('known', {})\n    radii = \
                 known.setdefault(len(radii), radii)\n    pairs = []\n";
    told(
        "    pairs = []\n",
        stale,
        none,
        &["only after earlier scenes: something is left in its buffers"],
    );
    // Refuses all.
    told("    pairs = []\n", "    raise ValueError('too hard')\n", none, &["too hard"]);
    let refuses = "reply = answer(scene, **asked) if asked['request'] == 'load' else {'reply': \
                   'refused', 'reason': 'no'}";
    let ended = changed(folder.path(), "reply = answer(scene, **asked)", refuses, none);
    assert_eq!(ended.code, Some(2), "{}", ended.stdout);
    for words in ["check: 0 detections by my-detector: nothing was compared", "my-detector: no"] {
        assert!(ended.stdout.contains(words), "{words}: {}", ended.stdout);
    }
}

/// Near-tangent couples, subnormal numbers: what only the hard scenes of the battery show.
#[test]
fn what_is_nearly_right_is_found() {
    if !has("python3") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for (old, new) in [
        ("\"f64\"", "\"exact\""),
        ("+ 1e-150", "+ 0.0"),
        ("square <= total * total", "square < total * total"),
    ] {
        let ended = changed(folder.path(), old, new, &["--seconds", "60", "--deadline", "60"]);
        assert_eq!(ended.code, Some(1), "{new}: {}", ended.stdout);
        assert!(smallest(&ended).0 <= 3, "{new}: {}", ended.stdout);
        let explained = ended.stdout.contains("it seems to decide contacts in rounded arithmetic");
        assert_eq!(explained, new == "\"exact\"", "{new}: {}", ended.stdout);
    }
}

#[test]
fn commands_that_are_none_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, words) in [
        (
            vec!["check", "--runner", "no-such-program-at-all"],
            "cannot start no-such-program-at-all",
        ),
        (vec!["check", "--runner", "sh -c 'a"], "a quote is not closed"),
        (vec!["check", "--runner", " "], "--runner is empty"),
        (vec!["check", "--runner", "a", "--detector", "nbs"], "cannot be used with"),
        (vec!["check", "--runner", "a", "--arithmetic", "f64"], "a runner says its own"),
    ] {
        let ended = run(folder.path(), &arguments);
        assert!(
            ended.code == Some(2) && ended.stderr.contains(words),
            "{arguments:?}: {:?} {}",
            ended.code,
            ended.stderr
        );
    }
    let missing = crate::common::say(
        r#"{"reply":"unavailable","reason":"the library is missing: apt install it"}"#,
    );
    let ended = check(folder.path(), &format!("sh -c '{}'", missing.replace('\'', "'\\''")), &[]);
    assert!(ended.code == Some(2) && ended.stderr.contains("apt install it"), "{}", ended.stderr);
}
