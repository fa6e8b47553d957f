//! Messages between harness and runner: one JSON object per line, over the runner's standard input
//! and output. docs/PROTOCOL.md describes them for authors of runners.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::run::runner::trajectory::Trajectory;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::pairs::sink::Digest;
use contactbench_lists::track::Step;
use contactbench_terms::mix::splitmix64;
use contactbench_terms::text::line;

/// The version of the protocol, which harness and runner must share.
pub const VERSION: u32 = 4;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "request", rename_all = "lowercase")]
pub enum Request {
    Load(Trajectory),
    /// Repeats passes until they last at least `min_ns` nanoseconds together, and times them. A
    /// pass is a reset and a detection in each frame.
    Sample {
        min_ns: u64,
    },
    Count,
    /// Measures the memory of one pass with fresh buffers.
    Memory,
    /// Runs one pass, and writes the pairs of a frame as npy: `<u4`, shape (pairs, 2); in a box
    /// `<i4`, shape (pairs, 2 + dim), with the image of the second particle.
    Pairs {
        path: PathBuf,
        /// Number of the frame, from 0; by default the last.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        frame: Option<u64>,
    },
    Quit,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "reply", rename_all = "lowercase")]
pub enum Reply {
    Hello(Box<Hello>),
    /// The trajectory is accepted; if it has one frame, the scene is in memory.
    Loaded,
    Sample(Box<Sample>),
    Count(Box<Counted>),
    Memory(Box<Memory>),
    Pairs {
        contacts: u64,
    },
    /// The runner does not support this request, which may only be count, memory or pairs.
    Unsupported,
    /// The detector cannot process this trajectory.
    Refused {
        reason: String,
    },
    /// The library behind the runner is not installed.
    Unavailable {
        /// The reason in one sentence, with the command that installs what is missing.
        reason: String,
    },
    Error {
        reason: String,
    },
}

impl Reply {
    /// Removes control characters, because texts of runners reach records, reports and terminals.
    pub fn cleaned(mut self) -> Reply {
        let clean = |text: &mut String| *text = line(text).into_owned();
        match &mut self {
            Reply::Hello(hello) => {
                let Hello { detector, arithmetic, version, build, .. } = &mut **hello;
                [detector, arithmetic, version].into_iter().for_each(clean);
                let fields = std::mem::take(build).into_iter();
                *build = fields.map(|(k, v)| (line(&k).into(), line(&v).into())).collect();
            }
            Reply::Refused { reason } | Reply::Unavailable { reason } | Reply::Error { reason } => {
                clean(reason);
            }
            _ => {}
        }
        self
    }
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Hello {
    /// Version of the protocol, which must be [`VERSION`].
    pub protocol: u32,
    pub detector: String,
    #[serde(default = "exact")]
    pub arithmetic: String,
    /// Version of the runner, or of the library behind it; may be empty.
    #[serde(default)]
    pub version: String,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub build: BTreeMap<String, String>,
    /// Whether the runner accepts only trajectories of one frame.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub at_rest: bool,
}

impl Hello {
    pub fn arithmetic(&self) -> Result<Arithmetic, String> {
        let found = Arithmetic::ALL.into_iter().find(|it| it.name() == self.arithmetic);
        found.ok_or_else(|| {
            let names = Arithmetic::names();
            format!("its hello has arithmetic '{}'; it must be one of {names}", self.arithmetic)
        })
    }
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    pub time_ns: u64,
    pub calls: u64,
    /// Time of all detections together, in nanoseconds.
    pub elapsed_ns: u64,
    /// Mean time of a detection in each frame, in nanoseconds; optional for one frame.
    #[serde(default)]
    pub step_ns: Vec<u64>,
    /// The part of `time_ns` that is spent on building neighbour lists; optional.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub building_ns: Option<u64>,
    /// Time of the detection before the timed ones, in nanoseconds; optional.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_ns: Option<u64>,
    #[serde(flatten)]
    pub found: Found,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Counted {
    pub counts: BTreeMap<String, u64>,
    #[serde(flatten)]
    pub found: Found,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    /// Peak memory in bytes, without the trajectory and the list of pairs.
    pub peak_bytes: u64,
    /// Memory held after the pass, in bytes.
    pub live_bytes: u64,
    pub allocations: u64,
    #[serde(default)]
    pub warm_allocations: Option<u64>,
    #[serde(default)]
    pub formula_bytes: Option<u64>,
    #[serde(flatten)]
    pub found: Found,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Found {
    pub contacts: u64,
    pub digest: String,
    #[serde(flatten)]
    pub steps: Steps,
}

impl From<Digest> for Found {
    fn from(digest: Digest) -> Found {
        Found { contacts: digest.contacts, digest: digest.hex(), steps: Steps::default() }
    }
}

impl From<Steps> for Found {
    fn from(steps: Steps) -> Found {
        let (contacts, digest) = steps.last();
        Found { contacts, digest, steps }
    }
}

impl Found {
    /// Returns the digest of the last frame.
    pub fn digest(&self) -> Result<Digest, String> {
        digest(self.contacts, &self.digest)
    }

    pub fn answers(&self) -> Result<Vec<Digest>, String> {
        let Steps { contacts, digests, .. } = &self.steps;
        match self.steps.is_empty() {
            true => Ok(vec![self.digest()?]),
            false => contacts.iter().zip(digests).map(|(&n, text)| digest(n, text)).collect(),
        }
    }

    /// Returns the number of contacts in all frames, and a chained hash of the digests of frames.
    /// For one frame, returns its digest instead.
    pub fn whole(&self) -> (u64, String) {
        let Found { contacts, digest: text, steps } = self;
        if steps.digests.len() < 2 {
            return (*contacts, text.clone());
        }
        let sum = |text: &String| digest(0, text).map_or(0, |digest| digest.sum);
        let sums = steps.digests.iter().map(sum);
        let chain = sums.fold(0, |hash, sum| splitmix64(hash ^ sum));
        let contacts = steps.contacts.iter().fold(0u64, |all, &one| all.saturating_add(one));
        (contacts, format!("{chain:#018x}"))
    }
}

/// Results by frame, in lists of equal length; empty for a detector on a single frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Steps {
    #[serde(default, rename = "step_contacts", skip_serializing_if = "Vec::is_empty")]
    pub contacts: Vec<u64>,
    #[serde(default, rename = "step_digests", skip_serializing_if = "Vec::is_empty")]
    pub digests: Vec<String>,
    /// Whether a neighbour list was built, by frame; optional.
    #[serde(default, rename = "step_built", skip_serializing_if = "Vec::is_empty")]
    pub built: Vec<bool>,
    /// Whether the neighbour list may have been built too late, by frame; optional.
    #[serde(default, rename = "step_dangerous", skip_serializing_if = "Vec::is_empty")]
    pub dangerous: Vec<bool>,
    /// Number of pairs that were tested, by frame; optional.
    #[serde(default, rename = "step_listed", skip_serializing_if = "Vec::is_empty")]
    pub listed: Vec<u64>,
}

impl Steps {
    pub fn push(&mut self, found: Digest, step: &Step) {
        self.contacts.push(found.contacts);
        self.digests.push(found.hex());
        self.built.push(step.built);
        self.dangerous.push(step.dangerous);
        self.listed.push(step.listed);
    }

