//! Tracks runners and the processes that they start, so that none is left behind.
//!
//! A runner is the head of a process group, which is ended with it. On Linux, processes that leave
//! the group (by `setsid`, with a parent that ends at once) are found, too. This process adopts
//! orphans below it, and a runner's processes have a mark in their environment. An orphan without a
//! mark is ended only if this process had no children before the first runner, is not process 1,
//! and no other runner is active.

use std::collections::BTreeMap;
use std::process::{Child, Command, ExitStatus};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The environment variable with the mark: the number of this process, and that of the runner.
const MARK: &str = "CONTACTBENCH_RUNNER";

/// The active runners: the number of the process (and group), and of the runner in this program.
static RUNNERS: Mutex<Runners> = Mutex::new(Runners { at_work: BTreeMap::new(), started: 0 });

struct Runners {
    at_work: BTreeMap<u32, u32>,
    started: u32,
}

fn runners() -> MutexGuard<'static, Runners> {
    RUNNERS.lock().unwrap_or_else(PoisonError::into_inner)
}

pub fn start(command: &mut Command) -> std::io::Result<Child> {
    // The lock prevents the new process from being taken for an orphan.
    let mut runners = runners();
    runners.started += 1;
    // The size of the environment moves the stack. The padding differs between processes, so that
    // an unlucky position is not measured every time.
    let padding = runners.started.wrapping_mul(271) % 4096;
    command.env("CONTACTBENCH_PADDING", "x".repeat(padding as usize));
    command.env(MARK, format!("{}.{}", std::process::id(), runners.started));
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(command, 0);
    #[cfg(target_os = "linux")]
    orphans::adopt();
    let child = command.spawn()?;
    let number = runners.started;
    runners.at_work.insert(child.id(), number);
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
    runners.at_work.remove(&runner.id());
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
    runners().at_work.remove(&runner.id());
    // These calls fail only if the process has ended.
    let _ = runner.kill();
    let _ = runner.wait();
    #[cfg(target_os = "linux")]
    orphans::end();
}

#[cfg(unix)]
pub(crate) fn end_all() {
    let mut runners = runners();
    for &runner in runners.at_work.keys() {
        signal(runner, rustix::process::Signal::KILL);
    }
    runners.at_work.clear();
    drop(runners);
    #[cfg(target_os = "linux")]
    orphans::end();
}

#[cfg(target_os = "linux")]
mod orphans {
    use std::collections::BTreeSet;
    use std::sync::{Mutex, OnceLock, PoisonError};
    use std::time::Duration;

    use rustix::process::{Pid, Signal, WaitOptions};

    use super::{MARK, Runners, runners};

    /// Maximum number of searches for orphans, because some start others before they end.
    const ROUNDS: u32 = 200;
    const PAUSE: Duration = Duration::from_millis(5);

    static ALONE: OnceLock<bool> = OnceLock::new();
    /// Orphans that survive SIGKILL; their end is not waited for again.
    static STUCK: Mutex<BTreeSet<i32>> = Mutex::new(BTreeSet::new());

    /// Makes this process the parent of orphans that its descendants leave.
    pub fn adopt() {
        ALONE.get_or_init(|| {
            // If the system lacks this feature, only process groups are ended.
            let _ = rustix::process::set_child_subreaper(Some(rustix::process::getpid()));
            // Orphans without a mark are ended only if all orphans come from runners. A shell that
            // became this program by `exec` may have left other children, and process 1 of a
            // container adopts all orphans.
            own() != 1 && children().iter().all(|child| child.ended)
        });
    }

    struct Process {
        pid: i32,
        parent: i32,
        group: i32,
        ended: bool,
    }

    fn own() -> i32 {
        rustix::process::getpid().as_raw_nonzero().get()
    }

