//! Cross-checks: every detector against all pairs tested, on every generator, in 2D and 3D, in the
//! arithmetics asked for, with many seeds and small N; and, in a [`battery`], on the hard cases,
//! committed regressions and random bytes; or on given scenes. A detector keeps its buffers from
//! scene to scene, so that what one call leaves behind is checked, too. It works in a thread of its
//! own ([`contender`]), so that one that hangs is found like any other. When one is wrong, the
//! scene is made as small and simple as it can be ([`shrink`](mod@shrink)) while a fresh detector
//! is still wrong, and written as a [`regression`] file.
//!
//! A detector in another language is a [`process`], which is asked the same questions over the
//! runner protocol, or, where that language calls this crate, a function. A contact list of another
//! code is compared with the truth in [`verify`].

pub mod bytes;
mod cases;
mod checker;
pub mod contender;
pub mod conversation;
pub mod numbers;
pub mod process;
pub mod regression;
pub mod shrink;
pub mod verify;
mod wrong;

use std::collections::BTreeMap;
use std::time::Duration;

use cases::Scene;
use checker::Checker;
use contender::Contender;
pub use regression::as_csv;
use shrink::Effort;
pub use wrong::{Differences, Wrong};

use contactbench_core::contact::Arithmetic;
use contactbench_core::detect::Options;
use contactbench_core::detect::table::Entry;
use contactbench_io::Given;

/// No scene of the battery needs more than this if it is not to be refused, and a small machine has
/// it. To fill much more takes as long as a hang.
const MOST_BYTES: u64 = 256 << 20;

#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Seeds tried at most; the first is always completed.
    pub seeds: u64,
    /// No new generated scene is begun after this time.
    pub time: Duration,
    /// A detection that takes longer hangs.
    pub deadline: Duration,
    pub effort: Effort,
    pub options: Options,
}

impl Default for Limits {
    /// For CI: under 10 s, if nothing is wrong.
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
    /// Detections compared with the truth.
    pub cases: u64,
    /// The same of each detector in each arithmetic; one without an entry was never compared.
    pub compared: BTreeMap<(String, &'static str), u64>,
    /// Scenes tried, by where they are from.
    pub scenes: BTreeMap<&'static str, u64>,
    /// True if the time was over before a [`battery`] was complete.
    pub cut: bool,
    /// Detections refused, with reason: not wrong, but said.
    pub refused: BTreeMap<String, u64>,
    /// The first failure of each detector.
    pub failures: Vec<Failure>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Every answer that was compared is right.
    Right,
    Wrong,
    /// No answer was compared: all scenes were refused. It is not a pass.
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

    /// Whether an answer of this detector in this arithmetic was compared with the truth.
    pub fn has_compared(&self, detector: &str, arithmetic: Arithmetic) -> bool {
        self.compared.contains_key(&(detector.to_string(), arithmetic.name()))
    }
}

pub struct Failure {
    pub detector: String,
    pub arithmetic: Arithmetic,
    /// On which scene it was noticed.
    pub found_on: String,
    pub found: Wrong,
    pub given: Given,
    /// The smallest scene found on which a fresh detector is still wrong; the one it was noticed
    /// on, if a fresh one is right or hangs.
    pub smallest: Given,
    /// In which way, there; `None` if a fresh detector is right there: what earlier scenes left in
    /// its buffers makes it wrong.
    pub wrong: Option<Wrong>,
}

/// Checks `detectors` in the given arithmetics on generated scenes, with seeds 1, 2, ... until a
/// limit is reached.
pub fn check(
    detectors: &[&'static Entry],
    arithmetics: &[Arithmetic],
    limits: &Limits,
) -> anyhow::Result<Report> {
    let contenders: Vec<Contender> = detectors.iter().copied().map(Contender::from).collect();
    let mut checker = Checker::new(&contenders, arithmetics, limits)?;
    for seed in 1..=limits.seeds {
        if !checker.all(cases::generated(seed), seed > 1)? {
            break;
        }
    }
    Ok(checker.report)
}

/// Checks contenders on all there is: generated scenes of the first seed (always completed); every
/// hard case with its history; the regressions that the tests keep; then scenes of random bytes,
/// and generated ones with further seeds, until a limit is reached.
pub fn battery(
    contenders: &[Contender],
    arithmetics: &[Arithmetic],
    limits: &Limits,
) -> anyhow::Result<Report> {
    let mut checker = Checker::new(contenders, arithmetics, limits)?;
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

/// Checks `detectors` in the given arithmetics on one scene. An arithmetic that cannot hold it
/// counts as a refusal.
pub fn check_scene(
    scene: &Given,
    name: &str,
    detectors: &[&'static Entry],
    arithmetics: &[Arithmetic],
    limits: &Limits,
) -> anyhow::Result<Report> {
    let contenders: Vec<Contender> = detectors.iter().copied().map(Contender::from).collect();
    one_scene(scene, name, &contenders, arithmetics, limits)
}

/// The same of any contenders.
pub fn one_scene(
    scene: &Given,
    name: &str,
    contenders: &[Contender],
    arithmetics: &[Arithmetic],
    limits: &Limits,
) -> anyhow::Result<Report> {
    let mut checker = Checker::new(contenders, arithmetics, limits)?;
    checker.scene(&Scene { source: "given", name: name.into(), given: scene.clone() })?;
    Ok(checker.report)
}
