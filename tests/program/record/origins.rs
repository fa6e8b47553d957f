//! Rows name where they come from. Doubts about times are recorded during the measurement, and
//! printed with the times.

use std::path::Path;
use std::process::Command;

use contactbench::record::folder::ledger::Ledger;
use contactbench::record::row::{Outcome, Pass, Row};
use contactbench_ground::wide::Level;
use serde_json::Value;
use sha2::{Digest, Sha256};

use crate::common::{PROGRAM, Place, answers, runner, sample};

const TEXT: &str = include_str!("../experiments/streamed.toml");

fn sum(path: &Path) -> String {
    let sum = Sha256::digest(std::fs::read(path).unwrap());
    sum.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// <https://w3id.org/ro/wfrun/process/0.5>
#[test]
fn a_report_describes_its_folder_for_archives() {
    let at = Place::new();
    at.file("t.toml", TEXT);
    at.good("run t.toml --out result");
    at.good("report result");
    let text = at.read("result/ro-crate-metadata.json");
    let crate_: Value = serde_json::from_str(&text).unwrap();
    let graph = crate_["@graph"].as_array().unwrap();
    let find = |id: &str| graph.iter().find(|it| it["@id"] == id).unwrap_or_else(|| panic!("{id}"));
    let parts = find("./")["hasPart"].as_array().unwrap();
    let listed: Vec<&str> = parts.iter().map(|part| part["@id"].as_str().unwrap()).collect();
    let there = at.shell("cd result; find . -type f | sed 's|^./||' | LC_ALL=C sort").stdout;
    let there: Vec<&str> = there.lines().filter(|it| !it.starts_with("ro-crate")).collect();
    assert_eq!(listed, there);
    for path in listed {
        assert_eq!(find(path)["sha256"], sum(&at.path("result").join(path)), "{path}");
    }
    let run = find("#run");
    assert!(run["name"].as_str().unwrap().contains("run t.toml --out result"), "{run}");
    assert_eq!(run["object"], serde_json::json!([{ "@id": "experiments/t.toml" }]));
    // Every reference within the file leads to an entity.
    for id in text.split("\"@id\": \"").skip(1).map(|rest| &rest[..rest.find('"').unwrap()]) {
        assert!(id == "https://w3id.org/ro/crate/1.1" || find(id)["@type"].is_string(), "{id}");
    }
}

#[test]
fn every_row_names_the_program_that_answered_and_when() {
    let at = Place::new();
    let hello = r#""arithmetic":"f64""#;
    let said = format!(r#"{hello},"version":"7.1","build":{{"compiler":"cc 5"}}"#);
    let library = answers(&[("sample", &sample(0, "0x0"))]).replace(hello, &said);
    at.file("library.sh", library);
    let named = "[[runner]]\nname = \"library\"\ncommand = [\"sh\", \"library.sh\"]\n";
    at.file("t.toml", format!("{TEXT}{named}{}", runner("missing", "no-such-program", "")));
    at.ends(1, "run t.toml --out result", &[]);
    let ledger = Ledger::read(&at.path("result"));
    let own = sum(Path::new(PROGRAM));
    for row in &at.rows("result") {
        let subject = row.id.subject();
        if subject == "missing" {
            assert_eq!((&row.process, row.time_ns), (&None, None));
            continue;
        }
        let process = &ledger.processes[row.process.as_ref().unwrap()];
        let build = |name: &str| process.build.get(name).map(String::as_str);
        let level = match &*subject {
            "streamed-nbs" => Some(Level::best().name()),
            "streamed-nbs:level=portable" => Some("portable"),
            _ => None,
        };
        assert_eq!(build("level"), level, "{subject}");
        if subject == "library" {
            assert_eq!((&*process.version, build("compiler")), ("7.1", Some("cc 5")));
            let script = process.files.iter().find(|file| file.name == "library.sh").unwrap();
            assert_eq!(script.sha256.as_ref().unwrap(), &sum(&at.path("library.sh")));
            assert!(process.files[0].sha256.is_some() && process.files.len() == 2);
        } else {
            assert_eq!(process.version, env!("CARGO_PKG_VERSION"));
            assert_eq!(process.files[0].name, "contactbench");
            assert_eq!(process.files[0].sha256.as_ref(), Some(&own));
            assert!(build("sources").is_some());
            let revision = build("revision").unwrap();
            assert_eq!(revision.len() == 40, is_tracked(), "{revision}");
        }
        let span = row.span.as_ref();
        assert_eq!(span.is_some(), row.pass == Pass::Time && cfg!(target_os = "linux"), "{row:?}");
        if let Some(span) = span {
            let span = &ledger.spans[span];
            assert!(span.scene.contains(&format!("N={}", row.id.n)), "{span:?}");
            assert!(span.seconds > 0.0 && span.own_s > 0.0 && span.cores > 0, "{span:?}");
        }
    }
    // The processes are one program with up to three instruction levels, and a library; each of two
    // scenes has a span.
    let levels = if Level::best().name() == "portable" { 2 } else { 3 };
    let spans = if cfg!(target_os = "linux") { 2 } else { 0 };
    assert_eq!((ledger.processes.len(), ledger.spans.len()), (levels + 1, spans));
    let text = at.read("result/samples.jsonl");
    assert!(!text.contains("sha256") && !text.contains("revision"));
    // Rows keep their processes in a merge.
    at.ends(1, "merge result result --out twice", &[]);
    assert_eq!(Ledger::read(&at.path("twice")), ledger);
    let page = at.read("twice/report.md");
    for words in ["## Programs", "library.sh (SHA-256 ", "compiler cc 5", "version 7.1"] {
        assert!(page.contains(words), "{words} is not in\n{page}");
    }
}

/// Returns whether the program was built in a git checkout of its sources.
fn is_tracked() -> bool {
    let mut git = Command::new("git");
    git.current_dir(env!("CARGO_MANIFEST_DIR")).args([
        "ls-files",
        "--error-unmatch",
        "src/build.rs",
    ]);
    git.output().is_ok_and(|output| output.status.success())
}

#[test]
fn the_build_notes_the_commit_of_what_it_compiles() {
    let at = Place::new();
    let script = at.path("script");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/build.rs");
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let mut compiler = Command::new(rustc);
    compiler.args(["--edition", "2024", "-o"]).args([&script, &source]);
    assert!(compiler.status().unwrap().success());
    let git = "git -c user.name=a -c user.email=a@b";
    let ended = at.shell(&format!(
        "export GIT_CEILING_DIRECTORIES=. GIT_CONFIG_GLOBAL=/dev/null; mkdir -p tree/src; cd tree\n\
         touch Cargo.lock src/build.rs README.md; ../script; git init -q; ../script; {git} add -A\n\
         {git} commit -qm a; git rev-parse HEAD; ../script; touch LICENSE; ../script; touch src/new.rs; \
         ../script"
    ));
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let head = ended.stdout.lines().find(|line| !line.contains(':')).unwrap();
    let noted = |name: &str| -> Vec<&str> {
        let key = format!("cargo:rustc-env=CONTACTBENCH_{name}=");
        ended.stdout.lines().filter_map(|line| line.strip_prefix(&*key)).collect()
    };
    assert_eq!(noted("REVISION"), ["unknown", "unknown", head, head, head]);
    assert_eq!(noted("DIRTY"), ["unknown", "unknown", "false", "false", "true"]);
}

/// The other build is a shell script whose second answer differs.
#[cfg(unix)]
#[test]
fn beside_another_build_all_answers_count_and_all_rows_are_of_it() {
    use std::os::unix::fs::PermissionsExt;
    let at = Place::new();
    let text = TEXT.replace("\"packed\"\nn = [20, 30]", "\"pack-c\"\nn = 25\ns = 5");
    at.file("t.toml", text.replace(", \"streamed-nbs\", \"streamed-nbs:level=portable\"", ""));
    let (right, other) = (sample(0, "0x0000000000000000"), sample(1, "0x910a2dec89025cc1"));
    let code = format!("k=$((k+1)); if [ $k = 2 ]; then {other}; else {right}; fi");
    let base = at.file("base.sh", format!("#!/bin/sh\n{}", answers(&[("sample", &code)])));
    std::fs::set_permissions(&base, std::fs::Permissions::from_mode(0o755)).unwrap();
    at.ends(1, "run t.toml --out result --against base.sh", &[]);
    let rows = at.rows("result");
    let timed: Vec<&Row> = rows.iter().filter(|row| row.pass == Pass::Time).collect();
    assert_eq!(timed.len(), 3);
    for row in timed {
        let wrong = row.id.detector == "nbs@base";
        assert_eq!(row.outcome == Outcome::Wrong, wrong, "{row:?}");
        assert_eq!(row.reason.contains("1 of "), wrong, "{row:?}");
    }
    let resume = "run t.toml --out result --resume";
    at.ends(2, resume, &["with --against"]);
    at.ends(2, &format!("{resume} --against {PROGRAM}"), &["SHA-256"]);
    let said = at.run(&format!("{resume} --against base.sh")).stderr;
    assert!(said.contains("resuming") && !said.contains("--against"), "{said}");
}
