//! Every verb refuses a record that contradicts itself: it exits with code 1 and prints
//! the first fault.

use std::sync::OnceLock;

use contactbench::record::folder::copies;
use serde_json::Value;

use crate::common::{Ended, Place, Template};

const EXPERIMENT: &str = include_str!("../experiments/three_detectors.toml");

pub(super) const RECORD: &str = "a/samples.jsonl";
const COPY: &str = "a/experiments/t.toml";

/// Returns a folder with a record `a`, also merged into `whole`, and the text of the record.
pub(super) fn measured() -> (Place, String) {
    static RUN: OnceLock<Template> = OnceLock::new();
    let template = RUN.get_or_init(|| {
        Template::new(|at| {
            at.file("t.toml", EXPERIMENT);
            at.good("run t.toml --out a");
            at.good("merge a --out whole");
        })
    });
    let at = template.place();
    let text = at.read(RECORD);
    (at, text)
}

/// Fails unless `report` exits with code 1 and prints these words on standard error only.
pub(super) fn refused(at: &Place, words: &[&str]) -> Ended {
    let ended = at.ends(1, "report a", words);
    assert_eq!(ended.stdout, "");
    ended
}

/// Returns the record with line `number` (from 1) changed, and its checksum made again.
pub(super) fn forged(text: &str, number: usize, change: impl FnOnce(&mut Value)) -> String {
    let mut lines: Vec<String> = text.lines().map(String::from).collect();
    lines[number - 1] = super::edited(&lines[number - 1], change);
    lines.join("\n") + "\n"
}

/// Returns the number of the first line that contains these words.
pub(super) fn line(text: &str, words: &[&str]) -> usize {
    text.lines().position(|line| words.iter().all(|words| line.contains(words))).unwrap() + 1
}

/// Every verb that reads a record refuses an edited one, and writes nothing.
#[test]
fn every_verb_refuses_a_damaged_record() {
    let (at, text) = measured();
    let before = at.read("a/report.md");
    let other = line(&text, &["\"pass\":\"time\""]);
    at.file(RECORD, forged(&text, other, |row| row["digest"] = super::OTHER.into()));
    for verb in [
        "report a",
        "merge whole a --out b",
        "compare whole a",
        "compare a whole",
        "run t.toml --resume --out a",
    ] {
        at.ends(1, verb, &[&format!("a/samples.jsonl:{other}: its digest is 0x0")]);
    }
    assert!(before == at.read("a/report.md") && !at.path("b").exists());
}

#[test]
fn an_edited_line_is_named() {
    let (at, text) = measured();
    let time = line(&text, &["\"pass\":\"time\""]);
    let whole = text.lines().nth(time - 1).unwrap();
    let ns = whole.split(',').find(|field| field.starts_with("\"time_ns\":")).unwrap();
    let check = "check";
    for (edited, words) in [
        (whole.replacen(ns, "\"time_ns\":1", 1), check),
        (whole.replacen("\"detector\":\"", "\"detector\":\"x", 1), check),
        (whole.replacen("0x", "0x1", 1), check),
        // Here a line loses its checksum, or is cut at its start.
        (whole.rsplit_once(",\"check\"").unwrap().0.to_string() + "}", check),
        (whole[7..].into(), ""),
    ] {
        assert_ne!(edited, whole);
        at.file(RECORD, text.replacen(whole, &edited, 1));
        refused(&at, &[&format!("{RECORD}:{time}: "), words]);
    }
    // If lines are deleted, a resumed run measures their rows again.
    let left = text.split_inclusive('\n').filter(|line| line.trim() != whole);
    at.file(RECORD, left.collect::<String>());
    at.good("run t.toml --resume --out a");
}

/// Deleting samples, as of the fastest blocks, is found, and they can be measured again.
#[test]
fn a_deleted_sample_is_missed() {
    let (at, text) = measured();
    let last = text.lines().rev().find(|line| line.contains("\"pass\":\"time\"")).unwrap();
    let span = serde_json::from_str::<Value>(last).unwrap()["span"].as_str().unwrap().to_string();
    at.file(RECORD, text.replacen(&format!("{last}\n"), "", 1));
    refused(&at, &["a/provenance.jsonl: the span", &span, "rows, and ", "are left", "--resume"]);
    at.ends(1, "merge a whole --out b", &[&span]);
    at.good("run t.toml --resume --out a");
    assert_eq!(at.read(RECORD).lines().count(), text.lines().count());
    assert!(at.read("a/report.md").contains("1 row had been deleted when the run was resumed"));
}

