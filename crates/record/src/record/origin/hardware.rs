//! The hardware of a machine, as its operating system reports it. Machines with one name may differ
//! in hardware. Fields that the system does not report are unknown.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use contactbench_terms::number::bytes;

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Hardware {
    pub cpu: Option<String>,
    pub cpu_vendor: Option<String>,
    /// Family, model and stepping distinguish processors that share a name.
    pub cpu_family: Option<u64>,
    pub cpu_model: Option<u64>,
    pub cpu_stepping: Option<u64>,
    pub cpu_features: Option<Vec<String>>,
    pub cores: Option<u64>,
    /// Size (`32K`) of each cache, by level and kind (`L1d`, `L1i`, `L2`, `L3`).
    pub caches: BTreeMap<String, String>,
    pub memory_bytes: Option<u64>,
}

impl Hardware {
    pub fn here() -> Hardware {
        let cores = std::thread::available_parallelism().ok().map(|cores| cores.get() as u64);
        Hardware { cores, cpu_features: features(), ..system() }
    }

    /// Whether the two may be one machine. Fields known of only one of them are ignored, since a
    /// container may hide the sizes of the caches.
    pub fn may_be(&self, other: &Hardware) -> bool {
        // The kernel reserves some memory, which may vary.
        let memory = match (self.memory_bytes, other.memory_bytes) {
            (Some(a), Some(b)) => a.abs_diff(b) <= a.max(b) / 50,
            _ => true,
        };
        let others = other.known();
        let alike = |(name, value): (String, Value)| {
            name == "memory_bytes" || others.get(&name).is_none_or(|other| *other == value)
        };
        memory && self.known().into_iter().all(alike)
    }

    /// The known fields by name; each cache is a field.
    fn known(&self) -> BTreeMap<String, Value> {
        let mut fields: BTreeMap<String, Value> =
            serde_json::from_value(json!(self)).unwrap_or_default();
        fields.remove("caches");
        fields.extend(self.caches.iter().map(|(name, size)| (name.clone(), json!(size))));
        fields.retain(|_, value| !value.is_null());
        fields
    }
}

/// Names of the second- and third-level caches in a provenance, and their bytes.
pub fn caches_of(provenance: Option<&Value>) -> Vec<(String, u64)> {
    let size = |name: &str| provenance?.get("caches")?.get(name)?.as_str().and_then(bytes);
    ["L2", "L3"].into_iter().filter_map(|name| Some((name.to_string(), size(name)?))).collect()
}

macro_rules! detected {
    ($test:ident: $($name:tt)*) => {{
        let known = [$(($name, std::arch::$test!($name))),*];
        Some(known.iter().filter(|(_, has)| *has).map(|(name, _)| name.to_string()).collect())
    }};
}

fn features() -> Option<Vec<String>> {
    #[cfg(any(target_arch = "x86_64", target_arch = "x86"))]
    return detected!(is_x86_feature_detected: "sse4.2" "popcnt" "avx" "avx2" "fma" "bmi1" "bmi2"
        "lzcnt" "avx512f" "avx512bw" "avx512cd" "avx512dq" "avx512vl" "avx512vbmi" "avx512vbmi2");
    #[cfg(target_arch = "aarch64")]
    return detected!(is_aarch64_feature_detected: "neon" "fp16" "dotprod" "lse" "sve" "sve2");
    #[cfg(not(any(target_arch = "x86_64", target_arch = "x86", target_arch = "aarch64")))]
    return None;
}

#[cfg(target_os = "linux")]
fn system() -> Hardware {
    let read = |path: &str| std::fs::read_to_string(path).unwrap_or_default();
    let mut caches = BTreeMap::new();
    for index in 0..8 {
        let folder = format!("/sys/devices/system/cpu/cpu0/cache/index{index}");
        let [level, kind, size] =
            ["level", "type", "size"].map(|it| read(&format!("{folder}/{it}")));
        let kind = match kind.trim() {
            "Data" => "d",
            "Instruction" => "i",
            _ => "",
        };
        if !size.is_empty() {
            caches.insert(format!("L{}{kind}", level.trim()), size.trim().to_string());
        }
    }
    let memory = field(&read("/proc/meminfo"), "MemTotal");
    let memory = memory.and_then(|said| bytes(&said.replace(" kB", "K")));
    Hardware { caches, memory_bytes: memory, ..processor(&read("/proc/cpuinfo")) }
}

#[cfg(all(unix, not(target_os = "linux")))]
fn system() -> Hardware {
    let output = std::process::Command::new("sysctl").args(["machdep.cpu", "hw"]).output();
    let said = output.map_or(String::new(), |it| String::from_utf8_lossy(&it.stdout).into_owned());
    Hardware { caches: caches(&said), memory_bytes: count(&said, "hw.memsize"), ..processor(&said) }
}

/// The processor is, for example, `Intel64 Family 6 Model 143 Stepping 8, GenuineIntel`.
#[cfg(windows)]
fn system() -> Hardware {
    Hardware { cpu: std::env::var("PROCESSOR_IDENTIFIER").ok(), ..Hardware::default() }
}

/// Parses the first processor in lines `name: value`, as Linux writes them for x86 and Arm, and
/// `sysctl` for macOS.
#[cfg(any(unix, test))]
fn processor(said: &str) -> Hardware {
    let text = |names: [&str; 3]| names.into_iter().find_map(|name| field(said, name));
    let number = |names: &[&str]| names.iter().find_map(|name| count(said, name));
    Hardware {
        cpu: text(["model name", "Processor", "machdep.cpu.brand_string"]),
        cpu_vendor: text(["vendor_id", "CPU implementer", "machdep.cpu.vendor"]),
        cpu_family: number(&["cpu family", "CPU variant", "machdep.cpu.family", "hw.cpufamily"]),
        cpu_model: number(&["model", "CPU part", "machdep.cpu.model", "hw.cpusubfamily"]),
        cpu_stepping: number(&["stepping", "CPU revision", "machdep.cpu.stepping"]),
        ..Hardware::default()
    }
}

