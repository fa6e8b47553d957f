//! Text from outside reaches neither a terminal, nor a log, nor a spreadsheet as a command.

use std::path::Path;

use crate::common::{Ended, fake, file, program, run, say};

/// No control characters but line feeds, and no line that a log takes for a command.
fn harmless(what: &str, ended: &Ended) {
    for text in [&ended.stdout, &ended.stderr] {
        assert!(text.chars().all(|c| c == '\n' || !c.is_control()), "{what}: {text:?}");
        let commands = text.lines().any(|line| line.trim_start().starts_with("::"));
        assert!(!commands && !text.contains("##["), "{what}: {text}");
    }
}

fn experiment(folder: &Path, runner: &str) {
    file(folder, "runner.sh", runner);
    let text = "name = \"h\"\ntitle = \"T\"\nquestion = \"?\"\nreading = \"-\"\nblocks = 1\n\
                detectors = [\"nbs\"]\n[[scene]]\nname = \"packed\"\nn = 20\n[[runner]]\n\
                name = \"theirs\"\ncommand = [\"sh\", \"runner.sh\"]\n";
    file(folder, "h.toml", text);
}

#[test]
fn runners_give_no_commands_to_terminals_logs_and_spreadsheets() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let words = r"\u001b[31m\u000a::error file=/etc/passwd::pwned\u000a##[add-mask]x";
    let error = say(&format!(r#"{{"reply":"error","reason":"{words}"}}"#));
    let refusal = say(r#"{"reply":"refused","reason":"=HYPERLINK(\"http://x\",\"y\")"}"#);
    let dies = r"printf 'x\n\033[2J::stop-commands::x\n' >&2; exit 3".to_string();
    let noise = r"printf 'no reply \033[31m\n'".to_string();
    for (out, answer, kept) in [
        ("a", error, "[31m"),
        ("b", refusal, "'=HYPERLINK("),
        ("c", dies, "stop-commands"),
        ("d", noise, "no reply"),
    ] {
        experiment(folder, &fake(&[("load", &answer)]));
        let ended = run(folder, &["run", "h.toml", "--out", out]);
        harmless(out, &ended);
        let summary = std::fs::read_to_string(folder.join(out).join("summary.csv")).unwrap();
        assert!(summary.contains(kept), "{out}: {summary}");
        let cells = summary.lines().flat_map(|line| line.split(','));
        let formula = |cell: &str| cell.trim_start_matches('"').starts_with(['=', '+', '@']);
        assert!(!cells.into_iter().any(formula), "{out}: {summary}");
        assert!(!summary.contains(['\x1b', '\r']), "{out}: {summary:?}");
        let ended = run(folder, &["check", "--runner", "sh runner.sh", "--seconds", "0"]);
        harmless(out, &ended);
    }
    let hello = r#"{"reply":"hello","protocol":9,"detector":"\u001b[31m"}"#;
    experiment(folder, &say(hello));
    harmless("hello", &run(folder, &["check", "--runner", "sh runner.sh"]));
}

#[cfg(unix)]
#[test]
fn names_and_lines_of_files_give_no_commands() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let (name, none) = ("\x1b[31m\n::error::a.csv", "::add-mask::\x07none.csv");
    file(folder, name, "x,y,r\n0,0,1\n1,0,1\n0,0,0.1\n");
    file(folder, "pairs.csv", "i,j\n0,1\n");
    file(folder, "grading", "\x1b]0;1\x07 passes\n1 2 3\n");
    file(folder, "bad.csv", "x,y,\x1b[2J\n\x1b[31m,2,3\n");
    for arguments in [
        &["detect", name][..],
        &["detect", none],
        &["inspect", name],
        &["inspect", none],
        &["verify", name, "--pairs", "pairs.csv"],
        &["verify", name, "--pairs", none],
        &["draw", name],
        &["track", name, "--frames", "2"],
        &["scene", name, "-o", "\x1b.csv"],
        &["check", "--scene", name, "--detector", "nbs"],
        &["recommend", name, "--seconds", "0.1"],
        &["ranks", name, "--ranks", "1", "--steps", "1"],
        &["scene", "loose:n=9,grading=grading"],
        &["inspect", "bad.csv"],
        &["run", none],
        &["report", name],
        &["compare", name, none],
        &["\x1b[31m\n::error::x"],
        &["detect", "--\x1b[31m"],
        &["detect", "a", "--detector", "\n::error::x"],
    ] {
        let ended = run(folder, arguments);
        harmless(&format!("{arguments:?}"), &ended);
    }
}

/// Beyond the limit on the size of files the error is printed: no signal ends the program.
#[cfg(unix)]
#[test]
fn a_limit_on_the_size_of_files_is_an_error_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "l.sh", "ulimit -f 1\nexec \"$@\"\n");
    let program = program(folder, &[]).get_program().to_owned();
    let limited = |arguments: &[&str]| {
        let mut command = std::process::Command::new("sh");
        command.arg("l.sh").arg(&program).args(arguments).current_dir(folder);
        crate::common::ended(command.output().unwrap())
    };
    let out = ["detect", "packed:n=2000", "-o", "pairs.csv"];
    let ended = limited(&out);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    assert!(ended.stderr.contains("cannot write") && ended.stderr.contains("pairs.csv"));
    experiment(folder, "exit 1");
    let ended = limited(&["run", "h.toml", "--out", "out"]);
    assert!(matches!(ended.code, Some(1..=3)), "{:?} {}", ended.code, ended.stderr);
    assert!(ended.stderr.contains("cannot write") || ended.stderr.contains("too large"));
}
