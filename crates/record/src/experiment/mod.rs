//! Experiments: TOML files with a question, scenes, detectors, claims and figures.
//! docs/EXPERIMENTS.md describes them.
//!
//! This module reads the file alone. `plan` of the run crate resolves its names to scenes and
//! detectors, and fills in [`Experiment::planned`].

pub mod claims;
pub mod document;
pub mod expression;
pub mod figures;
mod known;
mod plain;
pub mod planned;
pub mod shard;
pub mod sweep;

use serde::Deserialize;

pub use crate::experiment::claims::{Claim, ClaimKind, Where};
pub use crate::experiment::document::Document;
pub use crate::experiment::figures::{Against, Bars, Figure, FigureKind, Lines, SpeedError};
pub use crate::experiment::planned::{Planned, PlannedSubject};
pub use crate::experiment::sweep::{Quick, SceneSweep};
use crate::record::faults::{MOST_THREADS, is_word};
use contactbench_terms::arithmetic::Arithmetic;
use contactbench_terms::must;

/// One experiment file. [`Document::read`] requires the keys in [`REQUIRED`].
#[derive(Clone, Debug, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct Experiment {
    pub name: String,
    pub title: String,
    pub question: String,
    pub reading: String,
    pub standard: bool,
    pub detectors: Vec<String>,
    pub arithmetics: Vec<Arithmetic>,
    /// Numbers of threads. A detector that cannot use several runs once, with one thread.
    pub threads: Vec<usize>,
    /// Whether to also time k single-threaded copies at once, for each number k of threads.
    pub ceiling: bool,
    pub ratios_to: Option<String>,
    /// Number of blocks. Each block runs every detector once, in a new random order. If 0, only
    /// answers, counts and memory are measured.
    pub blocks: u32,
    /// Seconds after which a scene starts no further block, once it has [`FEWEST_BLOCKS`].
    pub block_budget_s: f64,
    /// Seconds allowed per request to a runner. The first sample of a scene runs two detections,
    /// the first of them to warm the caches.
    pub time_limit_s: f64,
    /// Limit for the arrays of a detector; `None` means the memory of the machine. The address
    /// space of a runner has this limit plus an allowance for input, output and program.
    pub memory_limit_mib: Option<u64>,
    #[serde(rename = "scene")]
    pub scenes: Vec<SceneSweep>,
    #[serde(rename = "runner")]
    pub runners: Vec<ExternalRunner>,
    #[serde(rename = "claim")]
    pub claims: Vec<Claim>,
    #[serde(rename = "figure")]
    pub figures: Vec<Figure>,
    pub table: Option<Table>,
    #[serde(skip)]
    pub planned: Planned,
}

pub const REQUIRED: [&str; 6] = ["name", "title", "question", "reading", "detectors", "scene"];

