//! Result folders beside each other and put together: shards, machines, revisions; and what
//! continuous integration is told.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::OnceLock;

use contactbench::record::row;
use contactbench::record::row::Row;
use contactbench::record::seal;
use serde_json::Value;

use crate::common::{Ended, PROGRAM, Template, file, run, steady};

const EXPERIMENT: &str = "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\nblocks \
                          = 5\ndetectors = [\"nbs\", \"sweep\", \"nothing\"]\n[[scene]]\nname = \
                          \"packed\"\ndim = [2, 3]\nn = [50, 200]\n[[scene]]\nname = \
                          \"pack-c\"\nn = 100\ns = [2, 5, 9]\n[[claim]]\nname = \"nbs \
                          pushes\"\nkind = \"at-most\"\nvalue = \"n\"\nto = \"list_push\"\nwhere \
                          = { detector = \"nbs\" }\n";

/// A fingerprint that nothing has.
const OTHER: &str = "0x0000000000000001";

fn good(folder: &Path, arguments: &[&str]) -> Ended {
    let ended = run(folder, arguments);
    assert_eq!(ended.code, Some(0), "{arguments:?}: {}{}", ended.stdout, ended.stderr);
    ended
}

/// One line on standard error, with exit code 2 and these words.
fn refused(folder: &Path, arguments: &[&str], words: &[&str]) {
    let ended = run(folder, arguments);
    assert_eq!(
        (ended.code, ended.stderr.lines().count()),
        (Some(2), 1),
        "{arguments:?}: {}{}",
        ended.stdout,
        ended.stderr
    );
    for word in words {
        assert!(ended.stderr.contains(word), "{arguments:?}: no '{word}' in: {}", ended.stderr);
    }
}

fn rows(folder: &Path, name: &str) -> Vec<Row> {
    let record = row::read(&folder.join(name).join(row::FILE)).unwrap();
    assert!(record.warnings.is_empty(), "{:?}", record.warnings);
    record.rows
}

/// A copy of a result folder, with its rows and its provenance changed.
fn changed(
    folder: &Path,
    from: &str,
    to: &str,
    change: impl Fn(&mut Value),
    provenance: impl Fn(&mut Value),
) {
    let (from, to) = (folder.join(from), folder.join(to));
    std::fs::create_dir_all(to.join("experiments")).unwrap();
    std::fs::copy(from.join("experiments/t.toml"), to.join("experiments/t.toml")).unwrap();
    let edit = |text: &str, change: &dyn Fn(&mut Value)| {
        let mut value: Value = serde_json::from_str(text).unwrap();
        change(&mut value);
        value.to_string()
    };
    // As a run would have written it: one detection in each sample, and a check of the line.
    let change = |row: &mut Value| {
        change(row);
        if row["time_ns"].is_u64() {
            (row["calls"], row["elapsed_ns"]) = (1.into(), row["time_ns"].clone());
        }
    };
    let record = std::fs::read_to_string(from.join(row::FILE)).unwrap();
    let sealed = |line: &str| seal::sealed(&edit(&seal::unsealed(line), &change)) + "\n";
    let lines: Vec<String> = record.lines().map(sealed).collect();
    std::fs::write(to.join(row::FILE), lines.concat()).unwrap();
    let fields = std::fs::read_to_string(from.join("provenance.json")).unwrap();
    std::fs::write(to.join("provenance.json"), edit(&fields, &provenance)).unwrap();
}

/// A result folder `a`, with times that do not depend on what else the machine does: 1000 ns and
/// the number of the block.
fn started() -> tempfile::TempDir {
    static RUN: OnceLock<Template> = OnceLock::new();
    let calm = |row: &mut Value| {
        if row["time_ns"].is_u64() {
            row["time_ns"] = (1000 + row["block"].as_u64().unwrap()).into();
        }
    };
    let template = RUN.get_or_init(|| {
        Template::new(|folder| {
            file(folder, "t.toml", EXPERIMENT);
            good(folder, &["run", "t.toml", "--out", "measured"]);
            changed(folder, "measured", "a", calm, |_| ());
        })
    });
    template.copy()
}

