//! `contactbench draw`.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context, bail};

use crate::cli::shared::limit::Limit;
use crate::cli::shared::scene::Source;
use crate::io::{self, Frame};
use crate::number::plural;
use crate::periodic::Periodic;
use crate::present::draw;
use crate::present::draw::{Boxed, Highlighted, Look, Slice};
use crate::scene::Given;

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
    /// A list of pairs (CSV: i,j; in a box with the image, i,j,sx,sy[,sz]): what it missed is drawn
    /// red and dashed, what it added orange
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
    let Some((name, Given { scene, lattice, has_box, .. })) = options.source.given()? else {
        bail!("there is nothing to draw; name a particle file, or a scene such as packed:n=200");
    };
    let limit = options.limit.bytes(scene.len());
    let look = Look {
        title: name.clone(),
        labels: options.labels,
        grid: options.grid,
        slice: options.slice,
        whole: options.whole,
    };
    let what = format!("N = {}, {}D", scene.len(), scene.dim());
    let (picture, contacts, across, wrong) = match lattice {
        None => {
            let pairs = match &options.pairs {
                None => Highlighted::from_scene(&scene, limit)?,
                Some(path) => Highlighted::compare(&scene, draw::read(path, has_box)?, limit)
                    .with_context(|| path.display().to_string())?,
            };
            let Highlighted { contacts, missed, spurious, duplicates, .. } = &pairs;
            let wrong = [missed.len(), spurious.len(), duplicates.len()];
            let count = contacts.len() + missed.len();
            (draw::svg(&scene, &pairs, &look)?, count, String::new(), wrong)
        }
        Some(lattice) => {
            let periodic = Periodic::new(scene, lattice)?;
            let boxed = match &options.pairs {
                None => Boxed::new(&periodic, None, limit).with_context(|| name.clone())?,
                Some(path) => {
                    let list = io::pairs::read(path, &[], Frame::Only)?;
                    Boxed::new(&periodic, Some(&list), limit)
                        .with_context(|| path.display().to_string())?
                }
            };
            let across = format!(", {} of them across the box", boxed.across);
            (draw::svg_in_box(&boxed, &look)?, boxed.contacts, across, boxed.wrong)
        }
    };
    let bytes = if png { crate::present::svg::png(&picture)? } else { picture.into_bytes() };
    io::write::whole(&options.output, |out| out.write_all(&bytes))
        .with_context(|| format!("cannot write {place}; choose another place with -o"))?;
    let size = crate::cli::bytes(bytes.len() as u64);
    let [missed, spurious, repeated] = wrong;
    let contacts = plural(contacts, "contact");
    let wrong = match &options.pairs {
        None => String::new(),
        Some(_) => format!(", {missed} missed, {spurious} spurious, {repeated} repeated"),
    };
    eprintln!("{name}: {what}, {contacts}{across}{wrong}; {place} ({size})");
    Ok(ExitCode::SUCCESS)
}
