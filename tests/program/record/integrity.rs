//! A record that contradicts itself is refused by every verb that reads one: exit code 1, every row
//! named, and nothing is made of it.

use std::sync::OnceLock;

use contactbench::record::seal;
use serde_json::Value;

use crate::common::{Ended, Place, Template};

const EXPERIMENT: &str = "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\nblocks = \
                          1\narithmetics = [\"f32\", \"exact\"]\ndetectors = [\"nbs\", \
                          \"sorting\", \"sweep\"]\n[[scene]]\nname = \"packed\"\nn = [50, 80]\n";

const RECORD: &str = "a/samples.jsonl";
const COPY: &str = "a/experiments/t.toml";

/// A result folder `a`, merged into `whole`, and the text of its record; all tests share one run.
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

/// The record is refused with these words, and nothing is printed of it.
fn refused(at: &Place, words: &[&str]) -> Ended {
    let ended = at.ends(1, "report a", words);
    assert_eq!(ended.stdout, "");
    ended
}

/// The record with line `number`, from 1, as a liar would write it: changed, and sealed again.
fn forged(text: &str, number: usize, change: impl FnOnce(&mut Value)) -> String {
    let mut lines: Vec<String> = text.lines().map(String::from).collect();
    let mut row: Value = serde_json::from_str(&seal::unsealed(&lines[number - 1])).unwrap();
    change(&mut row);
    lines[number - 1] = seal::sealed(&row.to_string());
    lines.join("\n") + "\n"
}

/// The number of the first line with these words.
fn line(text: &str, words: &[&str]) -> usize {
    text.lines().position(|line| words.iter().all(|words| line.contains(words))).unwrap() + 1
}

/// Every verb that reads a record refuses it, and leaves no trace.
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
        at.ends(1, verb, &["a/samples.jsonl:2: dim is 7; it must be 2 or 3"]);
    }
    assert!(before == at.read("a/report.md") && !at.path("b").exists());
}

#[test]
fn an_edited_line_is_named() {
    let (at, text) = measured();
    let time = line(&text, &["\"pass\":\"time\""]);
    let whole = text.lines().nth(time - 1).unwrap();
    let ns = whole.split(',').find(|field| field.starts_with("\"time_ns\":")).unwrap();
    let another = "its check is that of another text";
    let first = text.lines().next().unwrap();
    let older = |line: &str| line.replacen("\"schema\":4", "\"schema\":3", 1);
    for (number, line, edited, words) in [
        (time, whole, whole.replacen(ns, "\"time_ns\":1", 1), another),
        (time, whole, whole.replacen("\"detector\":\"", "\"detector\":\"x", 1), another),
        (time, whole, whole.replacen("0x", "0x1", 1), another),
        // Without its check, as a line of an older schema, and as no row at all.
        (time, whole, seal::unsealed(whole), "it has no check at its end"),
        (1, first, older(first), another),
        (time, whole, older(&seal::unsealed(whole)), "its schema is 3, after lines of schema 4"),
        (time, whole, whole[7..].into(), "it is not a row"),
    ] {
        assert_ne!(edited, line);
        at.file(RECORD, text.replacen(line, &edited, 1));
        refused(&at, &["1 fault: ", &format!("{RECORD}:{number}: {words}")]);
    }
    // The lines named taken out, a run measures them again.
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
        (time, |row| row["digest"] = super::OTHER.into(), "its digest is 0x0"),
        (time, |row| row["digest"] = "0x01".into(), "its digest is '0x01'"),
        (
            time,
            |row| {
                row["contacts"] = 7.into();
                row["stats"]["coordination"] = (2.0 * 7.0 / 50.0).into();
            },
            "its number of contacts is 7, and that of",
        ),
        (time, |row| row["contacts"] = 7.into(), "its contacts are 7, and by its coordination"),
        (count, |row| row["stats"]["scene_hash"] = super::OTHER.into(), "its scene_hash is"),
        (count, |row| row["causes"]["search"]["missed"] = 3.into(), "it is ok, and its search"),
        (count, |row| row["errors"]["spurious"] = 3.into(), "it is ok, and has 3 wrong pairs"),
        (time, |row| row["time_ns"] = 1.into(), "its time_ns 1 is not its elapsed_ns"),
        (time, |row| row["calls"] = 0.into(), "nothing was measured"),
        (time, |row| row["elapsed_ns"] = Value::Null, "without calls and elapsed_ns"),
        (time, |row| row["block"] = 0.into(), "blocks are numbered from 1"),
        (count, |row| row["block"] = 3.into(), "block is 3 in the pass count"),
        (count, |row| row["time_ns"] = 5.into(), "it has a time, and block 0"),
        (count, |row| row["peak_bytes"] = 5.into(), "it has peak_bytes in the pass count"),
        (time, |row| row["resources"]["threads"] = 0.into(), "threads is 0"),
        (time, |row| row["pass"] = "guess".into(), "it is not a row: "),
        (time, |row| row["experiment"] = "../t".into(), "the experiment '../t' is no name"),
    ];
    for (number, change, words) in cases {
        at.file(RECORD, forged(&text, number, change));
        refused(&at, &[&format!("{RECORD}:{number}: "), words]);
    }
    // Several are all named, and the better half is not.
    let two = forged(&text, time, |row| row["digest"] = super::OTHER.into());
    at.file(RECORD, forged(&two, count, |row| row["dim"] = 1.into()));
    let ended = refused(&at, &["2 faults: "]);
    assert_eq!(ended.stderr.matches("a/samples.jsonl:").count(), 2, "{}", ended.stderr);
    // A processor takes one sample at a time: the same beginning with another time is an edit.
    let slower = forged(&text, time, |row| {
        let ns = row["time_ns"].as_u64().unwrap() * 10;
        (row["time_ns"], row["elapsed_ns"], row["calls"]) = (ns.into(), ns.into(), 1.into());
    });
    at.file(RECORD, &slower);
    at.ends(2, "merge whole a --out b", &["is there twice, with "]);
    assert!(!at.path("b").exists());
    at.file(RECORD, format!("{text}{}\n", slower.lines().nth(time - 1).unwrap()));
    refused(&at, &["it is of the sample that began at"]);
}