#[test]
fn shards_merge_to_the_record_of_the_whole() {
    let folder = started();
    let folder = folder.path();
    let parts: Vec<String> = (1..=3).map(|k| format!("part-{k}")).collect();
    for (k, part) in parts.iter().enumerate() {
        good(folder, &["run", "t.toml", "--shard", &format!("{}/3", k + 1), "--out", part]);
        let scenes: BTreeSet<String> =
            rows(folder, part).iter().map(|row| row.stats.scene_hash.clone()).collect();
        assert!((2..=3).contains(&scenes.len()), "seven scenes on three shards: {}", scenes.len());
    }
    let names: Vec<&str> = parts.iter().map(String::as_str).collect();
    let ended = good(folder, &[&["merge"], &names[..], &["--out", "whole"]].concat());
    assert!(
        ended.stdout.contains("of 3 folders; 0 stood there twice")
            && ended.stdout.contains("report:  whole/report.md"),
        "{}",
        ended.stdout
    );
    assert_eq!(steady(&rows(folder, "whole")), steady(&rows(folder, "a")));
    let ended = good(folder, &["compare", "a", "whole", "--strict"]);
    assert!(
        ended.stdout.contains(
            "pairs, counts, bytes, outcomes: the same everywhere (28 cells compared, 0 in one \
             only)"
        ),
        "{}",
        ended.stdout
    );
    // A shard of its own is not complete, and says so only if it is asked to.
    good(folder, &["compare", "a", "part-1"]);
    assert_eq!(run(folder, &["compare", "a", "part-1", "--strict"]).code, Some(1));
    // More shards than scenes: the last have nothing to do, and can be merged all the same.
    let ended = good(folder, &["run", "t.toml", "--shard", "9/9", "--out", "empty"]);
    assert!(ended.stdout.contains("more shards than scenes"), "{}", ended.stdout);
    good(folder, &["merge", "empty", "whole", "--out", "again"]);
    assert_eq!(rows(folder, "again"), rows(folder, "whole"));
    for bad in ["0/3", "4/3", "3", "a/b", "1/0"] {
        let ended = run(folder, &["run", "t.toml", "--shard", bad]);
        assert!(
            ended.code == Some(2) && ended.stderr.contains("a shard is k/n with 1 <= k <= n"),
            "{bad}: {}",
            ended.stderr
        );
    }
}

