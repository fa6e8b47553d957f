use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, bail, ensure};

use crate::cli::shared::input::{self, doubt_given};
use crate::cli::shared::limit::Limit;
use crate::cli::shared::progress::Counted;
use crate::cli::shared::scene::Source;
use crate::cli::shared::sequence::{FRAMES, Sequence, Wanted, sequence};
use crate::cli::shared::{terminal, values};
use contactbench_detectors::tracker;
use contactbench_detectors::tracker::TrackerSpec;
use contactbench_ground::contact::{Arithmetic, Test};
use contactbench_ground::detect::Options;
use contactbench_ground::periodic::without_shift;
use contactbench_io as io;
use contactbench_io::pairs::List;
use contactbench_io::{Frame, Place};
use contactbench_scenes::motion::Motion;
use contactbench_scenes::touching::{in_any_box, in_open_space};
use contactbench_terms::number::plural;
use contactbench_views::draw::{self, Highlighted, Look, Slice};
use contactbench_views::film::{self, Film};

#[derive(clap::Args)]
pub struct Draw {
    #[command(flatten)]
    source: Source,
    /// Picture (.svg) or page (.html)
    #[arg(short, long, value_name = "FILE", default_value = "scene.svg")]
    out: PathBuf,
    /// Plane, as in z=0.5 [default: mistake or middle]
    #[arg(long, value_name = "PLANE")]
    slice: Option<Slice>,
    /// Contact list whose mistakes are drawn
    #[arg(long, value_name = "FILE")]
    pairs: Option<PathBuf>,
    /// Draw the whole scene (for --pairs)
    #[arg(long)]
    whole: bool,
    /// Print particle numbers [default: up to 60]
    #[arg(long, value_name = "BOOL", num_args = 0..=1, require_equals = true)]
    #[arg(hide_possible_values = true, default_missing_value = "true")]
    labels: Option<bool>,
    /// Draw the cells of a detector
    #[arg(long)]
    grid: bool,
    /// Page: motion (see: list) [default: by file]
    #[arg(long)]
    motion: Option<Motion>,
    /// Page: most frames [default: 100]
    #[arg(long, value_name = "COUNT", value_parser = values::whole::<u64>)]
    frames: Option<u64>,
    /// Page: tracker (see: list) [default: verlet]
    #[arg(long)]
    tracker: Option<String>,
    #[command(flatten)]
    limit: Limit,
}

const TRACKER: &str = "verlet(streamed-nbs,skin=auto)";

/// Draws the scene, and prints a summary on standard error.
pub fn draw(options: &Draw) -> anyhow::Result<ExitCode> {
    let place = options.out.display();
    let ending = options.out.extension().map(|it| it.to_string_lossy().to_ascii_lowercase());
    match ending.as_deref() {
        Some("svg") => {}
        Some("html") => return page(options),
        _ => {
            bail!("{place}: the file name must end in .svg for a picture, or in .html for a page")
        }
    }
    ensure!(
        options.motion.is_none() && options.frames.is_none() && options.tracker.is_none(),
        "--motion, --frames and --tracker need a page that plays; write one with -o NAME.html"
    );
    let (name, given) = options.source.given()?;
    doubt_given(&name, &given, Arithmetic::Exact);
    let periodic = in_any_box(&given)?;
    let (n, dim) = (periodic.scene().len(), periodic.scene().dim());
    let limit = options.limit.bytes(n);
    let pairs = match &options.pairs {
        None => Highlighted::from_scene(&periodic, limit).with_context(|| name.clone())?,
        Some(path) => {
            let mut list = list(path, options.source.input.frame.unwrap_or_default())?;
            if !given.has_box && !periodic.lattice().repeats() {
                list.without_box();
            }
            let pairs = Highlighted::compare(&periodic, &list, limit);
            pairs.with_context(|| path.display().to_string())?
        }
    };
    let look = Look {
        title: name.clone(),
        labels: options.labels,
        grid: options.grid,
        slice: options.slice,
        whole: options.whole,
    };
    let picture = draw::svg(&periodic, &pairs, &look)?;
    terminal::save(&options.out, picture.as_bytes(), "-o")?;
    let size = crate::cli::bytes(picture.len() as u64);
    let touching = || pairs.contacts.iter().chain(&pairs.missed);
    let mut found = plural(touching().count(), "contact");
    if periodic.lattice().repeats() {
        let across = touching().filter(|pair| pair.image != [0; 3]).count();
        found += &format!(", {across} of them across the box");
    }
    if options.pairs.is_some() {
        let Highlighted { missed, spurious, duplicates, .. } = &pairs;
        let [missed, spurious, repeated] = [missed, spurious, duplicates].map(Vec::len);
        found += &format!(", {missed} missed, {spurious} spurious, {repeated} repeated");
    }
    say!("{name}: N = {n}, {dim}D, {found}; {place} ({size})");
    Ok(ExitCode::SUCCESS)
}

