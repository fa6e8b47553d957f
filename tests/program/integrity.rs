//! A record that contradicts itself is refused by every verb that reads one: exit code 1, every row
//! named, and nothing is made of it.

use std::path::Path;
use std::sync::OnceLock;

use contactbench::record::seal;
use serde_json::Value;

use crate::common::{Ended, Template, file, good, run};

const EXPERIMENT: &str = "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\nblocks = \
                          1\narithmetics = [\"f32\", \"exact\"]\ndetectors = [\"nbs\", \
                          \"sorting\", \"sweep\"]\n[[scene]]\nname = \"packed\"\nn = [50, 80]\n";

/// A result folder `a`, merged into `whole`, and the text of its record; all tests share one run.
fn measured() -> (tempfile::TempDir, String) {
    static RUN: OnceLock<Template> = OnceLock::new();
    let template = RUN.get_or_init(|| {
        Template::new(|folder| {
            file(folder, "t.toml", EXPERIMENT);
            good(folder, &["run", "t.toml", "--out", "a"]);
            good(folder, &["merge", "a", "--out", "whole"]);
        })
    });
    let folder = template.copy();
    let text = std::fs::read_to_string(folder.path().join("a/samples.jsonl")).unwrap();
    (folder, text)
}

/// The record is refused with these words, by all verbs alike.
fn refused(folder: &Path, words: &[&str]) -> Ended {
    refused_by(folder, &["report", "a"], words)
}

fn refused_by(folder: &Path, verb: &[&str], words: &[&str]) -> Ended {
    let ended = run(folder, verb);
    assert_eq!(ended.code, Some(1), "{verb:?}: {}{}", ended.stdout, ended.stderr);
    assert_eq!(ended.stdout, "", "{verb:?}");
    for words in words {
        assert!(ended.stderr.contains(words), "{verb:?}: no '{words}' in {}", ended.stderr);
    }
    ended
}

