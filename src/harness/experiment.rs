//! Experiments: a question, scenes, a sweep, detectors, what is expected and how to read the answer, as a TOML file.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, bail, ensure};
use serde::Deserialize;

use super::toml_error::located;
use crate::contact::Arithmetic;
use crate::detect::{peers, table};
use crate::scene::spec::{Order, Spec};
use crate::scene::{generate, hard};

/// One experiment file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Experiment {
    /// The name in records; also the name of the file.
    pub name: String,
    /// One line for figures and reports.
    pub title: String,
    /// What is asked.
    pub question: String,
    /// How to read the figures.
    pub reading: String,
    /// Part of the standard reproduction.
    #[serde(default)]
    pub standard: bool,
    /// Detectors of the table.
    pub detectors: Vec<String>,
    /// Arithmetics to run each detector with.
    #[serde(default = "exact_only")]
    pub arithmetics: Vec<Arithmetic>,
    /// Threads given to the detectors; those that cannot use several run once, with one.
    #[serde(default = "one")]
    pub threads: OneOrMany<usize>,
    /// Beside every detector with several threads: as many copies of it with one thread each, all at work at the same time.
    #[serde(default)]
    pub ceiling: bool,
    /// Measures the machine's memory bandwidth before the run; the report then compares times with it.
    #[serde(default)]
    pub bound: bool,
    /// The report fits costs per operation to times, and says where detectors overtake each other.
    #[serde(default)]
    pub cost_model: bool,
    /// The detector that all others are compared with in a table of ratios.
    #[serde(default)]
    pub ratios_to: Option<String>,
    /// Paired blocks: each runs every detector once, in a fresh random order. 0: no times, only answers, counts and memory.
    #[serde(default = "fifteen")]
    pub blocks: u32,
    /// Seconds after which no further block of a scene is begun, once six are done.
    #[serde(default = "unlimited")]
    pub block_budget_s: f64,
    /// Seconds that one request to a runner may take; the first sample of a scene is two detections, one to warm the caches.
    #[serde(default = "thirty")]
    pub time_limit_s: f64,
    /// Limit for a detector's arrays, and (with an allowance for input, output and program) for a runner's address space.
    #[serde(default = "four_gib")]
    pub memory_limit_mib: u64,
    /// Scenes, each swept over its lists.
    #[serde(rename = "scene")]
    pub scenes: Vec<SceneSweep>,
    /// Runners in other languages.
    #[serde(rename = "runner", default)]
    pub runners: Vec<ExternalRunner>,
    /// What is expected.
    #[serde(rename = "claim", default)]
    pub claims: Vec<Claim>,
    /// What is drawn.
    #[serde(rename = "figure", default)]
    pub figures: Vec<Figure>,
    /// A table shown after the run and in the report, besides the usual ones.
    #[serde(default)]
    pub table: Option<Table>,
}

/// Kinds of tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Table {
    /// Case by case and arithmetic by arithmetic: which detectors are right, and what the others are.
    Verdicts,
}

fn exact_only() -> Vec<Arithmetic> {
    vec![Arithmetic::Exact]
}
fn one() -> OneOrMany<usize> {
    OneOrMany::One(1)
}
fn fifteen() -> u32 {
    15
}
fn unlimited() -> f64 {
    f64::INFINITY
}
fn thirty() -> f64 {
    30.0
}
fn four_gib() -> u64 {
    4096
}

/// More threads than any machine has cores are a slip of the pen.
const MOST_THREADS: usize = 1024;

/// A value, or a list of values to sweep over.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum OneOrMany<T> {
    /// Values to sweep over. First, because a single value of any kind could also be an array.
    Many(Vec<T>),
    /// A single value.
    One(T),
}

impl<T: Clone> OneOrMany<T> {
    /// The values.
    pub fn values(&self) -> Vec<T> {
        match self {
            OneOrMany::One(value) => vec![value.clone()],
            OneOrMany::Many(values) => values.clone(),
        }
    }
}

