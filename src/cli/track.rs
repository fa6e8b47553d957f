//! `contactbench track`.

use std::io::Write;
use std::process::ExitCode;

use anyhow::ensure;

use crate::cli::shared::arithmetic::arithmetic;
use crate::cli::shared::limit::Limit;
use crate::cli::shared::scene::Source;
use crate::cli::shared::{terminal, values};
use crate::contact::Arithmetic;
use crate::experiment::detectors;
use crate::moving::{Question, follow};
use crate::present::tracking;
use crate::scene::motion::{Frames, Motion};
use crate::track::TrackerSpec;

/// Options of `track`.
#[derive(clap::Args)]
pub struct Track {
    #[command(flatten)]
    source: Source,
    /// How particles move, with speed in diameters per frame (see: contactbench list motions)
    #[arg(long, default_value = "drift")]
    motion: Motion,
    /// Frames, the scene itself among them
    #[arg(long, default_value_t = 100, value_parser = values::whole::<u64>)]
    frames: u64,
    /// Who keeps a list: every-step(DETECTOR) or verlet(DETECTOR,rule=RULE,skin=S), the skin in
    /// diameters; may be said several times (default: the rules there are, over streamed-nbs)
    #[arg(long = "tracker", value_name = "TRACKER")]
    trackers: Vec<String>,
    /// How contacts are decided
    #[arg(long, value_parser = arithmetic(), default_value_t)]
    arithmetic: Arithmetic,
    #[command(flatten)]
    limit: Limit,
    /// Print JSON instead of a table
    #[arg(long)]
    json: bool,
}

/// Where none are named: all safe rules, LAMMPS's default, and one that looks at no particle.
const USUAL: [&str; 7] = [
    "every-step(streamed-nbs)",
    "verlet(streamed-nbs,skin=auto)",
    "verlet(streamed-nbs,rule=top-two)",
    "verlet(streamed-nbs,rule=half-skin)",
    "verlet(streamed-nbs,rule=summed)",
    "verlet(streamed-nbs,rule=lammps-0-1-yes)",
    "verlet(streamed-nbs,rule=every-10)",
];

/// Moves the scene, asks all trackers in every frame, and holds them to the truth.
pub fn track(options: &Track) -> anyhow::Result<ExitCode> {
    ensure!(options.frames >= 1, "--frames 0: at least one is needed");
    let texts: Vec<&str> = match options.trackers.is_empty() {
        true => USUAL.to_vec(),
        false => options.trackers.iter().map(String::as_str).collect(),
    };
    let trackers: Vec<TrackerSpec> =
        texts.into_iter().map(detectors::parse_tracker).collect::<Result<_, _>>()?;
    let Some((name, given)) = options.source.given()? else {
        anyhow::bail!(
            "name a particle file, or a scene such as packed:n=1000 (contactbench list scenes)"
        );
    };
    let scene = given.open(&name)?;
    let question = Question {
        trackers: &trackers,
        arithmetic: options.arithmetic,
        frames: options.frames,
        memory_limit: options.limit.bytes(scene.len()),
    };
    let followed = follow(&mut Frames::new(&scene, options.motion)?, &question)?;
    let mut out = std::io::stdout().lock();
    if options.json {
        writeln!(out, "{:#}", tracking::as_json(&name, options.motion, &followed))?;
    } else {
        let said = tracking::words(&name, options.motion, &followed);
        write!(out, "{}", crate::present::document::plain(&said, terminal::width()))?;
    }
    let wrong = followed.trackers.iter().any(|tracked| tracked.is_wrong());
    Ok(if wrong { ExitCode::FAILURE } else { ExitCode::SUCCESS })
}
