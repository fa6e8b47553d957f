//! The origin of a result: command, revision, compiler, machine, load.

use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use serde_json::{Map, Value, json};

use crate::record::folder::{copies, entries, is_provenance, seal};
use crate::record::origin::built::build;
use crate::record::origin::hardware::Hardware;
use crate::record::row::SCHEMA;
use contactbench_terms::must;

pub const FILE: &str = "provenance.json";

pub fn gather(experiments: &[String], quick: bool, shard: Option<String>, label: &str) -> Value {
    let number = |text: &str| text.trim_matches([' ', '\t', ':', '\n']).parse::<f64>().ok();
    let clock =
        read("/proc/cpuinfo").lines().find_map(|line| number(line.strip_prefix("cpu MHz")?));
    let highest = number(&read("/sys/devices/system/cpu/cpu0/cpufreq/cpuinfo_max_freq"));
    let build = build();
    let mut all = json!({
        "command": command(std::env::args().skip(1)),
        "record_schema": SCHEMA,
        "experiments": experiments,
        "quick": quick,
        "date_utc": date(),
        "contactbench": env!("CARGO_PKG_VERSION"),
        "revision": revision(),
        "dirty": dirty(),
        "rustc": build.rustc,
        "rustflags": build.rustflags,
        "profile": build.profile,
        "machine": label,
        "host": machine(),
        "os": format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
        "kernel": read("/proc/sys/kernel/osrelease").trim(),
        "cpu_mhz": clock,
        "cpu_mhz_highest": highest.map(|khz| khz / 1000.0),
        "load_average": read("/proc/loadavg").split(' ').take(3).collect::<Vec<_>>().join(" "),
    });
    let hardware = json!(Hardware::here());
    for (name, value) in hardware.as_object().into_iter().flatten() {
        all[name] = value.clone();
    }
    if let Some(shard) = shard {
        all["shard"] = json!(shard);
    }
    all
}

/// Joins the words of a command; absolute paths are reduced to their last part.
pub fn command(words: impl Iterator<Item = String>) -> String {
    let told = |word: String| {
        let (option, value) = word.split_at(word.find('=').map_or(0, |equals| equals + 1));
        let last = Path::new(value).is_absolute().then(|| Path::new(value).file_name()).flatten();
        last.map_or(word.clone(), |last| format!("{option}{}", last.to_string_lossy()))
    };
    std::iter::once("contactbench".into()).chain(words.map(told)).collect::<Vec<_>>().join(" ")
}

/// Returns the text of a file, which is empty if the file does not exist (as outside of Linux).
fn read(path: &str) -> String {
    std::fs::read_to_string(path).unwrap_or_default()
}

/// The last commit that changed a source file of this program; `None` outside of a checkout.
pub fn revision() -> Option<&'static str> {
    Some(build().revision).filter(|revision| *revision != "unknown")
}

/// Whether source files differed from that commit; `None` outside of a checkout.
pub fn dirty() -> Option<bool> {
    build().dirty.parse().ok()
}

pub fn machine() -> String {
    #[cfg(unix)]
    let name = rustix::system::uname().nodename().to_string_lossy().into_owned();
    #[cfg(not(unix))]
    let name = std::env::var("COMPUTERNAME").unwrap_or_default();
    let name: String =
        name.trim().chars().filter(|c| c.is_ascii_alphanumeric() || *c == '-').take(24).collect();
    if name.is_empty() { "machine".into() } else { name }
}

pub fn text(fields: &Value) -> serde_json::Result<String> {
    let mut fields = fields.clone();
    if let Some(fields) = fields.as_object_mut() {
        fields.remove(seal::NAME);
    }
    Ok(seal::sealed(&serde_json::to_string_pretty(&fields)?) + "\n")
}