    pub fn last(&self) -> (u64, String) {
        (
            self.contacts.last().copied().unwrap_or(0),
            self.digests.last().cloned().unwrap_or_default(),
        )
    }

    /// Returns the name and length of the first list whose length is not `frames`; optional lists
    /// may be empty.
    pub fn unlike(&self, frames: usize) -> Option<(&'static str, usize)> {
        let needed = [("step_contacts", self.contacts.len()), ("step_digests", self.digests.len())];
        let optional = [
            ("step_built", self.built.len()),
            ("step_dangerous", self.dangerous.len()),
            ("step_listed", self.listed.len()),
        ];
        let optional = optional.into_iter().filter(|(_, len)| *len > 0);
        needed.into_iter().chain(optional).find(|(_, len)| *len != frames)
    }

    pub fn is_empty(&self) -> bool {
        *self == Steps::default()
    }
}

fn exact() -> String {
    "exact".into()
}

/// Parses the digest in a reply: `0x` and 16 lower-case hexadecimal digits.
fn digest(contacts: u64, text: &str) -> Result<Digest, String> {
    let hexadecimal = |c: char| matches!(c, '0'..='9' | 'a'..='f');
    let digits = text
        .strip_prefix("0x")
        .filter(|digits| digits.len() == 16 && digits.chars().all(hexadecimal));
    match digits.and_then(|digits| u64::from_str_radix(digits, 16).ok()) {
        Some(sum) => Ok(Digest { contacts, sum }),
        None => Err(format!(
            "its digest is '{text}'; it must be 0x and 16 lower-case hexadecimal digits"
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_digest_is_0x_and_16_lower_case_digits() {
        let right = Digest { contacts: 3, sum: 0xab };
        assert_eq!(digest(3, &right.hex()), Ok(right));
        for text in ["", "0xab", "00000000000000ab", "0x00000000000000AB", "0x+0000000000000ab"] {
            assert!(digest(3, text).is_err(), "{text}");
        }
    }
}