impl Experiment {
    /// Whether the experiment asks for the fastest detector: its question contains "fast", it
    /// compares times (with one detector or in a claim), or it has no claims and does not compare
    /// arithmetics.
    pub fn asks_fastest(&self) -> bool {
        let faster = |claim: &Claim| matches!(claim.kind, ClaimKind::Faster { .. });
        self.question.to_lowercase().contains("fast")
            || self.ratios_to.is_some()
            || self.claims.is_empty() && self.arithmetics.len() == 1
            || self.claims.iter().any(faster)
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
            threads: vec![1],
            ceiling: false,
            ratios_to: None,
            blocks: 15,
            block_budget_s: f64::INFINITY,
            time_limit_s: 30.0,
            memory_limit_mib: None,
            scenes: Vec::new(),
            runners: Vec::new(),
            claims: Vec::new(),
            figures: Vec::new(),
            table: None,
            planned: Planned::default(),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Table {
    Verdicts,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExternalRunner {
    pub name: String,
    /// Program and arguments; `{threads}` in an argument stands for the number of threads.
    pub command: Vec<String>,
    /// How to install the runner. If this is given, the runner may be absent; the text then appears
    /// in rows with outcome `unavailable`.
    #[serde(default)]
    pub install: String,
    #[serde(default)]
    pub optional: bool,
}

impl ExternalRunner {
    pub fn is_optional(&self) -> bool {
        self.optional || !self.install.is_empty()
    }
}

/// Least number of blocks of a scene, whatever the time budget. The range of six values covers the
/// median in 96.9% of samples.
pub const FEWEST_BLOCKS: u32 = 6;
const QUICK_BLOCKS: u32 = 3;
/// Most blocks of a scene.
const MOST_BLOCKS: u32 = 100_000;

impl Experiment {
    pub fn all_blocks(&self, quick: bool) -> u32 {
        if quick { self.blocks.min(QUICK_BLOCKS) } else { self.blocks }
    }

    pub fn enough_blocks(&self, quick: bool) -> u32 {
        let blocks = self.all_blocks(quick);
        if self.block_budget_s.is_finite() { blocks.min(FEWEST_BLOCKS) } else { blocks }
    }

    pub fn check(&self, document: &Document<'_>) -> anyhow::Result<()> {
        self.sound().map_err(|words| {
            // The words begin with the key.
            let key = words.split([' ', ':']).next().unwrap_or_default().to_string();
            document.key(&key, words)
        })?;
        for (k, figure) in self.figures.iter().enumerate() {
            if let FigureKind::Lines(lines) = &figure.kind
                && let Some(problem) = lines.problem()
            {
                let words = format!("the figure {} has {problem}", figure.name);
                return Err(document.figure(k, words));
            }
        }
        Ok(())
    }

    pub fn check_names(&self, document: &Document<'_>) -> anyhow::Result<()> {
        known::check(self, document)
    }

    fn sound(&self) -> Result<(), String> {
        let name = &self.name;
        must!(is_word(name), "name = '{name}': use letters, digits, '-', '_' and '.' only");
        let names = || self.detectors.iter().chain(self.runners.iter().map(|runner| &runner.name));
        for (k, name) in names().enumerate() {
            must!(name.len() <= 1000, "a name has {} bytes; at most 1000 are allowed", name.len());
            must!(names().take(k).all(|other| other != name), "runner: {}", twice(name));
        }
        if let Some(to) = &self.ratios_to {
            let known = names().any(|known| known == to);
            must!(known, "ratios-to = \"{to}\": it must be one of the detectors or runners");
        }
        must!(names().next().is_some(), "detectors is empty, and there is no runner; name one");
        must!(!self.arithmetics.is_empty(), "arithmetics is empty; leave it out for exact");
        let limit = self.time_limit_s;
        let some = limit > 0.0 && limit <= 1e6;
        must!(some, "time-limit-s = {limit}: it must be over 0 and at most 10^6 seconds");
        let number = !self.block_budget_s.is_nan();
        must!(self.blocks <= MOST_BLOCKS, "blocks = {}: at most {MOST_BLOCKS}", self.blocks);
        must!(number, "block-budget-s is nan: leave it out for no budget");
        let limit = self.memory_limit_mib.unwrap_or(0);
        must!(limit <= 1 << 30, "memory-limit-mib = {limit}: at most 2^30 (1 PiB) can be limited");
        let threads = &self.threads;
        must!(!threads.is_empty(), "threads is empty; leave it out for one");
        for (k, count) in threads.iter().enumerate() {
            let some = (1..=MOST_THREADS).contains(count);
            must!(some, "threads = {count}: at least 1 and at most {MOST_THREADS}");
            must!(!threads[..k].contains(count), "threads names {count} twice; leave one out");
        }
        let several = threads.contains(&1) && threads.len() > 1;
        must!(
            !self.ceiling || several,
            "ceiling = true needs one thread and more: threads = [1, 2]"
        );
        Ok(())
    }
}

pub fn twice(name: &str) -> String {
    format!(
        "two runners are named '{name}'; rename one, because their rows could not be \
         distinguished"
    )
}
