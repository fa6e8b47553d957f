//! `contactbench recommend`.

use std::io::{IsTerminal, Write};
use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

use anyhow::{Context, bail, ensure};
use serde_json::json;

use super::scene::Source;
use crate::analyse::text::{self, number};
use crate::contact::Arithmetic;
use crate::detect::Options;
use crate::harness::interrupt;
use crate::harness::record::Outcome;
use crate::recommend::race::{self, Entrant, Question, Race};
use crate::recommend::verdict::{self, Verdict};
use crate::scene::AnyScene;
use crate::scene::spec::Spec;

/// Options of `recommend`.
#[derive(clap::Args)]
pub struct Recommend {
    #[command(flatten)]
    source: Source,
    /// The measurements take about so long, besides reading and finding the truth
    #[arg(long, default_value_t = 10.0, allow_negative_numbers = true)]
    seconds: f64,
    /// How contacts are decided
    #[arg(long, value_enum, default_value_t)]
    arithmetic: Arithmetic,
    /// Threads, for detectors that can use them
    #[arg(long, default_value_t = 1)]
    threads: usize,
    /// Most bytes for a detector's arrays
    #[arg(long, default_value_t = Options::default().memory_limit)]
    memory_limit: u64,
    /// All numbers, for programs
    #[arg(long)]
    json: bool,
}

/// Measures, and says which detector to use; exit code 1 if one was wrong, or none can be used.
pub fn recommend(options: &Recommend) -> anyhow::Result<ExitCode> {
    let (seconds, threads) = (options.seconds, options.threads);
    ensure!((0.1..1e6).contains(&seconds), "--seconds {seconds}: give a number from 0.1 to 10^6");
    ensure!((1..=1024).contains(&threads), "--threads {threads}: give a number from 1 to 1024");
    let Some((name, scene)) = options.source.get()? else {
        bail!("name a particle file, or a scene such as packed:n=20000 (contactbench list scenes)");
    };
    ensure!(!scene.is_empty(), "{name}: the scene has no elements; there is nothing to recommend");
    let history = history(&name)?;
    interrupt::end_runners_too().context("cannot listen to Ctrl-C")?;
    let program = std::env::current_exe().context("cannot find this program to start it as runner")?;
    let time = Duration::from_secs_f64(seconds);
    let Recommend { arithmetic, memory_limit, .. } = *options;
    let question = Question { scene: &scene, history: &history, arithmetic, threads, memory_limit, time, program };
    let terminal = std::io::stderr().is_terminal();
    let mut note = |text: &str| {
        if terminal {
            eprint!("\r\x1b[K{text}");
        }
    };
    let race = race::run(&question, &mut note)?;
    note("");
    let verdict = verdict::of(&race);
    let n = scene.len();
    let mut out = std::io::stdout().lock();
    if options.json {
        let mut value = verdict::as_json(verdict.as_ref(), &race, n);
        let about = json!({
            "scene": name, "dim": scene.dim(), "n": n, "contacts": race.contacts,
            "arithmetic": arithmetic.name(), "threads": threads, "seconds": seconds, "memory_limit": memory_limit,
        });
        if let (Some(value), serde_json::Value::Object(about)) = (value.as_object_mut(), about) {
            value.extend(about);
        }
        writeln!(out, "{}", serde_json::to_string_pretty(&value)?)?;
    } else {
        let what = if scene.dim() == 2 { "discs" } else { "spheres" };
        let (contacts, decided) = (race.contacts, arithmetic.name());
        let threads = text::plural(threads, "thread");
        writeln!(out, "{name}: {n} {what}, {contacts} contacts, {decided} arithmetic, {threads}, {} blocks", race.blocks)?;
        table(&race, verdict.as_ref(), n, &mut out)?;
        match &verdict {
            Some(verdict) => writeln!(out, "\nuse {}", verdict::sentence(verdict, &race, n))?,
            None => writeln!(out, "\nuse none: no detector has given a right answer in time; the reasons stand above")?,
        }
    }
    let wrong = race.entrants.iter().any(|entrant| entrant.outcome == Outcome::Wrong && entrant.entry.is_ours());
    Ok(if wrong || verdict.is_none() { ExitCode::from(1) } else { ExitCode::SUCCESS })
}

/// Scenes that come before, where a hard case has some: a file has none.
fn history(name: &str) -> anyhow::Result<Vec<AnyScene<'static>>> {
    if Path::new(name).exists() { Ok(Vec::new()) } else { Spec::parse(name).map_or(Ok(Vec::new()), |spec| spec.history()) }
}

/// The detectors, fastest first; those without a time at the end.
fn table(race: &Race, verdict: Option<&Verdict>, n: usize, out: &mut impl Write) -> anyhow::Result<()> {
    let choice = verdict.map(|verdict| &race.entrants[verdict.choice]);
    let mut entrants: Vec<&Entrant> = race.entrants.iter().collect();
    let rank = |entrant: &Entrant| verdict::per_element(entrant, n).map_or(f64::INFINITY, |time| time.median);
    let probe = |entrant: &Entrant| entrant.probe_ns.unwrap_or(u64::MAX);
    entrants.sort_by(|a, b| rank(a).total_cmp(&rank(b)).then(probe(a).cmp(&probe(b))));
    let width = entrants.iter().map(|entrant| entrant.entry.name.len()).max().unwrap_or_default();
    writeln!(out, "{:width$}  {:>24}  {:>15}  error", "", "ns per element", "bytes / element")?;
    for entrant in entrants {
        let name = entrant.entry.name;
        let mark = if choice.is_some_and(|choice| choice.entry.name == name) { "<" } else { "" };
        match verdict::per_element(entrant, n) {
            Some(time) => {
                let range = format!("{} ({} to {})", number(time.median), number(time.low), number(time.high));
                let bytes = verdict::bytes_per_element(entrant, n).map_or("not measured".into(), number);
                writeln!(out, "{name:width$}  {range:>24}  {bytes:>15}  {} {mark}", verdict::error(entrant))?;
            }
            None if entrant.outcome.is_good() => writeln!(out, "{name:width$}  out: {}", entrant.reason)?,
            None => writeln!(out, "{name:width$}  {}: {}", entrant.outcome.name(), entrant.reason)?,
        }
    }
    Ok(())
}
