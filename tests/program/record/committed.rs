//! Every committed record is readable, has all of its plan, and is in the index.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

use contactbench::cells::{self, Cell};
use contactbench::findings::trust::coverage::Coverage;
use contactbench::plan;
use contactbench::record::merge::Part;
use contactbench::record::row;

use crate::committed::committed;
use crate::common::{PROGRAM, Place};

fn results() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/results"))
}

#[test]
fn every_committed_record_is_readable_and_in_the_index() {
    let index = std::fs::read_to_string(results().join("README.md")).unwrap();
    let links = index.lines().filter_map(|line| line.strip_prefix("| [")?.split_once("]("));
    let listed: BTreeSet<&str> =
        links.filter_map(|(_, rest)| Some(rest.split_once(')')?.0)).collect();
    let mut expected = BTreeSet::new();
    for folder in committed() {
        let name = folder.strip_prefix(results()).unwrap().join("report.md");
        expected.insert(name.display().to_string());
        // The records of ranks and of settings are tables without rows.
        if !row::exists(&folder.join(row::FILE)) {
            continue;
        }
        let part = Part::read(&folder).unwrap_or_else(|e| panic!("{}: {e:#}", folder.display()));
        let cells = cells::cells(&part.rows);
        for (name, text) in &part.experiments {
            let experiment = plan::parse_copy(text).unwrap();
            let own: Vec<&Cell> = cells.iter().filter(|cell| cell.id.experiment == *name).collect();
            let gaps = Coverage::new(&experiment, &own).gaps();
            assert!(!own.is_empty() && gaps.is_none(), "{}: {gaps:?}", folder.display());
        }
    }
    assert_eq!(listed, expected.iter().map(String::as_str).collect());
}

/// All verbs read a compressed record, and none appends to it.
#[test]
fn verbs_read_compressed_records() {
    let record = &results().join("reference/vectors-intel");
    let at = Place::new();
    let copy = Command::new("cp").arg("-r").args([record, at.root()]).status().unwrap();
    assert!(copy.success());
    at.good("report vectors-intel");
    at.good("compare vectors-intel vectors-intel");
    at.good("merge vectors-intel --out whole");
    assert!(at.read("whole/samples.jsonl").lines().count() > 100);
    let words = ["vectors-intel/samples.jsonl.gz", "gunzip"];
    at.ends(2, "run vectors --resume --out vectors-intel", &words);
    at.ends(2, "merge whole --out vectors-intel", &["--out"]);
}

/// Returns the first line that git prints in the repository.
fn git(arguments: &[&str]) -> Option<String> {
    let root = env!("CARGO_MANIFEST_DIR");
    let printed = Command::new("git").current_dir(root).args(arguments).output().ok()?;
    Some(String::from_utf8(printed.stdout).ok()?.lines().next()?.to_string())
}

/// Returns the time of the first commit that `arguments` of `git log` select, in seconds.
fn first_commit(arguments: &[&str]) -> Option<u64> {
    git(&[&["log", "--reverse", "--format=%ct"], arguments].concat())?.parse().ok()
}

/// The limit of a claim that is marked `before` is older than the first record of its experiment.
/// Names of claims are not compared, because many were reworded.
#[test]
fn claims_marked_before_are_older_than_the_first_record() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    if git(&["rev-parse", "--is-shallow-repository"]).as_deref() != Some("false") {
        println!("skipped: this clone lacks the history");
        return;
    }
    let mut limits = BTreeMap::new();
    for entry in std::fs::read_dir(root.join("experiments")).unwrap() {
        let path = entry.unwrap().path();
        let (text, name) = (std::fs::read_to_string(&path).unwrap(), path.file_stem().unwrap());
        let copies = format!(":(glob)results/**/experiments/{}.toml", name.display());
        for claim in text.split("[[claim]]").filter(|claim| claim.contains("set = \"before\"")) {
            let recorded = first_commit(&["--diff-filter=A", "--", &copies]);
            for (key, limit) in claim.lines().filter_map(|line| line.split_once(" = ")) {
                if ["value", "to", "than", "within", "by", "model"].contains(&key) {
                    let stated = *limits.entry(limit.to_string()).or_insert_with(|| {
                        first_commit(&[&format!("-S{limit}"), "--", "experiments"])
                    });
                    let older = recorded.is_none() || stated.is_some() && stated < recorded;
                    assert!(older, "{copies}: {key} = {limit}");
                }
            }
        }
    }
    assert!(limits.len() > 10, "{limits:?}");
}

/// Exact counts of a contributed record are compared with those that the program has.
#[cfg(unix)]
#[test]
fn contributed_counts_are_those_of_the_program() {
    let at = Place::new();
    let run = |command: &mut Command| command.current_dir(at.root()).output().unwrap();
    run(Command::new("cp").arg("-r").arg(results().join("reference/standard")).arg("a"));
    run(Command::new("gunzip").arg("a/samples.jsonl.gz"));
    let row = ["\"scaling\"", "\"n\":1000,", "\"streamed-nbs\"", "\"pass\":\"count\""];
    let text = at.read("a/samples.jsonl");
    let line = text.lines().find(|line| row.iter().all(|words| line.contains(words))).unwrap();
    let more = super::edited(line, |row| {
        row["counts"]["contact_test"] =
            (row["counts"]["contact_test"].as_u64().unwrap() + 1).into();
    });
    at.file("a/samples.jsonl", text.replacen(line, &more, 1));
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/.ci/contributed");
    let ended = run(Command::new(script).args([PROGRAM, "a"]));
    let out = String::from_utf8_lossy(&ended.stdout);
    assert!(!ended.status.success() && out.contains("counts are not those"), "{out}");
}
