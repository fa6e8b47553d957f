//! Checks detectors against the truth on many small scenes, in 2D and 3D, in several arithmetics.
//!
//! [`battery`] uses every generator with many seeds, the hard cases, the committed regressions and
//! random bytes. A detector keeps its buffers from scene to scene, so errors caused by earlier
//! scenes are found, too. Each detector runs in a thread ([`subject`]), so endless loops are found.
//! If a detector is wrong, the scene is simplified ([`shrink`](mod@shrink)) while a fresh detector
//! is still wrong, and written as a [`regression`] file.
//!
//! A detector in another language is a [`process`] that speaks the runner protocol, or a function
//! of the program that calls this crate. `verify` compares a contact list of another program with
//! the truth.

pub mod answer;
pub mod bytes;
mod cases;
mod checker;
pub mod conversation;
pub mod numbers;
pub mod process;
pub mod regression;
pub mod shrink;
pub mod subject;
mod wrong;

use std::collections::BTreeMap;
use std::time::Duration;

use cases::Scene;
use checker::Checker;
pub use regression::as_csv;
use shrink::Effort;
use subject::CheckedSubject;
pub use wrong::{Differences, Wrong};

use contactbench_ground::contact::Arithmetic;
use contactbench_ground::detect::Options;
use contactbench_io::Given;

/// Memory limit in bytes: enough for every scene of the battery, and available on small machines.
/// Filling much more memory takes as long as a hang.
const MOST_BYTES: u64 = 256 << 20;

#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Maximum number of seeds; all scenes of the first seed are always checked.
    pub seeds: u64,
    pub time: Duration,
    /// Maximum time of a detection; a longer one counts as a hang.
    pub deadline: Duration,
    pub effort: Effort,
    pub options: Options,
}

impl Default for Limits {
    /// Returns limits for CI: under 10 s, if nothing is wrong.
    fn default() -> Limits {
        Limits {
            seeds: 1000,
            time: Duration::from_secs(6),
            deadline: Duration::from_secs(20),
            effort: Effort { trials: 20_000, time: Duration::from_secs(3) },
            options: Options { memory_limit: MOST_BYTES, ..Options::default() },
        }
    }
}

#[derive(Default)]
pub struct Report {
    pub cases: u64,
    /// Number of compared detections by detector and arithmetic; a missing entry means none.
    pub compared: BTreeMap<(String, &'static str), u64>,
    pub scenes: BTreeMap<&'static str, u64>,
    /// Whether the time ended before a [`battery`] was complete.
    pub cut: bool,
    pub refused: BTreeMap<String, u64>,
    pub failures: Vec<Failure>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Every compared answer is right.
    Right,
    Wrong,
    /// All scenes were refused. This does not count as a pass.
    Nothing,
}

impl Report {
    pub fn verdict(&self) -> Verdict {
        if !self.failures.is_empty() {
            Verdict::Wrong
        } else if self.cases == 0 {
            Verdict::Nothing
        } else {
            Verdict::Right
        }
    }
}

pub struct Failure {
    pub detector: String,
    pub arithmetic: Arithmetic,
    pub found_on: String,
    pub found: Wrong,
    pub given: Given,
    /// The smallest scene on which a fresh detector is wrong. If a fresh detector is right or
    /// hangs, this is the scene on which the error was found.
    pub smallest: Given,
    /// The error on `smallest`. `None` if a fresh detector is right there, so that earlier scenes
    /// caused the error.
    pub wrong: Option<Wrong>,
}

/// Checks subjects on generated scenes with the first seed, hard cases with their history, and
/// regressions. Then random bytes and further seeds follow until a limit is reached.
pub fn battery(
    subjects: &[CheckedSubject],
    arithmetics: &[Arithmetic],
    limits: &Limits,
) -> anyhow::Result<Report> {
    let mut checker = Checker::new(subjects, arithmetics, limits)?;
    checker.all(cases::generated(1), false)?;
    checker.all(cases::hard_cases(), true)?;
    checker.all(cases::regressions(), false)?;
    checker.report.cut = checker.over();
    for seed in 1..=limits.seeds {
        if !checker.all(cases::random_bytes(seed), true)?
            || seed > 1 && !checker.all(cases::generated(seed), true)?
        {
            break;
        }
    }
    Ok(checker.report)
}

/// Checks detectors on one scene. An arithmetic that cannot store the scene counts as a refusal.
pub fn check_scene(
    scene: &Given,
    name: &str,
    subjects: &[CheckedSubject],
    arithmetics: &[Arithmetic],
    limits: &Limits,
) -> anyhow::Result<Report> {
    let mut checker = Checker::new(subjects, arithmetics, limits)?;
    checker.scene(&Scene { source: "given", name: name.into(), given: scene.clone() })?;
    Ok(checker.report)
}
