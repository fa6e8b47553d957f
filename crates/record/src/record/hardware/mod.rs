//! What a machine is made of, as far as it says: what tells two machines of one name apart. What
//! cannot be known stays unknown, on any system.
//!
//! Processors of the x86 family are asked themselves (CPUID), so that the answer does not depend on
//! the system; caches come from the system where it knows them, because cores may differ.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// Processor, caches and memory of a machine. Its fields are fields of the provenance.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Hardware {
    /// The processor's name, as its maker gives it.
    pub cpu: Option<String>,
    /// Its maker.
    pub cpu_vendor: Option<String>,
    /// Family, model and stepping: the numbers by which makers tell processors apart that may have
    /// one name.
    pub cpu_family: Option<u64>,
    /// See `cpu_family`.
    pub cpu_model: Option<u64>,
    /// See `cpu_family`.
    pub cpu_stepping: Option<u64>,
    /// Fingerprint of everything that the processor says it can do: 16 hexadecimal digits.
    pub cpu_flags: Option<String>,
    /// What of this detectors and compilers make use of, as the compiler calls it.
    pub cpu_features: Option<Vec<String>>,
    /// Cores that this program may use.
    pub cores: Option<u64>,
    /// Level and kind (`L1d`, `L1i`, `L2`, `L3`) to size (`32K`).
    pub caches: BTreeMap<String, String>,
    /// Bytes of memory.
    pub memory_bytes: Option<u64>,
}

impl Hardware {
    /// That of this machine.
    pub fn here() -> Hardware {
        let (processor, system) = (processor(), system());
        let caches = match system.caches.is_empty() {
            true => processor.caches.clone(),
            false => system.caches.clone(),
        };
        let cores = std::thread::available_parallelism().ok().map(|cores| cores.get() as u64);
        Hardware { caches, cores, ..processor.or(system) }
    }

    /// May the two be one? What one of them does not say does not tell them apart, with one
    /// exception: caches that are known of one only, because processors of one name differ in them.
    pub fn may_be(&self, other: &Hardware) -> bool {
        fn alike<T: PartialEq>(a: &Option<T>, b: &Option<T>) -> bool {
            a.is_none() || b.is_none() || a == b
        }
        // A kernel keeps some of the memory, not always the same.
        let memory = match (self.memory_bytes, other.memory_bytes) {
            (Some(a), Some(b)) => a.abs_diff(b) <= a.max(b) / 50,
            _ => true,
        };
        alike(&self.cpu, &other.cpu)
            && alike(&self.cpu_vendor, &other.cpu_vendor)
            && alike(&self.cpu_family, &other.cpu_family)
            && alike(&self.cpu_model, &other.cpu_model)
            && alike(&self.cpu_stepping, &other.cpu_stepping)
            && alike(&self.cpu_flags, &other.cpu_flags)
            && alike(&self.cores, &other.cores)
            && self.caches == other.caches
            && memory
    }