#[test]
fn a_merge_keeps_machines_apart_and_rows_once() {
    let folder = started();
    let folder = folder.path();
    let whole = rows(folder, "a");
    good(folder, &["merge", "a", "a", "--out", "twice"]);
    assert_eq!(rows(folder, "twice"), whole, "the same row twice is one row");
    // The same machine once more: further blocks, paired as before.
    good(folder, &["run", "t.toml", "--out", "b"]);
    good(folder, &["merge", "a", "b", "--out", "more"]);
    let more = rows(folder, "more");
    let blocks = |rows: &[Row]| rows.iter().filter(|row| row.block > 0).count();
    assert_eq!((blocks(&more), more.len()), (2 * blocks(&whole), whole.len() + blocks(&whole)));
    assert_eq!(more.iter().map(|row| row.block).max(), Some(10));
    good(folder, &["merge", "a", "b", "b", "--out", "no-more"]);
    assert_eq!(rows(folder, "no-more"), more);
    // What was merged before is known again, under whatever number.
    for (k, parts) in [["more", "b"], ["b", "more"]].into_iter().enumerate() {
        let name = format!("known-{k}");
        good(folder, &["merge", parts[0], parts[1], "--out", &name]);
        assert_eq!(rows(folder, &name).len(), more.len(), "{parts:?}");
    }
    // Another machine, and one that only has the same name.
    let slower = |row: &mut Value| {
        if let Some(time) = row["time_ns"].as_u64() {
            row["time_ns"] = (1000 * time).into();
        }
    };
    let name = whole[0].id.machine.clone().unwrap();
    changed(
        folder,
        "a",
        "other",
        |row| (slower(row), row["machine"] = "other".into()).1,
        |fields| (fields["machine"], fields["host"]) = ("other".into(), "other".into()),
    );
    changed(folder, "a", "namesake", slower, |fields| fields["cpu"] = "another model".into());
    good(folder, &["merge", "a", "other", "namesake", "--out", "three"]);
    let three = rows(folder, "three");
    let machines: BTreeSet<&str> =
        three.iter().map(|row| row.id.machine.as_deref().unwrap()).collect();
    let namesake = format!("{name}-2");
    assert_eq!(machines, BTreeSet::from([&*name, "other", &*namesake]));
    assert_eq!(three.len(), 3 * whole.len());
    let summary = std::fs::read_to_string(folder.join("three/summary.csv")).unwrap();
    let head: Vec<&str> = summary.lines().next().unwrap().split(',').collect();
    let column = |name: &str| head.iter().position(|known| *known == name).unwrap();
    let (machine, time, blocks) = (column("machine"), column("time_ns_median"), column("blocks"));
    assert_eq!(summary.lines().count(), 1 + 3 * 28);
    for line in summary.lines().skip(1).map(|line| line.split(',').collect::<Vec<_>>()) {
        let median: f64 = line[time].parse().unwrap();
        assert_eq!(line[blocks], "5", "no median is over two machines");
        assert_eq!(median < 1e5, line[machine] == name, "{line:?}");
    }
    // A processor of the same model, with another cache: alone, and after a merge.
    changed(folder, "a", "cousin", slower, |fields| fields["caches"]["L3"] = "300M".into());
    // What an older version says of a merged record: nothing about caches.
    changed(folder, "a", "older", slower, |fields| {
        let kept = ["machine", "cpu", "cores", "revision"];
        fields.as_object_mut().unwrap().retain(|name, _| kept.contains(&name.as_str()));
    });
    for (name, parts) in [
        ("two", &["a", "cousin"][..]),
        ("four", &["three", "cousin"]),
        ("again", &["four", "cousin", "a"]),
        ("apart", &["a", "older"]),
    ] {
        good(folder, &[&["merge"], parts, &["--out", name]].concat());
        let rows = rows(folder, name);
        let mut medians: BTreeMap<_, BTreeSet<bool>> = BTreeMap::new();
        for row in rows.iter().filter(|row| row.time_ns.is_some()) {
            let slow = row.time_ns > Some(100_000);
            medians.entry(row.id.machine.clone()).or_default().insert(slow);
        }
        assert!(medians.values().all(|kinds| kinds.len() == 1), "{name}: {medians:?}");
        assert_eq!(
            medians.len(),
            if parts.len() == 2 && parts[0] == "a" { 2 } else { 4 },
            "{name}"
        );
    }
    // Each machine of a merged record against itself elsewhere.
    let ended = good(folder, &["compare", "three", "a"]);
    assert!(ended.stdout.contains("(28 cells compared"), "{}", ended.stdout);
}

#[test]
fn what_does_not_belong_together_is_not_merged() {
    let folder = started();
    let folder = folder.path();
    refused(
        folder,
        &["merge", "a", "--out", "a"],
        &["a/samples.jsonl holds a record already", "--out"],
    );
    refused(
        folder,
        &["merge", "a", "none", "--out", "b"],
        &["cannot read the record none/samples.jsonl"],
    );
    let pushed = |row: &mut Value| {
        if row["detector"] == "nbs" && row["n"] == 50 && row["pass"] == "count" {
            row["counts"]["list_push"] = 51.into();
        }
    };
    changed(folder, "a", "count", pushed, |_| ());
    refused(
        folder,
        &["merge", "a", "count", "--out", "b"],
        &[
            "the count of operations of nbs (exact, packed) with N = 50 in count is another",
            "Compare them",
        ],
    );
    changed(folder, "a", "scene", |row| row["stats"]["scene_hash"] = OTHER.into(), |_| ());
    refused(
        folder,
        &["merge", "a", "scene", "--out", "b"],
        &["the scene packed with N = 50 is not the same in a and scene"],
    );
    changed(folder, "a", "text", |_| (), |_| ());
    file(folder, "text/experiments/t.toml", EXPERIMENT.replace("blocks = 5", "blocks = 6"));
    refused(
        folder,
        &["merge", "a", "text", "--out", "b"],
        &["the experiment t is not the same in a and text", "experiments/t.toml"],
    );
    std::fs::rename(folder.join("text/experiments/t.toml"), folder.join("text/experiments/u.toml"))
        .unwrap();
    refused(
        folder,
        &["merge", "a", "text", "--out", "b"],
        &["a has the experiments t, text has u"],
    );
    assert!(!folder.join("b").exists());
}

