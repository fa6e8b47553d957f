//! Tests merging the records of shards and machines.

use std::collections::{BTreeMap, BTreeSet};

use contactbench::record::folder::copies;
use contactbench::record::row::Row;
use serde_json::Value;

use super::{EXPERIMENT, OTHER, changed, started};
use crate::common::steady;

#[test]
fn shards_merge_to_the_record_of_the_whole() {
    let at = started();
    for k in 1..=3 {
        at.good(&format!("run t.toml --shard {k}/3 --out part-{k}"));
        let rows = at.rows(&format!("part-{k}"));
        let scenes: BTreeSet<&String> = rows.iter().map(|row| &row.stats.scene_hash).collect();
        assert!((2..=3).contains(&scenes.len()), "seven scenes on three shards: {}", scenes.len());
    }
    let words = ["3 folders; 0 ", "whole/report.md"];
    let ended = at.ends(0, "merge part-1 part-2 part-3 --out whole", &words);
    assert!(!ended.stdout.contains("missing:"), "{}", ended.stdout);
    assert_eq!(steady(&at.rows("whole")), steady(&at.rows("a")));
    at.ends(0, "compare a whole --strict", &["(28 cells compared, 0 in one"]);
    at.ends(0, "merge part-1 part-3 --out two", &["missing: 1 part", "2/3"]);
    // A missing shard is an error only with --strict.
    at.good("compare a part-1");
    at.ends(1, "compare a part-1 --strict", &[]);
    // Shards of one machine may overlap in time.
    let begun = |part: &str| at.rows(part).iter().filter_map(|row| row.began_ms).min().unwrap();
    let between = begun("part-2") - begun("part-1");
    for (part, later) in [("part-1", between), ("part-2", 0)] {
        let file = format!("{part}/samples.jsonl");
        let at_once = |line: &str| {
            super::edited(line, |row| {
                if let Some(began) = row["began_ms"].as_u64() {
                    (row["began_ms"], row["processor"]) = ((began + later).into(), 0.into());
                }
            }) + "\n"
        };
        at.file(&file, at.read(&file).lines().map(at_once).collect::<String>());
    }
    at.good("merge part-1 part-2 --out at-once");
    // A shard without scenes can be merged.
    at.ends(0, "run t.toml --shard 9/9 --out empty", &["9/9"]);
    at.good("merge empty whole --out again");
    assert_eq!(at.rows("again"), at.rows("whole"));
}

fn slower(row: &mut Value) {
    if let Some(time) = row["time_ns"].as_u64() {
        row["time_ns"] = (1000 * time).into();
    }
}

#[test]
fn a_merge_keeps_rows_once() {
    let at = started();
    let whole = at.rows("a");
    at.good("merge a a --out twice");
    assert_eq!(at.rows("twice"), whole, "the same row twice is one row");
    // A second run on the same machine adds blocks; blocks merged before are recognised.
    at.good("run t.toml --out b");
    at.good("merge a b --out more");
    let more = at.rows("more");
    let blocks = |rows: &[Row]| rows.iter().filter(|row| row.block > 0).count();
    assert_eq!((blocks(&more), more.len()), (2 * blocks(&whole), whole.len() + blocks(&whole)));
    assert_eq!(more.iter().map(|row| row.block).max(), Some(10));
    for (k, parts) in ["a b b", "more b", "b more"].into_iter().enumerate() {
        at.good(&format!("merge {parts} --out known-{k}"));
        assert_eq!(at.rows(&format!("known-{k}")).len(), more.len(), "{parts}");
    }
}

#[test]
fn runs_of_few_blocks_merge_to_the_record_of_the_whole() {
    let at = started();
    at.ends(0, "run t.toml --blocks 2 --out a-2", &["21 cells short of blocks"]);
    at.ends(0, "run t.toml --blocks 3 --out a-3", &["21 cells short of blocks"]);
    let ended = at.ends(0, "merge a-2 a-3 --out whole", &["2 folders; "]);
    assert!(!ended.stdout.contains("short of blocks"), "{}", ended.stdout);
    assert_eq!(steady(&at.rows("whole")), steady(&at.rows("a")));
    at.ends(2, "run t.toml --blocks 0 --out none", &["--blocks"]);
}