/// A generator and the values of its parameters; any parameter may be a list.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct SceneSweep {
    /// The generator: packed, loose, clustered, pack-a ... pack-d; file; or hard, which without a `case` means all cases.
    pub name: String,
    /// Dimensions.
    #[serde(default = "plane")]
    pub dim: OneOrMany<u32>,
    /// Numbers of elements; not for `file`, which brings its own.
    pub n: Option<OneOrMany<u64>>,
    /// Seeds.
    #[serde(default = "seed_one")]
    pub seed: OneOrMany<u64>,
    /// Orders of the elements.
    #[serde(default = "shuffled")]
    pub order: OneOrMany<Order>,
    /// What a quick run takes instead.
    #[serde(default)]
    pub quick: BTreeMap<String, OneOrMany<toml::Value>>,
    /// The generator's parameters.
    #[serde(flatten)]
    pub params: BTreeMap<String, OneOrMany<toml::Value>>,
}

fn plane() -> OneOrMany<u32> {
    OneOrMany::One(2)
}
fn seed_one() -> OneOrMany<u64> {
    OneOrMany::One(1)
}
fn shuffled() -> OneOrMany<Order> {
    OneOrMany::One(Order::Shuffled)
}

/// A runner that is not part of this program: see docs/PROTOCOL.md.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct ExternalRunner {
    /// The detector's name in records.
    pub name: String,
    /// Program and arguments; `{threads}` in an argument stands for the number of threads.
    pub command: Vec<String>,
    /// How to get it, for rows that say `unavailable`.
    #[serde(default)]
    pub install: String,
}

/// An expectation, checked from the record.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Claim {
    /// The sentence in the verdict table.
    pub name: String,
    /// What is checked.
    pub kind: ClaimKind,
    /// Which rows: field or parameter to a value or a list of values.
    #[serde(rename = "where", default)]
    pub filter: BTreeMap<String, OneOrMany<toml::Value>>,
    /// An expression over the row: n, dim, contacts, operation names, bytes, numeric parameters.
    #[serde(default)]
    pub value: String,
    /// The other side of `equal` and `at-most`: an expression.
    #[serde(default)]
    pub to: String,
    /// Relative tolerance of `constant` and `equal`.
    #[serde(default)]
    pub within: f64,
    /// The model of `model`: N, N log N or N^2.
    #[serde(default)]
    pub model: String,
    /// The other detector of `faster`.
    #[serde(default)]
    pub than: String,
    /// Where the claim comes from.
    #[serde(default)]
    pub source: String,
}

/// Kinds of claims. Those about times (`faster`, and any expression with `time_ns`) are of one machine and gate nothing; all others are
/// checked from counts, bytes and digests.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClaimKind {
    /// Largest over smallest value - 1 is at most `within`.
    Constant,
    /// Value and `to` differ by at most `within` (relative) in every cell.
    Equal,
    /// Value <= `to` in every cell.
    AtMost,
    /// The value grows with n as `model` says.
    Model,
    /// The time ratio detector / `than` is below 1 in every cell; of this machine.
    Faster,
}

/// A figure.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Figure {
    /// The file name, without ending.
    pub name: String,
    /// The heading.
    pub title: String,
    /// What is drawn.
    #[serde(default)]
    pub kind: FigureKind,
    /// Lines: n or a parameter.
    #[serde(default)]
    pub x: String,
    /// Lines: the label of the x axis, with unit.
    #[serde(default)]
    pub x_label: String,
    /// Lines: an expression as in claims; `time_ns` is the median over blocks, drawn with its interval.
    #[serde(default)]
    pub y: String,
    /// Lines: the label of the y axis, with unit.
    #[serde(default)]
    pub y_label: String,
    /// Lines: logarithmic axes (both) or linear.
    #[serde(default = "yes")]
    pub log: bool,
    /// Lines: draw reference slopes N, N log N, N².
    #[serde(default)]
    pub slopes: bool,
    /// Lines: y is per element: an algorithm of cost N is flat, and so is the slope N.
    #[serde(default)]
    pub per_element: bool,
    /// Speed against error: which errors.
    #[serde(default)]
    pub against: Against,
    /// Speed against error: the parameter that makes the columns; without, the one with the most values.
    #[serde(default)]
    pub columns: String,
    /// Lines over n: mark where the input outgrows the caches of the machine.
    #[serde(default)]
    pub caches: bool,
    /// Which rows, as in claims.
    #[serde(rename = "where", default)]
    pub filter: BTreeMap<String, OneOrMany<toml::Value>>,
}

