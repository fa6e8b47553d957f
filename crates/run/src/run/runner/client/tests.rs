//! Tests with runners in shell: how they end, and how they get one frame at a time.

use super::*;
use crate::run::runner::trajectory::Trajectory;

/// Starts a shell script as a runner; `HELLO` in the script stands for the first line.
fn shell(script: &str) -> Client {
    let hello = r#"{"reply":"hello","protocol":4,"detector":"one","at_rest":true}"#;
    let command = ["sh", "-c", &script.replace("HELLO", hello)].map(String::from);
    Client::start(&Start::of(&command, Duration::from_secs(10), 1 << 30)).unwrap()
}

const DEAF: &str = "echo 'HELLO'; while read -r line; do :; done; while :; do sleep 0.01; done";

#[test]
fn a_runner_that_does_not_leave_is_asked_by_a_signal_before_it_is_killed() {
    let folder = tempfile::tempdir().unwrap();
    let mark = folder.path().join("mark");
    let trap = format!("trap 'echo cleaned > \"{}\"; exit' TERM; {DEAF}", mark.display());
    drop(shell(&trap));
    assert_eq!(std::fs::read_to_string(&mark).unwrap(), "cleaned\n");
    // SIGKILL follows if the runner ignores SIGTERM.
    let stubborn = shell(&format!("trap '' TERM; {DEAF}"));
    let id = stubborn.child.id() as i32;
    let started = Instant::now();
    drop(stubborn);
    assert!(started.elapsed() >= TO_LEAVE + TO_CLEAN_UP);
    let process = rustix::process::Pid::from_raw(id).unwrap();
    assert!(rustix::process::test_kill_process(process).is_err());
}

#[test]
fn a_runner_without_a_hello_is_named_with_its_last_words() {
    let command = ["sh", "-c", "echo loading >&2; exec sleep 60"].map(String::from);
    let start = Start::of(&command, Duration::from_secs(10), 1 << 30);
    let mut client = Client::spawn(&start).unwrap();
    let Failure { outcome, reason } = client.greet(Duration::from_secs(1)).unwrap_err();
    assert_eq!(outcome, Outcome::Timeout);
    assert!(reason.starts_with("no hello: no answer within 1 s"), "{reason}");
    assert!(reason.ends_with("last line on standard error: loading"), "{reason}");
}

/// A runner that reports N contacts for the scene file `tmp-N.npy`.
const AT_REST: &str = r#"echo 'HELLO'; while read -r line; do
    case "$line" in
    *load*) n=${line##*/tmp-}; n=${n%%.npy*}; said='"reply":"loaded"' ;;
    *sample*) said='"reply":"sample","time_ns":N00,"calls":1,"elapsed_ns":N00,FOUND' ;;
    *count*) said='"reply":"count","counts":{"probe":N},FOUND' ;;
    *pairs*) said='"reply":"pairs","contacts":N' ;;
    *) said='"reply":"unsupported"' ;;
    esac
    echo "{$said}" | sed 's/FOUND/"contacts":N,"digest":"0x000000000000000N"/' | sed "s/N/$n/g"
done"#;

#[test]
fn runners_of_scenes_at_rest_get_a_trajectory_frame_by_frame() {
    let frames = ["/tmp-3.npy", "/tmp-1.npy", "/tmp-2.npy"].map(Into::into).to_vec();
    let moving = Trajectory { frames, dim: 2, n: 4, radius: Some(0.5), ..Trajectory::default() };
    let (rest, load) = (moving.at_rest(1), Request::Load(moving));
    let mut runner = shell(AT_REST);
    assert_eq!(runner.ask(&load), Ok(Reply::Loaded));
    let Ok(Reply::Sample(sample)) = runner.ask(&Request::Sample { min_ns: 1 }) else {
        panic!("no sample")
    };
    let (steps, contacts) = (sample.found.steps, sample.found.contacts);
    assert_eq!((sample.time_ns, sample.calls, contacts), (200, 3, 2));
    assert_eq!(sample.step_ns, [300, 100, 200]);
    assert_eq!(steps.contacts, [3, 1, 2]);
    assert!(steps.built.is_empty() && steps.unlike(3).is_none());
    let Ok(Reply::Count(counted)) = runner.ask(&Request::Count) else { panic!("no counts") };
    assert_eq!((counted.counts["probe"], counted.found.contacts), (6, 2));
    let pairs = |frame| Request::Pairs { path: "p.npy".into(), frame };
    for (frame, contacts) in [(None, 2), (Some(0), 3), (Some(1), 1)] {
        assert_eq!(runner.ask(&pairs(frame)), Ok(Reply::Pairs { contacts }));
    }
    assert!(runner.ask(&pairs(Some(3))).unwrap_err().reason.contains("trajectory has 3"));
    assert_eq!(runner.ask(&Request::Memory), Ok(Reply::Unsupported));
    assert_eq!(runner.ask(&Request::Load(rest)), Ok(Reply::Loaded));
    let Ok(Reply::Sample(sample)) = runner.ask(&Request::Sample { min_ns: 1 }) else {
        panic!("no sample")
    };
    assert!(sample.found.contacts == 1 && sample.found.steps.is_empty());
}
