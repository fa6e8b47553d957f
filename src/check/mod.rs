//! Cross-checks: every detector against all pairs tested, on every generator, in 2D and 3D, in the arithmetics asked for, with many seeds and small
//! N; or on given scenes. A detector keeps its buffers from scene to scene, so that what one call leaves behind is checked, too. It
//! works in a thread of its own ([`subject`]), so that one that hangs is found like any other. When one is wrong, the scene is
//! made as small and simple as it can be ([`shrink`](mod@shrink)) while a fresh detector is still wrong, and written as a [`regression`] file.

pub mod bytes;
mod cases;
pub mod numbers;
pub mod regression;
pub mod shrink;
pub mod subject;

use std::collections::BTreeMap;
use std::fmt;
use std::mem::discriminant;
use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::contact::Arithmetic;
use crate::detect::Options;
use crate::detect::table::Entry;
use crate::oracle::{self, NoTruth, Truth};
use crate::scene::AnyScene;
use crate::sink::{key, normalise};
use cases::{CASES, SIZES};
pub use regression::as_csv;
use shrink::{Effort, shrink};
use subject::{Answer, Subject};

/// How far a check goes.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Seeds tried at most; the first is always completed.
    pub seeds: u64,
    /// No new generated scene is begun after this time.
    pub time: Duration,
    /// A detection that takes longer hangs.
    pub deadline: Duration,
    /// For every failing scene.
    pub effort: Effort,
    /// What detectors may use.
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
            options: Options::default(),
        }
    }
}

/// What was checked, and what was found.
#[derive(Default)]
pub struct Report {
    /// Detections compared with the truth.
    pub cases: u64,
    /// Detections refused, with reason: not wrong, but said.
    pub refused: BTreeMap<String, u64>,
    /// The first failure of each detector.
    pub failures: Vec<Failure>,
}

/// A detector that is wrong.
pub struct Failure {
    /// Its name.
    pub detector: &'static str,
    /// In which arithmetic.
    pub arithmetic: Arithmetic,
    /// On which scene it was noticed.
    pub found_on: String,
    /// In which way, there.
    pub found: Wrong,
    /// The smallest scene found on which a fresh detector is still wrong; the one it was noticed on, if a fresh one is right or hangs.
    pub smallest: AnyScene<'static>,
    /// In which way, there; `None` if a fresh detector is right there: what earlier scenes left in its buffers makes it wrong.
    pub wrong: Option<Wrong>,
}

/// In which way a detector is wrong.
#[derive(Clone, Debug, PartialEq)]
pub enum Wrong {
    /// It misses, adds or repeats pairs.
    Pairs(Differences),
    /// It refuses the scene, but has reported so many pairs before.
    RefusesLate(u64),
    /// It panics, with this message.
    Panics(String),
    /// It was not ready after this time.
    Hangs(Duration),
}

/// What is wrong with a list of pairs. The smaller index stands first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Differences {
    /// Touching pairs not reported.
    pub missed: Vec<[u32; 2]>,
    /// Reported pairs that do not touch.
    pub spurious: Vec<[u32; 2]>,
    /// Elements reported with themselves.
    pub selves: Vec<[u32; 2]>,
    /// Pairs reported again, once for each time.
    pub duplicate: Vec<[u32; 2]>,
}

/// This many pairs of a kind are shown.
const SHOWN: usize = 4;

impl Differences {
    /// Compares what was reported, in any order, with the true pairs, each once and in ascending order.
    pub fn new(mut reported: Vec<[u32; 2]>, truth: &[[u32; 2]]) -> Differences {
        normalise(&mut reported);
        let duplicate: Vec<[u32; 2]> = reported.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| pair[0]).collect();
        reported.dedup();
        let without = |pairs: &[[u32; 2]], others: &[[u32; 2]]| {
            let absent = |[i, j]: &[u32; 2]| others.binary_search_by_key(&key(*i, *j), |&[i, j]| key(i, j)).is_err();
            pairs.iter().copied().filter(absent).collect::<Vec<_>>()
        };
        let (selves, spurious) = without(&reported, truth).into_iter().partition(|[i, j]| i == j);
        Differences { missed: without(truth, &reported), spurious, selves, duplicate }
    }
}

impl fmt::Display for Differences {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Differences { missed, spurious, selves, duplicate } = self;
        write!(f, "{} missed, {} spurious, {} duplicate pairs", missed.len(), spurious.len(), duplicate.len())?;
        if !selves.is_empty() {
            write!(f, ", {} of an element with itself", selves.len())?;
        }
        for (kind, pairs) in [("missed", missed), ("spurious", spurious), ("itself", selves), ("duplicate", duplicate)] {
            if !pairs.is_empty() {
                let shown: Vec<String> = pairs.iter().take(SHOWN).map(|[i, j]| format!("{i},{j}")).collect();
                write!(f, "; {kind} {}{}", shown.join(" "), if pairs.len() > SHOWN { " ..." } else { "" })?;
            }
        }
        Ok(())
    }
}

impl fmt::Display for Wrong {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Wrong::Pairs(differences) => differences.fmt(f),
            Wrong::RefusesLate(reported) => write!(f, "it refuses after it has reported {reported} pairs"),
            Wrong::Panics(message) => write!(f, "it panics: {}", message.lines().next().unwrap_or_default()),
            Wrong::Hangs(deadline) => write!(f, "it hangs: not ready after {} s", deadline.as_secs_f64()),
        }
    }
}

