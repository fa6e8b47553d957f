use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

use anyhow::{Context, ensure};
use serde_json::json;

use crate::cli::shared::arithmetic::arithmetic;
use crate::cli::shared::limit::Limit;
use crate::cli::shared::output::Output;
use crate::cli::shared::progress::Line;
use crate::cli::shared::scene::Source;
use crate::cli::shared::values;
use contactbench_ground::contact::Arithmetic;
use contactbench_io::Given;
use contactbench_io::boxes::along;
use contactbench_record::record::row::Outcome;
use contactbench_record::stats::interval::ratio;
use contactbench_report::table::Table;
use contactbench_run::recommend::race::{self, Question};
use contactbench_run::recommend::subject::{Race, RacedSubject, fastest};
use contactbench_run::recommend::verdict::{Verdict, bytes_per_particle, per_particle};
use contactbench_run::recommend::words;
use contactbench_run::run::machine::interrupt;
use contactbench_scenes::spec::Spec;
use contactbench_terms::number::{number, plural, with_interval};

#[derive(clap::Args)]
pub struct Recommend {
    #[command(flatten)]
    source: Source,
    /// Time for the measurements, in seconds
    #[arg(long, value_name = "TIME", default_value_t = 10.0, allow_negative_numbers = true)]
    seconds: f64,
    /// Arithmetic (see: list); exact-open decides by <
    #[arg(long, value_name = "NAME", value_parser = arithmetic(), default_value_t)]
    #[arg(hide_possible_values = true)]
    arithmetic: Arithmetic,
    /// Threads, if the detector can use them
    #[arg(long, value_name = "COUNT", default_value_t = 1, value_parser = values::threads)]
    threads: usize,
    #[command(flatten)]
    limit: Limit,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Prints the detector to use; exit code 1 if one was wrong, or none can be used.
pub fn recommend(options: &Recommend) -> anyhow::Result<ExitCode> {
    let (seconds, threads) = (options.seconds, options.threads);
    ensure!((0.1..1e6).contains(&seconds), "--seconds {seconds}: give a number from 0.1 to 10^6");
    let (name, given) = options.source.given()?;
    ensure!(!given.scene.is_empty(), "{name}: the scene has no particles");
    let history = history(&name)?;
    interrupt::end_runners_too().context("cannot listen to Ctrl-C")?;
    let program = std::env::current_exe();
    let program = program.context("cannot find this program to start it as runner")?;
    let program = vec![program.display().to_string()];
    let time = Duration::from_secs_f64(seconds);
    let Recommend { arithmetic, limit, .. } = *options;
    let memory_limit = limit.bytes(given.scene.len());
    let question = Question {
        given: &given,
        history: &history,
        arithmetic,
        threads,
        memory_limit,
        time,
        program,
    };
    let line = Line::start();
    let race = race::run(&question, &mut |text| line.show(text))?;
    drop(line);
    let verdict = Verdict::new(&race);
    let mut out = Output::new(options.json);
    out.values(json!({ "seconds": seconds, "memory_limit": memory_limit }));
    head(&mut out, &name, &question, race.contacts, race.blocks);
    let n = given.scene.len();
    out.values(words::as_json(verdict.as_ref(), &race, n));
    out.table(&table(&race, verdict.as_ref(), n));
    out.gap();
    let none =
        || vec!["none: no detector gave a right answer in time; see the reasons above".into()];
    let said = verdict.as_ref().map_or_else(none, |verdict| words::sentences(verdict, &race, n));
    for (k, line) in said.iter().enumerate() {
        out.text(if k == 0 { format!("use {line}") } else { format!("  {line}") });
    }
    out.print()?;
    let wrong = race.subjects.iter().any(|subject| subject.row.outcome == Outcome::Wrong);
    Ok(ExitCode::from(u8::from(wrong || verdict.is_none())))
}

/// Prints what was measured.
fn head(out: &mut Output, name: &str, question: &Question<'_>, contacts: u64, blocks: u32) {
    let Question { given, arithmetic, threads, .. } = *question;
    let (n, dim) = (given.scene.len(), given.scene.dim());
    let what = if dim == 2 { "discs" } else { "spheres" };
    let boxed = given.lattice.as_ref().map_or(String::new(), |lattice| {
        format!(" in a box periodic along {}", along(lattice.periodic()))
    });
    let text = format!(
        "{name}: {n} {what}{boxed}, {}, {} arithmetic, {}, {}",
        plural(contacts as usize, "contact"),
        arithmetic.name(),
        plural(threads, "thread"),
        plural(blocks as usize, "block")
    );
    let values = json!({
        "scene": name,
        "dim": dim,
        "n": n,
        "contacts": contacts,
        "arithmetic": arithmetic.name(),
        "threads": threads,
    });
    out.line("", text, values);
}

/// Returns the scenes that a hard case runs before its own; empty for any other scene.
fn history(name: &str) -> anyhow::Result<Vec<Given>> {
    let spec = Spec::parse(name).ok().filter(|_| !Path::new(name).exists());
    spec.map_or(Ok(Vec::new()), |spec| spec.history())
}

/// Returns all detectors, the fastest first, and those without a time last.
fn ranked(race: &Race, n: usize) -> Vec<&RacedSubject> {
    let mut subjects: Vec<&RacedSubject> = race.subjects.iter().collect();
    let rank =
        |subject: &RacedSubject| per_particle(subject, n).map_or(f64::INFINITY, |time| time.median);
    let probe = |subject: &RacedSubject| subject.probe_ns.unwrap_or(u64::MAX);
    subjects.sort_by(|a, b| rank(a).total_cmp(&rank(b)).then(probe(a).cmp(&probe(b))));
    subjects
}

/// Returns the reason why a detector has no time; `None` if it has one.
fn why_out(subject: &RacedSubject) -> Option<String> {
    match subject.row.outcome {
        _ if !subject.times.is_empty() => None,
        outcome if outcome.is_good() => Some(format!("dropped: {}", subject.row.reason)),
        Outcome::Timeout | Outcome::Unavailable => Some(subject.row.reason.clone()),
        outcome => Some(format!("{}: {}", outcome.name(), subject.row.reason)),
    }
}

/// Returns one row for each detector. Intervals are of ratios, because absolute times hold in one
/// run only.
fn table(race: &Race, verdict: Option<&Verdict>, n: usize) -> Table {
    let base = fastest(&race.subjects).map(|k| &race.subjects[k]);
    let choice = verdict.map(|verdict| race.subjects[verdict.choice].entry.name);
    let name = |subject: &RacedSubject| match subject.entry.name {
        name if choice == Some(name) => format!("{name} <"),
        name => name.into(),
    };
    let to_fastest = |subject: &RacedSubject| match base {
        Some(base) if base.entry.name == subject.entry.name => Some("1".into()),
        Some(base) => ratio(&subject.times, &base.times).map(|ratio| with_interval(&ratio)),
        None => None,
    };
    Table::of("", ranked(race, n))
        .left("detector", name)
        .right("time / fastest", to_fastest)
        .right("ns per particle in this run", |subject| {
            per_particle(subject, n).map(|time| number(time.median))
        })
        .right("bytes / particle", |subject| bytes_per_particle(subject, n))
        .left("error", |subject| why_out(subject).unwrap_or_else(|| words::error(subject)))
        .into()
}
