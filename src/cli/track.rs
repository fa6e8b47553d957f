use std::io::Write;
use std::process::ExitCode;

use crate::cli::shared::arithmetic::arithmetic;
use crate::cli::shared::limit::Limit;
use crate::cli::shared::progress::Counted;
use crate::cli::shared::scene::Source;
use crate::cli::shared::sequence::{FRAMES, Sequence, sequence};
use crate::cli::shared::{terminal, tracking, values};
use anyhow::{Context, ensure};
use contactbench_detectors::oracle::SAMPLE;
use contactbench_detectors::tracker::{self, TrackerSpec};
use contactbench_ground::contact::Arithmetic;
use contactbench_run::run::machine::interrupt;
use contactbench_run::tracking::{Check, Question, follow};
use contactbench_scenes::motion::Motion;

#[derive(clap::Args)]
pub struct Track {
    #[command(flatten)]
    source: Source,
    /// Motion (see: list) [default: by file, else drift]
    #[arg(long)]
    motion: Option<Motion>,
    /// Number of frames [default: 100, or all of a file]
    #[arg(long, value_name = "COUNT", value_parser = values::whole::<u64>)]
    frames: Option<u64>,
    /// Tracker, repeatable (see: list) [default: seven]
    #[arg(long = "tracker", value_name = "TRACKER")]
    trackers: Vec<String>,
    /// Arithmetic (see: list); exact-open decides by <
    #[arg(long, value_name = "NAME", value_parser = arithmetic(), default_value_t)]
    #[arg(hide_possible_values = true)]
    arithmetic: Arithmetic,
    /// Check all, sample or none [default: by N * frames]
    #[arg(long, value_name = "CONTACTS", hide_possible_values = true)]
    truth: Option<Truth>,
    #[command(flatten)]
    limit: Limit,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Truth {
    All,
    Sample,
    None,
}

/// Largest number of particles times frames for which all contacts are checked by default. Checking
/// them takes some ten seconds. A file counts as [`FRAMES`] frames unless the options limit them.
const CHECKED: u64 = 10_000_000;

/// The default trackers: all safe rules, LAMMPS's default, and one that tracks no displacement.
const USUAL: [&str; 7] = [
    "every-step(streamed-nbs)",
    "verlet(streamed-nbs,skin=auto)",
    "verlet(streamed-nbs,rule=top-two)",
    "verlet(streamed-nbs,rule=half-skin)",
    "verlet(streamed-nbs,rule=summed)",
    "verlet(streamed-nbs,rule=lammps-0-1-yes)",
    "verlet(streamed-nbs,rule=every-10)",
];

/// Runs all trackers over the frames of a motion or a file, and checks their contacts.
pub fn track(options: &Track) -> anyhow::Result<ExitCode> {
    interrupt::end_runners_too().context("cannot listen to Ctrl-C")?;
    let usual = USUAL.into_iter().filter(|_| options.trackers.is_empty());
    let texts = options.trackers.iter().map(String::as_str).chain(usual);
    let trackers: Vec<TrackerSpec> = texts.map(tracker::parse).collect::<Result<_, _>>()?;
    let Track { motion, frames, .. } = *options;
    let body = |sequence: Sequence<'_>| followed(options, &trackers, sequence);
    sequence(&options.source, motion, frames, body)
}

fn followed(
    options: &Track,
    trackers: &[TrackerSpec],
    sequence: Sequence<'_>,
) -> anyhow::Result<ExitCode> {
    let Sequence { name, motion, particles, count: frames, next, .. } = sequence;
    ensure!(particles > 0, "{name} has no particles: there is nothing to compare");
    let memory_limit = options.limit.bytes(particles);
    let expected = if frames == u64::MAX { FRAMES } else { frames };
    let check = match options.truth {
        Some(Truth::All) => Check::All,
        Some(Truth::None) => Check::None,
        None if (particles as u64).saturating_mul(expected) <= CHECKED => Check::All,
        Some(Truth::Sample) | None => Check::Sample(SAMPLE),
    };
    let arithmetic = options.arithmetic;
    let question = Question { trackers, arithmetic, frames, memory_limit, check };
    let progress = Counted::new(Some(frames).filter(|&frames| frames < u64::MAX));
    let frame = |k| {
        progress.frame(k);
        next(k)
    };
    let followed = follow(frame, &question)?;
    drop(progress);
    let mut out = terminal::out();
    if options.json {
        terminal::json(&tracking::as_json(name, motion, &followed))?;
    } else {
        let said = tracking::words(name, motion, &followed);
        write!(out, "{}", contactbench_report::document::plain(&said, terminal::width()))?;
    }
    let wrong = followed.trackers.iter().any(|tracked| tracked.is_wrong());
    Ok(if wrong { ExitCode::FAILURE } else { ExitCode::SUCCESS })
}
