//! Default limits for memory.

use std::path::Path;
use std::sync::OnceLock;

/// Upper bound of default limits, in bytes.
const MOST: u64 = 4 << 30;
/// Number by which the machine's memory is divided for a default limit: a detector's arrays, its
/// list of pairs, the list of true contacts and the scene then fit in memory together.
const PART: u64 = 4;

/// Returns the default limit in bytes, for the arrays of a detector and for a list of pairs. It is
/// 4 GiB, or a quarter of the machine's memory if that is less. On Linux a smaller limit of the
/// control group counts as the machine's memory; on other systems the result is 4 GiB.
pub fn default_limit() -> u64 {
    static LIMIT: OnceLock<u64> = OnceLock::new();
    *LIMIT.get_or_init(|| total().map_or(MOST, |total| (total / PART).min(MOST)))
}

/// Returns the limit in bytes for one list while a file is read: half of the machine's memory. Many
/// systems kill a process without a message when memory runs out.
pub fn most_of_one() -> u64 {
    static MOST_OF_ONE: OnceLock<u64> = OnceLock::new();
    *MOST_OF_ONE.get_or_init(|| total().map_or(u64::MAX, |total| total / 2))
}

/// Returns the default limit in bytes for a scene with this many particles: 16 KiB per particle, at
/// least 256 MiB and at most [`default_limit`]. So huge grids between a few distant particles are
/// refused.
pub fn limit_for(particles: usize) -> u64 {
    let wanted = (particles as u64).saturating_mul(16 << 10).max(256 << 20);
    wanted.min(default_limit())
}

/// Returns the bytes of memory of the machine, or of its control group if that is less.
fn total() -> Option<u64> {
    let read = |path: &str| std::fs::read_to_string(path).ok();
    let machine = read("/proc/meminfo").and_then(|text| of_machine(&text));
    let groups = read("/proc/self/cgroup").unwrap_or_default();
    let group = of_groups(&groups).filter_map(|path| read(&path)?.trim().parse().ok());
    machine.into_iter().chain(group).filter(|&bytes| bytes > 0).min()
}

/// Returns the files with the limits of the process's control groups and of all groups above these,
/// because batch systems and services set limits below the root. A group of version 2 is the line
/// `0::/path`, and one of version 1 `3:memory:/path`.
fn of_groups(text: &str) -> impl Iterator<Item = String> {
    const ROOT: &str = "/sys/fs/cgroup";
    // The roots are added, because the text need not name the root of a container.
    let roots = [("", "/"), ("memory", "/")];
    let lines = text.lines().filter_map(|line| {
        let (controllers, path) = line.split_once(':')?.1.split_once(':')?;
        controllers.split(',').find(|name| matches!(*name, "" | "memory")).map(|name| (name, path))
    });
    roots.into_iter().chain(lines).flat_map(|(controller, path)| {
        Path::new(path).ancestors().filter_map(Path::to_str).map(move |path| {
            let path = path.trim_end_matches('/');
            match controller {
                "memory" => format!("{ROOT}/memory{path}/memory.limit_in_bytes"),
                _ => format!("{ROOT}{path}/memory.max"),
            }
        })
    })
}

/// Parses the line `MemTotal:  16384000 kB` and returns the number of bytes.
fn of_machine(text: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix("MemTotal:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_include_the_group_and_its_ancestors() {
        let files = |text: &str| of_groups(text).skip(2).collect::<Vec<_>>();
        let root = "/sys/fs/cgroup";
        assert_eq!(
            files("0::/system.slice/job\n"),
            ["/system.slice/job", "/system.slice", ""].map(|at| format!("{root}{at}/memory.max"))
        );
        assert_eq!(
            files("5:cpu,cpuacct:/a\n4:memory:/slurm/job\n1:name=systemd:/b\n"),
            ["/slurm/job", "/slurm", ""]
                .map(|at| format!("{root}/memory{at}/memory.limit_in_bytes"))
        );
        let roots: Vec<String> = of_groups("").collect();
        assert_eq!(
            roots,
            ["/memory.max", "/memory/memory.limit_in_bytes"].map(|at| format!("{root}{at}"))
        );
    }

    #[test]
    fn the_limit_is_a_fraction_of_the_memory() {
        let text = "MemTotal:       16384000 kB\nMemFree:         100 kB\n";
        assert_eq!(of_machine(text), Some(16_384_000 * 1024));
        assert_eq!(of_machine("MemTotal: much"), None);
        let limit = default_limit();
        assert!((1 << 20..=MOST).contains(&limit), "{limit}");
        assert_eq!([0, 2, usize::MAX].map(limit_for), [256 << 20, 256 << 20, limit]);
        assert_eq!(limit_for(20_000), (20_000u64 << 14).min(limit));
        if let Some(total) = total() {
            assert!(limit <= total / PART);
        }
    }
}