#[cfg(any(all(unix, not(target_os = "linux")), test))]
fn caches(said: &str) -> BTreeMap<String, String> {
    let names = [
        ("L1d", "hw.l1dcachesize"),
        ("L1i", "hw.l1icachesize"),
        ("L2", "hw.l2cachesize"),
        ("L3", "hw.l3cachesize"),
    ];
    let known = names.into_iter().filter_map(|(level, name)| Some((level, count(said, name)?)));
    let known = known.filter(|(_, bytes)| *bytes > 0);
    known.map(|(level, bytes)| (level.to_string(), format!("{}K", bytes >> 10))).collect()
}

#[cfg(any(unix, test))]
fn field(lines: &str, name: &str) -> Option<String> {
    let value = lines.lines().find_map(|line| {
        let (known, value) = line.split_once(':')?;
        (known.trim() == name).then(|| value.trim())
    })?;
    (!value.is_empty()).then(|| value.to_string())
}

#[cfg(any(unix, test))]
fn count(lines: &str, name: &str) -> Option<u64> {
    let text = field(lines, name)?;
    match text.strip_prefix("0x") {
        Some(digits) => u64::from_str_radix(digits, 16).ok(),
        None => text.parse().ok(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn xeon(l3: &str) -> Hardware {
        let caches = [("L2", "2048K"), ("L3", l3)];
        Hardware {
            cpu: Some("Intel(R) Xeon(R) Processor".into()),
            cpu_family: Some(6),
            cpu_model: Some(143),
            cpu_stepping: Some(8),
            cores: Some(2),
            caches: caches.map(|(name, size)| (name.to_string(), size.to_string())).into(),
            memory_bytes: Some(25_276_502_016),
            ..Hardware::default()
        }
    }

    #[test]
    fn processors_of_one_name_are_told_apart() {
        let one = xeon("491520K");
        assert!(one.may_be(&one.clone()));
        assert!(one.may_be(&Hardware { memory_bytes: Some(25_200_000_000), ..one.clone() }));
        let older =
            Hardware { cpu_family: None, cpu_model: None, cpu_stepping: None, ..one.clone() };
        let oldest = Hardware { caches: BTreeMap::new(), memory_bytes: None, ..older.clone() };
        assert!(one.may_be(&older) && older.may_be(&one) && oldest.may_be(&oldest));
        assert!(one.may_be(&oldest) && oldest.may_be(&one));
        let half = Hardware { caches: xeon("491520K").caches, ..oldest.clone() };
        assert!(one.may_be(&half));
        let features = |name: &str| Some(vec![name.to_string()]);
        let avx2 = Hardware { cpu_features: features("avx2"), ..one.clone() };
        assert!(avx2.may_be(&one));
        for other in [
            xeon("307200K"),
            Hardware { cpu_family: Some(25), ..one.clone() },
            Hardware { cpu_model: Some(106), ..one.clone() },
            Hardware { cpu_stepping: Some(4), ..one.clone() },
            Hardware { cpu_features: features("avx"), ..one.clone() },
            Hardware { memory_bytes: Some(1 << 34), ..one.clone() },
            Hardware { cores: Some(4), ..one.clone() },
        ] {
            assert!(!avx2.may_be(&other) && !other.may_be(&avx2), "{other:?}");
        }
    }

    #[test]
    fn the_hardware_here_is_the_same_twice_and_survives_the_provenance() {
        let here = Hardware::here();
        assert_eq!(here, Hardware::here());
        let mut fields = serde_json::to_value(&here).unwrap();
        fields["command"] = "contactbench run".into();
        assert_eq!(serde_json::from_value::<Hardware>(fields).unwrap(), here);
        let fields = serde_json::json!({"caches": {"L1d": "48K", "L2": "2048K"}});
        assert_eq!(caches_of(Some(&fields)), [("L2".into(), 2 << 20)]);
    }

    #[test]
    fn what_systems_say_is_read() {
        let said = "machdep.cpu.brand_string: Apple M2\nhw.cpufamily: 3660830781\n\
                    hw.cpusubfamily: 2\nhw.l1dcachesize: 65536\nhw.l2cachesize: 4194304\n\
                    hw.l3cachesize: 0\n";
        let (mac, caches) = (processor(said), caches(said));
        assert_eq!(mac.cpu.as_deref(), Some("Apple M2"));
        assert_eq!((mac.cpu_family, mac.cpu_model), (Some(3_660_830_781), Some(2)));
        assert_eq!((&*caches["L1d"], &*caches["L2"], caches.len()), ("64K", "4096K", 2));
        let arm = processor(
            "processor\t: 0\nFeatures\t: fp asimd\nCPU implementer\t: 0x41\nCPU variant\t: 0x3\n\
             CPU part\t: 0xd0c\nCPU revision\t: 1\n",
        );
        let numbers = (arm.cpu_family, arm.cpu_model, arm.cpu_stepping);
        assert_eq!(numbers, (Some(3), Some(0xd0c), Some(1)));
        assert_eq!(arm.cpu_vendor.as_deref(), Some("0x41"));
        assert_eq!(processor("no colon"), Hardware::default());
    }
}