#[test]
fn counts_bytes_and_digests_are_gated_and_times_are_not() {
    let folder = started();
    let folder = folder.path();
    good(folder, &["run", "t.toml", "--out", "b", "--junit", "run.xml"]);
    let ended = good(folder, &["compare", "a", "b", "--junit", "compare.xml"]);
    assert!(
        ended.stdout.contains("compare: passed")
            && ended.stdout.contains("times: each a multiple of that of nbs"),
        "{}",
        ended.stdout
    );
    assert_eq!(junit(&folder.join("compare.xml")), (28, 0));
    assert_eq!(junit(&folder.join("run.xml")), (2, 0), "the claim, right answers");
    for (what, change) in [
        (
            "list_push",
            (|row| {
                if row["detector"] == "nbs"
                    && row["n"] == 50
                    && row["dim"] == 2
                    && row["pass"] == "count"
                {
                    row["counts"]["list_push"] = 51.into();
                }
            }) as fn(&mut Value),
        ),
        ("peak_bytes", |row| {
            if row["detector"] == "nbs"
                && row["n"] == 50
                && row["dim"] == 2
                && row["pass"] == "memory"
            {
                (row["peak_bytes"], row["live_bytes"]) = (1.into(), 1.into());
            }
        }),
        // A record in which only one of them has it would contradict itself.
        ("answer", |row| {
            if row["detector"] != "nothing" && row["n"] == 50 && row["dim"] == 2 {
                row["digest"] = OTHER.into()
            }
        }),
        ("outcome (time)", |row| {
            if row["detector"] == "nbs"
                && row["n"] == 50
                && row["dim"] == 2
                && row["pass"] == "time"
            {
                row["outcome"] = "wrong".into();
            }
        }),
        ("scene", |row| {
            if row["n"] == 50 && row["dim"] == 2 {
                row["stats"]["scene_hash"] = OTHER.into()
            }
        }),
    ] {
        let cells = match what {
            "answer" => 3,
            "scene" => 4,
            _ => 1,
        };
        let count = if cells == 1 { "1 cell".into() } else { format!("{cells} cells") };
        changed(folder, "a", "changed", change, |_| ());
        let ended =
            run(folder, &["compare", "a", "changed", "--junit", "compare.xml", "--annotations"]);
        assert_eq!(ended.code, Some(1), "{what}: {}", ended.stdout);
        assert!(
            ended.stdout.contains("CHANGED  nbs, exact, packed, 2D, n = 50\n"),
            "{what}: {}",
            ended.stdout
        );
        assert!(ended.stdout.contains(&format!("         {what} ")), "{what}: {}", ended.stdout);
        let words = format!("CHANGED in {count} (28 cells compared");
        assert!(ended.stdout.contains(&words), "{}", ended.stdout);
        assert!(ended.stdout.contains(
            "::error title=contactbench compare%3A t.packed%3A nbs%2C exact%2C packed%2C 2D%2C n \
             = 50::changed"
        ));
        assert_eq!(junit(&folder.join("compare.xml")), (28, cells));
    }
    // Ten times as slow: said, and gated only where that is asked for.
    let slower: fn(&mut Value) = |row| {
        if let Some(time) = row["time_ns"].as_u64().filter(|_| row["detector"] == "sweep") {
            row["time_ns"] = (10 * time).into();
        }
    };
    changed(folder, "a", "slower", slower, |_| ());
    let ended = good(folder, &["compare", "a", "slower", "--annotations"]);
    assert!(
        ended.stdout.contains("slower") && ended.stdout.contains("::warning"),
        "{}",
        ended.stdout
    );
    let json = |more: &[&str]| -> (Option<i32>, Value) {
        let ended = run(folder, &[&["compare", "a", "slower", "--json"], more].concat());
        (ended.code, serde_json::from_str(&ended.stdout).unwrap())
    };
    let (code, all) = json(&["--gate-time"]);
    assert_eq!(
        (code, &all["passed"], &all["summary"]["failed"], &all["summary"]["times"]["slower"]),
        (Some(1), &false.into(), &7.into(), &7.into())
    );
    let sweep = |all: &Value| {
        all["cells"]
            .as_array()
            .unwrap()
            .iter()
            .find(|cell| cell["key"]["detector"] == "sweep")
            .unwrap()
            .clone()
    };
    let ratio = sweep(&all)["time"]["ratio"].as_f64().unwrap();
    assert!((9.9..10.1).contains(&ratio), "{ratio}");
    assert_eq!(json(&["--gate-time", "--band", "1000"]).0, Some(0));
    // Another machine, and no control in both: shown, not judged, unless against a detector of
    // both.
    let no_control = |row: &mut Value| {
        if row["role"]["twin"].is_string() {
            row["role"] = "runner".into();
        }
    };
    changed(
        folder,
        "a",
        "slower",
        |row| {
            slower(row);
            no_control(row);
            row["machine"] = "other".into();
        },
        |fields| (fields["machine"], fields["host"]) = ("other".into(), "other".into()),
    );
    let (code, all) = json(&[]);
    assert_eq!((code, &sweep(&all)["time"]["verdict"]), (Some(0), &"not-judged".into()));
    // A gate that judges nothing is not passed.
    refused(
        folder,
        &["compare", "a", "slower", "--gate-time"],
        &["no time could be judged", "two machines"],
    );
    assert!(all["times"].as_str().unwrap().contains("two machines: "), "{}", all["times"]);
    let (code, all) = json(&["--gate-time", "--against", "nbs"]);
    assert_eq!((code, &sweep(&all)["time"]["verdict"]), (Some(1), &"slower".into()));
    changed(folder, "a", "slower", slower, |fields| fields["profile"] = "another".into());
    let (code, all) = json(&["--against", "nbs"]);
    assert_eq!(
        (code, &sweep(&all)["time"]["verdict"]),
        (Some(0), &"not-judged".into()),
        "{}",
        all["times"]
    );
}

