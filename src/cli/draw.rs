//! `contactbench draw`.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context, bail};

use crate::cli::shared::limit::Limit;
use crate::cli::shared::scene::Source;
use crate::io;
use crate::present::draw;
use crate::present::draw::{Highlighted, Look, Slice};

/// Options of `draw`.
#[derive(clap::Args)]
pub struct Draw {
    #[command(flatten)]
    source: Source,
    /// Where the picture goes: a .svg or .png file
    #[arg(short, long, default_value = "scene.svg")]
    output: PathBuf,
    /// For spheres: the plane that is drawn, as in z=0.5 (default: through the worst mistake of
    /// --pairs, else through the middle along z)
    #[arg(long)]
    slice: Option<Slice>,
    /// A list of pairs (CSV: i,j): what it missed is drawn red and dashed, what it added orange
    #[arg(long)]
    pairs: Option<PathBuf>,
    /// With --pairs: all of the scene, also where the mistakes are too small to be seen
    #[arg(long)]
    whole: bool,
    /// Writes the particles' numbers, or not (default: up to 60 particles)
    #[arg(long, num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    labels: Option<bool>,
    /// Draws the cells of a detector
    #[arg(long)]
    grid: bool,
    #[command(flatten)]
    limit: Limit,
}

/// Draws the scene, and says on standard error what there is to see.
pub fn draw(options: &Draw) -> anyhow::Result<ExitCode> {
    let place = options.output.display();
    let png = match options
        .output
        .extension()
        .map(|ending| ending.to_string_lossy().to_ascii_lowercase())
        .as_deref()
    {
        Some("svg") => false,
        Some("png") => true,
        _ => bail!("{place}: the ending of a picture must be .svg or .png"),
    };
    let Some((name, scene)) = options.source.get()? else {
        bail!("there is nothing to draw; name a particle file, or a scene such as packed:n=200");
    };
    let limit = options.limit.bytes(scene.len());
    let pairs = match &options.pairs {
        None => Highlighted::from_scene(&scene, limit)?,
        Some(path) => Highlighted::compare(&scene, draw::read(path)?, limit)
            .with_context(|| path.display().to_string())?,
    };
    let labels = options.labels;
    let picture = draw::svg(
        &scene,
        &pairs,
        &Look {
            title: name.clone(),
            labels,
            grid: options.grid,
            slice: options.slice,
            whole: options.whole,
        },
    )?;
    let bytes = if png { crate::present::svg::png(&picture)? } else { picture.into_bytes() };
    io::write::whole(&options.output, |out| out.write_all(&bytes))
        .with_context(|| format!("cannot write {place}; choose another place with -o"))?;
    let size = crate::cli::bytes(bytes.len() as u64);
    let wrong = match &options.pairs {
        None => String::new(),
        Some(_) => format!(
            ", {} missed, {} spurious, {} repeated",
            pairs.missed.len(),
            pairs.spurious.len(),
            pairs.duplicates.len()
        ),
    };
    let contacts = pairs.contacts.len() + pairs.missed.len();
    eprintln!(
        "{name}: N = {}, {}D, {contacts} contacts{wrong}; {place} ({size})",
        scene.len(),
        scene.dim()
    );
    Ok(ExitCode::SUCCESS)
}