#[test]
fn what_stands_beside_the_record_is_whole() {
    let (at, _) = measured();
    // A provenance that is cut off, or none of a run.
    let fields = at.read("a/provenance.json");
    for (damaged, words) in [
        (fields[..fields.len() / 2].to_string(), "it is not whole"),
        ("[]".into(), "it is not an object"),
        (fields.replace("\"quick\": false", "\"quick\": \"no\""), "its quick is \"no\""),
        (fields.replace("\"profile\": \"", "\"profile\": \"x"), "its check is that of another"),
    ] {
        assert_ne!(damaged, fields);
        at.file("a/provenance.json", damaged);
        refused(&at, &["a/provenance.json: ", words]);
    }
    at.file("a/provenance.json", &fields);
    let entries = at.read("a/provenance.jsonl");
    let less: String = entries.split_inclusive('\n').skip(1).collect();
    for (damaged, words) in [
        (entries.replacen("\"entry\"", "\"entries\"", 1), "a/provenance.jsonl:1: it is no entry"),
        (entries.replacen("\"sha256\":\"", "\"sha256\":\"0", 1), "a/provenance.jsonl:1: its check"),
        // Rows point to processes that are there.
        (less, "which is not in provenance.jsonl"),
    ] {
        at.file("a/provenance.jsonl", damaged);
        refused(&at, &[words]);
    }
    // What a kill left torn, within a character, is not there, and the run goes on.
    let torn = [entries.as_bytes(), b"{\"entry\":\"span\",\"scene\":\"\xc3"].concat();
    at.file("a/provenance.jsonl", torn);
    at.good("run t.toml --resume --out a");
    at.good("report a");
}

/// Links out of the folder, for reading and for writing.
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
            at.ends(1, verb, &[&format!("a/{name}: it is a link that leads out of the folder")]);
        }
        std::fs::remove_file(&place).unwrap();
        std::fs::rename(at.path("kept"), &place).unwrap();
    }
}

/// A claim loosened after the run, or a plan cut together with its rows, is damage like any other.
#[test]
fn copies_of_experiments_are_under_the_seal() {
    let (at, text) = measured();
    let before = at.read(COPY);
    let edited = "a/experiments/t.toml: its SHA-256 is ";
    at.file(COPY, format!("{before}# loosened\n"));
    refused(&at, &["1 fault: ", edited, "it was edited"]);
    // The plan cut, and the rows with it: no line is torn or changed.
    at.file(COPY, before.replace("n = [50, 80]", "n = [50]"));
    let rows: String = text.split_inclusive('\n').filter(|it| !it.contains("\"n\":80,")).collect();
    assert_ne!(rows, text);
    at.file(RECORD, rows);
    refused(&at, &[edited]);
    at.file(RECORD, &text);
    at.remove(COPY);
    refused(&at, &["a/experiments/t.toml: the copy is missing"]);
    at.file(COPY, &before);
    at.file("a/experiments/u.toml", &before);
    refused(&at, &["a/experiments/u.toml: the run had no experiment of this name"]);
    at.remove("a/experiments/u.toml");
    // A merged record is sealed as its parts are.
    at.file("whole/experiments/t.toml", format!("{before}# loosened\n"));
    at.ends(1, "report whole", &[]);
    at.good("run t.toml --resume --out a");
}

#[test]
fn a_record_made_before_copies_were_sealed_is_sealed_once() {
    let (at, _) = measured();
    let mut fields: Value = serde_json::from_str(&at.read("a/provenance.json")).unwrap();
    let fields = fields.as_object_mut().unwrap();
    assert!(fields.remove("experiments_sha256").is_some());
    fields.remove("check");
    let text = seal::sealed(&serde_json::to_string_pretty(fields).unwrap());
    at.file("a/provenance.json", text + "\n");
    let words = "no checksums of its copies of experiments";
    at.ends(0, "report a", &[words]);
    at.ends(0, "compare whole a", &[words]);
    let sealed = at.good("report a --seal");
    assert!(!sealed.stdout.contains(words), "{}", sealed.stdout);
    at.ends(2, "report a --seal", &[]);
    at.file(COPY, EXPERIMENT.replace("[50, 80]", "[50]"));
    at.ends(1, "report a", &[]);
    at.ends(1, "report a --seal", &[]);
}
