use std::io::Write as _;
use std::path::PathBuf;

use anyhow::{Context, bail, ensure};

use crate::cli::shared::input::Input;
use crate::cli::shared::values;
use contactbench_io::write::{self, SceneFormat};
use contactbench_run::run::machine::interrupt;
use contactbench_scenes::motion::{Frames, Motion};
use contactbench_terms::number::plural;

#[derive(clap::Args)]
pub struct Scene {
    /// Particle file, or a scene such as packed:n=200 (list scenes)
    #[arg(value_name = "FILE|SCENE", value_hint = clap::ValueHint::FilePath)]
    scene: String,
    #[command(flatten)]
    input: Input,
    /// Scene as .csv, .xyz or .npy [default: CSV on stdout]
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Motion, for --at or --frames (see: list motions)
    #[arg(long)]
    motion: Option<Motion>,
    /// Write frame K of the motion; frame 0 is the scene
    #[arg(long, requires = "motion", conflicts_with = "frames", value_name = "K")]
    #[arg(value_parser = values::whole::<u64>)]
    at: Option<u64>,
    /// Write this many frames of the motion, as .xyz
    #[arg(long, requires = "motion", value_name = "COUNT", value_parser = values::whole::<u64>)]
    frames: Option<u64>,
}

/// Makes or reads the scene and writes it, in numbers that read back to the same bits.
pub fn scene(options: &Scene) -> anyhow::Result<()> {
    interrupt::end_runners_too().context("cannot listen to Ctrl-C")?;
    let format = options.out.as_deref().map(write::scene_format).transpose()?;
    let mut given = options.input.given(&options.scene)?;
    if let Some(motion) = options.motion {
        let mut frames = Frames::new(&given, motion)?;
        match (options.at, options.frames) {
            (Some(k), _) => given = frames.at(k)?,
            (None, Some(count)) => {
                ensure!(
                    count >= 1 && format.is_none_or(|format| format == SceneFormat::Xyz),
                    "--frames {count}: frames, at least one, are written to one .xyz file; for \
                     another format take --at K, frame by frame"
                );
                return trajectory(options, &mut frames, count);
            }
            (None, None) => bail!("--motion needs --at K for one frame, or --frames COUNT"),
        }
    }
    match &options.out {
        Some(path) => {
            write::scene(path, &given)?;
            let scene = &given.scene;
            // An npy file has no names, and three columns of it are read as x, y and z.
            let plain = format == Some(SceneFormat::Npy) && scene.dim() == 2;
            let hint = if plain { "; read it with --dim 2" } else { "" };
            say!("{}: N = {}, {}D{hint}", path.display(), scene.len(), scene.dim());
        }
        None => {
            let mut out = std::io::BufWriter::new(std::io::stdout().lock());
            let format = match given.lattice {
                None => SceneFormat::Csv,
                Some(_) => SceneFormat::Xyz,
            };
            write::scene_to(&mut out, format, &given)
                .and_then(|()| out.flush())
                .context("cannot write the scene to standard output")?;
        }
    }
    Ok(())
}

/// Writes frames one by one, and keeps none in memory.
fn trajectory(options: &Scene, frames: &mut Frames, count: u64) -> anyhow::Result<()> {
    let mut each = |out: &mut dyn std::io::Write| {
        (0..count).try_for_each(|k| {
            write::scene_to(out, SceneFormat::Xyz, &frames.at(k)?)?;
            anyhow::Ok(())
        })
    };
    match &options.out {
        Some(path) => {
            write::whole(path, each).map_err(|error| write::of_file(error, path))?;
            say!("{}: {}", path.display(), plural(count as usize, "frame"));
        }
        None => {
            let mut out = std::io::BufWriter::new(std::io::stdout().lock());
            each(&mut out)?;
            out.flush().context("cannot write the frames to standard output")?;
        }
    }
    Ok(())
}
