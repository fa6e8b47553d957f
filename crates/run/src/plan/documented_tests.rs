//! Compares docs/EXPERIMENTS.md with the types: keys, defaults, required keys, and examples.

use std::collections::{BTreeMap, BTreeSet};

use super::*;
use contactbench_record::experiment::figures::KINDS;
use contactbench_record::experiment::{Claim, ClaimKind, Figure};

const PAGE: &str = include_str!("../../../../docs/EXPERIMENTS.md");
const SCENE: &str = "\n[[scene]]\nname = \"packed\"\nn = 10\n";
const HEAD: &str = "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\n";

fn section(heading: &str) -> &'static str {
    let rest = PAGE.split_once(&format!("\n{heading}\n")).unwrap_or_else(|| panic!("{heading}")).1;
    rest.find("\n#").map_or(rest, |end| &rest[..end])
}

/// Returns the first two cells of each row of a section's table: the key and its default.
fn rows(section: &str) -> Vec<(&str, &str)> {
    let rows = section.lines().filter(|line| line.starts_with("| "));
    rows.skip(1)
        .map(|row| {
            let cells: Vec<&str> = row.split(" | ").collect();
            let default = cells.get(1).map_or("", |cell| cell.trim().trim_matches('`'));
            (cells[0].trim_start_matches("| ").trim_matches('`'), default)
        })
        .filter(|(key, _)| *key != "any other")
        .collect()
}

fn examples(section: &str) -> Vec<&str> {
    let blocks = section.split("```toml\n").skip(1);
    blocks.map(|block| block.split("```").next().unwrap_or_default()).collect()
}

fn completed(example: &str) -> String {
    let mut head = if example.contains("question = ") { String::new() } else { HEAD.to_string() };
    if !example.contains("detectors = ") {
        head += "detectors = [\"nbs\", \"sorting\"]\n";
    }
    let scene = if example.contains("[[scene]]") { "" } else { SCENE };
    format!("{head}{example}{scene}")
}

fn parse(text: &str) -> anyhow::Result<Experiment> {
    super::parse(text, Path::new("."))
}

/// Returns the names that serde lists when it refuses the name `?` in this text.
fn names<T: serde::de::DeserializeOwned>(text: &str) -> Vec<String> {
    let error = toml::from_str::<T>(text).err().expect("the name is unknown");
    let (known, message) = (["available keys: ", "expected "], error.message().replace('`', ""));
    let list = known.iter().find_map(|head| Some(message.split_once(head)?.1.to_string()));
    let list = list.expect("names are listed").replace("one of ", "").replace(" or ", ", ");
    list.lines().next().unwrap_or_default().split(", ").map(String::from).collect()
}

fn kinds<T: serde::de::DeserializeOwned>() -> Vec<String> {
    names::<BTreeMap<String, T>>("kind = \"?\"")
}

/// Returns the heading of each section, and the keys of its type.
fn sections() -> Vec<(String, Vec<String>)> {
    let sweep = ["name", "dim", "n", "seed", "order", "quick"];
    let mut sections = vec![
        ("## Top level".to_string(), names::<Experiment>("'?' = 1")),
        ("## Scenes".to_string(), sweep.map(String::from).into()),
        ("### Quick runs".to_string(), sweep[1..5].iter().map(|name| name.to_string()).collect()),
        ("## Runners".to_string(), names::<ExternalRunner>("'?' = 1")),
        ("## Claims".to_string(), names::<Claim>("'?' = 1")),
        ("## Figures".to_string(), names::<Figure>("'?' = 1")),
    ];
    for kind in kinds::<ClaimKind>() {
        let keys = names::<BTreeMap<String, ClaimKind>>(&format!("x.{kind}.'?' = 1"));
        sections.push((format!("### Claim: `{kind}`"), keys));
    }
    for kind in kinds::<FigureKind>() {
        let keys = names::<BTreeMap<String, FigureKind>>(&format!("x.{kind}.'?' = 1"));
        sections.push((format!("### Figure: `{kind}`"), keys));
    }
    sections
}

