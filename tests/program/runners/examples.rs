//! Runners that are right: the examples, old ones, this program.

use std::process::Command;

use super::{CPP, PYTHON, check, root};
use crate::common::{PROGRAM, has};

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
        &["--seconds", "0", "--deadline", "60"],
    );
    assert_eq!((ended.code, &*ended.stderr), (Some(0), ""), "{}", ended.stdout);
    assert!(
        ended.stdout.starts_with("runner: my-detector, f64 arithmetic, without count and memory\n"),
        "{}",
        ended.stdout
    );
    assert!(
        ended.stdout.contains("generated 210")
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
    let ended = check(folder.path(), "./my_detector", &["--seconds", "0", "--deadline", "60"]);
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
