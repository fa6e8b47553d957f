//! `check --runner`: the examples in Python and C++ pass, and runners that are wrong, each in its
//! way, are found out; and `recommend`.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::common::{Ended, PROGRAM, run};

const PYTHON: &str = include_str!("../../examples/my_detector.py");
const CPP: &str = include_str!("../../examples/my_detector.cpp");

/// Is there such a program? If not, the test passes, and is named among those left out.
fn has(program: &'static str) -> bool {
    let there =
        Command::new(program).arg("--version").output().is_ok_and(|output| output.status.success());
    if !there {
        crate::common::untested(&format!("runners that need {program}"), program);
    }
    there
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn check(folder: &Path, runner: &str, options: &[&str]) -> Ended {
    run(folder, &[&["check", "--out", ".", "--runner", runner], options].concat())
}

/// Checks the example in Python with one piece of its text changed.
fn changed(folder: &Path, old: &str, new: &str, options: &[&str]) -> Ended {
    assert!(PYTHON.contains(old), "the example has no '{old}' any more");
    crate::common::file(folder, "changed.py", PYTHON.replacen(old, new, 1));
    check(folder, "python3 changed.py", options)
}

/// The numbers of particles and the words of the smallest failing scene.
fn smallest(ended: &Ended) -> (u64, &str) {
    let line =
        ended.stdout.lines().find_map(|line| line.strip_prefix("  smallest failing scene: "));
    let (n, words) = line
        .unwrap_or_else(|| panic!("no scene: {}{}", ended.stdout, ended.stderr))
        .split_once(" particles, ")
        .unwrap();
    (n.parse().unwrap(), words)
}

#[test]
fn the_example_in_python_passes() {
    assert!(PYTHON.lines().count() < 80);
    if !has("python3") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = root().join("examples/my_detector.py");
    let ended = check(
        folder.path(),
        &format!("python3 '{}'", path.display()),
        &["--seconds", "3", "--deadline", "60"],
    );
    assert_eq!((ended.code, &*ended.stderr), (Some(0), ""), "{}", ended.stdout);
    assert!(
        ended.stdout.starts_with("runner: my-detector, f64 arithmetic, without count and memory\n"),
        "{}",
        ended.stdout
    );
    assert!(
        ended.stdout.contains("generated 168")
            && ended.stdout.contains(" detections by my-detector: all agree"),
        "{}",
        ended.stdout
    );
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "something is left behind");
}

#[test]
fn the_example_in_cpp_passes() {
    assert!(CPP.lines().count() < 80);
    if !has("c++") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    // The command that the example gives, with paths of this checkout.
    let line = CPP.lines().find_map(|line| line.strip_prefix("//     g++ ")).unwrap();
    let words = line.replace("runners ", &format!("{} ", root().join("runners").display()));
    let words = words.replace("examples/", &format!("{}/", root().join("examples").display()));
    let built = Command::new("c++")
        .args(["-Wall", "-Wextra", "-Werror"])
        .args(words.split(' '))
        .current_dir(&folder)
        .output()
        .unwrap();
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    let ended = check(folder.path(), "./my_detector", &["--seconds", "3", "--deadline", "60"]);
    assert_eq!((ended.code, &*ended.stderr), (Some(0), ""), "{}", ended.stdout);
    assert!(
        ended.stdout.starts_with("runner: my-grid 1.0, f64 arithmetic, without count and memory\n"),
        "{}",
        ended.stdout
    );
    assert!(ended.stdout.contains(" detections by my-grid: all agree"), "{}", ended.stdout);
}

