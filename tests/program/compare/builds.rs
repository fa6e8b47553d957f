//! Two builds side by side.

use std::collections::BTreeMap;

use contactbench::record::row;
use contactbench::record::row::{Measurement, Row};

use super::{EXPERIMENT, rows};
use crate::common::{PROGRAM, file, good, refused, run, steady};

/// Two builds take turns: the same program twice, and one that does more for the same answer.
#[cfg(unix)]
#[test]
fn builds_take_turns_in_one_record() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let few = EXPERIMENT.replace("dim = [2, 3]\nn = [50, 200]", "n = 50");
    let few = few.replace("s = [2, 5, 9]", "s = 2");
    file(folder, "t.toml", few.replace("blocks = 5", "blocks = 6"));
    good(folder, &["run", "t.toml", "--out", "same", "--against", PROGRAM]);
    let rows = rows(folder, "same");
    let named = |name: &str| {
        let timed = rows.iter().filter(|row| row.pass == row::Pass::Time);
        timed.filter(|row| row.id.detector == name).collect::<Vec<_>>()
    };
    for name in ["nbs", "nbs@base", "nbs-twin", "sweep", "sweep@base", "sweep-twin"] {
        let timed = named(name);
        // Two scenes, six blocks.
        assert_eq!(timed.len(), 2 * 6, "{name}");
        for row in timed {
            let mean = row.elapsed_ns.unwrap() / row.calls.unwrap();
            assert!(
                row.rounds_ns.len() >= 4 && row.time_ns.unwrap().abs_diff(mean) <= 1,
                "{row:?}"
            );
        }
    }
    // What takes turns is on one processor.
    for row in named("nbs") {
        let other = named("nbs@base")
            .into_iter()
            .find(|other| (other.block, other.id.scene_id()) == (row.block, row.id.scene_id()));
        assert_eq!(other.unwrap().processor, row.processor);
    }
    assert!(named("nothing").is_empty(), "controls have nothing to say of builds");
    let ended = good(folder, &["compare", "same", "--all"]);
    for words in [
        "A: the base, B: this build",
        "times: side by side",
        "floor: this build against itself, the same way: ",
        "the same everywhere (4 cells compared, 0 in one only)",
        " would show (median of cells; at most ",
    ] {
        assert!(ended.stdout.contains(words), "{words}: {}", ended.stdout);
    }
    let slow = format!("#!/bin/sh\nshift 3\nexec {PROGRAM} runner --detector direct \"$@\"\n");
    let other = file(folder, "other.sh", slow);
    std::fs::set_permissions(&other, std::fs::Permissions::from_mode(0o755)).unwrap();
    file(folder, "counts.toml", few.replace("blocks = 5", "blocks = 1"));
    good(folder, &["run", "counts.toml", "--out", "other", "--against", "other.sh"]);
    let ended = run(folder, &["compare", "other"]);
    assert_eq!(ended.code, Some(1), "{}", ended.stdout);
    assert!(
        ended.stdout.contains("list_push") && !ended.stdout.contains("answer "),
        "counts alone"
    );
    let ended = run(folder, &["compare", "same", "--against", "nbs"]);
    assert!(ended.code == Some(2) && ended.stderr.contains("<B>"), "{}", ended.stderr);
    good(folder, &["run", "t.toml", "--quick", "--out", "one"]);
    refused(folder, &["compare", "one"], &["one is of one build", "run --against PROGRAM"]);
}

#[test]
fn what_is_no_build_is_refused_before_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "t.toml", EXPERIMENT);
    for (program, words) in [
        ("/bin/sh", "--against /bin/sh is no build of contactbench: "),
        ("none", "--against none: there is no such program"),
    ] {
        refused(folder, &["run", "t.toml", "--out", "a", "--against", program], &[words]);
        assert!(!folder.join("a").exists());
    }
}

/// A block takes all builds in turns, so that one of which only some rows are there is taken again;
/// the later rows count.
#[test]
fn builds_that_were_stopped_are_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let text = EXPERIMENT
        .replace("dim = [2, 3]\nn = [50, 200]", "n = 50")
        .replace("\"nbs\", \"sweep\", \"nothing\"", "\"nbs\"");
    let text = text.replace("s = [2, 5, 9]", "s = 2").replace("blocks = 5", "blocks = 2");
    file(folder, "t.toml", text);
    let run = ["run", "t.toml", "--out", "result", "--against", PROGRAM];
    good(folder, &run);
    let latest = || -> BTreeMap<Measurement, Row> {
        rows(folder, "result").into_iter().map(|row| (row.measurement(), row)).collect()
    };
    let whole = latest();
    let expected = steady(&whole.values().cloned().collect::<Vec<_>>());
    let path = folder.join("result").join(row::FILE);
    let text = std::fs::read_to_string(&path).unwrap();
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    let timed = lines.iter().position(|line| line.contains("\"pass\":\"time\"")).unwrap();
    // Before the first block, in it, after it, in the second block of the last scene.
    for kept in [timed, timed + 1, timed + 3, lines.len() - 1] {
        std::fs::write(&path, lines[..kept].concat()).unwrap();
        good(folder, &[&run[..], &["--resume"]].concat());
        let resumed = std::fs::read_to_string(&path).unwrap();
        assert!(resumed.starts_with(&lines[..kept].concat()), "after {kept} rows");
        let resumed = latest();
        assert_eq!(steady(&resumed.values().cloned().collect::<Vec<_>>()), expected, "{kept}");
        // Those that are compared met the same state of the machine: none is of before the stop.
        let blocks = |row: &Row| (row.block, row.id.scene_id());
        for row in resumed.values().filter(|row| row.pass == row::Pass::Time) {
            let kept = |row: &Row| whole.get(&row.measurement()) == Some(row);
            let together = resumed.values().filter(|other| blocks(other) == blocks(row));
            assert!(together.clone().all(|other| kept(other) == kept(row)), "{row:?}");
            assert_eq!(together.count(), 3, "the build, the base and the twin");
        }
    }
    let ended = good(folder, &["compare", "result", "--all"]);
    assert!(ended.stdout.contains("(2 cells compared, 0 in one only)"), "{}", ended.stdout);
}
