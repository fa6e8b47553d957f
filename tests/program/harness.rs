//! From experiment files to records, with the program itself and with runners that fail in every
//! way there is: each planned cell has its rows, each failure its outcome and reason, and costs no
//! other runner anything.

use std::collections::BTreeSet;
use std::path::Path;

use contactbench::record::row;
use contactbench::record::row::{Measurement, Outcome, Pass, Row};
use serde_json::Value;

use crate::common::{PROGRAM, fake, runner, say};

const HEAD: &str = "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\nblocks = 2\n";

/// Runs an experiment to its end; gives the rows, the exit code and what was said on standard
/// error.
fn rows(folder: &Path, text: &str) -> (Vec<Row>, Option<i32>, String) {
    crate::common::file(folder, "t.toml", text);
    let ended = crate::common::run(folder, &["run", "t.toml", "--out", "result"]);
    let record = row::read(&folder.join("result/samples.jsonl"));
    (record.unwrap_or_else(|e| panic!("{e}: {}", ended.stderr)).rows, ended.code, ended.stderr)
}

fn of<'a>(rows: &'a [Row], detector: &str, n: u64) -> Vec<&'a Row> {
    rows.iter().filter(|row| row.id.detector == detector && row.id.n == n).collect()
}

/// Shell code that answers with a sample of a time that can be.
fn takes_its_time(fields: &str) -> String {
    let times = r#""time_ns":300000,"calls":1,"elapsed_ns":300000"#;
    format!("sleep 0.002; {}", say(&format!(r#"{{"reply":"sample",{times},{fields}}}"#)))
}

/// What no runner can have measured costs it its rows, with the reason; `check` says the same.
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
        ("zero", sample(r#""time_ns":0,"calls":1,"elapsed_ns":0"#), "every detection takes time"),
        (
            "tenth",
            sample(r#""time_ns":30000,"calls":1,"elapsed_ns":300000"#),
            "time_ns is elapsed_ns / calls, rounded",
        ),
        (
            "ages",
            sample(r#""time_ns":1000000000000000,"calls":1,"elapsed_ns":1000000000000000"#),
            "are these nanoseconds?",
        ),
        ("never", sample(r#""time_ns":5,"calls":0,"elapsed_ns":300000"#), "calls 0"),
        (
            "short",
            sample(r#""time_ns":5,"calls":1,"elapsed_ns":5"#),
            "asked for 2000000 ns, it measured only 5 ns",
        ),
        (
            "shrinks",
            memory(r#""peak_bytes":5,"live_bytes":9,"allocations":1"#),
            "peak_bytes 5 and live_bytes 9",
        ),
        (
            "huge",
            memory(r#""peak_bytes":18446744073709551615,"live_bytes":9,"allocations":1"#),
            "bytes of address space",
        ),
    ];
    let runners: String =
        cases.iter().map(|(name, script, _)| runner(name, "sh", script)).collect();
    let text = format!(
        "{HEAD}detectors = [\"nbs\"]\n[[scene]]\nname = \"pack-c\"\nn = 25\ns = 5\n{runners}"
    );
    let folder = tempfile::tempdir().unwrap();
    let (rows, code, stderr) = rows(folder.path(), &text);
    assert_eq!(code, Some(0), "{stderr}");
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
        // Where every sample is wrong, `check` looks for the simplest scene first.
        if !["ages", "shrinks"].contains(name) {
            continue;
        }
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
fn every_planned_cell_has_its_rows_and_the_answers_are_right() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "{HEAD}detectors = [\"screening\", \"nbs\", \"nothing\"]\narithmetics = \
         [\"f32\", \"exact\"]\n[[scene]]\nname = \"packed\"\ndim = [2, 3]\nn = [0, 60]\nseed = \
         [1, 2]\n[[scene]]\nname = \"pack-c\"\nn = 16\ns = [1, 3]\n"
    );
    let (rows, code, _) = rows(folder.path(), &text);
    assert_eq!(code, Some(0));
    let keys: BTreeSet<Measurement> = rows.iter().map(Row::measurement).collect();
    assert_eq!(keys.len(), rows.len(), "no cell has two rows");
    // Packed: 2 dimensions, 2 sizes, 2 seeds; pack C: 2 spacings. 3 detectors, 2 arithmetics, and
    // a twin in the first of them; counts, memory and 2 blocks.
    assert_eq!(rows.len(), (2 * 2 * 2 + 2) * (3 * 2 + 1) * (1 + 1 + 2));
    for row in &rows {
        assert_eq!(
            row.outcome,
            if row.id.detector == "nothing" { Outcome::Control } else { Outcome::Ok },
            "{row:?}"
        );
        assert_eq!(row.block > 0, row.pass == Pass::Time);
        assert_eq!(row.time_ns.is_some(), row.pass == Pass::Time);
        assert_eq!(row.peak_bytes.is_some(), row.pass == Pass::Memory);
        assert_eq!(row.counts.is_empty(), row.pass != Pass::Count);
        let others = rows
            .iter()
            .filter(|other| other.stats == row.stats && other.id.arithmetic == row.id.arithmetic);
        assert!(
            row.id.detector == "nothing"
                || others.filter(|o| o.id.detector != "nothing").all(|o| o.digest == row.digest)
        );
    }
    assert!(rows.iter().any(|row| row.contacts > Some(60)), "the packed scenes have contacts");
    let nothing = rows.iter().find(|row| row.id.detector == "nothing" && row.id.n == 60).unwrap();
    assert_eq!((nothing.contacts, nothing.reason.contains("control")), (Some(0), true));
}

#[test]
fn a_row_has_the_fields_of_the_format() {
    let folder = tempfile::tempdir().unwrap();
    let (rows, ..) = rows(
        folder.path(),
        &format!("{HEAD}detectors = [\"nbs\"]\n[[scene]]\nname = \"loose\"\nn = 20\n"),
    );
    assert!(!rows.is_empty());
    let names =
        |value: &Value| value.as_object().unwrap().keys().cloned().collect::<BTreeSet<String>>();
    let text = std::fs::read_to_string(folder.path().join("result/samples.jsonl")).unwrap();
    let published = "experiment scene params dim n seed order detector arithmetic pass \
                     block time_ns outcome reason contacts digest counts peak_bytes live_bytes \
                     allocations formula_bytes stats";
    // What the format has beyond the fields promised.
    let more = "first_ns calls elapsed_ns warm_allocations errors causes schema machine role resources \
         process check";
    let expected: BTreeSet<String> =
        published.split_whitespace().chain(more.split_whitespace()).map(String::from).collect();
    for line in text.lines() {
        let row: Value = serde_json::from_str(line).unwrap();
        let mut said = names(&row);
        let timed = row["pass"] == "time" && cfg!(target_os = "linux");
        for place in ["span", "processor"] {
            assert_eq!(said.remove(place), timed, "{line}");
        }
        assert_eq!(said, expected);
        let stats =
            ["box_diameters", "coordination", "packing_fraction", "radius_ratio", "scene_hash"];
        assert_eq!(names(&row["stats"]), stats.map(String::from).into());
        for whole in ["dim", "n", "seed", "block", "contacts"] {
            assert!(row[whole].is_u64(), "{whole} in {line}");
        }
        assert!(row["resources"]["threads"].is_u64(), "{line}");
        assert_eq!(row["time_ns"].is_u64(), row["pass"] == "time");
        assert_eq!(row["first_ns"].is_u64(), row["pass"] == "time");
        // A sample is many detections, however short one is.
        if row["pass"] == "time" {
            let (calls, elapsed) = (&row["calls"], &row["elapsed_ns"]);
            assert!(calls.as_u64() > Some(100) && elapsed.as_u64() > Some(1_000_000), "{line}");
        }
        assert_eq!(row["digest"].as_str().unwrap().len(), "0x".len() + 16);
        assert_eq!(row["outcome"], "ok");
    }
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
            "memory allocation",
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
            && row.reason.contains("the limit is 1048576; raise the memory limit")),
        "{refused:?}"
    );
    for (rows, n) in [(&sparse, 100), (&dense, 100), (&dense, 400)] {
        assert!(
            of(rows, "nbs", n).iter().all(|row| row.outcome == Ok) && of(rows, "nbs", n).len() == 4
        );
    }
}

#[test]
fn a_runner_of_version_1_is_given_the_path_of_its_scene() {
    let path = r#"case "$line" in *'"path":"'*scene-0.npy*) echo '{"reply":"loaded"}' ;; *) echo '{"reply":"error","reason":"no path"}' ;; esac"#;
    let sample = takes_its_time(r#""contacts":0,"digest":"0x0000000000000000""#);
    let unsupported = say(r#"{"reply":"unsupported"}"#);
    let new = fake(&[
        ("load", path),
        ("sample", &sample),
        ("count", &unsupported),
        ("memory", &unsupported),
    ]);
    let old = new.replace("\"protocol\":2", "\"protocol\":1");
    assert_ne!(old, new);
    let text = format!(
        "{HEAD}detectors = [\"nbs\"]\n[[scene]]\nname = \"pack-c\"\nn = 25\ns = 5\n{}{}",
        runner("old", "sh", &old),
        runner("new", "sh", &new)
    );
    let folder = tempfile::tempdir().unwrap();
    let (rows, _, stderr) = rows(folder.path(), &text);
    let old = of(&rows, "old", 25);
    assert!(old.len() == 4 && old.iter().all(|row| row.outcome == Outcome::Ok), "{stderr}");
    let new = of(&rows, "new", 25);
    assert!(new.iter().all(|row| row.reason == "no path"), "{new:?}");
}

#[test]
fn memory_is_measured_with_the_threads_of_the_row() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "{HEAD}threads = [1, 2]\ndetectors = [\"cell-grid\"]\n[[scene]]\nname = \"packed\"\nn = \
         400\n"
    );
    let (rows, code, stderr) = rows(folder.path(), &text);
    assert_eq!(code, Some(0), "{stderr}");
    let memory = |threads| {
        let row = rows.iter().find(|row| row.pass == Pass::Memory && row.id.threads() == threads);
        (row.unwrap().peak_bytes.unwrap(), row.unwrap().formula_bytes.unwrap())
    };
    let contacts = rows[0].contacts.unwrap();
    let ((peak, formula), (peak_of_two, formula_of_two)) = (memory(1), memory(2));
    assert_eq!(peak, formula);
    // The contacts that the threads have found are collected, and in the formula; what their lists
    // are listed in is not.
    assert!(contacts > 400 && formula_of_two >= peak + 8 * contacts, "{formula_of_two}, {peak}");
    let lists = formula_of_two..formula_of_two + (16 << 10);
    assert!(lists.contains(&peak_of_two), "{peak_of_two}, formula {formula_of_two}");
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
            "against all pairs tested in f64: 0 missed, 1 spurious, 0 duplicate, widest gap 8.0e0 \
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

#[test]
fn a_sequential_detector_is_never_said_to_use_threads() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "{HEAD}threads = 2\ndetectors = [\"direct\", \"nbs\"]\n[[scene]]\nname = \"packed\"\nn = \
         50\n"
    );
    let (rows, code, stderr) = rows(folder.path(), &text);
    assert_eq!(code, Some(0), "{stderr}");
    for (detector, threads) in [("direct", 2), ("nbs", 1)] {
        assert!(
            of(&rows, detector, 50).len() == 4
                && of(&rows, detector, 50).iter().all(|row| row.id.threads() == threads),
            "{detector}"
        );
    }
}

/// Threads 1 and 2; a detector that has a use for them, two that have none, a runner that is told,
/// and one that is there with two only.
fn threaded() -> String {
    let told = format!("exec {PROGRAM} runner --detector direct --threads {{threads}}");
    let particular = format!("[ {{threads}} = 2 ] || exit 7; {told}");
    format!(
        "{HEAD}threads = [1, 2]\nceiling = true\nbound = true\nratios-to = \"nbs\"\ncost-model = \
         true\ndetectors = [\"direct\", \"nbs\", \"nothing\"]\n[[scene]]\nname = \"packed\"\nn = \
         [50, 60]\n{}{}{}",
        runner("told", "sh", &told),
        runner("particular", "sh", &particular),
        runner("deaf", "sh", &format!("exec {PROGRAM} runner --detector sorting"))
    )
}

#[test]
fn threads_are_an_axis_and_copies_run_beside_them() {
    let folder = tempfile::tempdir().unwrap();
    let (rows, code, stderr) = rows(folder.path(), &threaded());
    assert_eq!(code, Some(0), "{stderr}");
    let passes = |detector: &str, threads: u32| -> Vec<(Pass, u32, Outcome)> {
        let mut found: Vec<_> = of(&rows, detector, 60)
            .iter()
            .filter(|row| row.id.threads() == threads)
            .map(|r| (r.pass, r.block, r.outcome))
            .collect();
        found.sort();
        found
    };
    let alone = |outcome| {
        vec![
            (Pass::Time, 1, outcome),
            (Pass::Time, 2, outcome),
            (Pass::Count, 0, outcome),
            (Pass::Memory, 0, outcome),
        ]
    };
    let beside = [
        alone(Outcome::Ok),
        vec![(Pass::Ceiling, 1, Outcome::Ok), (Pass::Ceiling, 2, Outcome::Ok)],
    ]
    .concat();
    for (detector, one, two) in [
        ("direct", alone(Outcome::Ok), beside.clone()),
        ("direct-twin", alone(Outcome::Ok), vec![]),
        ("told", alone(Outcome::Ok), beside),
        ("nbs", alone(Outcome::Ok), vec![]),
        ("nothing", alone(Outcome::Control), vec![]),
        ("deaf", alone(Outcome::Ok), vec![]),
    ] {
        assert_eq!((passes(detector, 1), passes(detector, 2)), (one, two), "{detector}");
    }
    // Without the copies its cell with two threads is whole.
    let two = passes("particular", 2);
    assert_eq!(two[..4], alone(Outcome::Ok));
    assert_eq!(two[4..], [(Pass::Ceiling, 0, Outcome::Unavailable)]);
    for row in rows.iter().filter(|row| row.pass == Pass::Ceiling && row.outcome == Outcome::Ok) {
        assert!(
            row.time_ns > Some(0)
                && row.calls >= Some(2)
                && row.digest.is_some()
                && row.counts.is_empty(),
            "{row:?}"
        );
    }
    let read =
        |name: &str| std::fs::read_to_string(folder.path().join("result").join(name)).unwrap();
    // Two scenes with three contenders of two threads, but that one of them has no time with one.
    assert_eq!(read("threads.csv").lines().count(), 1 + 2 * 2, "{}", read("threads.csv"));
    assert_eq!(
        read("ratios.csv").lines().count(),
        1 + 2 * (2 + 1 + 1 + 2 + 2 + 1),
        "{}",
        read("ratios.csv")
    );
    assert_eq!(
        read("bound.csv").lines().count(),
        1 + 2 * (2 + 1 + 1 + 2 + 1 + 1),
        "{}",
        read("bound.csv")
    );
    let report = read("report.md");
    for words in [
        "### Who is how fast, against nbs",
        "### What threads gain",
        "### How near the memory's bound",
        "### What an operation costs",
    ] {
        assert!(report.contains(words), "{words} is not in the report");
    }
    let provenance: Value = serde_json::from_str(&read("provenance.json")).unwrap();
    let measured = provenance["bandwidth_bytes_per_s"].as_array().unwrap();
    assert!(
        measured.len() == 2 && measured.iter().all(|one| one["triad"].as_f64() > Some(0.0)),
        "{measured:?}"
    );
}

#[test]
fn ceilings_that_a_killed_run_owes_are_measured_when_it_is_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let (before, code, stderr) = rows(
        folder.path(),
        &threaded().replace("bound = true\n", "").replace("n = [50, 60]", "n = 50"),
    );
    assert_eq!(code, Some(0), "{stderr}");
    let keys = |rows: &[Row]| rows.iter().map(Row::measurement).collect::<BTreeSet<_>>();
    let path = folder.path().join("result/samples.jsonl");
    let text = std::fs::read_to_string(&path).unwrap();
    let cut: String =
        text.split_inclusive('\n').filter(|line| !line.contains("\"pass\":\"ceiling\"")).collect();
    assert!(cut.len() < text.len());
    std::fs::write(&path, cut).unwrap();
    let resume =
        || crate::common::run(folder.path(), &["run", "t.toml", "--out", "result", "--resume"]);
    assert_eq!(resume().code, Some(0));
    let after = row::read(&path).unwrap().rows;
    assert_eq!((keys(&after), after.len()), (keys(&before), before.len()));
    assert_eq!(resume().code, Some(0));
    assert_eq!(
        row::read(&path).unwrap().rows.len(),
        before.len(),
        "a complete run has nothing to resume"
    );
}

#[test]
fn an_experiment_that_cannot_be_meant_is_refused() {
    let scene = "[[scene]]\nname = \"packed\"\nn = 10\n";
    let folder = tempfile::tempdir().unwrap();
    for (line, words) in [
        ("detectors = [\"nbs\", \"nbs\"]", "two runners named 'nbs'"),
        ("detectors = [\"nsb\"]", "there is no detector 'nsb'"),
        ("detectors = [\"nbs\"]\ntime-limit-s = -1", "time-limit-s = -1"),
        ("detectors = [\"nbs\"]\ntime-limit-s = inf", "time-limit-s = inf"),
        (
            "detectors = [\"nbs\"]\nmemory-limit-mib = 17592186044416",
            "memory-limit-mib = 17592186044416",
        ),
        ("detectors = [\"nbs\"]\nthreads = 0", "threads = 0"),
        ("detectors = [\"nbs\"]\nthreads = [1, 0]", "threads = 0"),
        ("detectors = [\"nbs\"]\nthreads = []", "threads is empty"),
        ("detectors = [\"nbs\"]\nthreads = [2, 1, 2]", "threads names a number twice"),
        ("detectors = [\"nbs\"]\nthreads = 1000000", "at most 1024"),
        ("detectors = [\"direct\"]\nthreads = 2\nceiling = true", "say threads = [1, 2]"),
        (
            "detectors = [\"nbs\"]\nratios-to = \"sorting\"",
            "ratios-to = \"sorting\": it must be one of",
        ),
        (
            "detectors = [\"nbs\"]\n[[figure]]\nname = \"f\"\ntitle = \"F\"\nx = \"s\"\nx-label = \
             \"s\"\ny = \"n\"\ny-label = \"n\"\ncaches = true",
            "its x must be n",
        ),
        ("detectors = [\"nbs\"]\nblock-budget-s = nan", "budget"),
        ("detectors = [\"nbs\"]\nblokcs = 3", "blokcs"),
        ("detectors = [\"nbs\"]\ntable = \"verdict\"", "verdicts"),
        (
            "detectors = [\"nbs\"]\n[[figure]]\nname = \"f\"\ntitle = \"F\"",
            "line 7, column 1: the key 'x' is missing",
        ),
    ] {
        crate::common::file(folder.path(), "t.toml", format!("{HEAD}{line}\n{scene}"));
        let ended = crate::common::run(folder.path(), &["run", "t.toml", "--out", "result"]);
        assert_eq!(ended.code, Some(2), "{line}");
        assert!(ended.stderr.contains(words), "{line}: {}", ended.stderr);
        assert!(!folder.path().join("result").exists(), "{line}: nothing is written");
    }
    crate::common::file(folder.path(), "t.toml", format!("{HEAD}detectors = [\"nbs\"]\n{scene}"));
    let twice = crate::common::run(folder.path(), &["run", "t.toml", "t.toml", "--out", "result"]);
    assert_eq!(twice.code, Some(2));
    assert!(twice.stderr.contains("two experiments named 't'"), "{}", twice.stderr);
}