/// The example as it was in version 1 of the protocol, which knows one path.
#[test]
fn a_runner_of_version_1_is_spoken_to_in_version_1() {
    if !has("python3") {
        return;
    }
    let mut old = PYTHON.to_string();
    for (new, before) in [
        ("\"protocol\": 2", "\"protocol\": 1"),
        ("def load(frames, ", "def load(path, "),
        ("    (path,) = frames\n", ""),
        (
            "load(*(load_fields[key] for key in (\"frames\", ",
            "load(path, *(load_fields[key] for key in (",
        ),
    ] {
        assert!(old.contains(new), "the example has no '{new}' any more");
        old = old.replace(new, before);
    }
    let folder = tempfile::tempdir().unwrap();
    crate::common::file(folder.path(), "old.py", old);
    let ended = check(folder.path(), "python3 old.py", &["--seconds", "0", "--deadline", "60"]);
    assert_eq!((ended.code, &*ended.stderr), (Some(0), ""), "{}", ended.stdout);
    assert!(ended.stdout.contains(": all agree"), "{}", ended.stdout);
}

/// A detector that gives no answer unless it was reset since the last one.
const TRACKER: &str = r#"#include "runner.hpp"
template <int D> struct Tracker {
    bool fresh = false;
    void reset() { fresh = true; }
    void operator()(const runner::Scene<D>& scene, runner::Pairs& pairs) {
        if (!fresh) throw std::runtime_error("it was not reset");
        fresh = false;
        for (std::uint32_t i = 0; i < scene.centres.size(); i++)
            for (std::uint32_t j = 0; j < i; j++)
                if (scene.touch(i, j)) pairs.push_back({i, j});
    }
};
int main() { runner::serve("tracker", "1", Tracker<2>{}, Tracker<3>{}, "f64"); }
"#;

#[test]
fn every_pass_begins_with_a_reset() {
    if !has("c++") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    crate::common::file(folder.path(), "tracker.cpp", TRACKER);
    let built = Command::new("c++")
        .args(["-std=c++17", "-ffp-contract=off", "tracker.cpp", "-o", "tracker", "-I"])
        .arg(root().join("runners"))
        .current_dir(&folder)
        .output()
        .unwrap();
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    let ended = check(folder.path(), "./tracker", &["--seconds", "0", "--deadline", "60"]);
    assert_eq!((ended.code, &*ended.stderr), (Some(0), ""), "{}", ended.stdout);
    assert!(ended.stdout.contains(" detections by tracker: all agree"), "{}", ended.stdout);
}

#[test]
fn this_program_is_a_runner_in_every_arithmetic() {
    let folder = tempfile::tempdir().unwrap();
    let command = format!("'{PROGRAM}' runner --detector kd-tree --arithmetic {{arithmetic}}");
    let ended = check(folder.path(), &command, &["--seconds", "0"]);
    assert_eq!((ended.code, &*ended.stderr), (Some(0), ""), "{}", ended.stdout);
    for arithmetic in ["f32", "f32-cell", "f64", "exact"] {
        assert!(
            ended.stdout.contains(&format!(", {arithmetic} arithmetic, has all requests\n")),
            "{arithmetic}: {}",
            ended.stdout
        );
    }
    // One that takes no notice of what it is asked.
    let command = format!("sh -c \"exec '{PROGRAM}' runner --detector nbs\" {{arithmetic}}");
    let ended = check(
        folder.path(),
        &command,
        &["--seconds", "0", "--arithmetic", "f64", "--arithmetic", "exact"],
    );
    assert_eq!(ended.code, Some(1), "{}", ended.stdout);
    assert!(
        ended.stdout.contains(
            "WRONG: it breaks the protocol: started with f64 as its arithmetic, it says exact"
        ),
        "{}",
        ended.stdout
    );
    assert!(
        ended.stdout.contains("runner: nbs ") && ended.stdout.contains(" detections by nbs: WRONG"),
        "{}",
        ended.stdout
    );
}

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
        &["it breaks the protocol: the runner's answer is not a reply", "hello", "by nobody"],
    );
    told(
        "    return pairs\n",
        "    print('found', len(pairs), file=channel)\n    return pairs\n",
        none,
        &["asked for a sample: the runner's answer is not a reply", "found"],
    );
    // Another version, arithmetic, digest, unit of time; a sample without repetition.
    told("\"protocol\": 2", "\"protocol\": 3", none, &["speaks protocol 3, this program 1 to 2"]);
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
    told(
        "reply = answer(scene, **asked)",
        "reply = answer(scene, **asked) if asked['request'] == 'load' else {'reply': 'refused', \
         'reason': 'no'}",
        none,
        &["it has refused all of them", "my-detector: no"],
    );
}

