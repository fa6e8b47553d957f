//! Tests runners that fork and hide children: all processes are ended.

use std::process::Command;
use std::time::{Duration, Instant};

use contactbench::record::row::Outcome;

use super::SPARSE;
use crate::common::{PROGRAM, Place, has};

/// A runner in Python that runs the code BEFORE before it answers.
const PYTHON: &str = include_str!("hides.py");

/// Waits until all processes that runners noted have ended; returns their number.
pub fn all_ended(at: &Place) -> usize {
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

const HEAD: &str = "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\nblocks = \
                    2\ntime-limit-s = 20\ndetectors = [\"nbs\"]\n";

#[cfg(target_os = "linux")]
#[test]
fn children_that_hide_are_found_and_ended() {
    if !has("python3") {
        return;
    }
    let at = Place::new();
    for (name, before) in [
        ("hides", ""),
        // This runner removes the mark from its environment, and so from that of its children.
        (
            "bare",
            "if os.environ.pop('CONTACTBENCH_RUNNER', ''): os.execve(sys.executable, [sys.executable, *sys.argv], os.environ)",
        ),
        // This runner dies, and leaves a child that keeps starting others.
        (
            "forks",
            "hide()\nif os.fork() == 0:\n    os.setsid()\n    while True:\n        if os.fork() == 0:\n            note()\n            time.sleep(0.05)\n        else:\n            time.sleep(0.02)\n            os._exit(0)\nif os.path.exists('die'): sys.exit(7)",
        ),
    ] {
        at.file(&format!("{name}.py"), PYTHON.replace("BEFORE", before));
        let command = format!("command = [\"python3\", \"{name}.py\"]\n");
        at.file("t.toml", format!("{HEAD}{SPARSE}[[runner]]\nname = \"hides\"\n{command}"));
        at.good(&format!("run t.toml --out {name}"));
        let rows = at.rows(name);
        let own: Vec<_> = rows.iter().filter(|row| row.id.detector == "hides").collect();
        assert!(own.iter().all(|row| row.outcome == Outcome::Ok) && own.len() == 4, "{own:#?}");
        assert!(all_ended(&at) >= 3, "{name}: nothing was hidden");
    }
    // `check` ends processes with the same code, so one case is enough.
    at.run("check --runner 'python3 forks.py' --seconds 0");
    assert!(all_ended(&at) >= 3);
    // Nor does a runner that dies leave a process behind.
    at.file("die", "");
    at.run("run t.toml --out dies");
    assert!(all_ended(&at) >= 1);
}

/// A process that a shell started in the background is spared when the shell becomes this program.
#[cfg(target_os = "linux")]
#[test]
fn what_was_there_before_the_first_runner_is_spared() {
    if !has("setsid") {
        return;
    }
    let at = Place::new();
    at.file("t.toml", format!("{HEAD}{SPARSE}"));
    let ended = at.shell(&format!(
        "setsid sh -c 'sleep 300 & echo $! > below; wait' > log 2>&1 & echo $! > child; until [ -s \
         below ]; do sleep 0.02; done; exec {PROGRAM} run t.toml --out result"
    ));
    let spared = ["child", "below"].map(|name| {
        let pid = at.read(name);
        let state = std::fs::read_to_string(format!("/proc/{}/stat", pid.trim()));
        let _ = Command::new("kill").args(["-9", pid.trim()]).status();
        state.is_ok_and(|state| !state.contains(") Z"))
    });
    assert_eq!((ended.code, spared), (Some(0), [true; 2]), "{}", ended.stderr);
}
