//! Runners that fork, hide children, flood or speak no text: nothing of them is left behind, and
//! what they do is said.

use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use contactbench::record::row;
use contactbench::record::row::Outcome;

use crate::common::{PROGRAM, fake, file, has, run, runner, say};

/// A runner in Python that does something before it answers as one should.
fn python(before: &str) -> String {
    let rest = r#"
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
say(reply="hello", protocol=2, detector="hides", arithmetic="f64")
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
    rest.replace("BEFORE", before)
}

/// The processes that the runners have noted: how many, and that none is left.
fn all_ended(folder: &Path) -> usize {
    let pids = std::fs::read_to_string(folder.join("pids")).unwrap_or_default();
    for pid in pids.lines() {
        let began = Instant::now();
        let state = || std::fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
        while !(state().is_empty() || state().contains(") Z")) {
            let late = began.elapsed() > Duration::from_secs(5);
            if late {
                let _ = Command::new("kill").args(["-9", pid]).status();
            }
            assert!(!late, "a process is left behind: {}", state());
            std::thread::sleep(Duration::from_millis(20));
        }
    }
    pids.lines().count()
}

const HEAD: &str = "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\nblocks = \
                    2\ntime-limit-s = 20\ndetectors = [\"nbs\"]\n[[scene]]\nname = \
                    \"pack-c\"\nn = 25\ns = 5\n";

#[cfg(target_os = "linux")]
#[test]
fn children_that_hide_are_found_and_ended() {
    if !has("python3") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (name, before) in [
        ("hides.py", ""),
        // Without the mark in its environment, also of what it starts.
        (
            "bare.py",
            "if os.environ.pop('CONTACTBENCH_RUNNER', ''): os.execve(sys.executable, [sys.executable, *sys.argv], os.environ)",
        ),
        // Dies right after, and leaves a child that starts others again and again.
        (
            "forks.py",
            "hide()\nif os.fork() == 0:\n    os.setsid()\n    while True:\n        if os.fork() == 0:\n            note()\n            time.sleep(0.05)\n        else:\n            time.sleep(0.02)\n            os._exit(0)\nif os.path.exists('die'): sys.exit(7)",
        ),
    ] {
        file(folder, name, python(before));
        let command =
            format!("[[runner]]\nname = \"hides\"\ncommand = [\"python3\", \"{name}\"]\n");
        file(folder, "t.toml", format!("{HEAD}{command}"));
        let ended = run(folder, &["run", "t.toml", "--out", name.strip_suffix(".py").unwrap()]);
        assert_eq!(ended.code, Some(0), "{name}: {}", ended.stderr);
        let record = folder.join(name.strip_suffix(".py").unwrap()).join(row::FILE);
        let rows = row::read(&record).unwrap().rows;
        let own: Vec<_> = rows.iter().filter(|row| row.id.detector == "hides").collect();
        assert!(own.iter().all(|row| row.outcome == Outcome::Ok) && own.len() == 4, "{own:#?}");
        assert!(all_ended(folder) >= 3, "{name}: nothing was hidden");
        std::fs::remove_file(folder.join("pids")).unwrap();
    }
    // `check` starts and ends them by the same code: the hardest is enough.
    run(folder, &["check", "--runner", "python3 forks.py", "--seconds", "0"]);
    assert!(all_ended(folder) >= 3);
    std::fs::remove_file(folder.join("pids")).unwrap();
    // One that dies leaves no more than one that is told to leave.
    file(folder, "die", "");
    run(folder, &["run", "t.toml", "--out", "dies"]);
    assert!(all_ended(folder) >= 1);
}

/// A shell that leaves something at work, and becomes this program.
#[cfg(target_os = "linux")]
#[test]
fn what_was_there_before_the_first_runner_is_spared() {
    if !has("setsid") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "t.toml", HEAD);
    let script = "setsid sh -c 'sleep 300 & echo $! > below; wait' > log 2>&1 & echo $! > \
                  child; until [ -s below ]; do sleep 0.02; done; \
                  exec \"$0\" run t.toml --out result";
    let mut command = Command::new("sh");
    command.args(["-c", script, PROGRAM]).current_dir(folder).env("TMPDIR", folder);
    let ended = command.output().unwrap();
    let spared = ["child", "below"].map(|name| {
        let pid = std::fs::read_to_string(folder.join(name)).unwrap();
        let state = std::fs::read_to_string(format!("/proc/{}/stat", pid.trim()));
        let _ = Command::new("kill").args(["-9", pid.trim()]).status();
        state.is_ok_and(|state| !state.contains(") Z"))
    });
    assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
    assert_eq!(spared, [true; 2]);
}

#[test]
fn floods_are_bounded_and_lines_that_are_no_text_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let loaded = say(r#"{"reply":"loaded"}"#);
    let answer = |code: &str| fake(&[("load", &loaded), ("count", code)]);
    let cases = [
        ("bytes", answer(r"printf 'a\377b\n'"), "byte 2 is not UTF-8): a\u{fffd}b"),
        ("long", answer("yes x | tr -d '\\n'"), "it is longer than 1 MiB): xxx"),
        ("many", answer("yes"), "the runner's answer is not a reply: it printed 'y'"),
        ("errors", answer("yes 0123456789 | head -c 200000000 >&2; exit 3"), "exit status: 3: 01"),
    ];
    let runners: String =
        cases.iter().map(|(name, script, _)| runner(name, "sh", script)).collect();
    file(folder, "t.toml", format!("{HEAD}{runners}"));
    let ended = run(folder, &["run", "t.toml", "--out", "result"]);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    let rows = row::read(&folder.join("result").join(row::FILE)).unwrap().rows;
    for (name, _, words) in &cases {
        let row = rows.iter().find(|row| row.id.detector == *name).unwrap();
        assert_eq!(row.outcome, Outcome::Crashed, "{name}: {}", row.reason);
        assert!(row.reason.contains(words), "{name}: {}", row.reason);
        assert!(row.reason.len() < 500, "{name}: {}", row.reason.len());
    }
    // `check` says the same.
    file(folder, "bytes.sh", &cases[0].1);
    let ended = run(folder, &["check", "--runner", "sh bytes.sh", "--seconds", "0"]);
    assert_eq!(ended.code, Some(1));
    let words =
        "it breaks the protocol: asked to count: the runner's answer is not a reply (byte 2";
    assert!(ended.stdout.contains(words), "{}", ended.stdout);
}
