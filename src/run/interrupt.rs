//! Ctrl-C, and the signal by which batch systems end jobs: the first ends a run after the rows that
//! it has, the second ends it at once.

use std::collections::BTreeSet;
use std::process::{Child, ExitStatus};
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};
use std::sync::{Mutex, PoisonError};

/// The signal that came first; 0 if none.
static SIGNAL: AtomicI32 = AtomicI32::new(0);
/// The runners at work, by the number of their process group: what a second signal must end.
static RUNNERS: Mutex<BTreeSet<u32>> = Mutex::new(BTreeSet::new());

/// The first signal ends everything.
static AT_ONCE: AtomicBool = AtomicBool::new(false);

/// A run that was ended by a signal. Its record holds what was measured.
#[derive(Debug, thiserror::Error)]
#[error("interrupted")]
pub struct Interrupted;

/// From now on a signal ends the runners with the program: for verbs that have nothing to finish.
pub fn end_runners_too() -> std::io::Result<()> {
    AT_ONCE.store(true, Ordering::Relaxed);
    install()
}

/// From now on signals do not end the program at once.
pub fn install() -> std::io::Result<()> {
    #[cfg(unix)]
    {
        use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};
        let mut wanted = vec![SIGINT, SIGTERM, SIGQUIT];
        // A terminal that is closed ends its programs, but not the runners, which are groups of
        // their own. Under nohup it ends nothing.
        if !ignored(SIGHUP) {
            wanted.push(SIGHUP);
        }
        let mut signals = signal_hook::iterator::Signals::new(wanted)?;
        std::thread::Builder::new().name("signals".into()).spawn(move || {
            for signal in signals.forever() {
                if SIGNAL.swap(signal, Ordering::Relaxed) != 0 || AT_ONCE.load(Ordering::Relaxed) {
                    RUNNERS
                        .lock()
                        .unwrap_or_else(PoisonError::into_inner)
                        .iter()
                        .for_each(|&runner| signal_group(runner, rustix::process::Signal::KILL));
                    signal_hook::low_level::exit(128 + signal);
                }
                eprintln!(
                    "ending after the step at hand; the record keeps what was measured (again: \
                     end at once)"
                );
            }
        })?;
    }
    Ok(())
}

/// Was this process started with the signal ignored?
#[cfg(unix)]
fn ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status
        .lines()
        .find_map(|line| u64::from_str_radix(line.strip_prefix("SigIgn:")?.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}

/// Has a signal come?
pub fn requested() -> bool {
    SIGNAL.load(Ordering::Relaxed) != 0
}

/// An error if a signal has come.
pub fn check() -> Result<(), Interrupted> {
    if requested() { Err(Interrupted) } else { Ok(()) }
}

/// What a shell makes of the signal: 130 after Ctrl-C.
pub fn exit_code() -> u8 {
    u8::try_from(128 + SIGNAL.load(Ordering::Relaxed)).unwrap_or(u8::MAX)
}

/// A runner has been started.
pub(crate) fn started(runner: u32) {
    RUNNERS.lock().unwrap_or_else(PoisonError::into_inner).insert(runner);
}

/// A runner is about to be waited for: its number may then mean another process.
pub(crate) fn ended(runner: u32) {
    RUNNERS.lock().unwrap_or_else(PoisonError::into_inner).remove(&runner);
}

/// How a runner has ended, if it has. Its number may then mean another process.
pub(crate) fn reap(runner: &mut Child) -> Option<ExitStatus> {
    let mut runners = RUNNERS.lock().unwrap_or_else(PoisonError::into_inner);
    let ended = runner.try_wait().ok().flatten()?;
    runners.remove(&runner.id());
    Some(ended)
}

/// Sends a signal to a runner and what it has started. Fails only if they have ended already.
#[cfg(unix)]
pub(crate) fn signal_group(runner: u32, signal: rustix::process::Signal) {
    if let Some(group) = i32::try_from(runner).ok().and_then(rustix::process::Pid::from_raw) {
        let _ = rustix::process::kill_process_group(group, signal);
    }
}
