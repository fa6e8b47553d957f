//! Tests the runners of `runners/`. A missing library is reported as unavailable, with a command
//! that installs it. Others give right answers, unless they compute in single precision.

use std::path::Path;

use contactbench::record::role::Role;
use contactbench::record::row::{Outcome, Row};

use crate::common::{Place, ended, program};

const EXPERIMENTS: [&str; 2] = [
    include_str!("../../../experiments/peers.toml"),
    include_str!("../../../experiments/codes.toml"),
];
const HEAD: &str = "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\nblocks = \
                    1\ntime-limit-s = 60\n";
/// Runners of libraries that compute in single precision.
const SINGLE: [&str; 2] = ["mdanalysis-nsgrid", "freud-aabb"];

fn runners() -> String {
    let tables = |text: &'static str| {
        &text[text.find("[[runner]]").unwrap()..text.find("[[claim]]").unwrap()]
    };
    EXPERIMENTS.map(tables).concat()
}

/// Runs an experiment in the folder `place` and returns its rows.
fn rows(place: &Path, text: &str) -> Vec<Row> {
    let at = Place::new();
    let (file, out) = (at.file("t.toml", format!("{HEAD}{text}")), at.path("result"));
    let [file, out] = [file, out].map(|path| path.display().to_string());
    let mut command = program(place, &["run", &file, "--out", &out]);
    // Runners cache the programs that they compile in this folder.
    command.env("XDG_CACHE_HOME", env!("CARGO_TARGET_TMPDIR")).env("TMPDIR", at.root());
    ended(command.output().unwrap());
    at.rows("result")
}

#[test]
fn runners_are_right_or_unavailable() {
    let scenes = "[[scene]]\nname = \"packed\"\nn = 300\nsize-ratio = 3\n[[scene]]\nname = \
                  \"packed\"\ndim = 3\nn = [0, 300]\n";
    let text = format!("memory-limit-mib = 16384\ndetectors = [\"nbs\"]\n{scenes}{}", runners());
    let rows = rows(Path::new(env!("CARGO_MANIFEST_DIR")), &text);
    for row in rows.iter().filter(|row| row.role == Role::Runner) {
        let wrong = row.outcome == Outcome::Wrong && SINGLE.contains(&row.id.detector.as_str());
        let absent = row.outcome == Outcome::Unavailable
            && ["pip install", "apt-get install", "cargo build"]
                .iter()
                .any(|way| row.reason.contains(way));
        // Some libraries refuse N < 2: a periodic box needs an extent, a neighbour list a cutoff.
        let refused = row.outcome == Outcome::Refused && row.id.n < 2;
        assert!(row.outcome == Outcome::Ok || wrong || absent || refused, "{row:?}");
        assert_eq!(
            row.time_ns.is_some(),
            row.block == 1 && (row.outcome == Outcome::Ok || wrong),
            "{row:?}"
        );
    }
    for name in runners().lines().filter_map(|line| line.strip_prefix("name = ")) {
        let last = rows.iter().rfind(|row| format!("\"{}\"", row.id.detector) == name).unwrap();
        println!("{name}: {} {}", last.outcome.name(), last.reason);
    }
}
