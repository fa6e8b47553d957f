//! Tracks runners and the processes that they start. A runner is the head of a process group, which
//! is ended with it. Processes that leave the group (by `setsid`) are not ended.

use std::collections::BTreeSet;
use std::process::{Child, Command, ExitStatus};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The active runners, by the number of the process and its group.
static RUNNERS: Mutex<Runners> = Mutex::new(Runners { active: BTreeSet::new(), started: 0 });

struct Runners {
    active: BTreeSet<u32>,
    started: u32,
}

fn runners() -> MutexGuard<'static, Runners> {
    RUNNERS.lock().unwrap_or_else(PoisonError::into_inner)
}

pub fn start(command: &mut Command) -> std::io::Result<Child> {
    // The lock is held until the runner is active, so that a signal ends this one, too.
    let mut runners = runners();
    runners.started += 1;
    // The size of the environment moves the stack. The padding differs between processes, so that
    // an unlucky position is not measured every time.
    let padding = runners.started.wrapping_mul(271) % 4096;
    command.env("CONTACTBENCH_PADDING", "x".repeat(padding as usize));
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(command, 0);
    let child = command.spawn()?;
    runners.active.insert(child.id());
    Ok(child)
}

/// Limits the address space of a new process on Linux. Elsewhere, detectors only refuse by their
/// own formula.
pub(crate) fn limit_memory(child: &Child, bytes: u64) {
    #[cfg(target_os = "linux")]
    {
        use rustix::process::{Pid, Resource, Rlimit, prlimit};
        let limit = Rlimit { current: Some(bytes), maximum: Some(bytes) };
        // If the process has ended already, this call fails, and so does the first request.
        let _ = prlimit(Pid::from_raw(child.id() as i32), Resource::As, limit);
    }
    #[cfg(not(target_os = "linux"))]
    let _ = (child, bytes);
}

/// Returns how a runner ended, or `None` if it still runs. An ended runner's number may be reused.
pub(crate) fn reap(runner: &mut Child) -> Option<ExitStatus> {
    let mut runners = runners();
    let ended = runner.try_wait().ok().flatten()?;
    runners.active.remove(&runner.id());
    Some(ended)
}

#[cfg(unix)]
pub fn signal(runner: u32, signal: rustix::process::Signal) {
    if let Some(group) = i32::try_from(runner).ok().and_then(rustix::process::Pid::from_raw) {
        let _ = rustix::process::kill_process_group(group, signal);
    }
}

pub fn end(runner: &mut Child) {
    #[cfg(unix)]
    signal(runner.id(), rustix::process::Signal::KILL);
    runners().active.remove(&runner.id());
    // These calls fail only if the process has ended.
    let _ = runner.kill();
    let _ = runner.wait();
}

#[cfg(unix)]
pub(crate) fn end_all() {
    let mut runners = runners();
    for &runner in &runners.active {
        signal(runner, rustix::process::Signal::KILL);
    }
    runners.active.clear();
}
