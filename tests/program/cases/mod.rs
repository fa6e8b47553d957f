//! Tests of the command line as text files in this folder, one test each.
//!
//! In `*.txt` a line `[title]` begins a scenario in a folder of its own. Lines above the first
//! title make files for every scenario. Lines below a title:
//!
//! | line | effect or expectation |
//! |---|---|
//! | `file NAME TEXT` | makes a file |
//! | `more NAME COUNT TEXT` | appends the text this many times |
//! | `copy FROM TO OLD => NEW` | copies a file with one text replaced by another everywhere |
//! | `CODE ARGUMENTS :: words \| words` | runs the program, which must exit with CODE and print the words |
//! | `= TEXT` | the whole standard output |
//! | `+ words \| words` | further words that the run prints |
//! | `! words \| words` | words that the run does not print |
//! | `in FILE words \| words` | words that the file contains |
//! | `same ARGUMENTS` | another run with the same standard output |
//!
//! Words are names, numbers, options and keys, not sentences. `ARRAYS/` stands for the folder
//! `tests/data/arrays`. Texts have `\n`, `\t`, `\\` and `\xff` for a byte. Line breaks count as
//! blanks. A run with exit code 2 prints one line that begins with `contactbench: `.

use std::fmt::Display;

use crate::common::{Ended, Place};

const ARRAYS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/arrays/");

macro_rules! cases {
    ($check:ident: $($name:ident),*) => {
        $(#[test]
        fn $name() {
            $check(stringify!($name));
        })*
    };
}
cases!(all: refusals, experiments, boxes, files, records);

fn unescaped(text: &str) -> Vec<u8> {
    let (mut bytes, mut rest) = (Vec::new(), text.bytes());
    while let Some(byte) = rest.next() {
        let escape = if byte == b'\\' { rest.next() } else { None };
        bytes.push(match escape {
            None => byte,
            Some(b'n') => b'\n',
            Some(b't') => b'\t',
            Some(b'\\') => b'\\',
            Some(b'x') => {
                let digits: String = rest.by_ref().take(2).map(char::from).collect();
                u8::from_str_radix(&digits, 16).unwrap()
            }
            Some(other) => panic!("\\{} in {text}", char::from(other)),
        });
    }
    bytes
}

fn flat(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A folder in which the program runs, its last run, and the expectations that failed.
struct Scenario {
    place: Place,
    last: Option<(String, Ended)>,
    faults: Vec<String>,
}

impl Scenario {
    fn fault(&mut self, at: &str, what: impl Display) {
        let (line, shown) = match &self.last {
            Some((line, ended)) => (&**line, format!("{}{}", ended.stdout, ended.stderr)),
            None => ("", String::new()),
        };
        self.faults.push(format!("{at}: {what}\n{line}\n{shown}"));
    }

    /// Records a fault for each word that the text lacks. If `there` is false, records one for each
    /// word that it contains.
    fn words(&mut self, at: &str, words: &str, text: &str, there: bool) {
        let text = flat(text);
        for word in words.split(" | ").map(flat).filter(|word| !word.is_empty()) {
            if text.contains(&word) != there {
                self.fault(at, format!("{} '{word}'", if there { "no" } else { "there is" }));
            }
        }
    }

    fn run(&mut self, at: &str, code: &str, rest: &str) {
        let (line, words) = rest.split_once(" :: ").unwrap_or((rest, ""));
        let ended = self.place.run(&line.replace("ARRAYS/", ARRAYS));
        let refusals = ended.stderr.lines().filter(|line| line.starts_with("contactbench: "));
        let one = refusals.clone().count() == 1
            && refusals.clone().next_back() == ended.stderr.lines().next_back();
        let is_one = one || !ended.stdout.is_empty();
        let expected = ended.code == code.parse().ok() && (code != "2" || is_one);
        let (said, found) = (format!("{} {}", ended.stdout, ended.stderr), ended.code);
        self.last = Some((rest.to_string(), ended));
        if !expected {
            self.fault(at, format!("exit code {found:?}, not {code} with one refusal"));
        }
        self.words(at, words, &said, true);
    }

    /// Executes a line of a scenario; returns false if the line is invalid.
    fn obey(&mut self, at: &str, line: &str) -> bool {
        let (head, rest) = line.split_once(' ').unwrap_or((line, ""));
        let (name, text) = rest.split_once(' ').unwrap_or((rest, ""));
        let (stdout, said) = match &self.last {
            Some((_, it)) => (it.stdout.clone(), format!("{} {}", it.stdout, it.stderr)),
            None => Default::default(),
        };
        match head {
            "file" => drop(self.place.file(name, unescaped(text))),
            "more" => {
                let (count, text) = text.split_once(' ').unwrap();
                let more = unescaped(text).repeat(count.parse().unwrap());
                let before = std::fs::read(self.place.path(name)).unwrap();
                self.place.file(name, [before, more].concat());
            }
            "copy" => {
                let (to, change) = text.split_once(' ').unwrap_or((text, " => "));
                let (old, new) = change.split_once(" => ").unwrap();
                let [old, new] = [old, new].map(|it| String::from_utf8(unescaped(it)).unwrap());
                let before = self.place.read(name);
                assert!(before.contains(&old), "{at}: no '{old}' in {name}");
                self.place.file(to, before.replace(&old, &new));
            }
            "=" => {
                if stdout.as_bytes() != unescaped(rest) {
                    self.fault(at, "standard output differs");
                }
            }
            "+" => self.words(at, rest, &said, true),
            "!" => self.words(at, rest, &said, false),
            "in" => match std::fs::read(self.place.path(name)) {
                Ok(bytes) => self.words(at, text, &String::from_utf8_lossy(&bytes), true),
                Err(error) => self.fault(at, format!("{name}: {error}")),
            },
            "same" => {
                let other = self.place.run(rest);
                if other.stdout != stdout || other.code != Some(0) {
                    self.fault(at, format!("not the same:\n{}{}", other.stdout, other.stderr));
                }
            }
            _ if head.parse::<i32>().is_ok() => self.run(at, head, rest),
            _ => return false,
        }
        true
    }
}

fn all(name: &str) {
    let (mut above, mut faults): (Vec<&str>, Vec<String>) = Default::default();
    let path = format!("{}/tests/program/cases/{name}.txt", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).unwrap();
    let mut scenario: Option<Scenario> = None;
    for (line, number) in text.lines().map(str::trim_start).zip(1..) {
        let at = format!("{name}.txt:{number}");
        if line.starts_with('[') {
            faults.extend(scenario.into_iter().flat_map(|it| it.faults));
            let mut next = Scenario { place: Place::new(), last: None, faults: Vec::new() };
            above.iter().for_each(|line| assert!(next.obey(&at, line)));
            scenario = Some(next);
        } else if !line.is_empty() && !line.starts_with('#') {
            match &mut scenario {
                Some(scenario) => assert!(scenario.obey(&at, line), "{at}: {line}"),
                None => above.push(line),
            }
        }
    }
    faults.extend(scenario.into_iter().flat_map(|it| it.faults));
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
