//! Tests README and docs: their Rust code equals that of the compiled example, and their commands
//! run as written.

use std::path::{Path, PathBuf};

use contactbench::cells::{self, Cell};
use contactbench::detect::table::{Role, TABLE};
use contactbench::record::row;

use crate::committed::committed;
use crate::common::{PROGRAM, Place};

const README: &str = include_str!("../../../README.md");
const DETECTORS: &str = include_str!("../../../docs/DETECTORS.md");
const EXAMPLE: &str = include_str!("../../../examples/add_a_detector.rs");

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

/// Returns the text of the example between `// PAGE: name` and `// PAGE: end`, unindented.
fn marked(name: &str) -> String {
    let lines =
        EXAMPLE.lines().skip_while(|line| line.trim() != format!("// PAGE: {name}")).skip(1);
    let lines: Vec<&str> = lines.take_while(|line| line.trim() != "// PAGE: end").collect();
    let indent = lines
        .iter()
        .filter(|line| !line.is_empty())
        .map(|line| line.len() - line.trim_start().len())
        .min()
        .unwrap_or(0);
    lines.iter().map(|line| format!("{}\n", line.get(indent..).unwrap_or_default())).collect()
}

#[test]
fn the_code_is_that_of_the_example() {
    let (detector, table) = (marked("detector"), marked("table"));
    assert_eq!(blocks(DETECTORS, "rust"), [detector.clone(), table]);
    assert!((10..50).contains(&detector.lines().count()), "{} lines", detector.lines().count());
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

#[test]
fn the_output_of_readme_is_that_of_the_record() {
    let at = Place::new();
    let record = Path::new(env!("CARGO_MANIFEST_DIR")).join("results/reference/standard");
    let copied = std::process::Command::new("cp").arg("-r").args([&record, at.root()]).status();
    assert!(copied.unwrap().success());
    let words = |line: &str| line.split_whitespace().collect::<Vec<_>>().join(" ");
    let printed: Vec<String> = at.good("report standard").stdout.lines().map(words).collect();
    let shown = &blocks(README, "text")[0];
    for line in shown.lines().map(words) {
        assert!(printed.iter().any(|it| it.starts_with(&line)), "README shows '{line}'");
    }
}

#[test]
fn the_measured_table_is_that_of_the_record() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("results/reference/standard");
    let cells = cells::cells(&row::read(&folder.join(row::FILE)).unwrap().rows);
    let is_shown = |cell: &&Cell| {
        let id = &cell.id;
        (&*id.experiment, &*id.scene, id.dim, id.n) == ("scaling", "packed", 3, 100_000)
            && (&*id.arithmetic, id.threads()) == ("exact", 1)
    };
    let (start, end) = ("<!-- measured:begin -->", "<!-- measured:end -->");
    let table = DETECTORS.split_once(start).unwrap().1.split_once(end).unwrap().0;
    let rows: Vec<Vec<&str>> = table
        .lines()
        .filter(|line| line.starts_with("| `"))
        .map(|line| line.trim_matches('|').split('|').map(str::trim).collect())
        .collect();
    // A detector that a user has added is neither in the page nor in the record.
    let ours = TABLE.iter().filter(|entry| entry.role == Role::Detector);
    let recorded = |name: &str| cells.iter().filter(is_shown).any(|cell| cell.id.detector == name);
    let names: Vec<String> = ours
        .map(|entry| entry.name)
        .filter(|name| recorded(name))
        .map(|n| format!("`{n}`"))
        .collect();
    assert!(names.len() >= 12, "{names:?}");
    assert_eq!(rows.iter().map(|row| row[0]).collect::<Vec<_>>(), names);
    for row in rows {
        let detector = row[0].trim_matches('`');
        let cell = cells.iter().filter(is_shown).find(|cell| cell.id.detector == detector);
        let cell = cell.unwrap_or_else(|| panic!("{detector} is not in the record"));
        let n = cell.id.n as f64;
        let time = cell.time().map(|time| format!("{:.0}", time.median / n));
        let bytes = cell.variable("peak_bytes", None).map(|bytes| format!("{:.1}", bytes / n));
        let expected = [time, bytes].map(|shown| shown.unwrap_or("over the limit".into()));
        assert_eq!(row[4..], expected, "{detector}");
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