/// Kinds of figures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FigureKind {
    /// y against x, one panel per scene and dimension, one line per detector.
    #[default]
    Lines,
    /// Error rate against time per element, one panel per scene, one mark per detector and arithmetic.
    SpeedError,
}

/// What answers are held to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Against {
    /// Exact decisions on the scene as given: all causes of error.
    #[default]
    Given,
    /// Exact decisions on the scene as stored in the arithmetic: deciding and looking, not storing.
    Stored,
}

fn yes() -> bool {
    true
}

impl Experiment {
    /// Reads and checks an experiment file.
    pub fn read(path: &Path) -> anyhow::Result<Experiment> {
        let text = std::fs::read_to_string(path).with_context(|| format!("cannot read the experiment {}", path.display()))?;
        Experiment::parse(&text, path.parent().unwrap_or(Path::new("."))).with_context(|| format!("in {}", path.display()))
    }

    /// Parses and checks; relative file names of scenes are taken from `folder`.
    pub fn parse(text: &str, folder: &Path) -> anyhow::Result<Experiment> {
        let mut experiment: Experiment = toml::from_str(text).map_err(|error| located(text, &error))?;
        for name in &experiment.detectors {
            // A peer that was not compiled is no error: its rows say how to get it.
            let known = table::find(name).is_some() || peers::missing(name).is_some();
            ensure!(known, "there is no detector '{name}'; the detectors are: {}", table::names());
        }
        let names = || experiment.detectors.iter().chain(experiment.runners.iter().map(|runner| &runner.name));
        for (k, name) in names().enumerate() {
            ensure!(
                names().take(k).all(|other| other != name),
                "there are two runners named '{name}'; their rows could not be told apart: rename one"
            );
        }
        let word =
            |name: &str| !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || "-_.".contains(c)) && !name.starts_with('.');
        ensure!(
            word(&experiment.name),
            "the name '{}' must be of letters, digits, '-', '_' and '.': files are named after it",
            experiment.name
        );
        let limit = experiment.time_limit_s;
        ensure!(limit > 0.0 && limit <= 1e6, "time-limit-s = {limit}: it must be over 0 and at most 10^6 seconds");
        ensure!(!experiment.block_budget_s.is_nan(), "block-budget-s is nan: leave it out for no budget");
        let limit = experiment.memory_limit_mib;
        ensure!(limit <= 1 << 30, "memory-limit-mib = {limit}: at most 2^30 (1 PiB) can be limited");
        experiment.check_threads()?;
        if let Some(name) = &experiment.ratios_to {
            ensure!(names().any(|known| known == name), "ratios-to = \"{name}\": it must be one of the experiment's detectors or runners");
        }
        for figure in experiment.figures.iter().filter(|figure| figure.kind == FigureKind::Lines) {
            let axes = [("x", &figure.x), ("x-label", &figure.x_label), ("y", &figure.y), ("y-label", &figure.y_label)];
            for (field, value) in axes {
                ensure!(!value.is_empty(), "the figure {} has no {field}; give one, or say kind = \"speed-error\"", figure.name);
            }
            ensure!(!figure.caches || figure.x == "n", "the figure {} has caches = true: its x must be n", figure.name);
        }
        ensure!(!experiment.arithmetics.is_empty(), "arithmetics is empty; leave it out for exact");
        for scene in &mut experiment.scenes {
            for value in [scene.params.get_mut("path"), scene.quick.get_mut("path")].into_iter().flatten() {
                let OneOrMany::One(toml::Value::String(path)) = value else { bail!("path must be one string") };
                *path = folder.join(&*path).display().to_string();
            }
        }
        experiment.plan(false)?;
        experiment.plan(true)?;
        Ok(experiment)
    }

    fn check_threads(&self) -> anyhow::Result<()> {
        let threads = self.threads.values();
        ensure!(!threads.is_empty(), "threads is empty; leave it out for one");
        ensure!(!threads.contains(&0), "threads = 0: at least one is needed");
        ensure!(threads.iter().all(|&k| k <= MOST_THREADS), "threads: at most {MOST_THREADS} can be asked for");
        ensure!((1..threads.len()).all(|k| !threads[..k].contains(&threads[k])), "threads names a number twice; leave one out");
        ensure!(
            !self.ceiling || threads.contains(&1) && threads.len() > 1,
            "ceiling = true compares several threads with one; say threads = [1, 2], for example"
        );
        Ok(())
    }

    /// All scenes of the experiment, in the order run.
    pub fn plan(&self, quick: bool) -> anyhow::Result<Vec<Spec>> {
        let mut specs = Vec::new();
        for sweep in &self.scenes {
            let sweep = if quick { sweep.quickened()? } else { sweep.clone() };
            let numbers = match &sweep.n {
                Some(numbers) => numbers.values(),
                None if generate::table::find(&sweep.name).is_ok_and(|generator| generator.own_n) => vec![0],
                None => bail!("scene {}: n is missing; give the numbers of elements, as in n = [100, 1000]", sweep.name),
            };
            for dim in sweep.dim.values() {
                let mut axes: Vec<(&str, Vec<toml::Value>)> =
                    sweep.params.iter().map(|(name, values)| (name.as_str(), values.values())).collect();
                if sweep.name == generate::hard::NAME && !sweep.params.contains_key("case") {
                    axes.push(("case", hard::cases().filter(|case| case.dims.contains(&dim)).map(|case| case.name.into()).collect()));
                }
                for order in sweep.order.values() {
                    for combination in product(&axes) {
                        for &n in &numbers {
                            for seed in sweep.seed.values() {
                                let spec = Spec::new(&sweep.name, dim, n, seed, order, &combination)?;
                                ensure!(
                                    !specs.contains(&spec),
                                    "scene {} stands there twice with the same parameters; leave one out",
                                    spec.name
                                );
                                specs.push(spec);
                            }
                        }
                    }
                }
            }
        }
        Ok(specs)
    }
}