/// A sample that stands twice, as two blocks, is found, also if it is moved by a millisecond.
#[test]
fn no_sample_is_counted_twice() {
    let (at, text) = measured();
    for later in [0, 1] {
        let copies = text.lines().filter(|line| line.contains("\"pass\":\"time\"")).map(|line| {
            super::edited(line, |row| {
                row["block"] = (row["block"].as_u64().unwrap() + 3).into();
                row["began_ms"] = (row["began_ms"].as_u64().unwrap() + later).into();
            }) + "\n"
        });
        at.file(RECORD, text.clone() + &copies.collect::<String>());
        refused(&at, &["its sample overlaps in time"]);
        // Another folder with the copies alone cannot be merged as a second run.
        std::fs::create_dir_all(at.path("b/experiments")).unwrap();
        for name in ["provenance.json", "provenance.jsonl", "experiments/t.toml"] {
            std::fs::copy(at.path("a").join(name), at.path("b").join(name)).unwrap();
        }
        let faster = text.lines().map(|line| {
            super::edited(line, |row| {
                if row["time_ns"].is_u64() {
                    row["began_ms"] = (row["began_ms"].as_u64().unwrap() + later).into();
                    (row["calls"], row["elapsed_ns"]) = (1.into(), row["time_ns"].clone());
                }
            }) + "\n"
        });
        at.file("b/samples.jsonl", faster.collect::<String>());
        at.ends(2, "merge whole b --out c", &["cannot be merged", "overlaps in time"]);
        assert!(!at.path("c").exists());
    }
}

#[test]
fn impossible_numbers_are_refused() {
    let (at, text) = measured();
    let [time, count] =
        ["time", "count"].map(|pass| line(&text, &[&format!("\"pass\":\"{pass}\"")]));
    type Change = fn(&mut Value);
    let cases: [(usize, Change, &str); 12] = [
        (count, |row| row["counts"]["contact_test"] = 1.into(), "contact_test 1, and found"),
        (count, |row| row["counts"]["exact_test"] = (1u64 << 40).into(), "exact_test"),
        (count, |row| row["counts"]["contact_test"] = u64::MAX.into(), "are possible"),
        (time, |row| row["block"] = u32::MAX.into(), "block 4294967295"),
        (time, |row| row["pulse_ns"] = 1.into(), "pulse_ns 1"),
        (time, |row| row["first_ns"] = 1.into(), "first_ns 1"),
        (time, |row| row["calls"] = Value::Null, "it has time_ns, but not calls"),
        (time, |row| row["outcome"] = "timeout".into(), "its outcome is timeout"),
        (count, |row| row["causes"]["search"]["missed"] = 5.into(), "its search is wrong"),
        (time, |row| row["calls"] = 1.into(), "elapsed_ns / calls, rounded"),
        (time, |row| row["first_ns"] = 1_000_000_000_000u64.into(), "are these nanoseconds?"),
        (
            time,
            |row| {
                let long = 1u64 << 62;
                (row["time_ns"], row["calls"], row["elapsed_ns"]) =
                    (long.into(), 1.into(), long.into());
            },
            "time_ns 4611686018427387904",
        ),
    ];
    for (number, change, words) in cases {
        at.file(RECORD, forged(&text, number, change));
        refused(&at, &[&format!("{RECORD}:{number}: "), words]);
    }
}

/// Dates and revisions may not contradict the clock or the rows.
#[test]
fn provenance_fits_the_rows() {
    let (at, text) = measured();
    let fields = at.read("a/provenance.json");
    for (name, value, words) in [
        ("date_utc", "2099-01-01T00-00-00", "its date_utc is 2099"),
        ("date_utc", "1970-01-01T00-00-00", "its date_utc is 1970"),
        ("date_utc", "<script>", "its date_utc is <script>"),
        ("revision", "ffffffffffffffffffffffffffffffffffffffff", "its revision is ffff"),
    ] {
        at.file("a/provenance.json", super::edited(&fields, |it| it[name] = value.into()));
        refused(&at, &["a/provenance.json: ", words]);
    }
    at.file("a/provenance.json", &fields);
    for (ms, words) in [
        (1_000_000_000_000u64, "later than the start of its first sample, 2001"),
        (5_000_000_000_000, "future"),
    ] {
        let rows = text.lines().map(|line| {
            super::edited(line, |row| {
                if let Some(began) = row["began_ms"].as_u64() {
                    row["began_ms"] = (ms + began % 1_000_000_000).into();
                }
            }) + "\n"
        });
        at.file(RECORD, rows.collect::<String>());
        refused(&at, &["a/provenance.json: ", words]);
    }
}

