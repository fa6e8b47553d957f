//! Tests docs/PROTOCOL.md: its transcript is replayed line by line and has every request and reply,
//! and its digests are right.

use std::io::{BufRead, BufReader, Write};
use std::process::Stdio;

use contactbench_ground::pairs::sink::{Digest, Sink};
use serde_json::Value;

use crate::common::{Place, npy, pairs, program};

const PAGE: &str = include_str!("../../../docs/PROTOCOL.md");
const TRANSCRIPT: &str = include_str!("../../../examples/transcript.txt");

/// Returns the fenced block of the page or the transcript whose opening line ends with `info`.
fn block(info: &str) -> Vec<&'static str> {
    let mut lines = PAGE
        .lines()
        .chain(TRANSCRIPT.lines())
        .skip_while(|line| *line != format!("```text {info}"));
    assert!(lines.next().is_some(), "the page has no block '{info}'");
    lines.take_while(|line| *line != "```").collect()
}

/// Removes the fields of a message that differ between machines and releases.
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
    if let Some(steps) = message.get_mut("step_ns") {
        assert!(steps[0].is_u64() && steps.as_array().unwrap().len() == 1, "step_ns in {line}");
        *steps = Value::Null;
    }
    message
}

#[test]
fn the_transcript_is_what_the_program_says() {
    let at = Place::new();
    for name in ["scene.npy", "far.npy", "moved.npy"] {
        let numbers = |line: &&str| line.split(',').map(|x| x.parse().unwrap()).collect();
        at.file(name, npy(&block(name).iter().map(numbers).collect::<Vec<Vec<f64>>>()));
    }
    let mut runner = program(at.root(), &["runner", "--detector", "nbs"]);
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
        let mut pairs = pairs(&at.path(name));
        contactbench_ground::pairs::normalise::normalise(&mut pairs);
        assert_eq!(pairs, [[0, 1], [1, 2]], "{name}");
    }
}

/// Measured memory stays within bounds, although rayon frees a job's memory after the job's end.
#[test]
fn memory_of_two_threads_is_never_less_than_nothing() {
    let at = Place::new();
    at.file("row.npy", npy(&(0..100).map(|k| vec![f64::from(k), 0.0]).collect::<Vec<_>>()));
    let line = ["runner", "--detector", "direct", "--threads", "2"];
    let mut runner = program(at.root(), &line);
    let mut runner = runner.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let mut input = runner.stdin.take().unwrap();
    let load = r#"{"request":"load","frames":["row.npy"],"dim":2,"n":100,"radius":0.5}"#;
    let asked = std::thread::spawn(move || {
        writeln!(input, "{load}").unwrap();
        (0..1_500).for_each(|_| writeln!(input, r#"{{"request":"memory"}}"#).unwrap());
    });
    let said: Vec<String> =
        BufReader::new(runner.stdout.take().unwrap()).lines().map(Result::unwrap).skip(2).collect();
    asked.join().unwrap();
    assert!(runner.wait().unwrap().success());
    assert_eq!(said.len(), 1_500);
    for line in said {
        let memory: Value = serde_json::from_str(&line).unwrap();
        let [peak, live] = ["peak_bytes", "live_bytes"].map(|key| memory[key].as_u64().unwrap());
        assert!(live <= peak && peak < 32 << 10, "{line}");
    }
}

fn numbers(text: &str) -> Vec<i32> {
    let pieces = text.split(|c: char| !c.is_ascii_digit() && c != '-');
    pieces.filter(|piece| !piece.is_empty()).map(|piece| piece.parse().unwrap()).collect()
}

#[test]
fn the_digests_of_the_page_are_those_of_the_program() {
    for (name, width) in [("digests", 2), ("digests in a box", 5)] {
        let lines = block(name);
        assert!(lines.len() >= 5);
        for line in lines {
            let (contacts, digest) = line.split_once(' ').unwrap();
            let mut found = Digest::default();
            for it in numbers(contacts).chunks_exact(width) {
                match it[2..] {
                    [x, y, z] => found.image(it[0] as u32, it[1] as u32, [x, y, z]),
                    _ => found.contact(it[0] as u32, it[1] as u32),
                }
            }
            assert_eq!(found.hex(), digest, "{line}");
        }
    }
}
