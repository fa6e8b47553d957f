//! What harness and runner say to each other: one JSON object per line, over the runner's standard input and output. A runner in any
//! language can join; docs/PROTOCOL.md is written for those who write one.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

/// The version of the protocol; a runner names it in its first line.
pub const VERSION: u32 = 1;

/// From the harness.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "request", rename_all = "lowercase")]
pub enum Request {
    /// Read the scene and keep it; forget the one before.
    Load {
        /// A NumPy npy file, little-endian f64, C order: N rows of `dim` coordinates, and the radius as one more column if `radius` is null.
        path: PathBuf,
        /// 2 or 3.
        dim: u32,
        /// Rows.
        n: u64,
        /// The radius of all elements, or null.
        radius: Option<f64>,
    },
    /// Detect repeatedly, for at least `min_ns` nanoseconds, at least once, and say how long it took.
    Sample {
        /// The shortest sample wanted.
        min_ns: u64,
    },
    /// Detect once and count operations.
    Count,
    /// Detect once with fresh buffers and measure the memory.
    Memory,
    /// Detect once and write the pairs to a file: npy, `<u4`, shape (pairs, 2).
    Pairs {
        /// Where to.
        path: PathBuf,
    },
    /// Leave.
    Quit,
}

/// From the runner.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "reply", rename_all = "lowercase")]
pub enum Reply {
    /// The first line, before any request.
    Hello {
        /// Must be [`VERSION`].
        protocol: u32,
        /// The detector's name.
        detector: String,
        /// Which truth it is held to: f32, f64 or exact.
        #[serde(default = "exact")]
        arithmetic: String,
        /// Version of the runner or the library behind it.
        #[serde(default)]
        version: String,
    },
    /// The scene is in memory.
    Loaded,
    /// To `sample`.
    Sample {
        /// Nanoseconds per detection.
        time_ns: u64,
        /// Detections in the sample.
        calls: u64,
        /// Nanoseconds of the whole sample.
        elapsed_ns: u64,
        /// Pairs of the last detection.
        contacts: u64,
        /// Fingerprint of the pairs of the last detection.
        digest: String,
    },
    /// To `count`.
    Count {
        /// Operation name to count.
        counts: BTreeMap<String, u64>,
        /// Pairs.
        contacts: u64,
        /// Fingerprint.
        digest: String,
    },
    /// To `memory`.
    Memory {
        /// Most bytes held at one time above the input.
        peak_bytes: u64,
        /// Bytes held after the detection.
        live_bytes: u64,
        /// Allocations.
        allocations: u64,
        /// Allocations of a second detection.
        #[serde(default)]
        warm_allocations: Option<u64>,
        /// Bytes by the declared formula.
        #[serde(default)]
        formula_bytes: Option<u64>,
        /// Pairs.
        contacts: u64,
        /// Fingerprint.
        digest: String,
    },
    /// To `pairs`.
    Pairs {
        /// Pairs written.
        contacts: u64,
    },
    /// The runner cannot do this (count or memory); everything else goes on.
    Unsupported,
    /// The detector will not work on this scene.
    Refused {
        /// One sentence.
        reason: String,
    },
    /// The library behind the runner is not installed.
    Unavailable {
        /// One sentence, with the command that installs it.
        reason: String,
    },
    /// The request could not be done.
    Error {
        /// One sentence.
        reason: String,
    },
}

fn exact() -> String {
    "exact".into()
}