/// Reads the contact list of the frame that is drawn.
fn list(path: &Path, frame: Frame) -> anyhow::Result<List> {
    let list = io::pairs::read(path, &[], frame)?;
    let name = path.display().to_string();
    input::tell(&name, &list.notices, Place::Argument);
    if let Some(frame) = list.frame {
        let step = list.step.map_or_else(String::new, |step| format!(" (step {step})"));
        say!("{name}: the list of frame {frame}{step} is drawn");
    }
    Ok(list)
}

/// Writes a page that plays the frames of a motion or a file.
fn page(options: &Draw) -> anyhow::Result<ExitCode> {
    let Draw { pairs, whole, labels, grid, .. } = options;
    ensure!(
        pairs.is_none() && !whole && labels.is_none() && !grid,
        "--pairs, --whole, --labels and --grid need a picture (-o NAME.svg); leave them out"
    );
    let tracker = tracker::parse(options.tracker.as_deref().unwrap_or(TRACKER))?;
    let play = |sequence: Sequence<'_>| play(options, &tracker, sequence);
    let Draw { motion, frames, .. } = *options;
    let wanted =
        Wanted { motion, otherwise: None, frames, of_file: FRAMES, arithmetic: Arithmetic::Exact };
    let done = sequence(&options.source, &wanted, play)?;
    done.context(
        "a page plays several frames, and there is one; add --motion drift, or name a file of \
         several frames without --frame",
    )
}

fn play(options: &Draw, tracker: &TrackerSpec, sequence: Sequence<'_>) -> anyhow::Result<ExitCode> {
    let Sequence { name, motion, particles, count, next, recorded } = sequence;
    let memory_limit = options.limit.bytes(particles);
    let mut at_work = tracker.make(Options { memory_limit, threads: 1 });
    let mut film = Film::new(name, motion, &tracker.to_string(), options.slice);
    let progress = Counted::new(None);
    let mut k = 0;
    while k < count
        && let Some(given) = next(k)?
    {
        progress.frame(k);
        ensure!(
            given.lattice.is_none(),
            "{name}: a page needs open boundaries, and the box of this scene repeats; add --open \
             for a file, or draw one frame as a picture"
        );
        let mut pairs = Vec::new();
        let step = at_work.step(&given.scene, Test::Exact, None, &mut pairs);
        let step = step.with_context(|| format!("frame {k}: {tracker}"))?;
        let frame = in_open_space(&given.scene)?;
        let pairs =
            Highlighted::from_scene(&frame, memory_limit)?.against(without_shift(&pairs).collect());
        ensure!(
            pairs.spurious.is_empty() && pairs.duplicates.is_empty(),
            "frame {k}: {tracker} reported pairs that do not touch, or repeated some; this is a \
             defect of the tracker"
        );
        film.take(&frame, &pairs, step.built)?;
        k += 1;
    }
    // Whether the file has further frames; one that cannot be read counts, too.
    let more = recorded && k == count && !matches!(next(k), Ok(None));
    drop(progress);
    let (html, place) = (film::html(&film), options.out.display());
    terminal::save(&options.out, html.as_bytes(), "-o")?;
    let size = crate::cli::bytes(html.len() as u64);
    let more = if more { " The file has more frames (--frames)." } else { "" };
    say!("{name}: {}{more} {place} ({size})", film.summary());
    Ok(ExitCode::SUCCESS)
}
