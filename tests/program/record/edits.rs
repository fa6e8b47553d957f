//! A record is refused if fields, rows or files of it contradict each other, although every
//! checksum is right.
#![cfg(target_os = "linux")]

use contactbench::record::row::Outcome;
use serde_json::{Value, json};

use super::integrity::{RECORD, forged, line, measured, refused};
use crate::common::Place;

const LEDGER: &str = "a/provenance.jsonl";
const FIELDS: &str = "a/provenance.json";

type Change = fn(&mut Value);

/// Edits with a right checksum: the file, words of the line, the change, and words of the fault.
const EDITS: &[(&str, &[&str], Change, &str)] = &[
    (RECORD, TIMED, |row| row["digest"] = Value::Null, "is ok, but it has no digest"),
    (RECORD, COUNTED, |row| row["counts"] = json!({}), "is ok, but it has no counts"),
    (RECORD, TIMED, |row| row["contacts"] = 1.into(), "contacts"),
    (RECORD, TIMED, |row| row["stats"]["coordination"] = 0.1234567.into(), "coordination"),
    (RECORD, TIMED, |row| row["machine"] = "m".repeat(300_000).into(), "bytes"),
    (RECORD, TIMED, |row| row["role"] = "nothing".into(), "is ok, but its role is 'nothing'"),
    (RECORD, TIMED, |row| row["role"] = "peer".into(), "its role is"),
    (RECORD, TIMED, |row| row["stats"]["packing_fraction"] = 0.1.into(), "its stats is"),
    (RECORD, TIMED, |row| row["machine"] = "other".into(), "machine other"),
    (RECORD, TIMED, |row| row["experiment"] = "u".into(), "its experiment and scene are"),
    (RECORD, TIMED, |row| row["process"] = "00000000".into(), "has no process 00000000"),
    (RECORD, TIMED, |row| row["block"] = 9.into(), "order"),
    (LEDGER, SPAN, |it| it["others_s"] = (-0.1).into(), "its others_s is -0.1"),
    (LEDGER, SPAN, |it| it["others_s"] = 1e6.into(), "its others_s is 1000000"),
    (LEDGER, SPAN, |it| it["stolen_s"] = 1e6.into(), "its stolen_s is 1000000"),
    (LEDGER, SPAN, |it| it["stolen_s"] = (-1).into(), "its stolen_s is -1"),
    (LEDGER, SPAN, |it| it["own_s"] = 1e6.into(), "its own_s is 1000000"),
    (LEDGER, SPAN, |it| it["seconds"] = (-5).into(), "its seconds is -5"),
    (LEDGER, SPAN, |it| it["seconds"] = 1e12.into(), "its seconds is 1000000000000"),
    (LEDGER, SPAN, |it| it["cores"] = 0.into(), "its cores is 0"),
    (LEDGER, SPAN, |it| it["cores"] = 10_000_000.into(), "its cores is 10000000"),
    (LEDGER, SPAN, |it| it["scene"] = "t: loose 2D N=50".into(), "those of its span are t: loose"),
    (LEDGER, PROGRAM, |it| it["version"] = "9".into(), "its id is"),
    (FIELDS, &[], |it| it["machine"] = 5.into(), "its machine is 5"),
    (FIELDS, &[], |it| it["revision"] = 7.into(), "its revision is 7"),
    (FIELDS, &[], |it| it["command"] = json!([]), "its command is []"),
    (FIELDS, &[], |it| it["quick"] = "no".into(), "its quick is \"no\""),
    (FIELDS, &[], |it| it["dirty"] = 0.into(), "its dirty is 0"),
    (FIELDS, &[], |it| it["cpu"] = 7.into(), "its cpu is 7"),
    (FIELDS, &[], |it| it["cores"] = "two".into(), "its cores is \"two\""),
    (FIELDS, &[], |it| it["caches"] = json!({"L2": 1}), "its caches is {"),
    (FIELDS, &[], |it| it["load_average"] = 1.into(), "its load_average is 1"),
    (FIELDS, &[], |it| it["command"] = "contactbench run t.toml --quick".into(), "quick is false"),
];
const TIMED: &[&str] = &["\"pass\":\"time\"", "\"arithmetic\":\"exact\"", "\"n\":50,"];
const COUNTED: &[&str] = &["\"pass\":\"count\"", "\"arithmetic\":\"exact\"", "\"n\":50,"];
const SPAN: &[&str] = &["\"entry\":\"span\"", "N=50"];
const PROGRAM: &[&str] = &["\"entry\":\"process\""];