#[test]
fn every_key_is_on_the_page_and_no_other() {
    let sections = sections();
    for (heading, keys) in &sections {
        let known: BTreeSet<&str> = keys.iter().map(String::as_str).collect();
        let listed: Vec<&str> = rows(section(heading)).into_iter().map(|(key, _)| key).collect();
        assert_eq!(listed.iter().copied().collect::<BTreeSet<_>>(), known, "{heading}");
        assert_eq!(listed.len(), known.len(), "{heading}: a key is listed twice");
    }
    let headings = |what: &str| PAGE.matches(&format!("\n### {what}: `")).count();
    assert_eq!(headings("Claim"), kinds::<ClaimKind>().len());
    assert_eq!(headings("Figure"), kinds::<FigureKind>().len());
    assert_eq!(kinds::<FigureKind>(), KINDS);
    let groups: BTreeSet<&str> = detectors::groups().collect();
    let listed = rows(section("### Detectors and groups"));
    assert_eq!(listed.into_iter().map(|(group, _)| group).collect::<BTreeSet<_>>(), groups);
}

#[test]
fn the_examples_can_be_read_and_planned() {
    let all = examples(PAGE);
    assert!(all.len() > 10, "{}", all.len());
    for example in all {
        if let Err(error) = parse(&completed(example)) {
            panic!("{error:#}\n{example}");
        }
    }
    let complete = parse(examples(PAGE)[0]).unwrap();
    assert_eq!((complete.planned.scenes.len(), complete.planned.quick.len()), (3, 3));
}

/// Returns the example with the lines of `key` removed from the table `header`, and `line` there.
fn edited(example: &str, header: &str, key: &str, line: &str) -> String {
    let at = example.find(header).unwrap_or_else(|| panic!("{header}\n{example}")) + header.len();
    let rest = &example[at..];
    let end = rest.find("\n[").unwrap_or(rest.len());
    let kept = rest[..end].lines().filter(|it| !it.starts_with(&format!("{key} = ")));
    let table = kept.collect::<Vec<_>>().join("\n");
    format!("{}{line}\n{table}{}", &example[..at], &rest[end..])
}

#[test]
fn required_keys_and_defaults_are_those_of_the_page() {
    let (mut required, mut defaults) = (0, 0);
    let kinds = sections().into_iter().map(|(heading, _)| heading);
    for heading in kinds.filter(|heading| heading != "### Quick runs") {
        let header = match heading.split([' ', ':']).nth(1) {
            Some("Top") => "",
            Some("Scenes") => "[[scene]]\n",
            Some("Runners") => "[[runner]]\n",
            Some("Claims" | "Claim") => "[[claim]]\n",
            _ => "[[figure]]\n",
        };
        let top = completed("detectors = [\"nbs\"]");
        let bars = "[[figure]]\nname = \"f\"\ntitle = \"f\"\nkind = \"bars\"\nto = \"nbs\"\n";
        let errors = &bars.replace("bars", "speed-error").replace("to = \"nbs\"\n", "");
        let own = match &*heading {
            "## Top level" => vec![&*top],
            "### Figure: `bars`" => vec![bars],
            "### Figure: `speed-error`" => vec![&**errors],
            heading => examples(section(heading)),
        };
        let found = own.into_iter().chain(examples(PAGE)).find(|example| example.contains(header));
        let example = completed(found.unwrap_or_else(|| panic!("no example: {heading}")));
        // A table is no line, so `scene` cannot be left out.
        for (key, default) in rows(section(&heading)).into_iter().filter(|(key, _)| *key != "scene")
        {
            let without = parse(&edited(&example, header, key, ""));
            match default {
                "required" => {
                    assert!(without.is_err(), "{heading}: {key} is not required");
                    required += 1;
                }
                "none" => assert!(without.is_ok(), "{heading}: {key}: {:#}", without.unwrap_err()),
                default
                    if default.starts_with(char::is_alphabetic)
                        && !matches!(default, "true" | "false" | "inf") => {}
                default => {
                    let with = parse(&edited(&example, header, key, &format!("{key} = {default}")));
                    let same = |it: anyhow::Result<Experiment>| format!("{it:?}");
                    assert_eq!(same(without), same(with), "{heading}: {key}");
                    defaults += 1;
                }
            }
        }
    }
    assert!(required > 20 && defaults > 20, "{required} required, {defaults} defaults");
}