    /// With what is known of the same machine from elsewhere.
    pub fn or(self, other: Hardware) -> Hardware {
        Hardware {
            cpu: self.cpu.or(other.cpu),
            cpu_vendor: self.cpu_vendor.or(other.cpu_vendor),
            cpu_family: self.cpu_family.or(other.cpu_family),
            cpu_model: self.cpu_model.or(other.cpu_model),
            cpu_stepping: self.cpu_stepping.or(other.cpu_stepping),
            cpu_flags: self.cpu_flags.or(other.cpu_flags),
            cpu_features: self.cpu_features.or(other.cpu_features),
            cores: self.cores.or(other.cores),
            caches: if self.caches.is_empty() { other.caches } else { self.caches },
            memory_bytes: self.memory_bytes.or(other.memory_bytes),
        }
    }
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

/// What the processor says of itself.
#[cfg(any(target_arch = "x86_64", target_arch = "x86"))]
fn processor() -> Hardware {
    #[cfg(target_arch = "x86")]
    use std::arch::x86::__cpuid_count;
    #[cfg(target_arch = "x86_64")]
    use std::arch::x86_64::__cpuid_count;

    // A leaf beyond the last answers with that of another: then there is nothing.
    let (last, last_extended) = (__cpuid_count(0, 0).eax, __cpuid_count(0x8000_0000, 0).eax);
    let ask = |leaf: u32, part: u32| {
        let there = if leaf >= 0x8000_0000 { leaf <= last_extended } else { leaf <= last };
        let said = if there { __cpuid_count(leaf, part) } else { return [0; 4] };
        [said.eax, said.ebx, said.ecx, said.edx]
    };
    let [_, b, c, d] = ask(0, 0);
    let vendor = text(&[b, d, c]);
    let name: Vec<u32> = (0x8000_0002..=0x8000_0004).flat_map(|leaf| ask(leaf, 0)).collect();
    let [signature, _, c1, d1] = ask(1, 0);
    let (family, model, stepping) = signature_of(signature);
    let ([_, b7, c7, d7], [_, _, cx, dx]) = (ask(7, 0), ask(0x8000_0001, 0));
    // Two flags tell what the system has switched on.
    let flags = [c1 & !(1 << 27), d1, b7, c7 & !(1 << 4), d7, ask(7, 1)[0], cx, dx];
    // Cores of several kinds have caches of several sizes.
    let hybrid = d7 >> 15 & 1 == 1;
    let leaf = if vendor.as_deref() == Some("AuthenticAMD") { 0x8000_001d } else { 4 };
    let caches = (0..8).map(|k| ask(leaf, k)).take_while(|said| said[0] & 31 != 0);
    let caches = caches.filter_map(cache_of).filter(|(name, _)| !hybrid || name == "L3").collect();
    macro_rules! known {
        ($($name:tt)*) => {
            [$(($name, std::arch::is_x86_feature_detected!($name))),*]
        };
    }
    let features = known!("sse4.2" "popcnt" "avx" "avx2" "fma" "bmi1" "bmi2" "lzcnt" "avx512f"
        "avx512bw" "avx512cd" "avx512dq" "avx512vl" "avx512vbmi" "avx512vbmi2");
    Hardware {
        cpu: text(&name),
        cpu_vendor: vendor,
        cpu_family: Some(family),
        cpu_model: Some(model),
        cpu_stepping: Some(stepping),
        cpu_flags: Some(fingerprint(flags.into_iter().map(u64::from))),
        cpu_features: Some(detected(&features)),
        caches,
        ..Hardware::default()
    }
}

/// The processor says nothing to a program: see [`system`].
#[cfg(not(any(target_arch = "x86_64", target_arch = "x86")))]
fn processor() -> Hardware {
    #[cfg(target_arch = "aarch64")]
    let features = {
        macro_rules! known {
            ($($name:tt)*) => {
                [$(($name, std::arch::is_aarch64_feature_detected!($name))),*]
            };
        }
        Some(detected(&known!("neon" "fp16" "dotprod" "lse" "sve" "sve2")))
    };
    #[cfg(not(target_arch = "aarch64"))]
    let features = None;
    Hardware { cpu_features: features, ..Hardware::default() }
}

#[cfg(any(target_arch = "x86_64", target_arch = "x86", target_arch = "aarch64"))]
fn detected(known: &[(&str, bool)]) -> Vec<String> {
    known.iter().filter(|(_, has)| *has).map(|(name, _)| name.to_string()).collect()
}

#[cfg(any(target_arch = "x86_64", target_arch = "x86", target_os = "linux", test))]
fn fingerprint(words: impl Iterator<Item = u64>) -> String {
    let sum = words.fold(0, |sum, word| contactbench_terms::mix::splitmix64(sum ^ word));
    format!("{sum:016x}")
}

/// Registers as text: runs of spaces are one, as systems show it.
#[cfg(any(target_arch = "x86_64", target_arch = "x86", test))]
fn text(registers: &[u32]) -> Option<String> {
    let bytes: Vec<u8> = registers.iter().flat_map(|word| word.to_le_bytes()).collect();
    let bytes = bytes.split(|&byte| byte == 0).next()?;
    let words = String::from_utf8_lossy(bytes);
    let words: Vec<&str> = words.split_whitespace().collect();
    (!words.is_empty()).then(|| words.join(" "))
}

/// Family, model and stepping of a processor's signature.
#[cfg(any(target_arch = "x86_64", target_arch = "x86", test))]
fn signature_of(signature: u32) -> (u64, u64, u64) {
    let bits = |from: u32, mask: u32| u64::from(signature >> from & mask);
    let (base, stepping) = (bits(8, 15), bits(0, 15));
    let family = if base == 15 { base + bits(20, 255) } else { base };
    let extended = if base == 6 || base == 15 { bits(16, 15) << 4 } else { 0 };
    (family, extended + bits(4, 15), stepping)
}

/// Name and size of a cache, from the processor's words about it.
#[cfg(any(target_arch = "x86_64", target_arch = "x86", test))]
fn cache_of([a, b, c, _]: [u32; 4]) -> Option<(String, String)> {
    let kind = ["", "d", "i", ""].get((a & 31) as usize)?;
    let part = |from: u32, mask: u32| u64::from(b >> from & mask) + 1;
    let bytes = part(22, 1023) * part(12, 1023) * part(0, 4095) * (u64::from(c) + 1);
    Some((format!("L{}{kind}", a >> 5 & 7), format!("{}K", bytes >> 10)))
}

/// What Linux says.
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
    let kib = field(&read("/proc/meminfo"), "MemTotal")
        .and_then(|said| said.split(' ').next()?.parse::<u64>().ok());
    let memory_bytes = kib.map(|kib| kib * 1024);
    Hardware { caches, memory_bytes, ..linux(&read("/proc/cpuinfo")) }
}

