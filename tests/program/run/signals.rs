//! Tests that Ctrl-C and SIGTERM end a run.

use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use contactbench::record::row::{Pass, Row};
use rustix::process::{Pid, Signal, kill_process};

use super::resume::{WHOLE, experiment, steady};
use crate::common::{Place, answers, ended, program, runner};

/// Starts a run whose runner writes its process ids to `pids`, and hangs unless the file `go`
/// exists. Returns when it hangs.
fn hanging(at: &Place) -> Child {
    let sample = "[ -e go ] || { sleep 60 & echo $$ >> pids; echo $! >> pids; wait; }; exit 3";
    let waits = runner("waits", "sh", &answers(&[("sample", sample)]));
    at.file("t.toml", experiment() + &waits);
    let mut program = program(at.root(), &["run", "t.toml", "--out", "result"]);
    let child = program.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let began = Instant::now();
    let pids = || std::fs::read_to_string(at.path("pids")).unwrap_or_default();
    while pids().lines().count() < 2 {
        assert!(began.elapsed() < Duration::from_secs(120), "the run does not come to the hang");
        std::thread::sleep(Duration::from_millis(20));
    }
    child
}

/// Waits until all processes that runners noted have ended; returns their number.
fn all_ended(at: &Place) -> usize {
    let pids = std::fs::read_to_string(at.path("pids")).unwrap_or_default();
    for pid in pids.lines() {
        let began = Instant::now();
        let state = || std::fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
        while !(state().is_empty() || state().contains(") Z")) {
            let late = began.elapsed() > Duration::from_secs(10);
            if late {
                let _ = Command::new("kill").args(["-9", pid]).status();
            }
            assert!(!late, "a process is left behind: {}", state());
            std::thread::sleep(Duration::from_millis(20));
        }
    }
    let _ = std::fs::remove_file(at.path("pids"));
    pids.lines().count()
}

fn signal(child: &Child, signal: Signal) {
    kill_process(Pid::from_child(child), signal).unwrap();
}

#[test]
fn ctrl_c_ends_a_run_with_its_record_and_a_report() {
    let at = Place::new();
    for (number, code) in [(Signal::TERM, 143), (Signal::INT, 130)] {
        let child = hanging(&at);
        signal(&child, number);
        let ended = ended(child.wait_with_output().unwrap());
        assert_eq!(ended.code, Some(code), "{}", ended.stderr);
        let last = ended.stderr.lines().last().unwrap_or_default();
        assert!(last.ends_with("contactbench run t.toml --resume --out result"));
        assert!(!ended.stderr.contains("CRASHED: waits"), "it has not crashed: {}", ended.stderr);
        let rows = at.rows("result");
        let hung = |row: &&Row| row.id.detector == "waits" && row.pass == Pass::Time;
        assert!(!rows.is_empty() && rows.iter().find(hung).is_none(), "a sample that did not end");
        assert!(at.path("result/report.md").exists());
        assert!(all_ended(&at) >= 2);
        if number == Signal::TERM {
            at.remove("result");
        }
    }
    at.file("go", "");
    at.ends(WHOLE, "run t.toml --out result --resume", &[]);
    let resumed = steady(&at);
    at.remove("result");
    at.ends(WHOLE, "run t.toml --out result", &[]);
    assert_eq!(resumed, steady(&at), "an interrupted run is completed");
}

#[test]
fn a_second_ctrl_c_ends_at_once() {
    let at = Place::new();
    let mut child = hanging(&at);
    // The report, written after the first signal, blocks on this pipe.
    assert_eq!(at.shell("mkfifo result/report.md").code, Some(0));
    signal(&child, Signal::INT);
    std::thread::sleep(Duration::from_millis(500));
    let began = Instant::now();
    while child.try_wait().unwrap().is_none() {
        assert!(began.elapsed() < Duration::from_secs(30), "a second signal does not end it");
        // The signal is sent again, because two pending signals may arrive as one.
        let _ = kill_process(Pid::from_child(&child), Signal::INT);
        std::thread::sleep(Duration::from_millis(100));
    }
    let ended = ended(child.wait_with_output().unwrap());
    assert_eq!((ended.code, ended.stderr.lines().last()), (Some(130), Some("stopped")));
    assert!(!at.rows("result").is_empty());
    std::thread::sleep(Duration::from_millis(200));
    assert!(all_ended(&at) >= 2);
}
