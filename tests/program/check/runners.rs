//! `check` accepts right runners: the examples, runners that print other text, and this program.

use std::process::Command;

use super::{CPP, PYTHON, changed, check, root};
use crate::common::{PROGRAM, Place, has};

/// Compiles a program in C++; fails on any error or warning.
fn built(at: &Place, arguments: &str) {
    let mut compiler = Command::new("c++");
    compiler.args(["-Wall", "-Wextra", "-Werror"]).args(shlex::split(arguments).unwrap());
    let built = compiler.current_dir(at.root()).output().unwrap();
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
}

#[test]
fn the_example_in_python_passes() {
    assert!(PYTHON.lines().count() < 80);
    if !has("python3") {
        return;
    }
    let at = Place::new();
    let command = format!("python3 '{}'", root().join("examples/my_detector.py").display());
    let head = "runner: my-detector, f64 ";
    let words = [head, "generated 210", " by my-detector: "];
    let ended = check(&at, &command, "--seconds 0", 0, &words);
    assert_eq!(ended.stderr, "");
    assert_eq!(std::fs::read_dir(at.root()).unwrap().count(), 0, "something is left behind");
}

#[test]
fn the_example_in_cpp_passes() {
    assert!(CPP.lines().count() < 80);
    if !has("c++") {
        return;
    }
    let at = Place::new();
    // Takes the command from the example, and replaces its paths by those of this checkout.
    let line = CPP.lines().find_map(|line| line.strip_prefix("//     g++ ")).unwrap();
    let line = line.replace("runners ", &format!("'{}' ", root().join("runners").display()));
    built(&at, &line.replace("examples/", &format!("'{}'/", root().join("examples").display())));
    let head = "runner: my-grid 1.0, f64 ";
    let words = [head, " by my-grid: "];
    check(&at, "./my_detector", "--seconds 0", 0, &words);
}

/// Text that a library prints, from Python or through its descriptor, is not taken for a reply.
#[test]
fn noisy_runners_in_python_are_understood() {
    if !has("python3") {
        return;
    }
    let at = Place::new();
    let old = "    pairs = []\n";
    let new = "    print('library 1.0')\n    os.write(1, b'noise\\n')\n    pairs = []\n";
    changed(&at, [old, new], "--seconds 0", 0, &[]);
}

#[test]
fn every_pass_begins_with_a_reset_and_every_scene_with_its_hook() {
    if !has("c++") {
        return;
    }
    let at = Place::new();
    at.file("strict.cpp", include_str!("strict.cpp"));
    let header = root().join("runners").display().to_string();
    built(&at, &format!("-std=c++17 -ffp-contract=off -I '{header}' strict.cpp -o strict"));
    check(&at, "./strict", "--seconds 0", 0, &[" by strict: "]);
}

#[test]
fn this_program_is_a_runner_in_every_arithmetic() {
    let at = Place::new();
    let command = format!("'{PROGRAM}' runner --detector kd-tree --arithmetic {{arithmetic}}");
    let words = ["f32", "f64", "exact"];
    let words = words.map(|it| format!(", {it} arithmetic, has all requests\n"));
    check(&at, &command, "--seconds 0", 0, &words.each_ref().map(String::as_str));
    // This runner ignores the requested arithmetic.
    let command = format!("sh -c \"exec '{PROGRAM}' runner --detector nbs\" {{arithmetic}}");
    let words = ["WRONG: ", " by nbs: WRONG"];
    check(&at, &command, "--seconds 0 --arithmetic f64 --arithmetic exact", 1, &words);
}