/// Checks `detectors` in the given arithmetics on generated scenes, with seeds 1, 2, ... until a limit is reached.
pub fn check(detectors: &[&'static Entry], arithmetics: &[Arithmetic], limits: &Limits) -> anyhow::Result<Report> {
    let started = Instant::now();
    let mut checker = Checker::new(detectors, limits)?;
    for seed in 1..=limits.seeds {
        for case in CASES {
            for &dim in case.dims {
                for &n in SIZES {
                    if seed > 1 && started.elapsed() > limits.time {
                        return Ok(checker.report);
                    }
                    let spec = case.spec(dim, n, seed)?;
                    let name = || format!("{} dim={} n={} seed={} {:?}", spec.name, spec.dim, spec.n, spec.seed, spec.params);
                    checker.scene(&spec.make()?, name, arithmetics)?;
                }
            }
        }
    }
    Ok(checker.report)
}

/// Checks `detectors` in the given arithmetics on one scene. An arithmetic that cannot hold it counts as a refusal.
pub fn check_scene(
    scene: &AnyScene<'static>,
    name: &str,
    detectors: &[&'static Entry],
    arithmetics: &[Arithmetic],
    limits: &Limits,
) -> anyhow::Result<Report> {
    let mut checker = Checker::new(detectors, limits)?;
    checker.scene(scene, || name.into(), arithmetics)?;
    Ok(checker.report)
}

struct Checker<'a> {
    limits: &'a Limits,
    subjects: Vec<Subject>,
    report: Report,
}

impl<'a> Checker<'a> {
    fn new(detectors: &[&'static Entry], limits: &'a Limits) -> anyhow::Result<Checker<'a>> {
        let subject = |entry: &&'static Entry| Subject::new(entry, limits.options, limits.deadline);
        Ok(Checker { limits, subjects: detectors.iter().map(subject).collect::<anyhow::Result<_>>()?, report: Report::default() })
    }

    fn scene(&mut self, scene: &AnyScene<'static>, name: impl Fn() -> String, arithmetics: &[Arithmetic]) -> anyhow::Result<()> {
        for &arithmetic in arithmetics {
            let (stored, truth) = match truth(scene, arithmetic) {
                Ok(found) => found,
                Err(error @ (NoTruth::Refused(_) | NoTruth::Stored(_))) => {
                    *self.report.refused.entry(format!("{}: {error}", arithmetic.name())).or_default() += 1;
                    continue;
                }
                Err(error) => return Err(error.into()),
            };
            for subject in &mut self.subjects {
                let entry = subject.entry;
                if self.report.failures.iter().any(|failure| failure.detector == entry.name) {
                    continue;
                }
                let answer = subject.ask(&stored, arithmetic.test(), false, &truth)?;
                if let Answer::Refused(refusal, 0) = &answer {
                    *self.report.refused.entry(format!("{}: {refusal}", entry.name)).or_default() += 1;
                } else {
                    self.report.cases += 1;
                }
                if let Some(found) = answer.wrong(&truth) {
                    let (smallest, wrong) = simplest(entry, arithmetic, scene, &found, self.limits)?;
                    self.report.failures.push(Failure { detector: entry.name, arithmetic, found_on: name(), found, smallest, wrong });
                }
            }
        }
        Ok(())
    }
}

/// The scene as the arithmetic stores it, and the pairs to be found.
fn truth(scene: &AnyScene<'_>, arithmetic: Arithmetic) -> Result<(Arc<AnyScene<'static>>, Truth), NoTruth> {
    let stored = Arc::new(scene.stored(arithmetic)?);
    let truth = oracle::truth_as_stored(&stored, arithmetic.test())?;
    Ok((stored, truth))
}

/// Candidates of the shrinker need no more than this, and a small machine has it.
const SHRINKING_BYTES: u64 = 256 << 20;
/// A candidate that hangs is given up, and after some of them the shrinking, since each leaves a thread behind.
const SHRINKING_DEADLINE: Duration = Duration::from_secs(1);
const SHRINKING_HANGS: u32 = 2;

/// The smallest scene found on which a fresh detector is wrong, and in which way.
fn simplest(
    entry: &'static Entry,
    arithmetic: Arithmetic,
    scene: &AnyScene<'static>,
    found: &Wrong,
    limits: &Limits,
) -> anyhow::Result<(AnyScene<'static>, Option<Wrong>)> {
    if matches!(found, Wrong::Hangs(_)) {
        return Ok((scene.clone(), Some(found.clone())));
    }
    let wrong = |subject: &mut Subject, scene: &AnyScene<'static>| -> anyhow::Result<Option<Wrong>> {
        let Ok((stored, truth)) = truth(scene, arithmetic) else { return Ok(None) };
        Ok(subject.ask(&stored, arithmetic.test(), true, &truth)?.wrong(&truth))
    };
    let mut patient = Subject::new(entry, limits.options, limits.deadline)?;
    let Some(first) = wrong(&mut patient, scene)? else { return Ok((scene.clone(), None)) };
    let options = Options { memory_limit: limits.options.memory_limit.min(SHRINKING_BYTES), ..limits.options };
    let mut subject = Subject::new(entry, options, limits.deadline.min(SHRINKING_DEADLINE))?;
    let mut hangs = 0;
    let smallest = shrink(scene, limits.effort, |scene| {
        hangs < SHRINKING_HANGS
            && match wrong(&mut subject, scene) {
                Ok(Some(Wrong::Hangs(_))) | Err(_) => {
                    hangs += 1;
                    false
                }
                // In the same way, or another defect may take its place.
                Ok(wrong) => wrong.is_some_and(|wrong| discriminant(&wrong) == discriminant(&first)),
            }
    });
    let wrong = wrong(&mut patient, &smallest)?;
    Ok((smallest, wrong))
}
