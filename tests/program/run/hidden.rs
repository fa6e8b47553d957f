//! Tests runners that fork, hide children, or print floods of bytes: all processes are ended, and
//! the reason is recorded.

use std::process::Command;
use std::time::{Duration, Instant};

use contactbench::record::row::Outcome;

use super::SPARSE;
use crate::common::{PROGRAM, Place, answers, has, runner};

/// A runner in Python that runs the code BEFORE before it answers.
const PYTHON: &str = r#"
import json, os, sys, time
def say(**reply): print(json.dumps(reply), flush=True)
def note():
    with open("pids", "a") as f: f.write(f"{os.getpid()}\n")
def hide():
    # A session of its own, and a parent that ends at once.
    there, here = os.pipe()
    if os.fork() == 0:
        os.setsid()
        if os.fork() == 0:
            note()
            os.write(here, b"x")
            time.sleep(600)
        os._exit(0)
    os.wait()
    os.read(there, 1)
BEFORE
say(reply="hello", protocol=4, detector="hides", arithmetic="f64")
for line in sys.stdin:
    asked = json.loads(line)["request"]
    if asked == "load":
        hide()
        say(reply="loaded")
    elif asked == "sample":
        start = time.perf_counter_ns()
        time.sleep(0.003)
        took = time.perf_counter_ns() - start
        say(reply="sample", time_ns=took, calls=1, elapsed_ns=took, contacts=0, digest="0x" + 16 * "0")
    elif asked == "quit":
        break
    else:
        say(reply="unsupported")
"#;

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

#[test]
fn floods_are_bounded_and_lines_that_are_no_text_are_named() {
    let at = Place::new();
    let cases = [
        ("bytes", r"printf 'a\377b\n'", "byte 2 is not UTF-8): a\u{fffd}b"),
        ("long", "yes x | tr -d '\\n'", "1 MiB): xxx"),
        ("many", "yes", "printed 'y'"),
        ("errors", "yes 0123456789 | head -c 50000000 >&2; exit 3", "exit status: 3: 01"),
    ];
    let script = |code: &str| answers(&[("count", code)]);
    let runners: String =
        cases.iter().map(|(name, code, _)| runner(name, "sh", &script(code))).collect();
    at.file("t.toml", format!("{HEAD}{SPARSE}{runners}"));
    at.ends(1, "run t.toml --out result", &[]);
    let rows = at.rows("result");
    for (name, _, words) in &cases {
        let row = rows.iter().find(|row| row.id.detector == *name).unwrap();
        assert_eq!(row.outcome, Outcome::Crashed, "{name}: {}", row.reason);
        assert!(row.reason.contains(words) && row.reason.len() < 500, "{name}: {}", row.reason);
    }
    at.file("bytes.sh", script(cases[0].1));
    at.ends(1, "check --runner 'sh bytes.sh' --seconds 0", &["count", "(byte 2"]);
}