#[test]
fn a_merge_keeps_machines_apart() {
    let at = started();
    let whole = at.rows("a");
    // Records differ in machine, in processor only, in cache only, or are older and lack caches.
    let name = whole[0].id.machine.clone().unwrap();
    let elsewhere = |row: &mut Value| {
        slower(row);
        row["machine"] = "other".into();
    };
    let host = |fields: &mut Value| {
        (fields["machine"], fields["host"]) = ("other".into(), "other".into());
    };
    changed(&at, "other", elsewhere, host);
    changed(&at, "namesake", slower, |fields| fields["cpu"] = "another model".into());
    changed(&at, "cousin", slower, |fields| fields["caches"]["L3"] = "300M".into());
    changed(&at, "older", slower, |fields| {
        let kept = ["machine", "cpu", "cores", "revision", copies::FIELD];
        fields.as_object_mut().unwrap().retain(|name, _| kept.contains(&name.as_str()));
    });
    at.good("merge a other namesake --out three");
    let three = at.rows("three");
    let machines = three.iter().map(|row| row.id.machine.as_deref().unwrap());
    let namesake = format!("{name}-2");
    assert_eq!(BTreeSet::from_iter(machines), BTreeSet::from([&*name, "other", &*namesake]));
    assert_eq!(three.len(), 3 * whole.len());
    let summary = at.read("three/summary.csv");
    assert_eq!(summary.lines().count(), 1 + 3 * 28);
    let mut lines = summary.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let head = lines.next().unwrap();
    let column = |name: &str| head.iter().position(|known| *known == name).unwrap();
    let [machine, time, blocks] = ["machine", "time_ns_median", "blocks"].map(column);
    for line in lines {
        let median: f64 = line[time].parse().unwrap();
        assert_eq!(line[blocks], "5", "no median is over two machines");
        assert_eq!(median < 1e5, line[machine] == name, "{line:?}");
    }
    for (name, parts, count) in [
        ("two", "a cousin", 2),
        ("four", "three cousin", 4),
        ("again", "four cousin a", 4),
        ("apart", "a older", 2),
    ] {
        at.good(&format!("merge {parts} --out {name}"));
        let mut medians: BTreeMap<_, BTreeSet<bool>> = BTreeMap::new();
        for row in at.rows(name).into_iter().filter(|row| row.time_ns.is_some()) {
            medians.entry(row.id.machine).or_default().insert(row.time_ns > Some(100_000));
        }
        assert!(medians.values().all(|kinds| kinds.len() == 1), "{name}: {medians:?}");
        assert_eq!(medians.len(), count, "{name}");
    }
    // A merged record can be compared with the record of one of its machines.
    at.ends(0, "compare three a", &["(28 cells compared"]);
}

#[test]
fn what_does_not_belong_together_is_not_merged() {
    let at = started();
    at.ends(2, "merge a --out a", &["a/samples.jsonl", "--out"]);
    at.ends(2, "merge a none --out b", &["no folder none"]);
    let pushed = |row: &mut Value| {
        if row["detector"] == "nbs" && row["n"] == 50 && row["pass"] == "count" {
            row["counts"]["list_push"] = 51.into();
        }
    };
    changed(&at, "count", pushed, |_| ());
    at.ends(2, "merge a count --out b", &["nbs (exact, packed)", "N = 50", "count"]);
    // Counts do not depend on the machine, either.
    let elsewhere = |row: &mut Value| {
        pushed(row);
        row["machine"] = "other".into();
    };
    changed(&at, "elsewhere", elsewhere, |fields| {
        (fields["machine"], fields["host"]) = ("other".into(), "other".into());
    });
    at.ends(2, "merge a elsewhere --out b", &["nbs (exact, packed)", "N = 50", "count"]);
    changed(&at, "scene", |row| row["stats"]["scene_hash"] = OTHER.into(), |_| ());
    at.ends(2, "merge a scene --out b", &["packed", "N = 50"]);
    // Another experiment, with its own checksum, is not taken for an edit.
    let text = EXPERIMENT.replace("blocks = 5", "blocks = 6");
    let of = |name: &'static str| {
        let sum = copies::field([(name, &*text)].into_iter());
        changed(&at, name, |_| (), |fields| fields[copies::FIELD] = sum.clone());
        std::fs::remove_file(at.path(name).join("experiments/t.toml")).unwrap();
        at.file(&format!("{name}/experiments/{name}.toml"), &text);
    };
    of("t");
    at.ends(2, "merge a t --out b", &["t", "t.toml"]);
    of("u");
    at.ends(2, "merge a u --out b", &["u has u"]);
    assert!(!at.path("b").exists());
}
