//! The report of an incomplete record begins with the share that was measured. Claims over missing
//! cells are not covered.

use crate::common::{Ended, Place};

/// An experiment with nine spacings, of which a quick run takes two.
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

/// Fails unless the terminal, `report.md` and `report.html` contain these words.
fn shown(at: &Place, ended: &Ended, words: &[&str]) {
    let (markdown, page) = (at.read("result/report.md"), at.read("result/report.html"));
    for (place, text) in [("terminal", &ended.stdout), ("report", &markdown), ("page", &page)] {
        for words in words {
            assert!(text.contains(words), "{place}: no '{words}' in {}", ended.stdout);
        }
    }
}

#[test]
fn reports_name_what_is_missing_and_claim_nothing_of_it() {
    let at = Place::new();
    at.file("t.toml", EXPERIMENT);
    let ended = at.ends(0, "run t.toml --out result", &["claims"]);
    shown(&at, &ended, &["9 scenes, 18 cells", "9 cells"]);
    assert!(!ended.stdout.contains("not covered"), "{}", ended.stdout);
    // Each scene has 24 rows: eight for each of two detectors and a twin.
    let whole = at.read("result/samples.jsonl");
    at.file("result/samples.jsonl", whole.split_inclusive('\n').take(5 * 24).collect::<String>());
    let none = "2 not covered";
    let ended = at.ends(0, "report result --junit claims.xml", &[none]);
    let words = [
        "5 of 9 scenes and 10 of 18 cells",
        "missing: 8 cells (stopped)",
        "s = 50 to 200 of 2 to 200; 4 of 8 cells (stopped)",
    ];
    shown(&at, &ended, &words);
    let top = at.read("result/report.md").lines().take(4).collect::<String>();
    assert!(top.contains(words[0]), "{top}");
    assert!(at.read("claims.xml").contains("skipped=\"2\""));
    at.remove("result");
    let ended = at.good("run t.toml --quick --out result");
    let words = [
        "2 of 9 scenes and 4 of 18 cells",
        "missing: 14 cells (quick run)",
        "4 cells got 3 of their 6 blocks (quick run)",
    ];
    shown(&at, &ended, &words);
    assert!(ended.stdout.contains("2 not covered"), "{}", ended.stdout);
}
