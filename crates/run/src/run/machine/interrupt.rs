//! Signals: the first Ctrl-C or SIGTERM ends a run after the current rows; the second ends it at
//! once.

use std::io::Write;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};

#[cfg(unix)]
use crate::run::runner::family;

/// Number of the first signal; 0 before it arrives.
static SIGNAL: AtomicI32 = AtomicI32::new(0);
/// Whether the first signal ends the program at once.
static AT_ONCE: AtomicBool = AtomicBool::new(false);

#[derive(Debug, thiserror::Error)]
#[error("interrupted")]
pub struct Interrupted;

/// Makes the first signal end runners and program, for commands with nothing to finish.
pub fn end_runners_too() -> std::io::Result<()> {
    AT_ONCE.store(true, Ordering::Relaxed);
    install()
}

/// Handles signals, so that the first one ends the run in order instead of at once.
pub fn install() -> std::io::Result<()> {
    #[cfg(unix)]
    {
        use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};
        let mut wanted = vec![SIGINT, SIGTERM, SIGQUIT];
        // A closed terminal ends its programs but not the runners, which are separate groups.
        // `nohup` makes the program ignore SIGHUP, which must stay so.
        if !ignored(SIGHUP) {
            wanted.push(SIGHUP);
        }
        let mut signals = signal_hook::iterator::Signals::new(wanted)?;
        std::thread::Builder::new().name("signals".into()).spawn(move || {
            for signal in signals.forever() {
                if SIGNAL.swap(signal, Ordering::Relaxed) != 0 || AT_ONCE.load(Ordering::Relaxed) {
                    family::end_all();
                    contactbench_io::write::remove_unfinished();
                    clear_line();
                    let _ = writeln!(std::io::stderr(), "stopped");
                    signal_hook::low_level::exit(128 + signal);
                }
                clear_line();
                eprintln!(
                    "ending after this step; the record keeps what was measured (again: at once)"
                );
            }
        })?;
    }
    Ok(())
}

#[cfg(unix)]
fn clear_line() {
    if std::io::IsTerminal::is_terminal(&std::io::stderr()) {
        eprint!("\r\x1b[K");
    }
}

/// Returns whether the signal was ignored when this process started. If the system does not report
/// this, returns whether standard error is not a terminal.
#[cfg(unix)]
fn ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status
        .lines()
        .find_map(|line| u64::from_str_radix(line.strip_prefix("SigIgn:")?.trim(), 16).ok());
    mask.map_or_else(
        || !std::io::IsTerminal::is_terminal(&std::io::stderr()),
        |mask| mask >> (signal - 1) & 1 == 1,
    )
}

pub fn requested() -> bool {
    SIGNAL.load(Ordering::Relaxed) != 0
}

pub fn check() -> Result<(), Interrupted> {
    if requested() { Err(Interrupted) } else { Ok(()) }
}

/// Returns the exit code that shells use for the signal: 130 after Ctrl-C.
pub fn exit_code() -> u8 {
    u8::try_from(128 + SIGNAL.load(Ordering::Relaxed)).unwrap_or(u8::MAX)
}
