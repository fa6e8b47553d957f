//! Compares docs/EXPERIMENTS.md with the types: keys, defaults, required keys, and examples.

use std::collections::BTreeSet;

use super::*;
use contactbench_record::experiment::{Claim, ClaimKind, Figure, Quick, SceneSweep, keys};

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

fn sections() -> Vec<(&'static str, Vec<&'static str>)> {
    let without = |names: &[&'static str]| -> Vec<&'static str> {
        names.iter().copied().filter(|name| *name != "params").collect()
    };
    let mut sections = vec![
        ("## Top level".to_string(), without(keys::fields::<Experiment>())),
        ("## Scenes".to_string(), without(keys::fields::<SceneSweep>())),
        ("### Quick runs".to_string(), without(keys::fields::<Quick>())),
        ("## Runners".to_string(), without(keys::fields::<ExternalRunner>())),
        ("## Claims".to_string(), without(keys::fields::<Claim>())),
        ("## Figures".to_string(), without(keys::fields::<Figure>())),
    ];
    for kind in keys::fields::<ClaimKind>() {
        let takes = keys::variant_fields::<ClaimKind>(kind);
        sections.push((format!("### Claim: `{kind}`"), takes.to_vec()));
    }
    for kind in keys::fields::<FigureKind>() {
        let takes = keys::variant_fields::<FigureKind>(kind);
        sections.push((format!("### Figure: `{kind}`"), takes.to_vec()));
    }
    sections.into_iter().map(|(heading, keys)| (&*heading.leak(), keys)).collect()
}

#[test]
fn every_key_is_on_the_page_and_no_other() {
    let sections = sections();
    for (heading, keys) in &sections {
        let known: BTreeSet<&str> = keys.iter().copied().collect();
        let listed: Vec<&str> = rows(section(heading)).into_iter().map(|(key, _)| key).collect();
        assert_eq!(listed.iter().copied().collect::<BTreeSet<_>>(), known, "{heading}");
        assert_eq!(listed.len(), known.len(), "{heading}: a key is listed twice");
    }
    let kinds = |what: &str| PAGE.matches(&format!("\n### {what}: `")).count();
    assert_eq!(kinds("Claim"), keys::fields::<ClaimKind>().len());
    assert_eq!(kinds("Figure"), keys::fields::<FigureKind>().len());
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
