//! `check --runner`: the examples in Python and C++ pass, and runners that are wrong, each in its
//! way, are found out; and `recommend`.

mod examples;
mod recommend;
mod wrong;

use std::path::{Path, PathBuf};

use crate::common::{Ended, run};

const PYTHON: &str = include_str!("../../../examples/my_detector.py");

const CPP: &str = include_str!("../../../examples/my_detector.cpp");

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
