//! Text from other programs and files reaches no terminal, log or spreadsheet as a command.

use crate::common::{Ended, Place, fake, run, say};

/// Fails if the output has control characters (except line feeds) or commands to a log.
fn harmless(what: &str, ended: &Ended) {
    for text in [&ended.stdout, &ended.stderr] {
        assert!(text.chars().all(|c| c == '\n' || !c.is_control()), "{what}: {text:?}");
        let commands = text.lines().any(|line| line.trim_start().starts_with("::"));
        assert!(!commands && !text.contains("##["), "{what}: {text}");
    }
}

fn experiment(at: &Place, runner: &str) {
    at.file("runner.sh", runner);
    let text = "name = \"h\"\ntitle = \"T\"\nquestion = \"?\"\nreading = \"-\"\nblocks = 1\n\
                detectors = [\"nbs\"]\n[[scene]]\nname = \"packed\"\nn = 20\n[[runner]]\n\
                name = \"theirs\"\ncommand = [\"sh\", \"runner.sh\"]\n";
    at.file("h.toml", text);
}

#[test]
fn runners_give_no_commands_to_terminals_logs_and_spreadsheets() {
    let at = Place::new();
    let words = r"\u001b[31m\u000a::error file=/etc/passwd::pwned\u000a##[add-mask]x";
    let error = say(&format!(r#"{{"reply":"error","reason":"{words}"}}"#));
    let refusal = say(r#"{"reply":"refused","reason":"=HYPERLINK(\"http://x\",\"y\")"}"#);
    let dies = r"printf 'x\n\033[2J::stop-commands::x\n' >&2; exit 3";
    let noise = r"printf 'no reply \033[31m\n'";
    for (out, answer, kept) in [
        ("a", &*error, "[31m"),
        ("b", &refusal, "'=HYPERLINK("),
        ("c", dies, "stop-commands"),
        ("d", noise, "no reply"),
    ] {
        experiment(&at, &fake(&[("load", answer)]));
        harmless(out, &at.run(&format!("run h.toml --out {out}")));
        let summary = at.read(&format!("{out}/summary.csv"));
        assert!(summary.contains(kept), "{out}: {summary}");
        let formula = |cell: &str| cell.trim_start_matches('"').starts_with(['=', '+', '@']);
        assert!(!summary.split([',', '\n']).any(formula), "{out}: {summary}");
        assert!(!summary.contains(['\x1b', '\r']), "{out}: {summary:?}");
        harmless(out, &at.run("check --runner 'sh runner.sh' --seconds 0"));
    }
    experiment(&at, &say(r#"{"reply":"hello","protocol":9,"detector":"\u001b[31m"}"#));
    harmless("hello", &at.run("check --runner 'sh runner.sh'"));
}

#[cfg(unix)]
#[test]
fn names_and_lines_of_files_give_no_commands() {
    let at = Place::new();
    let (name, none) = ("\x1b[31m\n::error::a.csv", "::add-mask::\x07none.csv");
    at.file(name, "x,y,r\n0,0,1\n1,0,1\n0,0,0.1\n");
    at.file("pairs.csv", "i,j\n0,1\n");
    at.file("grading", "\x1b]0;1\x07 passes\n1 2 3\n");
    at.file("bad.csv", "x,y,\x1b[2J\n\x1b[31m,2,3\n");
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
        harmless(&format!("{arguments:?}"), &run(at.root(), arguments));
    }
}
