//! Tests README and docs: their commands run as written, and their links lead somewhere.

use std::path::{Path, PathBuf};

use crate::committed::committed;
use crate::common::{PROGRAM, Place};

const README: &str = include_str!("../../../README.md");

/// Returns the text of all fenced blocks of a language, in order.
fn blocks(page: &str, language: &str) -> Vec<String> {
    let (mut found, mut inside) = (Vec::new(), None);
    for line in page.lines() {
        match (line.strip_prefix("```"), &mut inside) {
            (Some(name), None) => inside = Some((name.to_string(), String::new())),
            (Some(_), Some(_)) => found.extend(inside.take()),
            (None, Some((_, text))) => *text += &format!("{line}\n"),
            (None, None) => {}
        }
    }
    assert!(inside.is_none(), "a fenced block is not closed");
    found.into_iter().filter(|(name, _)| name == language).map(|(_, text)| text).collect()
}

/// Runs the commands of a page in order in one folder; returns their number. It skips blocks that
/// begin with cargo build, which take minutes.
fn run_commands_of(page: &str, at: &Place) -> usize {
    let program = Path::new(PROGRAM).parent().unwrap().display();
    let mut run = 0;
    for block in blocks(page, "sh").iter().filter(|block| !block.starts_with("cargo ")) {
        let ended = at.shell(&format!("set -eu\nPATH=\"{program}:$PATH\"\n{block}"));
        let said = format!("{}{}", ended.stdout, ended.stderr);
        assert_eq!(ended.code, Some(0), "{block}\n{said}");
        run += block.lines().filter(|line| line.starts_with("contactbench ")).count();
    }
    run
}

#[test]
fn the_commands_work_as_written() {
    let at = Place::new();
    assert_eq!(run_commands_of(README, &at), 3, "commands of README");
    assert_eq!(at.read("pairs.csv"), "i,j\n0,1\n2,3\n");
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    for path in std::fs::read_dir(docs).unwrap().map(|entry| entry.unwrap().path()) {
        if path.extension().is_some_and(|ending| ending == "md") {
            run_commands_of(&std::fs::read_to_string(&path).unwrap(), &Place::new());
        }
    }
}

/// Returns the anchors of the headings of a page, as GitHub makes them.
fn anchors(page: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(page).unwrap();
    let heads = text.lines().filter(|line| line.starts_with('#'));
    let heads = heads.map(|line| line.trim_start_matches('#').trim().to_lowercase());
    let kept = |c: &char| c.is_alphanumeric() || " -_".contains(*c);
    heads.map(|head| head.chars().filter(kept).collect::<String>().replace(' ', "-")).collect()
}

/// Files and headings exist if pages and write-ups link to them.
#[test]
fn links_lead_somewhere() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut pages: Vec<PathBuf> = Vec::new();
    let records = committed();
    let write_ups = records.iter().flat_map(|folder| [folder.clone(), folder.join("..")]);
    let folders = ["", "docs", "results"].map(|folder| root.join(folder));
    for folder in folders.into_iter().chain(write_ups) {
        let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        pages.extend(entries.filter(|path| path.extension().is_some_and(|it| it == "md")));
    }
    for page in pages {
        let text = std::fs::read_to_string(&page).unwrap();
        let links = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
        for target in links.filter(|target| !target.contains("://")) {
            let (name, anchor) = target.split_once('#').unwrap_or((target, ""));
            let file = if name.is_empty() { page.clone() } else { page.with_file_name(name) };
            assert!(file.exists(), "{} links to {target}, which is not there", page.display());
            let is_page = file.extension().is_some_and(|ending| ending == "md");
            let there = !is_page || anchor.is_empty() || anchors(&file).contains(&anchor.into());
            assert!(there, "{}: {target} has no such heading", page.display());
        }
    }
}

#[test]
fn the_citation_is_of_this_version() {
    let version = format!("\nversion: {}\n", env!("CARGO_PKG_VERSION"));
    assert!(include_str!("../../../CITATION.cff").contains(&version));
}
