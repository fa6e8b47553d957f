//! Where rows come from, and what makes their times doubtful: noted while they are measured, and
//! said wherever they are shown.

use std::path::Path;
use std::process::Command;

use contactbench::record::ledger::{self, Entry, Ledger, Span};
use contactbench::record::row::{Outcome, Pass, Row};
use contactbench::record::{provenance, row, seal};
use contactbench::wide::Level;
use serde_json::Value;
use sha2::{Digest, Sha256};

use crate::common::{PROGRAM, fake, file, good, run, runner, say, untested};

const TEXT: &str = "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\nblocks = \
                    3\ndetectors = [\"nbs\", \"streamed-nbs\", \
                    \"streamed-nbs:level=portable\"]\n[[scene]]\nname = \"packed\"\nn = [20, 30]\n";

fn rows(folder: &Path) -> Vec<Row> {
    row::read(&folder.join("result/samples.jsonl")).unwrap().rows
}

fn read(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join(name)).unwrap()
}

/// A runner in shell that answers each sample with this code.
fn sampled(code: &str) -> String {
    let unsupported = say(r#"{"reply":"unsupported"}"#);
    let sample = format!("sleep 0.002; {code}");
    let loaded = say(r#"{"reply":"loaded"}"#);
    let answers = [("load", &*loaded), ("count", &unsupported), ("memory", &unsupported)];
    fake(&[&answers[..], &[("sample", &sample)]].concat())
}

/// The answer to a sample.
fn sample(contacts: u32, digest: &str) -> String {
    let times = r#""reply":"sample","time_ns":300000,"calls":1,"elapsed_ns":300000"#;
    say(&format!(r#"{{{times},"contacts":{contacts},"digest":"{digest}"}}"#))
}

#[test]
fn every_row_says_which_program_answered_and_when() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let hello = r#""arithmetic":"f64""#;
    let library = sampled(&sample(0, "0x0"));
    let said = format!(r#"{hello},"version":"7.1","build":{{"compiler":"cc 5"}}"#);
    file(folder, "library.sh", library.replace(hello, &said));
    let named = "[[runner]]\nname = \"library\"\ncommand = [\"sh\", \"library.sh\"]\n";
    let missing = runner("missing", "no-such-program", "");
    file(folder, "t.toml", format!("{TEXT}{named}{missing}"));
    // The answers of the library are wrong.
    assert_eq!(run(folder, &["run", "t.toml", "--out", "result"]).code, Some(1));
    let rows = rows(folder);
    let ledger = Ledger::read(&folder.join("result"));
    let sum = |path: &Path| -> String {
        let sum = Sha256::digest(std::fs::read(path).unwrap());
        sum.iter().map(|byte| format!("{byte:02x}")).collect()
    };
    let own = sum(Path::new(PROGRAM));
    for row in &rows {
        let contender = row.id.contender();
        if contender == "missing" {
            assert_eq!((&row.process, row.time_ns), (&None, None));
            continue;
        }
        let process = &ledger.processes[row.process.as_ref().unwrap()];
        let build = |name: &str| process.build.get(name).map(String::as_str);
        let level = match &*contender {
            "streamed-nbs" => Some(Level::best().name()),
            "streamed-nbs:level=portable" => Some("portable"),
            _ => None,
        };
        assert_eq!(build("level"), level, "{contender}");
        if contender == "library" {
            assert_eq!((&*process.version, build("compiler")), ("7.1", Some("cc 5")));
            let script = process.files.iter().find(|file| file.name == "library.sh").unwrap();
            assert_eq!(script.sha256.as_ref().unwrap(), &sum(&folder.join("library.sh")));
            assert!(process.files[0].sha256.is_some() && process.files.len() == 2);
        } else {
            assert_eq!(process.version, env!("CARGO_PKG_VERSION"));
            assert_eq!(process.files[0].name, "contactbench");
            assert_eq!(process.files[0].sha256.as_ref(), Some(&own));
            assert!(build("revision").is_some() && build("sources").is_some());
        }
        let span = row.span.as_ref();
        assert_eq!(span.is_some(), row.pass == Pass::Time && cfg!(target_os = "linux"), "{row:?}");
        if let Some(span) = span {
            let span = &ledger.spans[span];
            assert!(span.scene.contains(&format!("N={}", row.id.n)), "{span:?}");
            assert!(span.seconds > 0.0 && span.own_s > 0.0 && span.cores > 0, "{span:?}");
        }
    }
    // One program with three levels of instructions, and a library; two scenes. Rows point there.
    let levels = if Level::best().name() == "portable" { 2 } else { 3 };
    assert_eq!(ledger.processes.len(), levels + 1);
    let spans = if cfg!(target_os = "linux") { 2 } else { 0 };
    assert_eq!(ledger.spans.len(), spans);
    let text = read(folder, "result/samples.jsonl");
    assert!(!text.contains("sha256") && !text.contains("revision"));
    // The entries stay with the rows.
    assert_eq!(run(folder, &["merge", "result", "result", "--out", "twice"]).code, Some(1));
    assert_eq!(Ledger::read(&folder.join("twice")), ledger);
    let page = read(folder, "twice/report.md");
    for words in ["## Programs", "library.sh (SHA-256 ", "compiler cc 5", "version 7.1"] {
        assert!(page.contains(words), "{words} is not in\n{page}");
    }
}

/// What the build script notes in a folder: revision, state of the sources, and whether it looks
/// again after the next commit.
fn noted(folder: &Path, script: &Path) -> (String, String, bool) {
    let output = git_free(Command::new(script), folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let said = String::from_utf8(output.stdout).unwrap();
    let value = |name: &str| {
        let head = format!("cargo:rustc-env=CONTACTBENCH_{name}=");
        said.lines().find_map(|line| line.strip_prefix(&head)).unwrap().to_string()
    };
    (value("REVISION"), value("DIRTY"), said.contains("logs/HEAD"))
}

/// A command in a folder that knows nothing of repositories above it, nor of the user's settings.
fn git_free(mut command: Command, folder: &Path) -> Command {
    command.current_dir(folder).env("GIT_CEILING_DIRECTORIES", folder.parent().unwrap());
    command.env("GIT_CONFIG_GLOBAL", "/dev/null").env("GIT_CONFIG_NOSYSTEM", "1");
    command.env_remove("GIT_DIR").env_remove("GIT_WORK_TREE");
    command
}

#[test]
fn the_build_notes_the_commit_of_what_it_compiles_and_of_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("script");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/build.rs");
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let mut compiler = Command::new(rustc);
    compiler.args(["--edition", "2024", "-o"]).args([&script, &source]);
    assert!(compiler.status().unwrap().success());
    // A tarball, unpacked somewhere.
    let tree = folder.path().join("tree");
    std::fs::create_dir_all(tree.join("src")).unwrap();
    for name in ["build.rs", "src/lib.rs", "README.md"] {
        file(&tree, name, "1");
    }
    let unknown = ("unknown".to_string(), "unknown".to_string(), false);
    assert_eq!(noted(&tree, &script), unknown);
    let git = |arguments: &[&str]| {
        let mut command = Command::new("git");
        command.args(["-c", "user.name=a", "-c", "user.email=a@b"]).args(arguments);
        let output = git_free(command, &tree).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_string())
    };
    if git(&["init", "-q"]).is_none() {
        return untested("that the build notes its commit", "git");
    }
    // In a repository of others.
    assert_eq!(noted(&tree, &script), unknown);
    let commit = || {
        git(&["add", "-A"]).unwrap();
        git(&["commit", "-q", "-m", "."]).unwrap();
        git(&["rev-parse", "HEAD"]).unwrap()
    };
    let first = commit();
    assert_eq!(noted(&tree, &script), (first.clone(), "false".into(), false));
    file(&tree, "README.md", "2");
    assert_eq!(noted(&tree, &script), (first.clone(), "false".into(), false));
    assert_ne!(commit(), first);
    assert_eq!(noted(&tree, &script), (first.clone(), "false".into(), false));
    for name in ["src/lib.rs", "src/new.rs"] {
        let before = git(&["rev-parse", "HEAD"]).unwrap();
        let (revision, ..) = noted(&tree, &script);
        file(&tree, name, "2");
        assert_eq!(noted(&tree, &script), (revision, "true".into(), true));
        let now = commit();
        assert_ne!(now, before);
        assert_eq!(noted(&tree, &script), (now, "false".into(), false));
    }
}

#[test]
fn a_doubtful_record_says_so_on_every_page() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "t.toml", TEXT);
    good(folder, &["run", "t.toml", "--out", "result"]);
    let path = folder.join("result/provenance.json");
    let mut fields: Value = serde_json::from_str(&read(folder, "result/provenance.json")).unwrap();
    for (name, value) in [("dirty", false.into()), ("profile", Value::from("release"))] {
        fields[name] = value;
    }
    let idle = Ledger::read(&folder.join("result"));
    let idle = |others: f64| -> String {
        let spans = idle.spans.values().map(|span| {
            let (seconds, others_s) = (10.0, 10.0 * others);
            Span { seconds, others_s, stolen_s: 0.0, ..span.clone() }
        });
        let processes = idle.processes.values().cloned().map(|mut process| {
            process.build.insert("profile".into(), "release".into());
            process.build.insert("sources".into(), "as committed".into());
            Entry::Process(process)
        });
        let entries = processes.chain(spans.map(Entry::Span));
        entries.map(|entry| seal::sealed(&serde_json::to_string(&entry).unwrap()) + "\n").collect()
    };
    let doubt = "do not quote the times of this record: ";
    let shown = |fields: &Value, entries: &str| {
        std::fs::write(&path, provenance::text(fields).unwrap()).unwrap();
        std::fs::write(folder.join("result").join(ledger::FILE), entries).unwrap();
        let report = good(folder, &["report", "result"]);
        let compared = good(folder, &["compare", "result", "result"]);
        let json = good(folder, &["compare", "result", "result", "--json"]);
        let json: Value = serde_json::from_str(&json.stdout).unwrap();
        let pages = [
            report.stdout.split_whitespace().collect::<Vec<_>>().join(" "),
            read(folder, "result/report.md"),
            read(folder, "result/report.html"),
            compared.stdout,
        ];
        (pages, json["b"]["doubts"].clone())
    };
    let (pages, doubts) = shown(&fields, &idle(0.02));
    assert!(pages.iter().all(|page| !page.contains(doubt)), "{}", pages[0]);
    assert_eq!(doubts, Value::Array(Vec::new()));
    let busy = "other processes used 35% of a core";
    let uncommitted = "the program was built from sources that were not committed";
    let dirty = |fields: &Value| {
        let mut fields = fields.clone();
        fields["dirty"] = true.into();
        fields
    };
    let mut debug = fields.clone();
    debug["profile"] = "debug".into();
    let unwatched: String =
        idle(0.0).split_inclusive('\n').filter(|line| !line.contains("\"span\"")).collect();
    for (fields, entries, words) in [
        (&fields, idle(0.35), busy),
        (&dirty(&fields), idle(0.0), uncommitted),
        (&debug, idle(0.0), "the program is a debug build"),
        (&fields, unwatched, "what else the machine did is not known of 24 rows of 24 timed"),
    ] {
        let (pages, doubts) = shown(fields, &entries);
        for page in &pages {
            let at = page.find(doubt).unwrap_or_else(|| panic!("no doubt in\n{page}"));
            assert!(page[at..].contains(words), "{words} is not in\n{page}");
        }
        assert!(doubts[0].as_str().unwrap().starts_with(words), "{doubts}");
        // At the head, before what it is about.
        assert!(pages[0].find(doubt) < pages[0].find("fast"), "{}", pages[0]);
        assert!(pages[1].find(doubt) < pages[1].find("**?**"), "{}", pages[1]);
    }
}

/// Another build, in shell: its second answer is another than the rest.
#[cfg(unix)]
#[test]
fn beside_another_build_all_answers_count_and_all_rows_are_of_it() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let text = TEXT.replace("\"packed\"\nn = [20, 30]", "\"pack-c\"\nn = 25\ns = 5");
    file(folder, "t.toml", text.replace(", \"streamed-nbs\", \"streamed-nbs:level=portable\"", ""));
    let (right, other) = (sample(0, "0x0000000000000000"), sample(1, "0x910a2dec89025cc1"));
    let script = sampled(&format!("k=$((k+1)); if [ $k = 2 ]; then {other}; else {right}; fi"));
    let base = file(folder, "base.sh", format!("#!/bin/sh\n{script}"));
    std::fs::set_permissions(&base, std::fs::Permissions::from_mode(0o755)).unwrap();
    let run = |more: &[&str]| {
        let ended = run(folder, &[&["run", "t.toml", "--out", "result"], more].concat());
        (ended.code, ended.stderr)
    };
    let (code, said) = run(&["--against", "base.sh"]);
    assert_eq!(code, Some(1), "{said}");
    let rows = rows(folder);
    let timed: Vec<&Row> = rows.iter().filter(|row| row.pass == Pass::Time).collect();
    assert_eq!(timed.len(), 3 * 3);
    for row in timed {
        let wrong = row.id.detector == "nbs@base";
        assert_eq!(row.outcome == Outcome::Wrong, wrong, "{row:?}");
        assert_eq!(row.reason.contains("1 of "), wrong, "{row:?}");
    }
    for (more, words) in [
        (&["--resume"][..], "was begun beside another build; continue it with --against"),
        (&["--resume", "--against", PROGRAM], "beside another build than that of --against"),
    ] {
        let (code, said) = run(more);
        assert!(code == Some(2) && said.contains(words), "{said}");
    }
    let (_, said) = run(&["--resume", "--against", "base.sh"]);
    assert!(said.contains("resuming") && !said.contains("was begun"), "{said}");
}