/// The first processor of `/proc/cpuinfo`, by the names that the kernel uses on x86 and on Arm.
#[cfg(any(target_os = "linux", test))]
fn linux(cpuinfo: &str) -> Hardware {
    let say = |names: [&str; 2]| names.into_iter().find_map(|name| field(cpuinfo, name));
    let number = |names: [&str; 2]| say(names).and_then(|said| number(&said));
    let flags = say(["flags", "Features"]);
    Hardware {
        cpu: say(["model name", "Processor"]),
        cpu_vendor: say(["vendor_id", "CPU implementer"]),
        cpu_family: number(["cpu family", "CPU variant"]),
        cpu_model: number(["model", "CPU part"]),
        cpu_stepping: number(["stepping", "CPU revision"]),
        cpu_flags: flags.map(|flags| fingerprint(flags.bytes().map(u64::from))),
        ..Hardware::default()
    }
}

/// What macOS says.
#[cfg(target_os = "macos")]
fn system() -> Hardware {
    let names = [
        "machdep.cpu.brand_string",
        "machdep.cpu.family",
        "machdep.cpu.model",
        "machdep.cpu.stepping",
        "hw.cpufamily",
        "hw.cpusubfamily",
        "hw.l1dcachesize",
        "hw.l1icachesize",
        "hw.l2cachesize",
        "hw.l3cachesize",
        "hw.memsize",
    ];
    // It leaves out the names that it does not know, and fails for them.
    macos(&output("sysctl", &names))
}

/// The lines of `sysctl`.
#[cfg(any(target_os = "macos", test))]
fn macos(said: &str) -> Hardware {
    let read = |name: &str| field(said, name).and_then(|said| number(&said));
    let cache = |(level, name): (&str, &str)| {
        let bytes = read(name).filter(|&bytes| bytes > 0)?;
        Some((level.to_string(), format!("{}K", bytes >> 10)))
    };
    let caches = [
        ("L1d", "hw.l1dcachesize"),
        ("L1i", "hw.l1icachesize"),
        ("L2", "hw.l2cachesize"),
        ("L3", "hw.l3cachesize"),
    ];
    Hardware {
        cpu: field(said, "machdep.cpu.brand_string"),
        cpu_family: read("machdep.cpu.family").or_else(|| read("hw.cpufamily")),
        cpu_model: read("machdep.cpu.model").or_else(|| read("hw.cpusubfamily")),
        cpu_stepping: read("machdep.cpu.stepping"),
        caches: caches.into_iter().filter_map(cache).collect(),
        memory_bytes: read("hw.memsize"),
        ..Hardware::default()
    }
}

/// What Windows says.
#[cfg(windows)]
fn system() -> Hardware {
    let key = r"HKLM\HARDWARE\DESCRIPTION\System\CentralProcessor\0";
    windows(&output("reg", &["query", key]))
}

/// The lines of `reg query`: name, type, value.
#[cfg(any(windows, test))]
fn windows(said: &str) -> Hardware {
    let value = |name: &str| {
        let line = said.lines().find_map(|line| line.trim().strip_prefix(name))?;
        let value: Vec<&str> = line.split_whitespace().skip(1).collect();
        (!value.is_empty()).then(|| value.join(" "))
    };
    // `Intel64 Family 6 Model 143 Stepping 8`; Arm says Revision.
    let identifier = value("Identifier").unwrap_or_default();
    let after = |names: [&str; 2]| {
        let mut words = identifier.split(' ').skip_while(|word| !names.contains(word));
        words.nth(1)?.parse().ok()
    };
    Hardware {
        cpu: value("ProcessorNameString"),
        cpu_vendor: value("VendorIdentifier"),
        cpu_family: after(["Family", "family"]),
        cpu_model: after(["Model", "model"]),
        cpu_stepping: after(["Stepping", "Revision"]),
        ..Hardware::default()
    }
}

/// A system that says nothing here.
#[cfg(not(any(target_os = "linux", target_os = "macos", windows)))]
fn system() -> Hardware {
    Hardware::default()
}

/// What a program of the system prints; nothing where there is none.
#[cfg(any(target_os = "macos", windows))]
fn output(program: &str, arguments: &[&str]) -> String {
    let output = std::process::Command::new(program).args(arguments).output();
    output.map_or(String::new(), |output| String::from_utf8_lossy(&output.stdout).into_owned())
}

/// The value of the first line `name: value`, if there is something.
#[cfg(any(target_os = "linux", target_os = "macos", test))]
fn field(lines: &str, name: &str) -> Option<String> {
    let value = lines.lines().find_map(|line| {
        let (known, value) = line.split_once(':')?;
        (known.trim() == name).then(|| value.trim())
    })?;
    (!value.is_empty()).then(|| value.to_string())
}

/// A whole number, decimal or with `0x`.
#[cfg(any(target_os = "linux", target_os = "macos", test))]
fn number(text: &str) -> Option<u64> {
    match text.strip_prefix("0x") {
        Some(digits) => u64::from_str_radix(digits, 16).ok(),
        None => text.parse().ok(),
    }
}

#[cfg(test)]
mod tests;
