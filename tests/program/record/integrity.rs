//! Every verb refuses a record that contradicts itself: it exits with code 1 and prints a line for
//! each fault.

use std::sync::OnceLock;

use contactbench::record::folder::copies;
use serde_json::Value;

use crate::common::{Ended, Place, Template};

const EXPERIMENT: &str = include_str!("../experiments/three_detectors.toml");

const RECORD: &str = "a/samples.jsonl";
const COPY: &str = "a/experiments/t.toml";

/// Returns a folder with a record `a`, also merged into `whole`, and the text of the record.
fn measured() -> (Place, String) {
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
fn refused(at: &Place, words: &[&str]) -> Ended {
    let ended = at.ends(1, "report a", words);
    assert_eq!(ended.stdout, "");
    ended
}

/// Returns the record with line `number` (from 1) changed, and its checksum made again.
fn forged(text: &str, number: usize, change: impl FnOnce(&mut Value)) -> String {
    let mut lines: Vec<String> = text.lines().map(String::from).collect();
    lines[number - 1] = super::edited(&lines[number - 1], change);
    lines.join("\n") + "\n"
}

/// Returns the number of the first line that contains these words.
fn line(text: &str, words: &[&str]) -> usize {
    text.lines().position(|line| words.iter().all(|words| line.contains(words))).unwrap() + 1
}

/// Every verb that reads a record refuses an edited one, and writes nothing.
#[test]
fn every_verb_refuses_a_damaged_record() {
    let (at, text) = measured();
    let before = at.read("a/report.md");
    at.file(RECORD, forged(&text, 2, |row| row["dim"] = 7.into()));
    for verb in [
        "report a",
        "merge whole a --out b",
        "compare whole a",
        "compare a whole",
        "run t.toml --resume --out a",
    ] {
        at.ends(1, verb, &["a/samples.jsonl:2: dim", "7", "2 or 3"]);
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
        refused(&at, &["1 fault: ", &format!("{RECORD}:{time}: "), words]);
    }
    // If lines are deleted, a resumed run measures their rows again.
    let left = text.split_inclusive('\n').filter(|line| line.trim() != whole);
    at.file(RECORD, left.collect::<String>());
    at.good("run t.toml --resume --out a");
}

#[test]
fn rows_are_held_to_each_other() {
    let (at, text) = measured();
    let time = line(&text, &["\"pass\":\"time\"", "\"arithmetic\":\"exact\"", "\"n\":50,"]);
    let count = line(&text, &["\"pass\":\"count\"", "\"arithmetic\":\"exact\"", "\"n\":50,"]);
    type Change = fn(&mut Value);
    let cases: [(usize, Change, &str); 17] = [
        (time, |row| row["digest"] = super::OTHER.into(), "digest is 0x0"),
        (time, |row| row["digest"] = "0x01".into(), "'0x01'"),
        (
            time,
            |row| {
                row["contacts"] = 7.into();
                row["stats"]["coordination"] = (2.0 * 7.0 / 50.0).into();
            },
            "contacts is 7",
        ),
        (time, |row| row["contacts"] = 7.into(), "coordination"),
        (count, |row| row["stats"]["scene_hash"] = super::OTHER.into(), "scene_hash"),
        (count, |row| row["causes"]["search"]["missed"] = 3.into(), "search"),
        (count, |row| row["errors"]["spurious"] = 3.into(), "3 wrong"),
        (time, |row| row["time_ns"] = 1.into(), "time_ns 1"),
        (time, |row| row["calls"] = 0.into(), "calls"),
        (time, |row| row["elapsed_ns"] = Value::Null, "elapsed_ns"),
        (time, |row| row["block"] = 0.into(), "block"),
        (count, |row| row["block"] = 3.into(), "block is 3"),
        (count, |row| row["time_ns"] = 5.into(), "block 0"),
        (count, |row| row["peak_bytes"] = 5.into(), "peak_bytes"),
        (time, |row| row["resources"]["threads"] = 0.into(), "threads is 0"),
        (time, |row| row["pass"] = "guess".into(), "guess"),
        (time, |row| row["experiment"] = "../t".into(), "'../t'"),
    ];
    for (number, change, words) in cases {
        at.file(RECORD, forged(&text, number, change));
        refused(&at, &[&format!("{RECORD}:{number}: "), words]);
    }
    // The report prints a line for each of two faults.
    let two = forged(&text, time, |row| row["digest"] = super::OTHER.into());
    at.file(RECORD, forged(&two, count, |row| row["dim"] = 1.into()));
    let ended = refused(&at, &["2 faults: "]);
    assert_eq!(ended.stderr.matches("a/samples.jsonl:").count(), 2, "{}", ended.stderr);
    // A processor runs one sample at a time, so two samples with the same start show an edit.
    let slower = forged(&text, time, |row| {
        let ns = row["time_ns"].as_u64().unwrap() * 10;
        (row["time_ns"], row["elapsed_ns"], row["calls"]) = (ns.into(), ns.into(), 1.into());
    });
    at.file(RECORD, &slower);
    at.ends(2, "merge whole a --out b", &["nbs", "N = 50"]);
    assert!(!at.path("b").exists());
    at.file(RECORD, format!("{text}{}\n", slower.lines().nth(time - 1).unwrap()));
    refused(&at, &["1 fault: "]);
}

#[test]
fn what_stands_beside_the_record_is_whole() {
    let (at, _) = measured();
    // Provenance is refused if it is cut off, has invalid fields, or was edited.
    let fields = at.read("a/provenance.json");
    for (damaged, words) in [
        (fields[..fields.len() / 2].to_string(), ""),
        ("[]".into(), "object"),
        (fields.replace("\"quick\": false", "\"quick\": \"no\""), "\"no\""),
        (fields.replace("\"profile\": \"", "\"profile\": \"x"), "check"),
    ] {
        assert_ne!(damaged, fields);
        at.file("a/provenance.json", damaged);
        refused(&at, &["a/provenance.json: ", words]);
    }
    at.file("a/provenance.json", &fields);
    let entries = at.read("a/provenance.jsonl");
    let less: String = entries.split_inclusive('\n').skip(1).collect();
    for (damaged, words) in [
        (entries.replacen("\"entry\"", "\"entries\"", 1), "a/provenance.jsonl:1: "),
        (entries.replacen("\"sha256\":\"", "\"sha256\":\"0", 1), "a/provenance.jsonl:1: "),
        // The record is refused if its rows name a process that is missing here.
        (less, "provenance.jsonl"),
    ] {
        at.file("a/provenance.jsonl", damaged);
        refused(&at, &[words]);
    }
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

/// The record is refused if a claim is loosened after the run, or planned cells are removed.
#[test]
fn copies_of_experiments_are_under_the_seal() {
    let (at, text) = measured();
    let before = at.read(COPY);
    let edited = "a/experiments/t.toml: ";
    at.file(COPY, format!("{before}# loosened\n"));
    refused(&at, &["1 fault: ", edited, "SHA-256"]);
    // A part of the plan is removed with its rows, and all other lines stay valid.
    at.file(COPY, before.replace("n = [50, 80]", "n = [50]"));
    let rows: String = text.split_inclusive('\n').filter(|it| !it.contains("\"n\":80,")).collect();
    assert_ne!(rows, text);
    at.file(RECORD, rows);
    refused(&at, &[edited]);
    at.file(RECORD, &text);
    at.remove(COPY);
    refused(&at, &["1 fault: ", edited]);
    at.file(COPY, &before);
    at.file("a/experiments/u.toml", &before);
    refused(&at, &["a/experiments/u.toml: "]);
    at.remove("a/experiments/u.toml");
    at.file("whole/experiments/t.toml", format!("{before}# loosened\n"));
    at.ends(1, "report whole", &[]);
    // Without sums, no copy can be checked.
    let sealed = at.read("a/provenance.json");
    let unsealed = super::edited(&sealed, |fields| fields[copies::FIELD] = Value::Null);
    at.file("a/provenance.json", unsealed);
    refused(&at, &["1 fault: ", edited, "SHA-256"]);
    at.file("a/provenance.json", sealed);
    at.good("run t.toml --resume --out a");
}
