//! `check` accepts right detectors and runners, and reports each kind of wrong one.

mod finds;
mod runners;
mod scenes;
mod wrong;

use std::path::PathBuf;

use crate::common::{Ended, Place};

const PYTHON: &str = include_str!("../../../examples/my_detector.py");

const CPP: &str = include_str!("../../../examples/my_detector.cpp");

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Checks a runner on few scenes; the exit code and the words must match.
fn check(at: &Place, runner: &str, options: &str, code: i32, words: &[&str]) -> Ended {
    let quoted = shlex::try_quote(runner).unwrap();
    let line = format!("check --out . --deadline 60 --runner {quoted} {options}");
    at.ends(code, &line, words)
}

/// Checks the example in Python with one piece of its text replaced.
fn changed(at: &Place, [old, new]: [&str; 2], options: &str, code: i32, words: &[&str]) -> Ended {
    assert!(PYTHON.contains(old), "the example has no '{old}' any more");
    at.file("changed.py", PYTHON.replacen(old, new, 1));
    check(at, "python3 changed.py", options, code, words)
}

/// Returns the size of the smallest failing scene, and the rest of its line.
fn smallest(ended: &Ended) -> (u64, &str) {
    let line =
        ended.stdout.lines().find_map(|line| line.strip_prefix("  smallest failing scene: "));
    let line = line.unwrap_or_else(|| panic!("no scene: {}{}", ended.stdout, ended.stderr));
    let (n, words) = line.split_once(" particles, ").unwrap();
    (n.parse().unwrap(), words)
}