/// What a library prints, from Python or by its descriptor, is not taken for a reply; the hook is
/// called for each scene before it is detected in.
#[test]
fn a_library_that_prints_and_a_hook_per_load_are_kept_apart_from_replies() {
    if !has("python3") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let prints = "    print('library 1.0')\n    os.write(1, b'noise\\n')\n    pairs = []\n";
    let noisy = PYTHON.replacen("    pairs = []\n", prints, 1);
    assert!(noisy.contains("os.write"));
    crate::common::file(folder.path(), "noisy.py", noisy);
    let ended = check(folder.path(), "python3 noisy.py", &["--seconds", "0"]);
    assert_eq!(ended.code, Some(0), "{}{}", ended.stdout, ended.stderr);
    if !has("c++") {
        return;
    }
    let cpp = "#include \"runner.hpp\"\ntemplate <int D> struct All {\n    std::size_t prepared = 0;\n    \
               void prepare(const runner::Scene<D>& scene) { std::puts(\"noise\"); std::cout << \
               \"noise\" << std::endl; prepared = scene.centres.size(); }\n    void operator()(const \
               runner::Scene<D>& scene, runner::Pairs& pairs) {\n        if (prepared != \
               scene.centres.size()) throw std::runtime_error(\"not prepared\");\n        for \
               (std::uint32_t i = 0; i < prepared; i++)\n            for (std::uint32_t j = i + 1; j < \
               prepared; j++)\n                if (scene.touch(i, j)) pairs.push_back({i, j});\n    \
               }\n};\nint main() { runner::serve(\"all\", \"1\", All<2>{}, All<3>{}, \"f64\"); }\n";
    crate::common::file(folder.path(), "all.cpp", cpp);
    let built = Command::new("c++")
        .args(["-std=c++17", "-ffp-contract=off", "-Wall", "-Wextra", "-Werror", "-I"])
        .arg(root().join("runners"))
        .args(["all.cpp", "-o", "all"])
        .current_dir(&folder)
        .output()
        .unwrap();
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    let ended = check(folder.path(), "./all", &["--seconds", "0", "--deadline", "60"]);
    assert_eq!(ended.code, Some(0), "{}{}", ended.stdout, ended.stderr);
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

/// All regressions that the tests keep are in the battery.
#[test]
fn the_battery_has_every_regression() {
    let source = include_str!("../../src/check/checker.rs");
    for entry in std::fs::read_dir(root().join("tests/regressions")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        assert!(
            source.contains(&format!("tests/regressions/{name}")),
            "{name} is missing in src/check/checker.rs"
        );
    }
}

fn recommended(folder: &Path, arguments: &[&str]) -> Value {
    let ended = run(folder, &[&["recommend", "--json", "--seconds", "3"], arguments].concat());
    assert_eq!((ended.code, &*ended.stderr), (Some(0), ""), "{arguments:?}: {}", ended.stdout);
    serde_json::from_str(&ended.stdout).unwrap()
}

#[test]
fn recommend_names_one_and_says_why_not_the_others() {
    let folder = tempfile::tempdir().unwrap();
    let answer = recommended(folder.path(), &["pack-c:n=2500,s=100", "--memory-limit", "300000"]);
    let detectors = answer["detectors"].as_array().unwrap();
    let of = |name: &str| {
        detectors
            .iter()
            .find(|detector| detector["detector"] == name)
            .unwrap_or_else(|| panic!("no {name}"))
    };
    for name in ["direct", "nbs", "sorting", "streamed-nbs", "kd-tree"] {
        of(name);
    }
    assert!(detectors.iter().all(|detector| detector["detector"] != "nothing" && detector["detector"] != "nbs-twin"));
    // An array over cells does not fit.
    let refused = of("screening");
    assert!(
        refused["outcome"] == "refused"
            && refused["reason"].as_str().unwrap().contains("the limit is 300000"),
        "{refused}"
    );
    assert!(refused["ns_per_particle"].is_null());
    let choice = of(answer["use"].as_str().unwrap());
    assert!(
        choice["outcome"] == "ok"
            && choice["peak_bytes"].as_u64().is_some()
            && choice["errors"]["missed"] == 0,
        "{choice}"
    );
    let time = &choice["ns_per_particle"];
    assert!(
        time["low"].as_f64() <= time["median"].as_f64()
            && time["median"].as_f64() <= time["high"].as_f64(),
        "{time}"
    );
    // It is the fastest, or leaner than all from which it cannot be told apart.
    let blocks = |detector: &Value| detector["ns_per_particle"]["blocks"].as_u64();
    assert_eq!(blocks(choice), answer["blocks"].as_u64());
    for name in answer["cannot_tell_apart"].as_array().unwrap() {
        assert!(
            of(name.as_str().unwrap())["peak_bytes"].as_u64() >= choice["peak_bytes"].as_u64(),
            "{name}"
        );
    }
    if let Some(next) = answer["next"].as_object() {
        assert!(next["ratio"]["median"].as_f64() > Some(1.0), "{next:?}");
    }
    assert_eq!(
        (&answer["n"], &answer["contacts"], &answer["dim"]),
        (&2500.into(), &0.into(), &2.into())
    );
    assert!(
        answer["because"].as_str().unwrap().ends_with("exact")
            || !answer["cannot_tell_apart"].as_array().unwrap().is_empty()
    );
}

#[test]
fn recommend_takes_files_dimensions_and_arithmetics() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    crate::common::file(folder, "discs.csv", "x,y\n0,0\n1,0\n5,0\n");
    let answer = recommended(
        folder,
        &["discs.csv", "--radius", "0.5", "--arithmetic", "f32", "--threads", "2"],
    );
    assert_eq!(
        (&answer["n"], &answer["contacts"], &answer["arithmetic"]),
        (&3.into(), &1.into(), &"f32".into())
    );
    assert_eq!(recommended(folder, &["loose:dim=3,n=300"])["dim"], 3);
    assert!(recommended(folder, &["hard:case=shrink-then-grow,dim=3"])["use"].is_string());
    // In words.
    let ended = run(folder, &["recommend", "packed:n=400", "--seconds", "0.3"]);
    assert_eq!((ended.code, &*ended.stderr), (Some(0), ""), "{}", ended.stdout);
    let last = ended.stdout.split("\n\nuse ").nth(1).unwrap();
    assert!(
        last.contains(" ns per particle (") && last.contains(" bytes per particle; exact"),
        "{last}"
    );
    assert!(ended.stdout.starts_with("packed:n=400: 400 discs, "), "{}", ended.stdout);
    for (arguments, words) in [
        (vec!["recommend"], "name a particle file, or a scene"),
        (vec!["recommend", "none.csv"], "none.csv"),
        (vec!["recommend", "packed:n=0x"], "n is '0x'"),
        (vec!["recommend", "loose:n=0"], "the scene has no particles"),
        (vec!["recommend", "packed", "--seconds", "0"], "--seconds 0: give a number from"),
        (vec!["recommend", "packed", "--threads", "0"], "--threads 0: give a number from"),
        (vec!["recommend", "packed", "--radius", "1"], "belong to files"),
    ] {
        let ended = run(folder, &arguments);
        assert!(
            ended.code == Some(2) && ended.stderr.contains(words),
            "{arguments:?}: {:?} {}",
            ended.code,
            ended.stderr
        );
    }
}