impl SceneSweep {
    fn quickened(&self) -> anyhow::Result<SceneSweep> {
        let mut sweep = self.clone();
        for (name, value) in &self.quick {
            let whole = |v: &toml::Value| {
                v.as_integer().and_then(|v| u64::try_from(v).ok()).with_context(|| format!("quick.{name}: {v} is not a whole number"))
            };
            let values = || value.values().iter().map(whole).collect::<anyhow::Result<Vec<u64>>>();
            match name.as_str() {
                "n" => sweep.n = Some(OneOrMany::Many(values()?)),
                "seed" => sweep.seed = OneOrMany::Many(values()?),
                "dim" => sweep.dim = OneOrMany::Many(values()?.into_iter().map(|dim| dim as u32).collect()),
                _ => {
                    sweep.params.insert(name.clone(), value.clone());
                }
            }
        }
        Ok(sweep)
    }
}

/// All combinations of one value per axis.
fn product(axes: &[(&str, Vec<toml::Value>)]) -> Vec<BTreeMap<String, toml::Value>> {
    let mut all = vec![BTreeMap::new()];
    for (name, values) in axes {
        all = all
            .into_iter()
            .flat_map(|head| {
                values.iter().map(move |value| {
                    let mut head = head.clone();
                    head.insert((*name).to_string(), value.clone());
                    head
                })
            })
            .collect();
    }
    all
}
