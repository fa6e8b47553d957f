//! `contactbench track`.

use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use anyhow::{Context, ensure};

use crate::cli::shared::arithmetic::arithmetic;
use crate::cli::shared::limit::Limit;
use crate::cli::shared::progress::Counted;
use crate::cli::shared::scene::Source;
use crate::cli::shared::{input, terminal, values};
use crate::contact::Arithmetic;
use crate::experiment::detectors;
use crate::io::{self, Frame, Place};
use crate::moving::{Question, Recorded, follow};
use crate::present::tracking;
use crate::scene::Given;
use crate::scene::motion::{self, Frames, Kind, Motion};
use crate::track::TrackerSpec;

/// Options of `track`.
#[derive(clap::Args)]
pub struct Track {
    #[command(flatten)]
    source: Source,
    /// How particles move, with speed in diameters per frame (see: contactbench list motions;
    /// default: as a file of several frames says, else drift)
    #[arg(long)]
    motion: Option<Motion>,
    /// Frames, the scene itself among them (default: 100, or all of a file)
    #[arg(long, value_parser = values::whole::<u64>)]
    frames: Option<u64>,
    /// Who finds the contacts: every-step(DETECTOR), verlet(DETECTOR,rule=RULE,skin=S), the skin in
    /// diameters, or incremental(DETECTOR); may be said several times (default: the rules there
    /// are, over streamed-nbs)
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

/// Where no motion is named and the file has none: straight flight.
const MOTION: Motion = Motion { kind: Kind::Drift, speed: motion::SPEED, seed: motion::SEED };
/// Frames of a motion, where nobody says how many.
const FRAMES: u64 = 100;

/// Moves the scene, or takes the frames of a file; asks all trackers in every frame, and holds them
/// to the truth.
pub fn track(options: &Track) -> anyhow::Result<ExitCode> {
    ensure!(options.frames != Some(0), "--frames 0: at least one is needed");
    let texts: Vec<&str> = match options.trackers.is_empty() {
        true => USUAL.to_vec(),
        false => options.trackers.iter().map(String::as_str).collect(),
    };
    let trackers: Vec<TrackerSpec> =
        texts.into_iter().map(detectors::parse_tracker).collect::<Result<_, _>>()?;
    let Track { source: Source { scene, input }, motion, .. } = options;
    // Whoever names a motion or a frame wants that frame to move.
    let recorded = motion.is_none() && matches!(input.frame, None | Some(Frame::All));
    if let Some(path) = scene.as_deref().map(Path::new).filter(|path| recorded && path.exists()) {
        let all = io::Options { ids: true, ..input.options() };
        return input::frames(path, all, |frames| of_file(options, &trackers, path, frames));
    }
    let Some((name, given)) = options.source.given()? else {
        anyhow::bail!(
            "name a particle file, or a scene such as packed:n=1000 (contactbench list scenes)"
        );
    };
    moved(options, &trackers, &name, given)
}

/// Takes the frames of a file; one that is alone is moved.
fn of_file(
    options: &Track,
    trackers: &[TrackerSpec],
    path: &Path,
    mut frames: io::Frames<'_>,
) -> anyhow::Result<ExitCode> {
    let text = path.display().to_string();
    let name = path.file_name().map_or(text.clone(), |name| name.to_string_lossy().into_owned());
    let radius = options.source.input.radius;
    let none = || format!("{text} holds no frame of particles; is it of another format?");
    let first = frames.next().transpose()?.with_context(none)?;
    input::tell(&text, first.0.notices(), Place::Argument);
    let Some(second) = frames.next().transpose()? else {
        return moved(options, trackers, &name, first.0.given(&text, radius)?);
    };
    let particles = first.0.len();
    let all = [Ok(first), Ok(second)].into_iter().chain(frames);
    let mut recorded = Recorded::new(all, &text, radius);
    let count = options.frames.unwrap_or(u64::MAX);
    let mut next = |_| recorded.next_frame();
    followed(options, trackers, (&name, "as recorded"), particles, &mut next, count)
}

/// Moves a scene.
fn moved(
    options: &Track,
    trackers: &[TrackerSpec],
    name: &str,
    given: Given,
) -> anyhow::Result<ExitCode> {
    let particles = given.scene.len();
    let motion = options.motion.unwrap_or(MOTION);
    let mut frames = Frames::new(&given, motion)?;
    let count = options.frames.unwrap_or(FRAMES);
    let called = (name, &*motion.to_string());
    followed(options, trackers, called, particles, &mut |k| frames.at(k).map(Some), count)
}

/// Asks all trackers in every frame, and prints what they did.
fn followed(
    options: &Track,
    trackers: &[TrackerSpec],
    (name, motion): (&str, &str),
    particles: usize,
    next: &mut dyn FnMut(u64) -> anyhow::Result<Option<Given>>,
    frames: u64,
) -> anyhow::Result<ExitCode> {
    let memory_limit = options.limit.bytes(particles);
    let question = Question { trackers, arithmetic: options.arithmetic, frames, memory_limit };
    let progress = Counted::new(Some(frames).filter(|&frames| frames < u64::MAX));
    let frame = |k| {
        progress.frame(k);
        next(k)
    };
    let followed = follow(frame, &question)?;
    drop(progress);
    let mut out = std::io::stdout().lock();
    if options.json {
        writeln!(out, "{:#}", tracking::as_json(name, motion, &followed))?;
    } else {
        let said = tracking::words(name, motion, &followed);
        write!(out, "{}", crate::present::document::plain(&said, terminal::width()))?;
    }
    let wrong = followed.trackers.iter().any(|tracked| tracked.is_wrong());
    Ok(if wrong { ExitCode::FAILURE } else { ExitCode::SUCCESS })
}
