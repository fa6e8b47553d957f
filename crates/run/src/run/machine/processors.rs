//! Assigns processors to processes (Linux only; elsewhere the system chooses).
//!
//! Processors of a machine differ: one may share its core with another program or another guest. On
//! a virtual machine with two processors, equal code in new processes scattered twice as much if
//! the system chose. So all single-threaded subjects of a block run on one processor, and the next
//! block uses the next one, so that no result depends on one processor. Subjects with several
//! threads run where the system puts them.

use std::sync::LazyLock;

/// Processors that this program may use, in ascending order; empty if they are unknown.
static ALLOWED: LazyLock<Vec<usize>> = LazyLock::new(allowed);

pub fn in_block(block: u32) -> Option<usize> {
    nth(block as usize)
}

/// Returns a processor for each of `k` processes at the same time, or `None` if too few exist.
pub fn apart(k: usize) -> Vec<Option<usize>> {
    (0..k).map(|i| nth(i).filter(|_| k <= ALLOWED.len())).collect()
}

fn nth(k: usize) -> Option<usize> {
    ALLOWED.get(k.checked_rem(ALLOWED.len())?).copied()
}

#[cfg(target_os = "linux")]
fn allowed() -> Vec<usize> {
    use rustix::thread::{CpuSet, sched_getaffinity};
    let set = sched_getaffinity(None);
    set.map_or(Vec::new(), |set| (0..CpuSet::MAX_CPU).filter(|&k| set.is_set(k)).collect())
}

#[cfg(not(target_os = "linux"))]
fn allowed() -> Vec<usize> {
    Vec::new()
}

/// Keeps a process, or this thread, on a processor.
pub(crate) fn keep(process: Option<u32>, processor: Option<usize>) {
    #[cfg(target_os = "linux")]
    {
        use rustix::thread::{CpuSet, sched_setaffinity};
        let whom = process.and_then(|process| rustix::process::Pid::from_raw(process as i32));
        if let Some(processor) = processor.filter(|&processor| processor < CpuSet::MAX_CPU) {
            let mut set = CpuSet::new();
            set.set(processor);
            let _ = sched_setaffinity(whom, &set);
        }
    }
    #[cfg(not(target_os = "linux"))]
    let _ = (process, processor);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_take_turns_and_copies_stand_apart() {
        let all = ALLOWED.len();
        for block in 1..=7 {
            assert_eq!(in_block(block), in_block(block + all as u32));
        }
        let mut two = apart(2);
        two.dedup();
        assert_eq!(two.len(), if all >= 2 { 2 } else { 1 }, "{two:?}");
        assert!(apart(all + 1).iter().all(Option::is_none));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_process_stays_where_it_is_kept() {
        use std::process::Command;
        let Some(processor) = ALLOWED.last().copied() else { return };
        let mut child = Command::new("sleep").arg("60").spawn().unwrap();
        keep(Some(child.id()), Some(processor));
        let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap();
        child.kill().and_then(|()| child.wait()).unwrap();
        let list = status.lines().find_map(|line| line.strip_prefix("Cpus_allowed_list:"));
        assert_eq!(list.map(str::trim), Some(&*processor.to_string()));
    }
}
