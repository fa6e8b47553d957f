//! Where a result comes from: command, revision, compiler, machine, load.

use std::path::Path;
use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::record::row::SCHEMA;

/// The memory bandwidth measured before a run, in bytes per second.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bandwidth {
    /// Threads at work.
    pub threads: usize,
    /// Bytes of one of the three arrays, over all threads.
    pub array_bytes: u64,
    /// Adding up an array.
    pub read: f64,
    /// Filling an array.
    pub write: f64,
    /// a = b + s c.
    pub triad: f64,
}

/// The name of the provenance file in a result folder.
pub const FILE: &str = "provenance.json";

/// What there is to know about this run, as a JSON object; the bandwidths are those measured, if
/// any were.
pub fn gather(
    experiments: &[String],
    quick: bool,
    shard: Option<String>,
    bandwidth: &[Bandwidth],
) -> Value {
    let cpu = read("/proc/cpuinfo");
    let of_cpu = |name: &str| {
        cpu.lines()
            .find_map(|line| line.strip_prefix(name))
            .map(|rest| rest.trim_start_matches([' ', '\t', ':']))
    };
    let model = of_cpu("model name").map(String::from);
    let clock = of_cpu("cpu MHz").and_then(|clock| clock.parse::<f64>().ok());
    let highest = read("/sys/devices/system/cpu/cpu0/cpufreq/cpuinfo_max_freq")
        .trim()
        .parse::<f64>()
        .ok()
        .map(|khz| khz / 1000.0);
    let memory = read("/proc/meminfo")
        .lines()
        .next()
        .and_then(|line| line.split_whitespace().nth(1)?.parse::<u64>().ok())
        .map(|kib| kib * 1024);
    let command: Vec<String> =
        std::iter::once("contactbench".into()).chain(std::env::args().skip(1)).collect();
    let command = command.join(" ");
    let mut all = json!({
        "command": command,
        "record_schema": SCHEMA,
        "experiments": experiments,
        "quick": quick,
        "date_utc": date(),
        "contactbench": env!("CARGO_PKG_VERSION"),
        "revision": revision(),
        "dirty": git(&["status", "--porcelain"]).map(|changes| !changes.is_empty()),
        "rustc": env!("CONTACTBENCH_RUSTC"),
        "rustflags": env!("CONTACTBENCH_RUSTFLAGS"),
        "profile": env!("CONTACTBENCH_PROFILE"),
        "machine": machine(),
        "os": format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
        "kernel": read("/proc/sys/kernel/osrelease").trim(),
        "cpu": model,
        "cpu_mhz": clock,
        "cpu_mhz_highest": highest,
        "cores": std::thread::available_parallelism().map(|cores| cores.get()).ok(),
        "caches": caches(),
        "memory_bytes": memory,
        "load_average": read("/proc/loadavg").split(' ').take(3).collect::<Vec<_>>().join(" "),
    });
    if let Some(shard) = shard {
        all["shard"] = json!(shard);
    }
    if !bandwidth.is_empty() {
        all["bandwidth_bytes_per_s"] = json!(bandwidth);
    }
    all
}

/// The bytes of the last cache of the first core; 0 where the system does not say.
pub fn last_cache() -> u64 {
    let caches = caches();
    caches
        .as_object()
        .into_iter()
        .flatten()
        .filter_map(|(_, size)| size_of(size.as_str()?))
        .max()
        .unwrap_or(0)
}

/// The bytes of a size as the system writes it: `48K`, `2M`.
pub fn size_of(text: &str) -> Option<u64> {
    let text = text.trim();
    let (digits, shift) = match text.chars().last()? {
        'K' => (&text[..text.len() - 1], 10),
        'M' => (&text[..text.len() - 1], 20),
        'G' => (&text[..text.len() - 1], 30),
        _ => (text, 0),
    };
    digits.parse::<u64>().ok()?.checked_mul(1 << shift)
}

/// Empty where there is no such file (not on Linux): the field is then empty, too.
fn read(path: &str) -> String {
    std::fs::read_to_string(path).unwrap_or_default()
}

/// The commit of the folder that this program was built from, as it is now: that of the program, if
/// it was built after the last commit.
pub fn revision() -> Option<String> {
    git(&["rev-parse", "HEAD"])
}

/// Answers of git, in the folder that this program was built from, if that is still a checkout.
fn git(arguments: &[&str]) -> Option<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let output = Command::new("git").arg("-C").arg(folder).args(arguments).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_string())
}

/// Caches of the first core: level and kind to size.
fn caches() -> Value {
    let mut caches = serde_json::Map::new();
    for index in 0..8 {
        let folder = format!("/sys/devices/system/cpu/cpu0/cache/index{index}");
        let (level, size) = (read(&format!("{folder}/level")), read(&format!("{folder}/size")));
        let kind = match read(&format!("{folder}/type")).trim() {
            "Data" => "d",
            "Instruction" => "i",
            _ => "",
        };
        if !size.is_empty() {
            caches.insert(format!("L{}{kind}", level.trim()), json!(size.trim()));
        }
    }
    Value::Object(caches)
}

/// The machine's name, fit for a folder name.
pub fn machine() -> String {
    let system = rustix::system::uname();
    let name: String = system
        .nodename()
        .to_string_lossy()
        .trim()
        .chars()
        .filter(|c| c.is_ascii_alphanumeric() || *c == '-')
        .take(24)
        .collect();
    if name.is_empty() { "machine".into() } else { name }
}

/// The provenance in a result folder; none where there is none, or it cannot be read.
pub fn of_folder(folder: &Path) -> Option<Value> {
    serde_json::from_slice(&std::fs::read(folder.join(FILE)).ok()?).ok()
}

/// The name of the machine that the provenance in a folder gives, if it gives one.
pub fn machine_of(folder: Option<&Path>) -> Option<String> {
    let provenance = of_folder(folder.unwrap_or(Path::new(".")))?;
    Some(provenance.get("machine")?.as_str()?.to_string())
}

/// Now, as 2004-03-01T12-30-59 (UTC), fit for a folder name.
pub fn date() -> String {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let (year, month, day) = civil(seconds / 86_400);
    let time = seconds % 86_400;
    format!(
        "{year:04}-{month:02}-{day:02}T{:02}-{:02}-{:02}",
        time / 3600,
        time / 60 % 60,
        time % 60
    )
}

/// Year, month and day of a day counted from 1970-01-01: whole years and months are taken off while
/// they fit.
fn civil(mut day: u64) -> (u64, u64, u64) {
    let leap = |year: u64| {
        year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400))
    };
    let mut year = 1970;
    while day >= 365 + u64::from(leap(year)) {
        day -= 365 + u64::from(leap(year));
        year += 1;
    }
    let lengths = [31, 28 + u64::from(leap(year)), 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let mut month = 0;
    while day >= lengths[month] {
        day -= lengths[month];
        month += 1;
    }
    (year, month as u64 + 1, day + 1)
}

#[cfg(test)]
mod tests {
    use super::{civil, size_of};

    #[test]
    fn sizes_are_read() {
        assert_eq!(
            ["48K", "2M\n", "512", "", "µ", "K"].map(size_of),
            [Some(48 << 10), Some(2 << 20), Some(512), None, None, None]
        );
    }

    #[test]
    fn days_become_dates() {
        assert_eq!(civil(0), (1970, 1, 1));
        assert_eq!(civil(11_016), (2000, 2, 29));
        assert_eq!(civil(11_017), (2000, 3, 1));
        assert_eq!(civil(20_453), (2025, 12, 31));
    }
}
