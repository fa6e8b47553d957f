//! Tests experiments that compare two builds (`run --against`).
#![cfg(unix)]

use std::collections::BTreeMap;
use std::os::unix::fs::PermissionsExt;

use contactbench::record::row::{Measurement, Pass, Row};

use super::EXPERIMENT;
use crate::common::{PROGRAM, Place, steady};

fn few() -> String {
    let few = EXPERIMENT.replace("dim = [2, 3]\nn = [50, 200]", "n = 50");
    few.replace("s = [2, 5, 9]", "s = 2")
}

/// Two builds are timed in turns: first the same program twice, then one that does more work for
/// the same answer.
#[test]
fn builds_take_turns_in_one_record() {
    let at = Place::new();
    at.file("t.toml", few().replace("blocks = 5", "blocks = 6"));
    at.good(&format!("run t.toml --out same --against {PROGRAM}"));
    let rows = at.rows("same");
    let named = |name: &str| -> Vec<&Row> {
        let timed = rows.iter().filter(|row| row.pass == Pass::Time);
        timed.filter(|row| row.id.detector == name).collect()
    };
    for name in ["nbs", "nbs@base", "nbs-twin", "sweep", "sweep@base", "sweep-twin"] {
        let timed = named(name);
        assert_eq!(timed.len(), 2 * 6, "{name}: two scenes, six blocks");
        for row in timed {
            let mean = row.elapsed_ns.unwrap() / row.calls.unwrap();
            assert!(row.rounds_ns.len() >= 4, "{row:?}");
            assert!(row.time_ns.unwrap().abs_diff(mean) <= 1, "{row:?}");
        }
    }
    let place = |row: &Row| (row.block, row.id.scene_id());
    for row in named("nbs") {
        let other = named("nbs@base").into_iter().find(|other| place(other) == place(row));
        assert_eq!(other.unwrap().processor, row.processor);
    }
    assert!(named("nothing").is_empty(), "controls have nothing to say of builds");
    at.ends(0, "compare same --all", &["A: ", "B: ", "(4 cells compared, 0 in one"]);
    at.ends(2, "compare same --against nbs", &["<B>"]);
    let slow = format!("#!/bin/sh\nshift 3\nexec {PROGRAM} runner --detector direct \"$@\"\n");
    let other = at.file("other.sh", slow);
    std::fs::set_permissions(&other, std::fs::Permissions::from_mode(0o755)).unwrap();
    at.file("counts.toml", few().replace("blocks = 5", "blocks = 0"));
    at.good("run counts.toml --out other --against other.sh");
    let ended = at.ends(1, "compare other", &["list_push"]);
    assert!(!ended.stdout.contains("answer "), "counts alone: {}", ended.stdout);
    at.good("run counts.toml --out one");
    at.ends(2, "compare one", &["one", "run --against PROGRAM"]);
}

/// A block with rows of some builds only is measured again, and the later rows count.
#[test]
fn builds_that_were_stopped_are_resumed() {
    let at = Place::new();
    let text = few().replace("\"nbs\", \"sweep\", \"nothing\"", "\"nbs\"");
    at.file("t.toml", text.replace("blocks = 5", "blocks = 2"));
    let run = format!("run t.toml --out result --against {PROGRAM}");
    at.good(&run);
    let latest = || -> BTreeMap<Measurement, Row> {
        at.rows("result").into_iter().map(|row| (row.measurement(), row)).collect()
    };
    let whole = latest();
    let expected = steady(&whole.values().cloned().collect::<Vec<_>>());
    let text = at.read("result/samples.jsonl");
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    let timed = lines.iter().position(|line| line.contains("\"pass\":\"time\"")).unwrap();
    // The run is cut in the first block, then in the second block of the last scene.
    for kept in [timed + 1, lines.len() - 1] {
        at.file("result/samples.jsonl", lines[..kept].concat());
        at.good(&format!("{run} --resume"));
        assert!(at.read("result/samples.jsonl").starts_with(&lines[..kept].concat()), "{kept}");
        let resumed = latest();
        assert_eq!(steady(&resumed.values().cloned().collect::<Vec<_>>()), expected, "{kept}");
        // Rows that are compared were all measured before the stop, or all after it.
        let blocks = |row: &Row| (row.block, row.id.scene_id());
        for row in resumed.values().filter(|row| row.pass == Pass::Time) {
            let kept = |row: &Row| whole.get(&row.measurement()) == Some(row);
            let together = resumed.values().filter(|other| blocks(other) == blocks(row));
            assert!(together.clone().all(|other| kept(other) == kept(row)), "{row:?}");
            assert_eq!(together.count(), 3, "the build, the base and the twin");
        }
    }
    at.ends(0, "compare result --all", &["(2 cells compared, 0 in one"]);
}
