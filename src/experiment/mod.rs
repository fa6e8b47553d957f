//! Experiments: a question, scenes, a sweep, detectors, what is expected and how to read the
//! answer, as a TOML file. docs/EXPERIMENTS.md describes the files.

pub mod builtin;
pub mod claims;
pub mod detectors;
mod document;
pub mod expression;
pub mod figures;
pub mod keys;
mod known;
pub mod list;
mod plain;
pub mod plan;
pub mod scenes;
pub mod shard;

use std::io::Read;
use std::path::Path;

use anyhow::{Context, ensure};
use serde::Deserialize;

pub use crate::experiment::claims::{Claim, ClaimKind, Where};
use crate::experiment::document::Document;
pub use crate::experiment::figures::{
    Against, Bars, Figure, FigureKind, Lines, MapAxes, SpeedError,
};
pub use crate::experiment::list::List;
pub use crate::experiment::scenes::SceneSweep;
use crate::memory::default_limit;
use crate::record::faults::{MOST_THREADS, is_word};
use contactbench_terms::arithmetic::Arithmetic;

/// One experiment file. [`Experiment::parse`] asks for the keys in [`REQUIRED`].
#[derive(Clone, Debug, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
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
    pub standard: bool,
    /// Detectors of the table, with their parameters; groups are resolved.
    #[serde(deserialize_with = "list::many")]
    pub detectors: Vec<String>,
    /// Arithmetics to run each detector with.
    #[serde(deserialize_with = "list::many")]
    pub arithmetics: Vec<Arithmetic>,
    /// Threads given to the detectors; those that cannot use several run once, with one.
    pub threads: List<usize>,
    /// With every detector with several threads: as many copies of it with one thread each, all at
    /// work at the same time.
    pub ceiling: bool,
    /// Measures the machine's memory bandwidth before the run; the report then compares times with
    /// it.
    pub bound: bool,
    /// The report fits costs per operation to times, and says where detectors overtake each other.
    pub cost_model: bool,
    /// The detector that all others are compared with in a table of ratios.
    pub ratios_to: Option<String>,
    /// The report says what following printed advice would cost in these scenes.
    pub advice: bool,
    /// Paired blocks: each runs every detector once, in a fresh random order. 0: no times, only
    /// answers, counts and memory.
    #[serde(deserialize_with = "list::one")]
    pub blocks: u32,
    /// Seconds after which no further block of a scene is begun, once six are done.
    pub block_budget_s: f64,
    /// Seconds that one request to a runner may take; the first sample of a scene is two
    /// detections, one to warm the caches.
    pub time_limit_s: f64,
    /// Limit for a detector's arrays, and (with an allowance for input, output and program) for a
    /// runner's address space.
    #[serde(deserialize_with = "list::one")]
    pub memory_limit_mib: u64,
    /// Scenes, each swept over its lists.
    #[serde(rename = "scene")]
    pub scenes: Vec<SceneSweep>,
    /// Runners in other languages.
    #[serde(rename = "runner")]
    pub runners: Vec<ExternalRunner>,
    /// What is expected.
    #[serde(rename = "claim")]
    pub claims: Vec<Claim>,
    /// What is drawn.
    #[serde(rename = "figure")]
    pub figures: Vec<Figure>,
    /// A table shown after the run and in the report, besides the usual ones.
    pub table: Option<Table>,
}

/// The keys that every file must have.
pub const REQUIRED: [&str; 6] = ["name", "title", "question", "reading", "detectors", "scene"];

impl Experiment {
    /// Does it ask which detector is the fastest? Its question has the word, or it compares times:
    /// with one detector, with advice, on a map or in a claim; or it has no claims, and does not
    /// compare arithmetics.
    pub fn asks_fastest(&self) -> bool {
        let faster = |claim: &Claim| matches!(claim.kind, ClaimKind::Faster { .. });
        let map = |figure: &Figure| matches!(figure.kind, FigureKind::Map(_));
        self.question.to_lowercase().contains("fast")
            || self.ratios_to.is_some()
            || self.advice
            || self.claims.is_empty() && self.arithmetics.len() == 1
            || self.claims.iter().any(faster)
            || self.figures.iter().any(map)
    }
}

impl Default for Experiment {
    fn default() -> Experiment {
        Experiment {
            name: String::new(),
            title: String::new(),
            question: String::new(),
            reading: String::new(),
            standard: false,
            detectors: Vec::new(),
            arithmetics: vec![Arithmetic::Exact],
            threads: 1.into(),
            ceiling: false,
            bound: false,
            cost_model: false,
            ratios_to: None,
            advice: false,
            blocks: 15,
            block_budget_s: f64::INFINITY,
            time_limit_s: 30.0,
            memory_limit_mib: default_limit() >> 20,
            scenes: Vec::new(),
            runners: Vec::new(),
            claims: Vec::new(),
            figures: Vec::new(),
            table: None,
        }
    }
}

