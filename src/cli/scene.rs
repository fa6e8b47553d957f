//! `contactbench scene`: writes one.

use std::io::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context;

use crate::cli::shared::input::Input;
use crate::cli::shared::values;
use crate::io::write;

/// Options of `scene`.
#[derive(clap::Args)]
pub struct Scene {
    /// A generator such as packed:dim=3,n=1000,seed=1 (see contactbench list scenes), or a particle
    /// file
    #[arg(value_parser = values::SCENE, hide_possible_values = true)]
    scene: String,
    #[command(flatten)]
    input: Input,
    /// Where the scene goes: a .csv, .xyz (extended XYZ) or .npy file (default: CSV to standard
    /// output); with a box that repeats .xyz, which holds one
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// Makes or reads the scene and writes it, in numbers that read back to the same bits.
pub fn scene(options: &Scene) -> anyhow::Result<ExitCode> {
    if let Some(path) = &options.output {
        write::scene_format(path)?;
    }
    let given = options.input.given(&options.scene)?;
    match &options.output {
        Some(path) => {
            write::scene(path, &given)?;
            let scene = &given.scene;
            eprintln!("{}: N = {}, {}D", path.display(), scene.len(), scene.dim());
        }
        None => {
            let mut out = std::io::BufWriter::new(std::io::stdout().lock());
            let format = match given.lattice {
                None => write::SceneFormat::Csv,
                Some(_) => write::SceneFormat::Xyz,
            };
            write::scene_to(&mut out, format, &given)
                .and_then(|()| out.flush())
                .context("cannot write the scene to standard output")?;
        }
    }
    Ok(ExitCode::SUCCESS)
}
