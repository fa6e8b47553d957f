//! Cross-checks: every detector against all pairs tested, on every generator, in 2D and 3D, in the arithmetics asked for, with many seeds and small
//! N. A detector keeps its buffers from scene to scene, so that what one call leaves behind is checked, too. When one
//! disagrees, elements are taken away as long as it still does.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use crate::contact::{Arithmetic, Real, array};
use crate::detect::Options;
use crate::detect::any::AnyDetector;
use crate::detect::table::Entry;
use crate::harness::record::Errors;
use crate::oracle;
use crate::scene::AnyScene;
use crate::scene::spec::{Order, Spec};
use crate::sink::Digest;
use crate::with_scene;

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
    /// The smallest scene found on which it is still wrong.
    pub smallest: AnyScene<'static>,
    /// In which way, there; `None` if a fresh detector is right there: what earlier scenes left in its buffers makes it wrong.
    pub wrong: Option<Wrong>,
}

/// In which way a detector is wrong.
pub enum Wrong {
    /// It misses, adds or repeats pairs.
    Pairs(Errors),
    /// It panics.
    Panics,
}

/// A scene of the check: a generator with parameters.
struct Case {
    generator: &'static str,
    dims: &'static [u32],
    params: &'static [(&'static str, f64)],
    lattice: [&'static str; 2],
}

const fn case(generator: &'static str, dims: &'static [u32], params: &'static [(&'static str, f64)]) -> Case {
    Case { generator, dims, params, lattice: [""; 2] }
}

/// Lattices at spacing 1 without jitter have neighbours exactly one diameter apart, or as near to it as rounding allows.
const CASES: &[Case] = &[
    case("packed", &[2, 3], &[]),
    case("packed", &[2, 3], &[("spacing", 1.0), ("jitter", 0.0)]),
    Case { lattice: ["square", "cubic"], ..case("packed", &[2, 3], &[("spacing", 1.0), ("jitter", 0.0)]) },
    Case { lattice: ["square", "cubic"], ..case("packed", &[2, 3], &[("spacing", 1.0), ("jitter", 0.0), ("diameter", 0.1)]) },
    case("packed", &[2, 3], &[("size-ratio", 3.0)]),
    case("loose", &[2, 3], &[]),
    case("loose", &[2, 3], &[("fraction", 0.6), ("size-ratio", 20.0)]),
    case("clustered", &[2, 3], &[("per-cluster", 20.0)]),
    case("clustered", &[2, 3], &[("per-cluster", 50.0), ("width", 0.5), ("fraction", 0.0001)]),
    case("pack-a", &[2], &[]),
    case("pack-b", &[2], &[("s", 1.0)]),
    case("pack-c", &[2], &[("s", 1.0), ("diameter", 0.3)]),
    case("pack-d", &[2], &[("s", 3.0)]),
];

/// Small numbers of elements, the smallest included.
const SIZES: &[u64] = &[0, 1, 2, 3, 17, 100, 300];

impl Case {
    fn spec(&self, dim: u32, n: u64, seed: u64) -> anyhow::Result<Spec> {
        let mut params: BTreeMap<String, toml::Value> = BTreeMap::new();
        for &(name, value) in self.params {
            let whole = name == "per-cluster";
            params.insert(name.into(), if whole { toml::Value::Integer(value as i64) } else { toml::Value::Float(value) });
        }
        let lattice = self.lattice[dim as usize - 2];
        if !lattice.is_empty() {
            params.insert("lattice".into(), lattice.into());
        }
        Spec::new(self.generator, dim, n, seed, Order::Shuffled, &params)
    }
}