/// Edits that a checksum does not show contradict other fields, rows or files.
#[test]
fn an_edit_with_a_right_checksum_is_found() {
    let (at, _) = measured();
    let mut missed = Vec::new();
    for &(name, words, change, fault) in EDITS {
        let text = at.read(name);
        let edit = match words {
            [] => super::edited(&text, change),
            _ => forged(&text, line(&text, words), change),
        };
        at.file(name, edit);
        let said = at.run("report a").stderr;
        if !said.contains("damaged") || !said.contains(fault) {
            missed.push((fault, said));
        }
        at.file(name, text);
    }
    assert!(missed.is_empty(), "{missed:#?}");
}

/// What stands twice is the same twice.
#[test]
fn a_copy_with_another_value_is_found() {
    let (at, _) = measured();
    let cases: [(&str, &[&str], Change, &str); 3] = [
        (RECORD, COUNTED, |row| row["counts"]["bound_test"] = 7.into(), "its counts is"),
        (LEDGER, SPAN, |it| it["others_s"] = 0.0125.into(), "differs"),
        (LEDGER, PROGRAM, |it| it["version"] = "9".into(), "its id is"),
    ];
    for (name, words, change, fault) in cases {
        let text = at.read(name);
        let copied = super::edited(text.lines().nth(line(&text, words) - 1).unwrap(), change);
        at.file(name, format!("{text}{copied}\n"));
        refused(&at, &[name, fault]);
        at.file(name, text);
    }
}

/// The samples of a span fit into it together, although each is shorter.
#[test]
fn samples_fit_into_their_span() {
    let (at, text) = measured();
    let entries = at.read(LEDGER);
    let span = entries.lines().nth(line(&entries, SPAN) - 1).unwrap();
    let span: Value = serde_json::from_str(span).unwrap();
    let ns = (span["seconds"].as_f64().unwrap() * 4e8) as u64;
    let long = text.lines().map(|line| {
        super::edited(line, |row| {
            if row["time_ns"].is_u64() && row["span"] == span["id"] {
                (row["time_ns"], row["calls"], row["elapsed_ns"]) =
                    (ns.into(), 1.into(), ns.into());
            }
        }) + "\n"
    });
    at.file(RECORD, long.collect::<String>());
    refused(&at, &[RECORD, "are these nanoseconds?"]);
}

/// Not every row of a scene is the same: a search that exceeds its time, a tracker of a twin.
#[test]
fn lawful_records_are_read() {
    let at = Place::new();
    let late = "detectors = ['nbs', 'direct']\narithmetics = ['exact-open']\ntime-limit-s = 0.1\n\
                [[scene]]\nname = 'pack-a'\nn = [14400, 19600]";
    let moving = "detectors = ['verlet(streamed-nbs)', 'verlet(streamed-nbs-twin)']\n\
                  [[scene]]\nname = 'packed'\nn = 40\nmotion = 'drift'\nframes = 3";
    for (name, rest) in [("late", late), ("moving", moving)] {
        let head =
            format!("name = '{name}'\ntitle = 't'\nquestion = '?'\nreading = '-'\nblocks = 1\n");
        at.file(&format!("{name}.toml"), head + rest);
    }
    at.good("run late.toml moving.toml --out a");
    let late = at.rows("a").into_iter().filter(|row| row.outcome != Outcome::Ok);
    assert!(late.count() > 0);
    at.good("report a");
}