/// A run that was cut short has not passed what it has not measured.
#[test]
fn what_one_has_not_measured_is_lacking() {
    let folder = started();
    let folder = folder.path();
    changed(folder, "a", "cut", |_| (), |_| ());
    let record = folder.join("cut").join(row::FILE);
    let text = std::fs::read_to_string(&record).unwrap();
    let kept: String = text
        .lines()
        .filter(|line| !line.contains("\"pass\":\"time\""))
        .map(|line| format!("{line}\n"))
        .collect();
    assert!(kept.len() < text.len());
    std::fs::write(&record, kept).unwrap();
    let ended = good(folder, &["compare", "a", "cut"]);
    assert!(ended.stdout.contains("28 measured in part in one"), "{}", ended.stdout);
    let ended = run(folder, &["compare", "a", "cut", "--strict"]);
    assert!(
        ended.code == Some(1) && ended.stdout.contains("the time pass only in A"),
        "{}",
        ended.stdout
    );
}

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
    refused(folder, &["run", "t.toml", "--against", "none"], &["--against none: there is no such"]);
    good(folder, &["run", "t.toml", "--quick", "--out", "one"]);
    refused(folder, &["compare", "one"], &["one is of one build", "run --against PROGRAM"]);
}

/// Test cases and failures of a file that is well-formed.
fn junit(path: &Path) -> (usize, usize) {
    let text = std::fs::read_to_string(path).unwrap();
    let document = roxmltree::Document::parse(&text).unwrap();
    let count = |name: &str| document.descendants().filter(|node| node.has_tag_name(name)).count();
    assert!(
        document
            .descendants()
            .filter(|node| node.has_tag_name("testcase"))
            .all(|case| case.attribute("classname").is_some())
    );
    (count("testcase"), count("failure"))
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let folder = started();
    let folder = folder.path();
    refused(folder, &["compare", "a", "none"], &["cannot read the record none/samples.jsonl"]);
    refused(
        folder,
        &["compare", "a", "a", "--against", "bvh"],
        &["--against bvh: a has no rows of this detector", "nbs, nbs-twin, nothing, sweep"],
    );
    refused(
        folder,
        &["compare", "a", "a", "--band", "-1"],
        &["--band -1: give percent from 0 to 1000"],
    );
    changed(folder, "a", "b", |row| row["seed"] = 7.into(), |_| ());
    refused(folder, &["compare", "a", "b"], &["a and b have no cell in common"]);
    // Records of the first schema, which do not name the machine in their rows.
    let old = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/records/schema-1");
    let old = old.display().to_string();
    let ended = good(folder, &["compare", &old, &old, "--strict", "--against", "nbs"]);
    assert!(ended.stdout.contains("the same everywhere"), "{}", ended.stdout);
}

