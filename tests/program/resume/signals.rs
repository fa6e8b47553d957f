//! Ctrl-C and SIGTERM.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use contactbench::record::row;
use contactbench::record::row::Pass;
use rustix::process::{Pid, Signal, kill_process};

use super::{WHOLE, experiment, start, steady};
use crate::common::{fake, file, runner, say};

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
    assert_eq!(start(folder, &["--resume"]).code, WHOLE);
    let resumed = steady(folder);
    std::fs::remove_dir_all(folder.join("result")).unwrap();
    assert_eq!(start(folder, &[]).code, WHOLE);
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
