//! Version 1 and the end of runners, with runners in shell.

use super::*;
use crate::run::trajectory::Trajectory;

/// A runner in shell, with its first line for `HELLO`.
fn shell(protocol: u32, script: &str) -> Client {
    let hello = format!(r#"{{"reply":"hello","protocol":{protocol},"detector":"one"}}"#);
    let start = Start {
        command: ["sh", "-c", &script.replace("HELLO", &hello)].map(String::from).into(),
        install: String::new(),
        time_limit: Duration::from_secs(10),
        memory_limit: 1 << 30,
        processor: None,
    };
    Client::start(&start).unwrap()
}

const DEAF: &str = "echo 'HELLO'; while read -r line; do :; done; while :; do sleep 0.01; done";

#[test]
fn a_runner_that_does_not_leave_is_asked_by_a_signal_before_it_is_killed() {
    let folder = tempfile::tempdir().unwrap();
    let mark = folder.path().join("mark");
    let trap = format!("trap 'echo cleaned > \"{}\"; exit' TERM; {DEAF}", mark.display());
    drop(shell(2, &trap));
    assert_eq!(std::fs::read_to_string(&mark).unwrap(), "cleaned\n");
    // Nor is it waited for without end.
    let stubborn = shell(2, &format!("trap '' TERM; {DEAF}"));
    let id = stubborn.child.id() as i32;
    let started = Instant::now();
    drop(stubborn);
    assert!(started.elapsed() >= TO_LEAVE + TO_CLEAN_UP);
    let process = rustix::process::Pid::from_raw(id).unwrap();
    assert!(rustix::process::test_kill_process(process).is_err());
}

#[test]
fn several_frames_are_not_available_in_version_1() {
    let frames = vec!["a.npy".into(), "b.npy".into()];
    let load = Request::Load(Trajectory { frames, dim: 2, n: 4, radius: Some(0.5), in_box: None });
    let answering = "echo 'HELLO'; while read -r line; do echo '{\"reply\":\"loaded\"}'; done";
    let failure = shell(1, answering).ask(&load).unwrap_err();
    assert_eq!(failure.outcome, Outcome::Unavailable);
    assert!(failure.reason.contains("this trajectory has 2 frames"), "{}", failure.reason);
    assert_eq!(shell(2, answering).ask(&load), Ok(Reply::Loaded));
}