/// Fails if a field has another type than programs write, or if `quick` contradicts the command.
pub(crate) fn sound(fields: &Map<String, Value>) -> Result<(), String> {
    let texts = |it: &Value| it.as_array().is_some_and(|all| all.iter().all(Value::is_string));
    let named = |it: &Value| it.as_object().is_some_and(|all| all.values().all(Value::is_string));
    for (name, value) in fields.iter().filter(|(_, value)| !value.is_null()) {
        let is_valid = match &**name {
            "quick" | "dirty" => value.is_boolean(),
            "cpu_mhz" | "cpu_mhz_highest" => value.is_number(),
            "record_schema" | "cpu_family" | "cpu_model" | "cpu_stepping" | "cores"
            | "memory_bytes" => value.is_u64(),
            "experiments" | "cpu_features" | "features" | "merged_from" => texts(value),
            "caches" | copies::FIELD => named(value),
            "machines" => {
                let machines = value.as_object().into_iter().flat_map(Map::values);
                machines.filter_map(Value::as_object).try_for_each(sound)?;
                value.is_object()
            }
            _ => value.is_string(),
        };
        must!(is_valid, "its {name} is {value}, which has another type");
    }
    let mut command = fields.get("command").and_then(Value::as_str).unwrap_or("").split(' ');
    let is_whole = fields.get("quick") == Some(&false.into());
    must!(!is_whole || !command.any(|word| word == "--quick"), "quick is false beside --quick");
    Ok(())
}

pub fn of_folder(folder: &Path) -> Option<Value> {
    fields(&folder.join(FILE))
}

fn fields(path: &Path) -> Option<Value> {
    serde_json::from_slice(&std::fs::read(path).ok()?).ok()
}

/// Reads the files `provenance-*.json` of a folder.
pub fn of_others(folder: &Path) -> Vec<Value> {
    let mut paths = entries(folder);
    paths.retain(|path| is_provenance(path) && !path.ends_with(FILE));
    // Sorting by length first puts part 10 after part 9.
    paths.sort_by_key(|path| path.as_os_str().len());
    paths.iter().filter_map(|path| fields(path)).collect()
}

pub fn all(folder: &Path) -> Vec<Value> {
    of_folder(folder).into_iter().chain(of_others(folder)).collect()
}

/// The current time (UTC) for a folder name, such as 2004-03-01T12-30-59.
pub fn date() -> String {
    date_after(0)
}

/// Like [`date`], this many seconds from now.
pub fn date_after(seconds: u64) -> String {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    dated(now + seconds)
}

/// Like [`date`], of a time in seconds since 1970.
pub fn dated(seconds: u64) -> String {
    let (year, month, day) = civil(seconds / 86_400);
    let time = seconds % 86_400;
    format!(
        "{year:04}-{month:02}-{day:02}T{:02}-{:02}-{:02}",
        time / 3600,
        time / 60 % 60,
        time % 60
    )
}

/// Year, month and day of a day counted from 1970-01-01, by eras of 400 years that begin in March
/// (H. Hinnant, chrono-compatible low-level date algorithms).
fn civil(day: u64) -> (u64, u64, u64) {
    let day = day + 719_468;
    let (era, day) = (day / 146_097, day % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let january = month >= 10;
    let number = if january { month - 9 } else { month + 3 };
    (era * 400 + year + u64::from(january), number, day - (153 * month + 2) / 5 + 1)
}

#[cfg(test)]
mod tests {
    use super::{civil, command};

    #[test]
    #[cfg(unix)]
    fn a_command_names_no_folders_of_one_machine() {
        let of = |text: &str| command(text.split(' ').map(str::to_string));
        let out = of("run codes --out /home/me/x/codes --label=/y/z --where a=1/2 --radius 0.5");
        assert_eq!(out, "contactbench run codes --out codes --label=z --where a=1/2 --radius 0.5");
        assert_eq!(of("run / results/a"), "contactbench run / results/a");
    }

    #[test]
    fn days_become_dates() {
        assert_eq!(civil(0), (1970, 1, 1));
        assert_eq!(civil(11_016), (2000, 2, 29));
        assert_eq!(civil(11_017), (2000, 3, 1));
        assert_eq!(civil(20_453), (2025, 12, 31));
    }
}