/// Kinds of tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Table {
    /// Case by case and arithmetic by arithmetic: which detectors are right, and what the others
    /// are.
    Verdicts,
}

/// A runner that is not part of this program: see docs/PROTOCOL.md.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExternalRunner {
    /// The detector's name in records.
    pub name: String,
    /// Program and arguments; `{threads}` in an argument stands for the number of threads.
    pub command: Vec<String>,
    /// How to get it, for rows that say `unavailable`. Whoever says this expects that it may not
    /// be there.
    #[serde(default)]
    pub install: String,
    /// A run without it is no failure.
    #[serde(default)]
    pub optional: bool,
}

impl ExternalRunner {
    /// Whether a run in which it cannot be started has failed in nothing.
    pub fn is_optional(&self) -> bool {
        self.optional || !self.install.is_empty()
    }
}

/// The bytes of an experiment file, at most; the largest of ours has 15 kB.
const MOST_BYTES: u64 = 1 << 20;

/// The text of an experiment file, which is read no further than its bound.
pub fn text_of(path: &Path) -> anyhow::Result<String> {
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path);
    file.and_then(|file| file.take(MOST_BYTES + 1).read_to_end(&mut bytes))
        .with_context(|| format!("cannot read the experiment {}", path.display()))?;
    short_enough(&String::from_utf8_lossy(&bytes))
        .with_context(|| format!("in {}", path.display()))?;
    String::from_utf8(bytes).with_context(|| format!("{} is not text (UTF-8)", path.display()))
}

fn short_enough(text: &str) -> anyhow::Result<()> {
    let scenes = text.matches("[[scene]]").count();
    ensure!(
        text.len() as u64 <= MOST_BYTES,
        "an experiment has at most {} KiB, and this text is longer, with {scenes} [[scene]] tables \
         in what was read; give a scene lists of values, or write several experiments",
        MOST_BYTES >> 10
    );
    Ok(())
}

impl Experiment {
    /// Reads and checks an experiment file.
    pub fn read(path: &Path) -> anyhow::Result<Experiment> {
        let text = text_of(path)?;
        Experiment::parse(&text, path.parent().unwrap_or(Path::new(".")))
            .with_context(|| format!("in {}", path.display()))
    }

    /// As [`Experiment::read`], for a run that is to begin: names in claims and figures must be of
    /// rows that it will have.
    pub fn read_to_run(path: &Path) -> anyhow::Result<Experiment> {
        let text = text_of(path)?;
        let named = |text: &str, folder: &Path| {
            let (experiment, document) = Experiment::checked(text, folder)?;
            known::check(&experiment, &document)?;
            Ok::<_, anyhow::Error>(experiment)
        };
        named(&text, path.parent().unwrap_or(Path::new(".")))
            .with_context(|| format!("in {}", path.display()))
    }

    /// Parses and checks; relative file names of scenes are taken from `folder`.
    pub fn parse(text: &str, folder: &Path) -> anyhow::Result<Experiment> {
        Experiment::checked(text, folder).map(|read| read.0)
    }

