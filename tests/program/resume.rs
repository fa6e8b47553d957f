//! A killed run continues: wherever it stopped, a resumed run ends with the rows of an undisturbed
//! one, and no result is ever written over.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use contactbench::record::row;
use contactbench::record::row::{Measurement, Pass};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rustix::process::{Pid, Signal, kill_process};

use crate::common::{self, Ended, Template, fake, file, run, runner, say};

/// Cells that succeed, are refused, do nothing on purpose, crash in a timed pass (in an arithmetic
/// that only the runner knows), crash at once, and are not there at all.
fn experiment() -> String {
    let loaded = say(r#"{"reply":"loaded"}"#);
    let unsupported = say(r#"{"reply":"unsupported"}"#);
    let fails_late = fake(&[
        ("load", &loaded),
        ("count", &unsupported),
        ("memory", &unsupported),
        ("sample", "exit 3"),
    ]);
    format!(
        "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\nblocks = \
         2\nmemory-limit-mib = 1\ndetectors = [\"nbs\", \"screening\", \
         \"nothing\"]\n[[scene]]\nname = \"pack-c\"\nn = 100\ns = [2, 3000]\n{}{}{}",
        runner("late", "sh", &fails_late),
        runner("early", "sh", &fake(&[("load", "exit 4")])),
        runner("absent", "/no/such/program", "")
    )
}

/// Scenes; rows of nbs, of its twin, of nothing (count, memory, 2 blocks), of late (count, memory, block 1), of
/// early and of absent (one per pass); and screening once good (4 rows), once refused (3).
const ROWS: usize = 2 * (4 + 4 + 4 + 3 + 3 + 3) + 4 + 3;

fn start(folder: &Path, more: &[&str]) -> Ended {
    run(folder, &[&["run", "t.toml", "--out", "result"], more].concat())
}

/// The rows of the result, without their times.
fn steady(folder: &Path) -> BTreeMap<Measurement, String> {
    let record = row::read(&folder.join("result/samples.jsonl")).unwrap();
    assert!(record.warnings.is_empty(), "{:?}", record.warnings);
    common::steady(&record.rows)
}

/// A copy of an undisturbed run in a folder of its own; all tests share one run, and how long it
/// took.
fn undisturbed() -> (tempfile::TempDir, BTreeMap<Measurement, String>, Duration) {
    static RUN: OnceLock<(Template, Duration)> = OnceLock::new();
    let (template, took) = RUN.get_or_init(|| {
        let mut took = Duration::ZERO;
        let template = Template::new(|folder| {
            file(folder, "t.toml", experiment());
            let began = Instant::now();
            let ended = start(folder, &[]);
            took = began.elapsed();
            assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        });
        (template, took)
    });
    let folder = template.copy();
    let rows = steady(folder.path());
    assert_eq!(rows.len(), ROWS, "{rows:#?}");
    (folder, rows, *took)
}

#[test]
fn a_record_that_was_cut_is_completed() {
    let (folder, expected, _) = undisturbed();
    let path = folder.path().join("result/samples.jsonl");
    let whole = std::fs::read_to_string(&path).unwrap();
    let lines: Vec<&str> = whole.split_inclusive('\n').collect();
    // Every third row meets all passes and outcomes.
    for kept in (0..lines.len()).step_by(3) {
        let torn = &lines[kept][..lines[kept].len() / 2];
        std::fs::write(&path, lines[..kept].concat() + torn).unwrap();
        let ended = start(folder.path(), &["--resume"]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        assert!(ended.stderr.contains(&format!("line {} is torn", kept + 1)), "{}", ended.stderr);
        assert!(
            ended.stderr.contains(&format!("resuming: {kept} rows are there already")),
            "{}",
            ended.stderr
        );
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(
            text.starts_with(&lines[..kept].concat()),
            "rows that were there are left as they are"
        );
        assert_eq!(steady(folder.path()), expected, "after {kept} rows");
    }
    let before = std::fs::read(&path).unwrap();
    assert_eq!(start(folder.path(), &["--resume"]).code, Some(0));
    assert_eq!(std::fs::read(&path).unwrap(), before, "a complete run has nothing to resume");
}

/// A seed to repeat a failure with: `CONTACTBENCH_SEED=7 cargo test --test program resume`.
/// Without, another one every time.
fn seed() -> u64 {
    let given = std::env::var("CONTACTBENCH_SEED").ok().and_then(|text| text.parse().ok());
    given.unwrap_or_else(|| {
        std::time::UNIX_EPOCH.elapsed().map_or(1, |since| since.subsec_nanos().into())
    })
}

/// Kills the program after a while, with nothing tidied up.
fn kill_after(mut program: Command, while_: Duration) {
    let mut child = program.stderr(Stdio::null()).stdout(Stdio::null()).spawn().unwrap();
    std::thread::sleep(while_);
    child.kill().unwrap();
    child.wait().unwrap();
}

#[test]
fn a_run_killed_at_random_moments_is_completed() {
    let (_folder, expected, took) = undisturbed();
    let whole = took.as_secs_f64();
    let seed = seed();
    eprintln!("CONTACTBENCH_SEED={seed}, an undisturbed run takes {whole:.2} s");
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut cut_short = 0;
    // More only while none fell into the run.
    for kill in 1..=20 {
        if kill > 10 && cut_short > 0 {
            break;
        }
        let folder = tempfile::tempdir().unwrap();
        file(folder.path(), "t.toml", experiment());
        let (first, second) = (random.random::<f64>(), random.random::<f64>());
        kill_after(
            crate::common::program(folder.path(), &["run", "t.toml", "--out", "result"]),
            Duration::from_secs_f64(whole * first),
        );
        let path = folder.path().join("result/samples.jsonl");
        let readable = || row::read(&path).map_or(0, |record| record.rows.len());
        if path.exists() {
            row::read(&path).unwrap_or_else(|error| panic!("kill {kill} of seed {seed}: {error}"));
        }
        let rows = readable();
        cut_short += usize::from(rows > 0 && rows < ROWS);
        // Every other one is killed when it is resumed, too.
        if kill % 2 == 0 {
            let resumed = crate::common::program(
                folder.path(),
                &["run", "t.toml", "--out", "result", "--resume"],
            );
            kill_after(resumed, Duration::from_secs_f64(whole * second));
            assert!(readable() >= rows, "kill {kill} of seed {seed}: rows were lost");
        }
        let ended = start(folder.path(), &["--resume"]);
        assert_eq!(ended.code, Some(0), "kill {kill} of seed {seed}: {}", ended.stderr);
        assert_eq!(
            steady(folder.path()),
            expected,
            "kill {kill} of seed {seed}: after {first} of the time, {rows} rows"
        );
        eprintln!("kill {kill}: {rows} of {ROWS} rows were there");
    }
    assert!(cut_short > 0, "no kill fell into the run: the test shows nothing");
}

/// A detector that hangs until a file says otherwise; the numbers of its processes are in `pids`.
fn waits() -> String {
    let loaded = say(r#"{"reply":"loaded"}"#);
    let unsupported = say(r#"{"reply":"unsupported"}"#);
    let sample = "[ -e go ] || { sleep 60 & echo $$ >> pids; echo $! >> pids; wait; }; exit 3";
    let script = fake(&[
        ("load", &loaded),
        ("count", &unsupported),
        ("memory", &unsupported),
        ("sample", sample),
    ]);
    experiment() + &runner("waits", "sh", &script)
}

/// Starts a run, and waits until it hangs.
fn hanging(folder: &Path) -> std::process::Child {
    file(folder, "t.toml", waits());
    let mut program = crate::common::program(folder, &["run", "t.toml", "--out", "result"]);
    let child = program.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let began = Instant::now();
    while std::fs::read_to_string(folder.join("pids")).unwrap_or_default().lines().count() < 2 {
        assert!(
            began.elapsed() < Duration::from_secs(120),
            "the run does not come to the detector that hangs"
        );
        std::thread::sleep(Duration::from_millis(20));
    }
    child
}

fn signal(child: &std::process::Child, signal: Signal) {
    kill_process(Pid::from_child(child), signal).unwrap();
}

/// All processes of the detector that hangs have ended.
fn runners_ended(folder: &Path) {
    let pids = std::fs::read_to_string(folder.join("pids")).unwrap();
    let began = Instant::now();
    for pid in pids.lines() {
        let state = || std::fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
        while !(state().is_empty() || state().contains(") Z")) {
            assert!(
                began.elapsed() < Duration::from_secs(10),
                "a runner is left, or what it has started: {}",
                state()
            );
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

#[test]
fn ctrl_c_ends_a_run_with_its_record_and_a_report() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (number, code) in [(Signal::INT, 130), (Signal::TERM, 143)] {
        let child = hanging(folder);
        signal(&child, number);
        let ended = crate::common::ended(child.wait_with_output().unwrap());
        assert_eq!(ended.code, Some(code), "{}", ended.stderr);
        let command = "continue with: contactbench run t.toml --resume --out result";
        assert!(
            ended.stderr.lines().last().is_some_and(|line| line.ends_with(command)),
            "{}",
            ended.stderr
        );
        assert!(
            !ended.stderr.contains("CRASHED: waits"),
            "what was stopped has not crashed: {}",
            ended.stderr
        );
        let record = row::read(&folder.join("result/samples.jsonl")).unwrap();
        assert!(record.warnings.is_empty() && !record.rows.is_empty());
        assert!(
            record.rows.iter().all(|row| row.id.detector != "waits" || row.pass != Pass::Time),
            "a sample that did not end"
        );
        assert!(folder.join("result/report.md").exists());
        runners_ended(folder);
        if number == Signal::INT {
            std::fs::remove_dir_all(folder.join("result")).unwrap();
            std::fs::remove_file(folder.join("pids")).unwrap();
        }
    }
    file(folder, "go", "");
    assert_eq!(start(folder, &["--resume"]).code, Some(0));
    let resumed = steady(folder);
    std::fs::remove_dir_all(folder.join("result")).unwrap();
    assert_eq!(start(folder, &[]).code, Some(0));
    assert_eq!(resumed, steady(folder), "an interrupted run is completed");
}

#[test]
fn a_second_ctrl_c_ends_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let mut child = hanging(folder.path());
    // After the first signal the report waits for a reader who never comes.
    assert!(
        Command::new("mkfifo")
            .arg(folder.path().join("result/report.md"))
            .status()
            .unwrap()
            .success()
    );
    signal(&child, Signal::INT);
    std::thread::sleep(Duration::from_millis(500));
    let began = Instant::now();
    while child.try_wait().unwrap().is_none() {
        assert!(began.elapsed() < Duration::from_secs(30), "a second signal does not end it");
        // Two of a kind may arrive as one.
        let _ = kill_process(Pid::from_child(&child), Signal::INT);
        std::thread::sleep(Duration::from_millis(100));
    }
    assert_eq!(crate::common::ended(child.wait_with_output().unwrap()).code, Some(130));
    assert!(!row::read(&folder.path().join("result/samples.jsonl")).unwrap().rows.is_empty());
    std::thread::sleep(Duration::from_millis(200));
    runners_ended(folder.path());
}

#[test]
fn a_full_disk_costs_no_row() {
    let (_folder, expected, _) = undisturbed();
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "t.toml", experiment());
    // No file may have more than 8 KiB (16 blocks of 512 bytes); the signal that says so is
    // ignored, so that writing fails as on a full disk.
    let script = format!(
        "trap '' XFSZ; ulimit -f 16; exec {} run t.toml --out result",
        crate::common::PROGRAM
    );
    let mut full = Command::new("sh");
    full.args(["-c", &script]).current_dir(folder).env("TMPDIR", folder).stdin(Stdio::null());
    let ended = crate::common::ended(full.output().unwrap());
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    let rows = row::read(&folder.join("result/samples.jsonl")).unwrap();
    assert!(
        rows.warnings.is_empty() && (3..ROWS).contains(&rows.rows.len()),
        "{:?}, {}",
        rows.warnings,
        rows.rows.len()
    );
    let last = ended.stderr.lines().last().unwrap();
    for words in [
        "the run stopped; when this is mended, continue with: contactbench run t.toml --resume \
         --out result",
        "cannot write to result/samples.jsonl: File too large",
        &format!("the {} rows before stand there and are whole", rows.rows.len()),
    ] {
        assert!(last.contains(words), "no '{words}' in: {last}");
    }
    assert_eq!(start(folder, &["--resume"]).code, Some(0));
    assert_eq!(steady(folder), expected);
}

/// A run that is refused before anything is measured: one sentence with these words.
fn refused(folder: &Path, arguments: &[&str], words: &[&str]) {
    let ended = run(folder, &[&["run"], arguments].concat());
    assert_eq!(
        (ended.code, ended.stderr.lines().count()),
        (Some(2), 1),
        "{arguments:?}: {}",
        ended.stderr
    );
    for word in words {
        assert!(ended.stderr.contains(word), "{arguments:?}: no '{word}' in: {}", ended.stderr);
    }
}

#[test]
fn what_cannot_work_is_said_before_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let text = experiment();
    file(folder, "t.toml", &text);
    refused(
        folder,
        &["t.toml", "--out", "/proc/self/task"],
        &["cannot make the result folder /proc/self/task", "--out"],
    );
    file(folder, "huge.toml", text.replace("blocks = 2", "blocks = 4000000000"));
    refused(
        folder,
        &["huge.toml", "--out", "huge"],
        &["huge has ", " free, and the record and the report may need ", "make room, or choose"],
    );
    file(folder, "beyond.toml", text.replace("s = [2, 3000]", "s = [2, 1e308]"));
    refused(
        folder,
        &["beyond.toml", "--out", "beyond"],
        &[
            "in experiment t, scene t: pack-c 2D N=100 diameter=1.0 s=1e+308: ",
            "leave the range of f64; take parameters nearer to 1",
        ],
    );
    assert!(!folder.join("beyond").exists(), "nothing was begun");
    let (head, runners) = text.split_once("[[scene]]").unwrap();
    let runners = runners.split_once("[[runner]]").unwrap().1;
    file(
        folder,
        "file.toml",
        format!("{head}[[scene]]\nname = \"file\"\npath = \"gone.csv\"\n[[runner]]{runners}"),
    );
    refused(folder, &["file.toml", "--out", "file"], &["cannot read ", "gone.csv", "No such file"]);
    file(folder, "typo.toml", text.replace("blocks = 2", "blocks = two"));
    refused(folder, &["typo.toml"], &["typo.toml: line 5, column 10: "]);
}

#[test]
fn a_resumed_run_notices_that_a_file_has_changed() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let text = "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\nblocks = \
                2\ndetectors = [\"nbs\", \"sweep\"]\n[[scene]]\nname = \"file\"\npath = \
                \"discs.csv\"\n";
    file(folder, "t.toml", text);
    let discs = "x,y,r\n0,0,1\n1,0,1\n5,0,1\n";
    file(folder, "discs.csv", discs);
    assert_eq!(start(folder, &[]).code, Some(0));
    let path = folder.join("result/samples.jsonl");
    let whole = std::fs::read_to_string(&path).unwrap();
    let first: String = whole.split_inclusive('\n').take(3).collect();
    for rows in [&whole, &first] {
        for changed in [discs.replace("5,0,1", "5,0,2"), format!("{discs}9,0,1\n")] {
            std::fs::write(&path, rows).unwrap();
            file(folder, "discs.csv", changed);
            let ended = start(folder, &["--resume"]);
            assert_eq!(ended.code, Some(2), "{}", ended.stderr);
            let last = ended.stderr.lines().last().unwrap();
            assert!(
                last.contains("the scene is not the one in the record")
                    && last.contains("begin a new record with --out"),
                "{last}"
            );
            assert_eq!(&std::fs::read_to_string(&path).unwrap(), rows, "nothing was added");
        }
    }
    file(folder, "discs.csv", discs);
    assert_eq!(start(folder, &["--resume"]).code, Some(0));
    file(folder, "t.toml", text.replace("blocks = 2", "blocks = 3"));
    let ended = start(folder, &["--resume"]);
    assert_eq!(ended.code, Some(2));
    assert!(
        ended.stderr.contains("t differs from the experiment that this record was begun with"),
        "{}",
        ended.stderr
    );
}

#[test]
fn earlier_records_are_read_and_later_ones_are_refused() {
    let results = Path::new(env!("CARGO_MANIFEST_DIR")).join("results");
    let mut read = 0;
    for folder in std::fs::read_dir(results).unwrap() {
        let path = folder.unwrap().path().join(row::FILE);
        if path.exists() {
            let record = row::read(&path).unwrap_or_else(|error| panic!("{error}"));
            assert!(record.rows.len() > 50 && record.warnings.is_empty(), "{}", path.display());
            assert!(
                record.rows.iter().all(|row| row.id.machine.is_some()),
                "{}: the machine is that of the provenance",
                path.display()
            );
            read += 1;
        }
    }
    assert!(read >= 4, "{read} committed records");
    let (folder, ..) = undisturbed();
    let path = folder.path().join("result/samples.jsonl");
    let whole = std::fs::read_to_string(&path).unwrap();
    assert!(
        whole.lines().all(|line| line.starts_with("{\"schema\":4,\"")),
        "every line says its schema"
    );
    std::fs::write(&path, whole.replacen("{\"schema\":4,", "{\"schema\":5,", 2)).unwrap();
    for verb in [
        &["report", "result"][..],
        &["run", "t.toml", "--resume", "--out", "result"],
        &["compare", "result", "result"],
    ] {
        let ended = run(folder.path(), verb);
        assert_eq!((ended.code, ended.stderr.lines().count()), (Some(2), 1), "{}", ended.stderr);
        assert!(
            ended
                .stderr
                .contains("samples.jsonl: line 1 has record schema 5, and this contactbench ("),
            "{}",
            ended.stderr
        );
        assert!(
            ended
                .stderr
                .contains("reads schemas 1 to 4: take the version that wrote it, or a later one"),
            "{}",
            ended.stderr
        );
    }
}

#[test]
fn a_resumed_run_remembers_which_detector_was_too_slow() {
    let loaded = say(r#"{"reply":"loaded"}"#);
    let hangs = fake(&[("load", &loaded), ("count", "exec sleep 60")]);
    let text = experiment()
        .split("[[scene]]")
        .next()
        .unwrap()
        .replace("memory-limit-mib = 1\n", "time-limit-s = 0.5\n");
    let folder = tempfile::tempdir().unwrap();
    file(
        folder.path(),
        "t.toml",
        format!(
            "{text}[[scene]]\nname = \"packed\"\nn = [10, 20]\n{}",
            runner("hangs", "sh", &hangs)
        ),
    );
    assert_eq!(start(folder.path(), &[]).code, Some(0));
    let expected = steady(folder.path());
    let path = folder.path().join("result/samples.jsonl");
    let text = std::fs::read_to_string(&path).unwrap();
    let first: Vec<&str> =
        text.split_inclusive('\n').filter(|line| line.contains("\"n\":10,")).collect();
    assert!(first.iter().any(|line| line.contains("timeout")) && first.len() < expected.len());
    std::fs::write(&path, first.concat()).unwrap();
    assert_eq!(start(folder.path(), &["--resume"]).code, Some(0));
    assert_eq!(steady(folder.path()), expected, "the reason says that it was not tried");
}

/// Two virtual machines of one name on two kinds of processors.
#[test]
fn a_run_resumed_on_other_hardware_of_the_same_name_is_of_another_machine() {
    let (folder, ..) = undisturbed();
    let result = folder.path().join("result");
    let text = std::fs::read_to_string(result.join("samples.jsonl")).unwrap();
    let half: String = text.split_inclusive('\n').take(text.lines().count() / 2).collect();
    let provenance = std::fs::read_to_string(result.join("provenance.json")).unwrap();
    let mut fields: serde_json::Value = serde_json::from_str(&provenance).unwrap();
    let here = fields["machine"].as_str().unwrap().to_string();
    assert!(fields["cpu_features"].is_array() || !cfg!(target_arch = "x86_64"), "{fields}");
    fields["caches"]["L3"] = "300M".into();
    std::fs::write(result.join("provenance.json"), fields.to_string()).unwrap();
    for resumed in 1..=2 {
        // The second time it is known already.
        let rows: String =
            text.split_inclusive('\n').take(half.lines().count() + resumed).collect();
        std::fs::write(result.join("samples.jsonl"), if resumed == 1 { &half } else { &rows })
            .unwrap();
        let ended = start(folder.path(), &["--resume"]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        let note = format!("the record was begun on {here}, this is {here}-2");
        assert!(ended.stderr.contains(&note), "{}", ended.stderr);
        let record = row::read(&result.join("samples.jsonl")).unwrap();
        let machines: Vec<_> =
            record.rows.iter().map(|row| row.id.machine.clone().unwrap()).collect();
        assert!(
            machines.contains(&here) && machines.contains(&format!("{here}-2")),
            "{machines:?}"
        );
        assert_eq!(machines.iter().collect::<std::collections::BTreeSet<_>>().len(), 2);
    }
}

#[test]
fn a_result_is_never_written_over() {
    let (folder, ..) = undisturbed();
    let files = || {
        let all = ["samples.jsonl", "provenance.json", "experiments/t.toml"]
            .map(|name| std::fs::read(folder.path().join("result").join(name)));
        all.map(Result::unwrap)
    };
    let before = files();
    file(folder.path(), "t.toml", experiment().replace("blocks = 2", "blocks = 1"));
    let ended = start(folder.path(), &[]);
    assert_eq!(ended.code, Some(2));
    assert_eq!(ended.stderr.lines().count(), 1, "{}", ended.stderr);
    assert!(
        ended.stderr.contains("--resume") && ended.stderr.contains("--out"),
        "{}",
        ended.stderr
    );
    assert!(before == files());
    // Anything but a torn last line is not repaired.
    let path = folder.path().join("result/samples.jsonl");
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, format!("not a row\n{text}")).unwrap();
    let ended = start(folder.path(), &["--resume"]);
    assert_eq!(ended.code, Some(1));
    assert!(ended.stderr.contains("samples.jsonl:1: it is not a row"), "{}", ended.stderr);
}