/// Every verb that reads a record refuses it, and leaves no trace.
#[test]
fn every_verb_refuses_a_damaged_record() {
    let (folder, text) = measured();
    let folder = folder.path();
    let report = || std::fs::read(folder.join("a/report.md")).unwrap();
    let before = report();
    let damaged = forged(&text, 2, |row| row["dim"] = 7.into());
    std::fs::write(folder.join("a/samples.jsonl"), damaged).unwrap();
    let verbs: [&[&str]; 5] = [
        &["report", "a"],
        &["merge", "whole", "a", "--out", "b"],
        &["compare", "whole", "a"],
        &["compare", "a", "whole"],
        &["run", "t.toml", "--resume", "--out", "a"],
    ];
    for verb in verbs {
        refused_by(folder, verb, &["a/samples.jsonl:2: dim is 7; it must be 2 or 3"]);
    }
    assert!(before == report() && !folder.join("b").exists());
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

#[test]
fn an_edited_line_is_named() {
    let (folder, text) = measured();
    let folder = folder.path();
    let path = folder.join("a/samples.jsonl");
    let time = line(&text, &["\"pass\":\"time\""]);
    let whole = text.lines().nth(time - 1).unwrap();
    let ns = whole.split_once("\"time_ns\":").unwrap().1.split(',').next().unwrap();
    let named = format!("a/samples.jsonl:{time}: its check is that of another text: it was edited");
    for edited in [
        whole.replacen(&format!("\"time_ns\":{ns}"), &format!("\"time_ns\":1{ns}"), 1),
        whole.replacen("\"detector\":\"", "\"detector\":\"x", 1),
        whole.replacen("0x", "0x1", 1),
    ] {
        assert_ne!(edited, whole);
        std::fs::write(&path, text.replacen(whole, &edited, 1)).unwrap();
        refused(folder, &["1 fault: ", &named, "--resume"]);
    }
    // Without its check, as a line of an older schema, and as no row at all.
    std::fs::write(&path, text.replacen(whole, &seal::unsealed(whole), 1)).unwrap();
    refused(folder, &[&format!("samples.jsonl:{time}: it has no check at its end")]);
    // The first line has none before it that is newer.
    let first = text.lines().next().unwrap();
    let older = first.replacen("\"schema\":4", "\"schema\":3", 1);
    std::fs::write(&path, text.replacen(first, &older, 1)).unwrap();
    refused(folder, &["samples.jsonl:1: its check is that of another text"]);
    let older = seal::unsealed(whole).replacen("\"schema\":4", "\"schema\":3", 1);
    std::fs::write(&path, text.replacen(whole, &older, 1)).unwrap();
    refused(folder, &[&format!("samples.jsonl:{time}: its schema is 3, after lines of schema 4")]);
    std::fs::write(&path, text.replacen(whole, &whole[7..], 1)).unwrap();
    refused(folder, &[&format!("samples.jsonl:{time}: it is not a row")]);
    // What is whole is taken; the lines named taken out, a run measures them again.
    let left: String = text.split_inclusive('\n').filter(|line| line.trim() != whole).collect();
    std::fs::write(&path, left).unwrap();
    let ended = run(folder, &["run", "t.toml", "--resume", "--out", "a"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
}

#[test]
fn rows_are_held_to_each_other() {
    let (folder, text) = measured();
    let folder = folder.path();
    let path = folder.join("a/samples.jsonl");
    let time = line(&text, &["\"pass\":\"time\"", "\"arithmetic\":\"exact\"", "\"n\":50,"]);
    let count = line(&text, &["\"pass\":\"count\"", "\"arithmetic\":\"exact\"", "\"n\":50,"]);
    let other = "0x0000000000000001";
    type Change = fn(&mut Value);
    let cases: [(usize, Change, &str); 17] = [
        (time, |row| row["digest"] = "0x0000000000000001".into(), "its digest is 0x0"),
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
        (
            count,
            |row| row["stats"]["scene_hash"] = "0x0000000000000001".into(),
            "its scene_hash is 0x0000000000000001, and that of",
        ),
        (count, |row| row["causes"]["search"]["missed"] = 3.into(), "it is ok, and its search has"),
        (count, |row| row["errors"]["spurious"] = 3.into(), "it is ok, and has 3 wrong pairs"),
        (time, |row| row["time_ns"] = 1.into(), "its time_ns 1 is not its elapsed_ns"),
        (time, |row| row["calls"] = 0.into(), "nothing was measured"),
        (time, |row| row["elapsed_ns"] = Value::Null, "without calls and elapsed_ns"),
        (time, |row| row["block"] = 0.into(), "blocks are numbered from 1"),
        (count, |row| row["block"] = 3.into(), "block is 3 in the pass count"),
        (count, |row| row["time_ns"] = 5.into(), "it has a time, and block 0"),
        (count, |row| row["peak_bytes"] = 5.into(), "it has peak_bytes in the pass count"),
        (time, |row| row["dim"] = 7.into(), "dim is 7; it must be 2 or 3"),
        (time, |row| row["resources"]["threads"] = 0.into(), "threads is 0; it must be 1 to 1024"),
        (time, |row| row["pass"] = "guess".into(), "it is not a row: "),
    ];
    for (number, change, words) in cases {
        std::fs::write(&path, forged(&text, number, change)).unwrap();
        refused(folder, &[&format!("a/samples.jsonl:{number}: "), words]);
    }
    // Several are all named, and the better half is not.
    let two = forged(&text, time, |row| row["digest"] = other.into());
    std::fs::write(&path, forged(&two, count, |row| row["dim"] = 1.into())).unwrap();
    let ended = refused(folder, &["2 faults: "]);
    assert_eq!(ended.stderr.matches("a/samples.jsonl:").count(), 2, "{}", ended.stderr);
}

#[test]
fn no_path_leaves_the_folder_and_what_stands_beside_the_record_is_whole() {
    let (folder, text) = measured();
    let folder = folder.path();
    let path = folder.join("a/samples.jsonl");
    for name in ["../t", "/etc/hosts", ".hidden", ""] {
        std::fs::write(&path, forged(&text, 2, |row| row["experiment"] = name.into())).unwrap();
        refused(folder, &["a/samples.jsonl:2: the experiment '", "is no name"]);
    }
    std::fs::write(&path, &text).unwrap();
    // A provenance that is cut off, or none of a run.
    let provenance = folder.join("a/provenance.json");
    let fields = std::fs::read_to_string(&provenance).unwrap();
    for (damaged, words) in [
        (fields[..fields.len() / 2].to_string(), "it is not whole"),
        ("[]".into(), "it is not an object"),
        (fields.replace("\"quick\": false", "\"quick\": \"no\""), "its quick is \"no\""),
        (fields.replace("\"profile\": \"", "\"profile\": \"x"), "its check is that of another"),
    ] {
        assert_ne!(damaged, fields);
        std::fs::write(&provenance, damaged).unwrap();
        refused(folder, &["a/provenance.json: ", words]);
    }
    std::fs::write(&provenance, &fields).unwrap();
    let ledger = folder.join("a/provenance.jsonl");
    let entries = std::fs::read_to_string(&ledger).unwrap();
    std::fs::write(&ledger, entries.replacen("\"entry\"", "\"entries\"", 1)).unwrap();
    refused(folder, &["a/provenance.jsonl:1: it is no entry"]);
    std::fs::write(&ledger, entries.replacen("\"sha256\":\"", "\"sha256\":\"0", 1)).unwrap();
    refused(folder, &["a/provenance.jsonl:1: its check is that of another text"]);
    // Rows point to processes that are there.
    std::fs::write(&ledger, entries.split_inclusive('\n').skip(1).collect::<String>()).unwrap();
    refused(folder, &["a/samples.jsonl:", "which is not in provenance.jsonl"]);
    // What a kill left torn, within a character, is not there, and the run goes on.
    let torn = [entries.as_bytes(), b"{\"entry\":\"span\",\"scene\":\"\xc3"].concat();
    std::fs::write(&ledger, torn).unwrap();
    for verb in [&["run", "t.toml", "--resume", "--out", "a"][..], &["report", "a"]] {
        let ended = run(folder, verb);
        assert_eq!(ended.code, Some(0), "{verb:?}: {}", ended.stderr);
    }
    std::fs::write(&ledger, &entries).unwrap();
    // Links out, for reading and for writing.
    #[cfg(unix)]
    {
        let link = |name: &str, to: &Path| {
            let place = folder.join("a").join(name);
            let kept = folder.join("kept");
            std::fs::rename(&place, &kept).unwrap();
            std::os::unix::fs::symlink(to, &place).unwrap();
            refused_link(folder, name);
            std::fs::remove_file(&place).unwrap();
            std::fs::rename(&kept, &place).unwrap();
        };
        link("experiments/t.toml", &folder.join("t.toml"));
        link("experiments", &folder.join("whole/experiments"));
        link("samples.jsonl", &folder.join("whole/samples.jsonl"));
        link("summary.csv", &folder.join("nowhere.csv"));
    }
    // A copy of another experiment.
    let copy = folder.join("a/experiments/t.toml");
    std::fs::write(&copy, EXPERIMENT.replace("\"t\"", "\"u\"")).unwrap();
    let ended = run(folder, &["report", "a"]);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    assert!(ended.stderr.contains("a/experiments/t.toml: its SHA-256 is "));
}

#[cfg(unix)]
fn refused_link(folder: &Path, name: &str) {
    for verb in [&["report", "a"][..], &["merge", "a", "--out", "b"], &["compare", "a", "whole"]] {
        let ended = run(folder, verb);
        assert_eq!(ended.code, Some(1), "{name}: {}", ended.stderr);
        let words = format!("a/{name}: it is a link that leads out of the folder");
        assert!(ended.stderr.contains(&words), "{}", ended.stderr);
    }
}

/// A claim loosened after the run, or a plan cut together with its rows, is damage like any other.
#[test]
fn copies_of_experiments_are_under_the_seal() {
    let (folder, text) = measured();
    let folder = folder.path();
    let copy = folder.join("a/experiments/t.toml");
    let before = std::fs::read_to_string(&copy).unwrap();
    let edited = "a/experiments/t.toml: its SHA-256 is ";
    std::fs::write(&copy, format!("{before}# loosened\n")).unwrap();
    refused(folder, &["1 fault: ", edited, "it was edited"]);
    // The plan cut, and the rows with it: no line is torn or changed.
    std::fs::write(&copy, before.replace("n = [50, 80]", "n = [50]")).unwrap();
    let rows: String = text.split_inclusive('\n').filter(|it| !it.contains("\"n\":80,")).collect();
    assert_ne!(rows, text);
    std::fs::write(folder.join("a/samples.jsonl"), rows).unwrap();
    refused(folder, &[edited]);
    std::fs::write(folder.join("a/samples.jsonl"), &text).unwrap();
    std::fs::remove_file(&copy).unwrap();
    refused(folder, &["a/experiments/t.toml: the copy is missing"]);
    std::fs::write(&copy, &before).unwrap();
    file(&folder.join("a/experiments"), "u.toml", &before);
    refused(folder, &["a/experiments/u.toml: the run had no experiment of this name"]);
    std::fs::remove_file(folder.join("a/experiments/u.toml")).unwrap();
    // A merged record is sealed as its parts are.
    let merged = folder.join("whole/experiments/t.toml");
    std::fs::write(&merged, format!("{before}# loosened\n")).unwrap();
    assert_eq!(run(folder, &["report", "whole"]).code, Some(1));
    std::fs::write(&merged, &before).unwrap();
    let resumed = run(folder, &["run", "t.toml", "--resume", "--out", "a"]);
    assert_eq!(resumed.code, Some(0), "{}", resumed.stderr);
}

#[test]
fn a_record_made_before_copies_were_sealed_says_so_and_is_sealed_once() {
    let (folder, _) = measured();
    let folder = folder.path();
    let path = folder.join("a/provenance.json");
    let mut fields: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    let fields = fields.as_object_mut().unwrap();
    assert!(fields.remove("experiments_sha256").is_some());
    fields.remove("check");
    let text = seal::sealed(&serde_json::to_string_pretty(fields).unwrap());
    std::fs::write(&path, text + "\n").unwrap();
    let words = "made before copies of experiments were sealed";
    let report = run(folder, &["report", "a"]);
    assert_eq!(report.code, Some(0), "{}", report.stderr);
    assert!(report.stdout.contains(words), "{}", report.stdout);
    let compared = run(folder, &["compare", "whole", "a"]);
    assert!(compared.code == Some(0) && compared.stderr.contains(words), "{}", compared.stderr);
    let sealed = run(folder, &["report", "a", "--seal"]);
    assert!(sealed.code == Some(0) && !sealed.stdout.contains(words), "{}", sealed.stdout);
    assert_eq!(run(folder, &["report", "a", "--seal"]).code, Some(2));
    file(&folder.join("a/experiments"), "t.toml", EXPERIMENT.replace("[50, 80]", "[50]"));
    assert_eq!(run(folder, &["report", "a"]).code, Some(1));
    assert_eq!(run(folder, &["report", "a", "--seal"]).code, Some(1));
}

/// A processor takes one sample at a time: the same beginning with another time is an edit.
#[test]
fn a_sample_has_one_time() {
    let (folder, text) = measured();
    let folder = folder.path();
    let time = line(&text, &["\"pass\":\"time\""]);
    let slower = forged(&text, time, |row| {
        let ns = row["time_ns"].as_u64().unwrap() * 10;
        (row["time_ns"], row["elapsed_ns"], row["calls"]) = (ns.into(), ns.into(), 1.into());
    });
    let ns = |text: &str| -> u64 {
        let row = seal::unsealed(text.lines().nth(time - 1).unwrap());
        serde_json::from_str::<Value>(&row).unwrap()["time_ns"].as_u64().unwrap()
    };
    file(&folder.join("a"), "samples.jsonl", &slower);
    let ended = run(folder, &["merge", "whole", "a", "--out", "b"]);
    assert_eq!(ended.code, Some(2), "{}", ended.stdout);
    let both = format!("is there twice, with {} and {} ns", ns(&text), ns(&slower));
    assert!(ended.stderr.contains(&both) && !folder.join("b").exists(), "{}", ended.stderr);
    // In one file, too.
    let twice = format!("{text}{}\n", slower.lines().nth(time - 1).unwrap());
    file(&folder.join("a"), "samples.jsonl", twice);
    refused(folder, &["it is of the sample that began at"]);
}