    fn checked<'a>(text: &'a str, folder: &Path) -> anyhow::Result<(Experiment, Document<'a>)> {
        short_enough(text)?;
        let (mut experiment, document) =
            Document::read(text).map_err(|problem| problem.located(text))?;
        experiment.detectors = detectors::expand(&experiment.detectors)
            .map_err(|words| document.key("detectors", words))?;
        experiment.ratios_to = experiment.ratios_to.as_deref().map(detectors::normal);
        experiment.name_claimed(&document)?;
        if let Some((key, words)) = experiment.problem() {
            return Err(document.key(key, words));
        }
        for (k, figure) in experiment.figures.iter().enumerate() {
            if let FigureKind::Lines(lines) = &figure.kind
                && let Some(problem) = lines.problem()
            {
                let words = format!("the figure {} has {problem}", figure.name);
                return Err(document.figure(k, words));
            }
        }
        for sweep in &mut experiment.scenes {
            sweep.relative_to(folder).with_context(|| format!("line {}", sweep.line))?;
        }
        let moves = experiment.plan(false)?.iter().any(|spec| spec.course.is_some());
        experiment.plan(true)?;
        if moves && (experiment.bound || experiment.cost_model) {
            let words = "bound and cost-model are about single detections, and a scene moves; \
                         leave them out";
            let key = if experiment.bound { "bound" } else { "cost-model" };
            return Err(document.key(key, words.into()));
        }
        Ok((experiment, document))
    }

    /// Parses without a check of what the values mean.
    #[cfg(test)]
    pub(crate) fn unchecked(text: &str) -> anyhow::Result<Experiment> {
        Document::read(text).map(|read| read.0).map_err(|problem| problem.located(text))
    }

    /// Resolves groups and parameters where claims and figures name detectors.
    fn name_claimed(&mut self, document: &Document) -> anyhow::Result<()> {
        let runners = self.runners.iter().map(|runner| runner.name.clone());
        let known: Vec<String> = self.detectors.iter().cloned().chain(runners).collect();
        for (k, claim) in self.claims.iter_mut().enumerate() {
            let problem = |words| document.claim(k, words);
            claims::resolve(&mut claim.filter).map_err(problem)?;
            if let Some(than) = claim.kind.than_mut() {
                *than = detectors::normal(than);
                if !known.contains(than) {
                    let words = format!(
                        "than = \"{than}\": it must be one of the experiment's detectors or \
                         runners{}",
                        crate::nearest::hint(than, known.iter().map(String::as_str))
                    );
                    return Err(problem(words));
                }
            }
        }
        for (k, figure) in self.figures.iter_mut().enumerate() {
            let problem = |words| document.figure(k, words);
            claims::resolve(&mut figure.filter).map_err(problem)?;
            if let FigureKind::Bars(Bars { to }) = &mut figure.kind {
                *to = detectors::normal(to);
                if !known.contains(to) {
                    let words = format!(
                        "to = \"{to}\": it must be one of the experiment's detectors or runners{}",
                        crate::nearest::hint(to, known.iter().map(String::as_str))
                    );
                    return Err(problem(words));
                }
            }
        }
        Ok(())
    }

    /// The first value that cannot be meant: its key, and what is wrong with it.
    fn problem(&self) -> Option<(&'static str, String)> {
        if !is_word(&self.name) {
            let words = format!(
                "the name '{}' must be of letters, digits, '-', '_' and '.': files are named \
                 after it",
                self.name
            );
            return Some(("name", words));
        }
        let names = || self.detectors.iter().chain(self.runners.iter().map(|runner| &runner.name));
        for (k, name) in names().enumerate() {
            if names().take(k).any(|other| other == name) {
                return Some(("runner", detectors::twice(name)));
            }
        }
        if let Some(name) = self.ratios_to.as_ref().filter(|name| names().all(|n| n != *name)) {
            let words = format!(
                "ratios-to = \"{name}\": it must be one of the experiment's detectors or runners"
            );
            return Some(("ratios-to", words));
        }
        if names().next().is_none() {
            let words = "detectors is empty, and there is no runner: nobody takes part; name one";
            return Some(("detectors", words.into()));
        }
        if self.arithmetics.is_empty() {
            return Some(("arithmetics", "arithmetics is empty; leave it out for exact".into()));
        }
        self.limit_problem().or_else(|| self.thread_problem())
    }

    fn limit_problem(&self) -> Option<(&'static str, String)> {
        let limit = self.time_limit_s;
        if !(limit > 0.0 && limit <= 1e6) {
            let words =
                format!("time-limit-s = {limit}: it must be over 0 and at most 10^6 seconds");
            return Some(("time-limit-s", words));
        }
        if self.block_budget_s.is_nan() {
            let words = "block-budget-s is nan: leave it out for no budget";
            return Some(("block-budget-s", words.into()));
        }
        let limit = self.memory_limit_mib;
        if limit > 1 << 30 {
            let words = format!("memory-limit-mib = {limit}: at most 2^30 (1 PiB) can be limited");
            return Some(("memory-limit-mib", words));
        }
        None
    }

    fn thread_problem(&self) -> Option<(&'static str, String)> {
        let threads = &self.threads;
        let words = if threads.is_empty() {
            "threads is empty; leave it out for one".into()
        } else if threads.contains(&0) {
            "threads = 0: at least one is needed".into()
        } else if threads.iter().any(|&k| k > MOST_THREADS) {
            format!("threads: at most {MOST_THREADS} can be asked for")
        } else if (1..threads.len()).any(|k| threads[..k].contains(&threads[k])) {
            "threads names a number twice; leave one out".into()
        } else if self.ceiling && !(threads.contains(&1) && threads.len() > 1) {
            let words = "ceiling = true compares several threads with one; say threads = [1, 2], \
                         for example";
            return Some(("ceiling", words.into()));
        } else {
            return None;
        };
        Some(("threads", words))
    }
}

#[cfg(test)]
mod documented;
