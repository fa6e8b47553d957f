//! docs/PROTOCOL.md is true: its transcript is replayed against the program line by line, every
//! request and reply of the protocol is in it, and the digests that it lists are those of the
//! program.

use std::collections::BTreeSet;
use std::io::{BufRead, BufReader, Write};
use std::process::Stdio;

use contactbench::sink::Digest;
use serde_json::Value;

const PAGE: &str = include_str!("../../docs/PROTOCOL.md");

/// The fenced block of the page with this information string.
fn block(info: &str) -> Vec<&'static str> {
    let mut lines = PAGE.lines().skip_while(|line| *line != format!("```text {info}"));
    assert!(lines.next().is_some(), "the page has no block '{info}'");
    lines.take_while(|line| *line != "```").collect()
}

/// A message without what differs from machine to machine and from release to release.
fn steady(line: &str) -> Value {
    let mut message: Value = serde_json::from_str(line).unwrap();
    for field in ["time_ns", "calls", "elapsed_ns", "first_ns", "version"] {
        if let Some(value) = message.get_mut(field) {
            assert!(
                value.is_string() || value.as_u64().is_some_and(|whole| whole > 0),
                "{field} in {line}"
            );
            *value = Value::Null;
        }
    }
    if let Some(build) = message.get_mut("build") {
        assert!(build["profile"].is_string() && build["revision"].is_string(), "{line}");
        *build = Value::Null;
    }
    // Of one frame.
    if let Some(steps) = message.get_mut("step_ns") {
        assert!(steps[0].is_u64() && steps.as_array().unwrap().len() == 1, "step_ns in {line}");
        *steps = Value::Null;
    }
    message
}

#[test]
fn the_transcript_is_what_the_program_says() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["scene.npy", "far.npy", "moved.npy"] {
        let rows: Vec<Vec<f64>> = block(name)
            .iter()
            .map(|line| line.split(',').map(|x| x.parse().unwrap()).collect())
            .collect();
        crate::common::file(folder.path(), name, crate::common::npy(&rows));
    }
    let mut runner = crate::common::program(folder.path(), &["runner", "--detector", "nbs"]);
    let mut runner = runner.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let (mut input, mut output) =
        (runner.stdin.take().unwrap(), BufReader::new(runner.stdout.take().unwrap()));
    for line in block("transcript") {
        match line.split_at(2) {
            ("> ", request) => writeln!(input, "{request}").unwrap(),
            ("< ", reply) => {
                let mut said = String::new();
                output.read_line(&mut said).unwrap();
                assert_eq!(steady(&said), steady(reply));
                let sample: Value = serde_json::from_str(&said).unwrap();
                if let [Some(time), Some(calls), Some(elapsed)] =
                    ["time_ns", "calls", "elapsed_ns"].map(|field| sample[field].as_u64())
                {
                    assert!(
                        (time * calls).abs_diff(elapsed) <= calls,
                        "time_ns is elapsed_ns / calls, rounded: {said}"
                    );
                    assert_eq!(sample["step_ns"][0].as_u64(), Some(time), "{said}");
                }
            }
            _ => panic!("a line of the transcript begins with neither '> ' nor '< ': {line}"),
        }
    }
    let mut rest = String::new();
    assert_eq!(output.read_line(&mut rest).unwrap(), 0, "after quit it said {rest}");
    assert!(runner.wait().unwrap().success());
    for name in ["pairs.npy", "first.npy"] {
        let mut pairs = crate::common::pairs(&folder.path().join(name));
        contactbench::sink::normalise(&mut pairs);
        assert_eq!(pairs, [[0, 1], [1, 2]], "{name}");
    }
}

/// Threads of rayon give back what they took for a job a moment after it is done: now and then in
/// the next measurement.
#[test]
fn memory_of_two_threads_is_never_less_than_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let rows: Vec<Vec<f64>> = (0..100).map(|k| vec![f64::from(k), 0.0]).collect();
    crate::common::file(folder.path(), "row.npy", crate::common::npy(&rows));
    let line = ["runner", "--detector", "direct", "--threads", "2"];
    let mut runner = crate::common::program(folder.path(), &line);
    let mut runner = runner.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let mut input = runner.stdin.take().unwrap();
    let load = r#"{"request":"load","frames":["row.npy"],"dim":2,"n":100,"radius":0.5}"#;
    let asked = std::thread::spawn(move || {
        writeln!(input, "{load}").unwrap();
        (0..10_000).for_each(|_| writeln!(input, r#"{{"request":"memory"}}"#).unwrap());
    });
    let said: Vec<String> =
        BufReader::new(runner.stdout.take().unwrap()).lines().map(Result::unwrap).skip(2).collect();
    asked.join().unwrap();
    assert!(runner.wait().unwrap().success());
    assert_eq!(said.len(), 10_000);
    for line in said {
        let memory: Value = serde_json::from_str(&line).unwrap();
        let [peak, live] = ["peak_bytes", "live_bytes"].map(|key| memory[key].as_u64().unwrap());
        assert!(live <= peak && peak < 32 << 10, "{line}");
    }
}

#[test]
fn the_transcript_holds_every_request_and_every_reply_of_the_program() {
    let words = |mark: &str, key: &str| -> BTreeSet<String> {
        let lines = block("transcript");
        let messages = lines.iter().filter_map(|line| line.strip_prefix(mark));
        messages
            .map(|message| {
                serde_json::from_str::<Value>(message).unwrap()[key].as_str().unwrap().to_string()
            })
            .collect()
    };
    assert_eq!(
        words("> ", "request"),
        ["load", "sample", "count", "memory", "pairs", "quit"].map(String::from).into()
    );
    // This program measures everything and needs no library: it never says unsupported or
    // unavailable.
    assert_eq!(
        words("< ", "reply"),
        ["hello", "loaded", "sample", "count", "memory", "pairs", "refused", "error"]
            .map(String::from)
            .into()
    );
}

#[test]
fn the_digests_of_the_page_are_those_of_the_program() {
    let lines = block("digests in a box");
    assert!(lines.len() >= 5);
    for line in lines {
        let (contacts, digest) = line.split_once(' ').unwrap();
        let numbers = contacts.split(|c: char| !c.is_ascii_digit() && c != '-');
        let numbers = numbers.filter(|piece| !piece.is_empty());
        let numbers: Vec<i32> = numbers.map(|piece| piece.parse().unwrap()).collect();
        let mut found = Digest::default();
        for contact in numbers.chunks_exact(5) {
            found.image(contact[0] as u32, contact[1] as u32, [contact[2], contact[3], contact[4]]);
        }
        assert_eq!(found.hex(), digest, "{line}");
    }
    let lines = block("digests");
    assert!(lines.len() >= 5);
    for line in lines {
        let (pairs, digest) = line.split_once(' ').unwrap();
        let numbers: Vec<u32> = pairs
            .split(|c: char| !c.is_ascii_digit())
            .filter(|piece| !piece.is_empty())
            .map(|piece| piece.parse().unwrap())
            .collect();
        let pairs: Vec<[u32; 2]> = numbers.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect();
        assert_eq!(Digest::from_pairs(&pairs).hex(), digest, "{line}");
    }
}
