//! A part of a plan is not the whole: reports say on top how much of the plan is there, and claims
//! over what is not there are not covered.

use std::path::Path;

use contactbench::record::row;

use crate::common::{Ended, file, run};

/// Nine spacings, of which a quick run takes two.
const EXPERIMENT: &str = r#"
name = "t"
title = "t"
question = "?"
reading = "-"
blocks = 6
detectors = ["nbs", "sorting"]
[[scene]]
name = "pack-c"
n = 50
s = [1, 2, 5, 10, 20, 50, 100, 150, 200]
quick.s = [1, 2]
[[claim]]
name = "NBS: the same memory for S/D = 2 to 200"
kind = "at-most"
value = "peak_bytes"
to = "formula_bytes"
where = { detector = "nbs", s = ">= 2" }
[[claim]]
name = "fast"
kind = "faster"
than = "sorting"
where = { detector = "nbs" }
"#;

/// On the terminal, in `report.md` and in `report.html`.
fn said(folder: &Path, ended: &Ended, words: &[&str]) {
    let read = |name: &str| std::fs::read_to_string(folder.join("result").join(name)).unwrap();
    let (markdown, page) = (read("report.md"), read("report.html"));
    // On the terminal long lines are not broken where no one looks.
    for (place, text) in [("terminal", &ended.stdout), ("report", &markdown), ("page", &page)] {
        for words in words {
            assert!(text.contains(words), "{place}: no '{words}' in {}", ended.stdout);
        }
    }
    let top = markdown.lines().take(4).collect::<String>();
    assert!(top.contains("of the plan"), "{top}");
}

#[test]
fn a_stopped_run_says_what_is_missing_and_claims_nothing_of_it() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "t.toml", EXPERIMENT);
    let ended = run(folder, &["run", "t.toml", "--out", "result"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    said(
        folder,
        &ended,
        &["All of the plan is there: 9 scenes, 18 cells; beside them 9 cells of twins"],
    );
    assert!(ended.stdout.contains("2 claims: ") && !ended.stdout.contains("not covered"));
    let path = folder.join("result").join(row::FILE);
    let whole = std::fs::read_to_string(&path).unwrap();
    // Each scene has three cells of eight rows: a twin takes part beside those planned.
    let part: String = whole.split_inclusive('\n').take(5 * 24).collect();
    std::fs::write(&path, part).unwrap();
    let junit = folder.join("claims.xml");
    let ended = run(folder, &["report", "result", "--junit", &junit.display().to_string()]);
    assert_eq!(ended.code, Some(0), "not covered is no failure: {}", ended.stderr);
    said(
        folder,
        &ended,
        &[
            "t: 5 of 9 scenes and 10 of 18 cells of the plan are there; missing: 8 cells (stopped)",
            "s = 50 to 200 of 2 to 200; 4 of 8 cells (stopped)",
            "2 not covered",
        ],
    );
    assert!(ended.stdout.contains("0 hold, 0 fail, 0 could not be shown, 2 not covered"));
    assert!(std::fs::read_to_string(junit).unwrap().contains("skipped=\"2\""));
}

#[test]
fn a_quick_run_and_a_shard_cover_what_they_measured() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "t.toml", EXPERIMENT);
    let ended = run(folder, &["run", "t.toml", "--quick", "--out", "result"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    said(
        folder,
        &ended,
        &[
            "t: 2 of 9 scenes and 4 of 18 cells of the plan are there; missing: 14 cells (quick \
             run); 4 cells got 3 of their 6 blocks (quick run)",
            "2 not covered",
        ],
    );
    std::fs::remove_dir_all(folder.join("result")).unwrap();
    let ended = run(folder, &["run", "t.toml", "--shard", "1/9", "--out", "result"]);
    said(folder, &ended, &["1 of 9 scenes", "missing: 16 cells (other shard)"]);
}