/// A pipe under the name of a file is refused, because reading it would never end.
#[cfg(unix)]
#[test]
fn only_files_are_read() {
    let (at, _) = measured();
    for name in ["samples.jsonl", "provenance.json", "provenance.jsonl", "experiments/t.toml"] {
        let place = at.path("a").join(name);
        std::fs::rename(&place, at.path("kept")).unwrap();
        assert!(std::process::Command::new("mkfifo").arg(&place).status().unwrap().success());
        refused(&at, &[&format!("a/{name}: it is not a file")]);
        std::fs::remove_file(&place).unwrap();
        std::fs::rename(at.path("kept"), &place).unwrap();
    }
}

#[test]
fn rows_are_held_to_each_other() {
    let (at, text) = measured();
    let time = line(&text, &["\"pass\":\"time\"", "\"arithmetic\":\"exact\"", "\"n\":50,"]);
    type Change = fn(&mut Value);
    let cases: [(Change, &str); 3] = [
        (|row| row["digest"] = super::OTHER.into(), "digest is 0x0"),
        (|row| row["stats"]["scene_hash"] = super::OTHER.into(), "scene_hash"),
        (|row| row["pass"] = "guess".into(), "guess"),
    ];
    for (change, words) in cases {
        at.file(RECORD, forged(&text, time, change));
        refused(&at, &[&format!("{RECORD}:{time}: "), words]);
    }
}

#[test]
fn what_stands_beside_the_record_is_whole() {
    let (at, _) = measured();
    let fields = at.read("a/provenance.json");
    for damaged in [
        fields[..fields.len() / 2].to_string(),
        "[]".into(),
        fields.replace("\"profile\": \"", "\"profile\": \"x"),
    ] {
        assert_ne!(damaged, fields);
        at.file("a/provenance.json", damaged);
        refused(&at, &["a/provenance.json: "]);
    }
    at.file("a/provenance.json", &fields);
    let entries = at.read("a/provenance.jsonl");
    at.file("a/provenance.jsonl", entries.replacen("\"sha256\":\"", "\"sha256\":\"0", 1));
    refused(&at, &["a/provenance.jsonl:1: "]);
    // A last line torn by a kill, even within a character, is dropped, and the run continues.
    let torn = [entries.as_bytes(), b"{\"entry\":\"span\",\"scene\":\"\xc3"].concat();
    at.file("a/provenance.jsonl", torn);
    at.good("run t.toml --resume --out a");
    at.good("report a");
}

/// Links that lead out of the folder are refused for reading and for writing.
#[cfg(unix)]
#[test]
fn no_path_leaves_the_folder() {
    let (at, _) = measured();
    for (name, to) in [
        ("experiments/t.toml", "t.toml"),
        ("experiments", "whole/experiments"),
        ("samples.jsonl", "whole/samples.jsonl"),
        ("summary.csv", "nowhere.csv"),
    ] {
        let place = at.path("a").join(name);
        std::fs::rename(&place, at.path("kept")).unwrap();
        std::os::unix::fs::symlink(at.path(to), &place).unwrap();
        for verb in ["report a", "merge a --out b", "compare a whole"] {
            at.ends(1, verb, &[&format!("a/{name}: ")]);
        }
        std::fs::remove_file(&place).unwrap();
        std::fs::rename(at.path("kept"), &place).unwrap();
    }
}

/// The record is refused if its copy of the experiment was edited after the run.
#[test]
fn copies_of_experiments_are_under_the_seal() {
    let (at, _) = measured();
    let before = at.read(COPY);
    let edited = "a/experiments/t.toml: ";
    at.file(COPY, format!("{before}# loosened\n"));
    refused(&at, &[edited, "SHA-256"]);
    at.remove(COPY);
    refused(&at, &[edited]);
    at.file(COPY, &before);
    at.file("a/experiments/u.toml", &before);
    refused(&at, &["a/experiments/u.toml: "]);
    at.remove("a/experiments/u.toml");
    // Without sums, no copy can be checked.
    let sealed = at.read("a/provenance.json");
    let unsealed = super::edited(&sealed, |fields| fields[copies::FIELD] = Value::Null);
    at.file("a/provenance.json", unsealed);
    refused(&at, &[edited, "SHA-256"]);
}