    /// Ends the orphans of runners that are no longer active.
    pub fn end() {
        let mut stuck = STUCK.lock().unwrap_or_else(PoisonError::into_inner);
        for round in 1..=ROUNDS {
            // The lock prevents the start of a runner, which would look like an orphan.
            let runners = runners();
            let found = found(&runners);
            stuck.retain(|pid| found.contains(pid));
            for &pid in &found {
                if let Some(pid) = Pid::from_raw(pid) {
                    let _ = rustix::process::kill_process(pid, Signal::KILL);
                    // This call fails for a process that is not a child; its parent waits for it.
                    let _ = rustix::process::waitpid(Some(pid), WaitOptions::NOHANG);
                }
            }
            drop(runners);
            if found.len() == stuck.len() {
                return;
            }
            if round == ROUNDS {
                *stuck = found;
                return;
            }
            std::thread::sleep(PAUSE);
        }
    }

    /// Returns orphans that do not belong to an active runner, and all processes below them.
    fn found(runners: &Runners) -> BTreeSet<i32> {
        let group = rustix::process::getpgrp().as_raw_nonzero().get();
        // Processes in this program's own group are not runners.
        let orphan = |process: &Process| {
            let at_work = runners.at_work.keys().any(|&runner| runner as i32 == process.pid);
            process.group != group && !at_work
        };
        let alone = ALONE.get().is_some_and(|alone| *alone);
        let nobodys = |process: &Process| match mark(process.pid) {
            Some(number) => runners.at_work.values().all(|&known| known != number),
            None => alone && runners.at_work.is_empty(),
        };
        let mut found: BTreeSet<i32> = children()
            .into_iter()
            .filter(|it| orphan(it) && (it.ended || nobodys(it)))
            .map(|it| it.pid)
            .collect();
        // Usually there are no orphans, and the other processes need not be listed.
        let all = if found.is_empty() { Vec::new() } else { processes() };
        loop {
            let below = all.iter().filter(|it| found.contains(&it.parent)).map(|it| it.pid);
            let more: Vec<i32> = below.filter(|pid| !found.contains(pid)).collect();
            if more.is_empty() {
                return found;
            }
            found.extend(more);
        }
    }

    fn children() -> Vec<Process> {
        listed().map_or_else(
            || processes().into_iter().filter(|it| it.parent == own()).collect(),
            |pids| pids.into_iter().filter_map(process).collect(),
        )
    }

    /// Reads the children of each thread from `/proc`; `None` if the system does not list them.
    fn listed() -> Option<Vec<i32>> {
        let mut pids = Vec::new();
        for thread in std::fs::read_dir("/proc/self/task").ok()?.flatten() {
            // A missing file may be a thread that just ended; another thread then has its children.
            let text = std::fs::read_to_string(thread.path().join("children")).ok()?;
            pids.extend(text.split_whitespace().flat_map(str::parse::<i32>));
        }
        Some(pids)
    }

    fn mark(pid: i32) -> Option<u32> {
        let environment = std::fs::read(format!("/proc/{pid}/environ")).ok()?;
        let head = format!("{MARK}={}.", std::process::id());
        let variable = environment.split(|&byte| byte == 0);
        let mark = variable.filter_map(|text| text.strip_prefix(head.as_bytes())).next()?;
        std::str::from_utf8(mark).ok()?.parse().ok()
    }

    fn processes() -> Vec<Process> {
        let entries = std::fs::read_dir("/proc").into_iter().flatten().flatten();
        let numbers = entries.filter_map(|entry| entry.file_name().to_str()?.parse().ok());
        numbers.filter_map(process).collect()
    }

    fn process(pid: i32) -> Option<Process> {
        let text = std::fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
        // The program's name, in parentheses, may contain anything.
        let mut fields = text.rsplit_once(')')?.1.split_whitespace();
        let ended = fields.next()? == "Z";
        let (parent, group) = (fields.next()?.parse().ok()?, fields.next()?.parse().ok()?);
        Some(Process { pid, parent, group, ended })
    }
}
