//! Shards and machines put together.

use std::collections::{BTreeMap, BTreeSet};

use contactbench::record::row::Row;
use serde_json::Value;

use super::{EXPERIMENT, OTHER, changed, rows, started};
use crate::common::{file, good, refused, run, steady};

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
            && ended.stdout.contains("report:  whole/report.md")
            && !ended.stdout.contains("missing:"),
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
    let ended = good(folder, &["merge", "part-1", "part-3", "--out", "two"]);
    assert!(ended.stdout.contains("missing: 1 part, the first is 2/3"), "{}", ended.stdout);
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
    // Of another experiment from the beginning: its copy is not sealed.
    changed(folder, "a", "text", |_| (), |fields| fields["experiments_sha256"] = Value::Null);
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
