//! Runners that crash, hang, lie or are not there.

use contactbench::record::row::{Outcome, Pass, Row};

use super::{HEAD, of, rows, takes_its_time};
use crate::common::{PROGRAM, fake, runner, say};

/// What no runner can have measured costs it its rows, with the reason; `check` says the same. What
/// that is, is tested where it is decided, in `run/possible`.
#[test]
fn impossible_numbers_are_refused() {
    let loaded = say(r#"{"reply":"loaded"}"#);
    let unsupported = say(r#"{"reply":"unsupported"}"#);
    let none = r#""contacts":0,"digest":"0x0000000000000000""#;
    let sample = |times: &str| {
        let sample =
            format!("sleep 0.002; {}", say(&format!(r#"{{"reply":"sample",{times},{none}}}"#)));
        fake(&[
            ("load", &loaded),
            ("count", &unsupported),
            ("memory", &unsupported),
            ("sample", &sample),
        ])
    };
    let memory = |bytes: &str| {
        let memory = say(&format!(r#"{{"reply":"memory",{bytes},{none}}}"#));
        fake(&[("load", &loaded), ("count", &unsupported), ("memory", &memory)])
    };
    let cases = [
        (
            "ages",
            sample(r#""time_ns":1000000000000000,"calls":1,"elapsed_ns":1000000000000000"#),
            "are these nanoseconds?",
        ),
        (
            "shrinks",
            memory(r#""peak_bytes":5,"live_bytes":9,"allocations":1"#),
            "peak_bytes 5 and live_bytes 9",
        ),
    ];
    let runners: String =
        cases.iter().map(|(name, script, _)| runner(name, "sh", script)).collect();
    let text = format!(
        "{HEAD}detectors = [\"nbs\"]\n[[scene]]\nname = \"pack-c\"\nn = 25\ns = 5\n{runners}"
    );
    let folder = tempfile::tempdir().unwrap();
    let (rows, code, stderr) = rows(folder.path(), &text);
    assert_eq!(code, Some(1), "those that crash everywhere are failures: {stderr}");
    for (name, script, words) in &cases {
        let own = of(&rows, name, 25);
        let last = own.last().unwrap();
        assert_eq!((own.len(), last.outcome), (3, Outcome::Crashed), "{own:?}");
        assert!(
            last.reason.starts_with("the runner breaks the protocol: ")
                && last.reason.contains(words),
            "{name}: {}",
            last.reason
        );
        assert!(own.iter().all(|row| row.time_ns.is_none() && row.peak_bytes.is_none()));
        crate::common::file(folder.path(), "one.sh", script);
        let ended = crate::common::run(
            folder.path(),
            &["check", "--runner", "sh one.sh", "--seconds", "0"],
        );
        let said = words.rsplit(" ns, it ").next().unwrap();
        assert!(
            ended.code == Some(1)
                && ended.stdout.contains("breaks the protocol")
                && ended.stdout.contains(said),
            "{name}: {}",
            ended.stdout
        );
    }
    assert!(of(&rows, "nbs", 25).iter().all(|row| row.outcome == Outcome::Ok));
}

#[test]
fn each_failure_has_its_outcome_and_costs_no_other_runner_anything() {
    let loaded = ("load", say(r#"{"reply":"loaded"}"#));
    let unsupported = say(r#"{"reply":"unsupported"}"#);
    let sample = |contacts: u32, digest: &str| {
        let reply = format!(r#""contacts":{contacts},"digest":"{digest}""#);
        ("sample", takes_its_time(&reply))
    };
    let empty = sample(0, "0x0000000000000000");
    let other = sample(7, "0x0123456789abcdef");
    let script = |answers: &[&(&str, String)]| {
        let quiet = [("count", &unsupported), ("memory", &unsupported), ("pairs", &unsupported)];
        let answers: Vec<(&str, &str)> = answers
            .iter()
            .map(|(r, code)| (*r, code.as_str()))
            .chain(quiet.map(|(r, c)| (r, c.as_str())))
            .collect();
        fake(&answers)
    };
    let long = "x".repeat(100);
    let gone = say(r#"{"reply":"unavailable","reason":"the library is missing"}"#);
    // Name, program, script, outcomes of count, memory and time, and words of the reason of the
    // last.
    use Outcome::*;
    let cases: Vec<(&str, &str, String, [Outcome; 3], &str)> = vec![
        ("empty", "sh", script(&[&loaded, &empty]), [Ok, Ok, Wrong], "could not be read"),
        ("other", "sh", script(&[&loaded, &other]), [Ok, Ok, Wrong], "could not be read"),
        (
            "exits",
            "sh",
            script(&[&loaded, &("sample", "echo so be it >&2; exit 3".into())]),
            [Ok, Ok, Crashed],
            "so be it",
        ),
        ("dies", "sh", script(&[&("load", "kill -9 $$".into())]), [Crashed; 3], "signal: 9"),
        (
            "babbles",
            "sh",
            script(&[&loaded, &("sample", say(&long))]),
            [Ok, Ok, Crashed],
            "is not a reply",
        ),
        (
            "floods",
            "sh",
            script(&[&loaded, &("sample", "exec cat /dev/zero".into())]),
            [Ok, Ok, Crashed],
            "is not a reply",
        ),
        (
            "repeats",
            "sh",
            script(&[&("load", format!("exec yes '{}'", r#"{"reply":"loaded"}"#))]),
            [Crashed; 3],
            "answered Count with Loaded",
        ),
        (
            "strays",
            "sh",
            script(&[&loaded, &("count", loaded.1.clone()), &empty]),
            [Crashed; 3],
            "answered Count with Loaded",
        ),
        (
            "skips-load",
            "sh",
            script(&[&("load", unsupported.clone()), &empty]),
            [Crashed; 3],
            "answered Load",
        ),
        (
            "hangs",
            "sh",
            script(&[&loaded, &("sample", "exec sleep 60".into())]),
            [Ok, Ok, Timeout],
            "no answer within 1 s",
        ),
        (
            "declines",
            "sh",
            script(&[&("load", say(r#"{"reply":"refused","reason":"too flat"}"#))]),
            [Refused; 3],
            "too flat",
        ),
        (
            "errs",
            "sh",
            script(&[&("load", say(r#"{"reply":"error","reason":"no such thing"}"#))]),
            [Crashed; 3],
            "no such thing",
        ),
        ("absent", "/no/such/program", String::new(), [Unavailable; 3], "apt install it"),
        ("gone", "sh", gone, [Unavailable; 3], "the library is missing"),
        (
            "old",
            "sh",
            say(r#"{"reply":"hello","protocol":0,"detector":"old"}"#),
            [Unavailable; 3],
            "speaks protocol 0",
        ),
        ("vague", "sh", fake(&[]).replace("f64", "about"), [Unavailable; 3], "arithmetic 'about'"),
        // An array of 9·10^9 cells, which the runner is allowed but its address space is not:
        // limit, and 1 GiB for the program.
        (
            "greedy",
            "sh",
            format!("exec {PROGRAM} runner --detector screening --memory-limit 99000000000"),
            [OutOfMemory; 3],
            "could not be had",
        ),
    ];
    let runners: String =
        cases.iter().map(|(name, program, script, ..)| runner(name, program, script)).collect();
    // 100 discs, 3000 diameters apart in a row of 10.
    let text = format!(
        "{HEAD}time-limit-s = 1\nmemory-limit-mib = 1\ndetectors = [\"screening\", \
         \"nbs\"]\n[[scene]]\nname = \"pack-c\"\nn = 100\ns = 3000\n[[scene]]\nname = \
         \"packed\"\nn = [100, 400]\n{runners}"
    );
    let folder = tempfile::tempdir().unwrap();
    let (rows, code, stderr) = rows(folder.path(), &text);
    assert_eq!(code, Some(1), "wrong answers are an error: {stderr}");
    let dense: Vec<Row> = rows.iter().filter(|row| row.id.scene == "packed").cloned().collect();
    let sparse: Vec<Row> = rows.iter().filter(|row| row.id.scene == "pack-c").cloned().collect();
    for (name, _, _, outcomes, words) in &cases {
        let cell = of(if *name == "greedy" { &sparse } else { &dense }, name, 100);
        for (pass, outcome) in [Pass::Count, Pass::Memory, Pass::Time].iter().zip(outcomes) {
            let row = cell
                .iter()
                .rfind(|row| row.pass == *pass)
                .unwrap_or_else(|| panic!("{name}: no row for {pass:?}"));
            assert_eq!(row.outcome, *outcome, "{name}, {pass:?}: {}", row.reason);
        }
        let last = cell.last().unwrap();
        assert!(last.reason.contains(words), "{name}: {}", last.reason);
        assert!(
            cell.iter().all(|row| row.time_ns.is_none() || row.outcome == Wrong),
            "{name}: a time without a right answer"
        );
    }
    // Nothing is a wrong answer where there is something to be found, and the right one where there
    // is not.
    let alone = of(&sparse, "empty", 100);
    assert_eq!(
        alone.iter().filter(|row| row.outcome == Ok && row.time_ns == Some(300_000)).count(),
        2,
        "{alone:?}"
    );
    assert!(
        of(&sparse, "other", 100).iter().all(|row| row.outcome == Wrong || row.pass != Pass::Time)
    );
    // Too slow with 100 particles: not tried with 400.
    assert!(
        of(&dense, "hangs", 400)
            .iter()
            .all(|row| row.outcome == Timeout && row.reason.contains("not tried"))
    );
    assert_eq!(of(&dense, "hangs", 400).len(), 3);
    // Refused by the detector itself, with numbers and remedy.
    let refused = of(&sparse, "screening", 100);
    assert_eq!(refused.len(), 3);
    assert!(
        refused.iter().all(|row| row.outcome == Refused
            && row.reason.contains("the limit is 1048576 bytes; raise the memory limit")),
        "{refused:?}"
    );
    for (rows, n) in [(&sparse, 100), (&dense, 100), (&dense, 400)] {
        assert!(
            of(rows, "nbs", n).iter().all(|row| row.outcome == Ok) && of(rows, "nbs", n).len() == 4
        );
    }
}

#[test]
fn pairs_that_are_wrong_are_counted_and_never_taken_from_another_runner() {
    let digest = r#""contacts":1,"digest":"0x910a2dec89025cc1""#;
    let sample = takes_its_time(digest);
    // One pair, (0, 1), which is none of the scene's.
    let write = r#"f=${line#*path\":\"}; { printf '\223NUMPY\001\000\166\000'; printf "%-117s\n" "{'descr': '<u4', 'fortran_order': False, 'shape': (1, 2), }"; printf '\000\000\000\000\001\000\000\000'; } > "${f%%\"*}"; echo "{\"reply\":\"pairs\",\"contacts\":1}""#;
    let unsupported = say(r#"{"reply":"unsupported"}"#);
    let loaded = say(r#"{"reply":"loaded"}"#);
    // A runner that hands over another list than the one it was judged by.
    let other = sample.replace("0x910a2dec89025cc1", "0x0000000000000001");
    let answering = |sample: &str, pairs: &str| {
        fake(&[
            ("load", &loaded),
            ("sample", sample),
            ("pairs", pairs),
            ("", ""),
            ("count", &unsupported),
            ("memory", &unsupported),
        ])
    };
    let text = format!(
        "{HEAD}detectors = [\"nbs\"]\n[[scene]]\nname = \"pack-c\"\nn = 25\ns = 5\n{}{}{}",
        runner("open", "sh", &answering(&sample, write)),
        runner("shut", "sh", &answering(&sample, &unsupported)),
        runner("fickle", "sh", &answering(&other, write))
    );
    let folder = tempfile::tempdir().unwrap();
    let (rows, code, stderr) = rows(folder.path(), &text);
    assert_eq!(code, Some(1), "{stderr}");
    for row in of(&rows, "open", 25).iter().filter(|row| row.pass == Pass::Time) {
        assert_eq!(row.outcome, Outcome::Wrong);
        assert_eq!(
            row.reason,
            "against the true pairs in f64: 0 missed, 1 spurious, 0 duplicate, widest gap 8.0e0 \
             r"
        );
        assert_eq!(
            row.errors.map(|errors| (errors.missed, errors.spurious, errors.duplicate)),
            Some((0, 1, 0))
        );
    }
    for row in of(&rows, "shut", 25).iter().filter(|row| row.pass == Pass::Time) {
        assert!(
            row.outcome == Outcome::Wrong
                && row.errors.is_none()
                && row.reason.contains("could not be read"),
            "{row:?}"
        );
    }
    for row in of(&rows, "fickle", 25).iter().filter(|row| row.pass == Pass::Time) {
        assert!(
            row.outcome == Outcome::Wrong
                && row.errors.is_none()
                && row.reason.contains("it gave others"),
            "{row:?}"
        );
    }
}

/// A runner of the experiment's own that cannot start is named with the reason and fails the run,
/// unless it is optional; one that crashed in every scene fails it, too.
#[test]
fn a_runner_that_cannot_start_fails_the_run_unless_it_is_optional() {
    let crashes = fake(&[("load", "exit 3")]);
    let crashes = runner("mine", "sh", &crashes);
    let absent = "[[runner]]\nname = \"mine\"\ncommand = [\"./nothere\"]\n";
    let optional = format!("{absent}optional = true\n");
    let installed = format!("{absent}install = \"make\"\n");
    for (runner, code, words) in [
        (absent, 1, "NOT STARTED: mine, in 2 of its 2 cells, first in experiment = t"),
        (&*crashes, 1, "CRASHED: mine, in 2 of its 2 cells"),
        (&optional, 0, "NOT STARTED: mine, in 2 of its 2 cells"),
        (&installed, 0, "NOT STARTED: mine, in 2 of its 2 cells"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let scene = "[[scene]]\nname = \"packed\"\nn = [50, 60]\n";
        let text = format!("{HEAD}detectors = [\"nbs\"]\n{scene}{runner}");
        crate::common::file(folder, "t.toml", text);
        let summary = ["--summary", "a.md", "--junit", "a.xml"];
        let run = [&["run", "t.toml", "--out", "result"][..], &summary].concat();
        let ended = crate::common::run(folder, &run);
        assert_eq!(ended.code, Some(code), "{runner}: {}", ended.stdout);
        let words: Vec<&str> = words.split(", ").collect();
        for words in words {
            assert!(ended.stdout.contains(words), "{words}: {}", ended.stdout);
        }
        let summary = std::fs::read_to_string(folder.join("a.md")).unwrap();
        assert_eq!(summary.contains("| failed | record | mine "), code == 1, "{summary}");
        if runner != crashes {
            assert!(ended.stdout.contains("cannot start ./nothere"), "{}", ended.stdout);
        }
        // The report of the record says the same.
        assert_eq!(crate::common::run(folder, &["report", "result"]).code, Some(code));
    }
}