#[test]
fn check_and_list_speak_to_machines() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let ended = good(
        folder,
        &["check", "--detector", "nbs", "--seeds", "1", "--json", "--junit", "good.xml"],
    );
    let json: Value = serde_json::from_str(&ended.stdout).unwrap();
    assert_eq!((&json["passed"], &json["detectors"][0]), (&true.into(), &"nbs".into()));
    assert!(json["checks"][0]["detections"].as_u64().unwrap() > 100);
    assert_eq!(junit(&folder.join("good.xml")), (1, 0));
    let bad = [
        "check",
        "--detector",
        "nothing",
        "--detector",
        "direct",
        "--seeds",
        "1",
        "--junit",
        "bad.xml",
    ];
    let ended = run(folder, &[&bad[..], &["--annotations"]].concat());
    assert_eq!(ended.code, Some(1));
    assert!(
        ended.stdout.contains(
            "::error title=contactbench check%3A generated%3A nothing%2C exact arithmetic::on "
        ),
        "{}",
        ended.stdout
    );
    assert_eq!(junit(&folder.join("bad.xml")), (2, 1));
    let ended = run(folder, &[&bad[..], &["--json"]].concat());
    let json: Value = serde_json::from_str(&ended.stdout).unwrap();
    let failure = &json["checks"][0]["failures"][0];
    assert_eq!((ended.code, &failure["detector"]), (Some(1), &"nothing".into()));
    assert!(folder.join(failure["file"].as_str().unwrap()).exists());
    let list = |what: &[&str]| -> Value {
        serde_json::from_str(&good(folder, &[&["list", "--json"], what].concat()).stdout).unwrap()
    };
    let all = list(&[]);
    for (table, least) in
        [("detectors", 11), ("arithmetics", 5), ("scenes", 8), ("experiments", 10)]
    {
        assert!(
            all[table]
                .as_array()
                .is_some_and(|rows| rows.len() >= least && rows[0]["name"].is_string()),
            "{table}"
        );
    }
    assert_eq!(list(&["detectors"]).as_object().unwrap().len(), 1);
    assert!(list(&["hard-cases"])["hard_cases"].as_array().is_some_and(|cases| cases.len() > 20));
}

/// The commands of the example workflow, on a baseline made by this very program.
#[test]
fn the_example_workflow_passes() {
    let ci = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/ci");
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::create_dir(folder.join("ci")).unwrap();
    std::fs::copy(ci.join("contacts.toml"), folder.join("ci/contacts.toml")).unwrap();
    let workflow = std::fs::read_to_string(ci.join("github.yml")).unwrap();
    let make = workflow.lines().find_map(|line| line.strip_prefix("#   contactbench ")).unwrap();
    good(folder, &make.split_whitespace().collect::<Vec<_>>());
    let commands: Vec<&str> = workflow
        .lines()
        .filter_map(|line| line.trim().strip_prefix("- run: contactbench "))
        .collect();
    assert_eq!(commands.len(), 3, "{commands:?}");
    for command in &commands {
        good(folder, &command.split_whitespace().collect::<Vec<_>>());
    }
    for file in ["check.xml", "run.xml", "compare.xml"] {
        assert_eq!(junit(&folder.join(file)).1, 0, "{file}");
    }
    // The gate closes.
    let record = folder.join("ci/baseline/samples.jsonl");
    let text = std::fs::read_to_string(&record).unwrap().replacen(
        "\"digest\":\"0x",
        "\"digest\":\"0xf",
        1,
    );
    std::fs::write(&record, text).unwrap();
    assert_eq!(run(folder, &commands[2].split_whitespace().collect::<Vec<_>>()).code, Some(1));
}
