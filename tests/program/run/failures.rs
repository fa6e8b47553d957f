//! Tests runners that crash, hang, give wrong answers or are missing.

use contactbench::record::row::{Outcome, Pass, Row};

use super::{EMPTY, HEAD, SPARSE, of, rows};
use crate::common::{PROGRAM, Place, answers, fake, runner, sample, say};

/// A runner with impossible numbers counts as crashed, in a run and in `check`, with the reason.
#[test]
fn impossible_numbers_are_refused() {
    let fields = r#""time_ns":1000000000000000,"calls":1,"elapsed_ns":1000000000000000"#;
    let ages = format!(r#"{{"reply":"sample",{fields},"contacts":0,"digest":"{EMPTY}"}}"#);
    let fields = r#""peak_bytes":5,"live_bytes":9,"allocations":1"#;
    let memory = format!(r#"{{"reply":"memory",{fields},"contacts":0,"digest":"{EMPTY}"}}"#);
    let cases = [
        ("ages", answers(&[("sample", &say(&ages))]), "nanoseconds"),
        ("shrinks", answers(&[("memory", &say(&memory))]), "peak_bytes 5 and live_bytes 9"),
    ];
    let runners: String = cases.iter().map(|(name, text, _)| runner(name, "sh", text)).collect();
    let (at, rows) = rows(&format!("detectors = [\"nbs\"]\n{SPARSE}{runners}"), 1);
    for (name, script, words) in &cases {
        let own = of(&rows, name, 25);
        let last = own.last().unwrap();
        assert_eq!((own.len(), last.outcome), (3, Outcome::Crashed), "{own:?}");
        assert!(last.reason.contains("protocol") && last.reason.contains(words));
        assert!(own.iter().all(|row| row.time_ns.is_none() && row.peak_bytes.is_none()));
        at.file("one.sh", script);
        let words = ["protocol", words];
        at.ends(1, "check --runner 'sh one.sh' --seconds 0", &words);
    }
    assert!(of(&rows, "nbs", 25).iter().all(|row| row.outcome == Outcome::Ok));
}

/// Cases: name, program, script, outcomes of count, memory and time, words of the last reason.
fn cases() -> Vec<(&'static str, &'static str, String, [Outcome; 3], &'static str)> {
    use Outcome::*;
    let right = sample(0, EMPTY);
    let late = |code: &str| answers(&[("sample", code)]);
    let load = |code: &str| fake(&[("load", code)]);
    let loaded = say(r#"{"reply":"loaded"}"#);
    let gone = say(r#"{"reply":"unavailable","reason":"the library is missing"}"#);
    let error = say(r#"{"reply":"error","reason":"no such thing"}"#);
    let flat = say(r#"{"reply":"refused","reason":"too flat"}"#);
    let old = say(r#"{"reply":"hello","protocol":0,"detector":"old"}"#);
    let strays = answers(&[("count", &loaded), ("sample", &right)]);
    let skips = fake(&[("sample", &right)]);
    // An array of 9·10^9 cells, which the detector may allocate, but not its process.
    let greedy = format!("exec {PROGRAM} runner --detector screening --memory-limit 99000000000");
    let stray = "Loaded";
    let loud = "yes 0123456789 | head -c 5000000 >&2; exit 3";
    vec![
        ("empty", "sh", late(&right), [Ok, Ok, Wrong], "pairs"),
        ("other", "sh", late(&sample(7, "0x0123456789abcdef")), [Ok, Ok, Wrong], "pairs"),
        ("exits", "sh", late("echo so be it >&2; exit 3"), [Ok, Ok, Crashed], "so be it"),
        ("dies", "sh", load("kill -9 $$"), [Crashed; 3], "signal: 9"),
        ("babbles", "sh", late(&say(&"x".repeat(100))), [Ok, Ok, Crashed], "xxx"),
        ("floods", "sh", late("exec cat /dev/zero"), [Ok, Ok, Crashed], "reply"),
        ("bytes", "sh", late(r"printf 'a\377b\n'"), [Ok, Ok, Crashed], "UTF-8: a\u{fffd}b"),
        ("long", "sh", late("yes x | tr -d '\\n'"), [Ok, Ok, Crashed], "1 MiB: xxx"),
        ("many", "sh", late("yes"), [Ok, Ok, Crashed], "printed 'y'"),
        ("errors", "sh", late(loud), [Ok, Ok, Crashed], "exit status: 3: 01"),
        ("repeats", "sh", load(r#"exec yes '{"reply":"loaded"}'"#), [Crashed; 3], stray),
        ("strays", "sh", strays, [Crashed; 3], stray),
        ("skips-load", "sh", skips, [Crashed; 3], "Load"),
        ("hangs", "sh", late("exec sleep 60"), [Ok, Ok, Timeout], "1 s"),
        ("declines", "sh", load(&flat), [Refused; 3], "too flat"),
        ("errs", "sh", load(&error), [Crashed; 3], "no such thing"),
        ("absent", "/no/such/program", String::new(), [Unavailable; 3], "apt install it"),
        ("gone", "sh", gone, [Unavailable; 3], "the library is missing"),
        ("old", "sh", old, [Unavailable; 3], "speaks protocol 0"),
        ("vague", "sh", fake(&[]).replace("f64", "about"), [Unavailable; 3], "'about'"),
        ("greedy", "sh", greedy, [OutOfMemory; 3], ""),
    ]
}

#[test]
fn each_failure_has_its_outcome_and_costs_no_other_runner_anything() {
    let cases = cases();
    let runners: String =
        cases.iter().map(|(name, program, script, ..)| runner(name, program, script)).collect();
    // 100 discs in rows of 10, 3000 diameters apart.
    let text = format!(
        "time-limit-s = 1\nmemory-limit-mib = 1\ndetectors = [\"screening\", \"nbs\"]\n\
         [[scene]]\nname = \"pack-c\"\nn = 100\ns = 3000\n[[scene]]\nname = \"packed\"\nn = [100, \
         400]\n{runners}"
    );
    let (_at, rows) = rows(&text, 1);
    let (dense, sparse): (Vec<Row>, Vec<Row>) =
        rows.into_iter().partition(|row| row.id.scene == "packed");
    for (name, _, _, outcomes, words) in &cases {
        let cell = of(if *name == "greedy" { &sparse } else { &dense }, name, 100);
        for (pass, outcome) in [Pass::Count, Pass::Memory, Pass::Time].iter().zip(outcomes) {
            let row = cell.iter().rfind(|row| row.pass == *pass);
            let row = row.unwrap_or_else(|| panic!("{name}: no row for {pass:?}"));
            assert_eq!(row.outcome, *outcome, "{name}, {pass:?}: {}", row.reason);
        }
        let last = cell.last().unwrap();
        assert!(last.reason.contains(words), "{name}: {}", last.reason);
        assert!(last.reason.len() < 500, "{name}: {}", last.reason);
        let untimed = |row: &&Row| row.time_ns.is_none() || row.outcome == Outcome::Wrong;
        assert!(cell.iter().all(untimed), "{name}: a time without a right answer");
    }
    // An empty answer is right if the scene has no contacts.
    let alone = of(&sparse, "empty", 100);
    let right = |row: &&&Row| row.outcome == Outcome::Ok && row.time_ns == Some(300_000);
    assert_eq!(alone.iter().filter(right).count(), 1, "{alone:?}");
    let other = of(&sparse, "other", 100);
    assert!(other.iter().all(|row| row.outcome == Outcome::Wrong || row.pass != Pass::Time));
    // The runner is too slow with 100 particles, so it is not tried with 400.
    let late = of(&dense, "hangs", 400);
    let untried = |row: &&Row| row.outcome == Outcome::Timeout && row.reason.contains("not tried");
    assert!(late.len() == 3 && late.iter().all(untried), "{late:?}");
    // screening refuses the scene itself; its process does not exceed a limit.
    for row in of(&sparse, "screening", 100) {
        assert!(row.outcome == Outcome::Refused && row.reason.contains("1048576 bytes"), "{row:?}");
    }
    for (rows, n) in [(&sparse, 100), (&dense, 100), (&dense, 400)] {
        let nbs = of(rows, "nbs", n);
        assert!(nbs.len() == 3 && nbs.iter().all(|row| row.outcome == Outcome::Ok), "{nbs:?}");
    }
}

#[test]
fn pairs_that_are_wrong_are_counted_and_never_taken_from_another_runner() {
    let one = sample(1, "0x910a2dec89025cc1");
    // Shell code that writes one pair, (0, 1), which does not touch.
    let write = r#"f=${line#*path\":\"}; { printf '\223NUMPY\001\000\166\000'; printf "%-117s\n" "{'descr': '<u4', 'fortran_order': False, 'shape': (1, 2), }"; printf '\000\000\000\000\001\000\000\000'; } > "${f%%\"*}"; echo "{\"reply\":\"pairs\",\"contacts\":1}""#;
    let open = answers(&[("sample", &one), ("pairs", write)]);
    // A runner that writes other pairs than those whose digest it reported.
    let fickle = answers(&[("sample", &sample(1, "0x0000000000000001")), ("pairs", write)]);
    let text = format!(
        "detectors = [\"nbs\"]\n{SPARSE}{}{}{}",
        runner("open", "sh", &open),
        runner("shut", "sh", &answers(&[("sample", &one)])),
        runner("fickle", "sh", &fickle)
    );
    let (_at, rows) = rows(&text, 1);
    for (name, words, errors) in [
        ("open", "0 missed, 1 spurious, 0 duplicate", Some((0, 1, 0))),
        ("shut", "could not be read", None),
        ("fickle", "reported digest", None),
    ] {
        let own = of(&rows, name, 25);
        let row = own.iter().find(|row| row.pass == Pass::Time).unwrap();
        assert!(row.outcome == Outcome::Wrong && row.reason.contains(words), "{row:?}");
        let found = row.errors.map(|errors| (errors.missed, errors.spurious, errors.duplicate));
        assert_eq!(found, errors, "{name}");
    }
}

/// A wrong answer is printed once, above everything else, on the terminal and on every page.
#[test]
fn who_is_wrong_comes_first_and_once() {
    let at = Place::new();
    let none = format!(r#"{{"reply":"count","counts":{{}},"contacts":0,"digest":"{EMPTY}"}}"#);
    let script = answers(&[("count", &say(&none))]);
    let claim = "[[claim]]\nname = \"c\"\nkind = \"at-most\"\nvalue = 1\nto = 2\nwhere = { \
                 detector = \"nbs\" }\n";
    let scene = "[[scene]]\nname = \"packed\"\nn = [20, 30]\n";
    let runner = runner("fake", "sh", &script);
    at.file("t.toml", format!("{HEAD}detectors = [\"nbs\"]\n{scene}{claim}{runner}"));
    let line = "run t.toml --out out --annotations";
    let ended = at.ends(1, line, &["1 of 1 claims hold"]);
    assert!(ended.stdout.starts_with("WRONG: fake in 2 "), "{}", ended.stdout);
    let said = |text: &str| text.lines().filter(|line| line.starts_with("WRONG")).count();
    assert_eq!((said(&ended.stdout), said(&ended.stderr)), (1, 1), "{}", ended.stderr);
    assert_eq!(ended.stdout.matches("::error ").count(), 1, "{}", ended.stdout);
    let report = at.read("out/report.md");
    assert!(report.lines().nth(2).unwrap().starts_with("> Warning: WRONG: fake"), "{report}");
    assert!(at.read("out/report.html").contains("WRONG: fake in 2 "));
    std::fs::create_dir(at.path("empty")).unwrap();
    at.ends(2, "report empty", &["samples.jsonl"]);
    at.ends(2, "report .", &["such as ./out"]);
}