/// Checks `detectors` in the given arithmetics with seeds 1, 2, ... until `seeds` are done or the time is over (the first seed is always
/// completed).
pub fn check(detectors: &[&'static Entry], arithmetics: &[Arithmetic], seeds: u64, time: Duration) -> anyhow::Result<Report> {
    let started = Instant::now();
    let mut report = Report::default();
    let mut subjects: Vec<(&'static Entry, Box<dyn AnyDetector>)> =
        detectors.iter().map(|entry| (*entry, entry.make(Options::default()))).collect();
    for seed in 1..=seeds {
        for case in CASES {
            for &dim in case.dims {
                for &n in SIZES {
                    if seed > 1 && started.elapsed() > time {
                        return Ok(report);
                    }
                    let spec = case.spec(dim, n, seed)?;
                    check_scene(&spec, arithmetics, &mut subjects, &mut report)?;
                }
            }
        }
    }
    Ok(report)
}

fn check_scene(
    spec: &Spec,
    arithmetics: &[Arithmetic],
    subjects: &mut [(&'static Entry, Box<dyn AnyDetector>)],
    report: &mut Report,
) -> anyhow::Result<()> {
    let scene = spec.make()?;
    for &arithmetic in arithmetics {
        let truth = oracle::truth(&scene, arithmetic)?.digest;
        let stored = scene.stored(arithmetic)?;
        for (entry, detector) in subjects.iter_mut() {
            if report.failures.iter().any(|failure| failure.detector == entry.name) {
                continue;
            }
            let mut digest = Digest::default();
            report.cases += 1;
            let answer = catch_unwind(AssertUnwindSafe(|| detector.visit(&stored, arithmetic.test(), &mut digest)));
            match answer {
                Ok(Err(refusal)) => *report.refused.entry(format!("{}: {refusal}", entry.name)).or_default() += 1,
                Ok(Ok(())) if digest == truth => {}
                // Other pairs, or a panic.
                Ok(Ok(())) | Err(_) => {
                    let smallest = shrink(entry, arithmetic, &scene);
                    let wrong = wrong(entry, arithmetic, &smallest);
                    let found_on = format!("{} dim={} n={} seed={} {:?}", spec.name, spec.dim, spec.n, spec.seed, spec.params);
                    report.failures.push(Failure { detector: entry.name, arithmetic, found_on, smallest, wrong });
                }
            }
        }
    }
    Ok(())
}

/// In which way a fresh detector is wrong on a scene; `None` if it is right, refuses, or there is no truth.
fn wrong(entry: &Entry, arithmetic: Arithmetic, scene: &AnyScene<'_>) -> Option<Wrong> {
    let truth = oracle::truth(scene, arithmetic).ok()?;
    let stored = scene.stored(arithmetic).ok()?;
    let mut pairs = Vec::new();
    let answer = catch_unwind(AssertUnwindSafe(|| entry.make(Options::default()).list(&stored, arithmetic.test(), &mut pairs)));
    match answer {
        Err(_) => Some(Wrong::Panics),
        Ok(Err(_)) => None,
        Ok(Ok(())) => (Digest::of(&pairs) != truth.digest).then(|| Wrong::Pairs(oracle::compare(&pairs, &truth.pairs, &stored))),
    }
}

/// Takes elements away, in ever smaller chunks, as long as a fresh detector is still wrong. A failure that needs the history of
/// earlier calls is given back whole.
fn shrink(entry: &Entry, arithmetic: Arithmetic, scene: &AnyScene<'static>) -> AnyScene<'static> {
    let mut kept: Vec<u32> = (0..scene.len() as u32).collect();
    if wrong(entry, arithmetic, scene).is_none() {
        return scene.clone();
    }
    let mut chunk = kept.len().div_ceil(2);
    while chunk > 0 {
        let mut start = 0;
        while start < kept.len() {
            let mut fewer = kept.clone();
            fewer.drain(start..(start + chunk).min(kept.len()));
            if wrong(entry, arithmetic, &scene.reordered(&fewer)).is_some() {
                kept = fewer;
            } else {
                start += chunk;
            }
        }
        chunk /= 2;
    }
    scene.reordered(&kept)
}

/// A scene as CSV with a header, in numbers that read back to the same bits.
pub fn as_csv(scene: &AnyScene<'_>) -> String {
    let dim = scene.dim();
    with_scene!(scene, scene => {
        let mut text = String::from(if dim == 2 { "x,y,r\n" } else { "x,y,z,r\n" });
        for (k, centre) in scene.centres().iter().enumerate() {
            for x in array(centre) {
                text.push_str(&format!("{:?},", x.wide()));
            }
            text.push_str(&format!("{:?}\n", scene.radius(k).wide()));
        }
        text
    })
}
